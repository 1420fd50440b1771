"""Equilibrium equations of rods in exact geometry, as functions of the displacements of their particles.

The unknowns are the displacements of particles with rods in their free directions: a vector of shape (N,),
or a field (n, 2) over all particles. Lengths in m, forces in kN.

Where members bend, fields are (n, 3): the third coordinate of a particle is the rotation (rad) of its rigid rod ends, and
what acts along it a moment (kN·m). What is called displacement or force here has three then.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from pinjoint.components.arrays import ROUND_OFF, Array, Flags, Rows
from pinjoint.components.derived import with_full_turns
from pinjoint.components.field import SMALLEST
from pinjoint.components.mistake import WrongValue
from pinjoint.components.model import Model
from pinjoint.components.particle import spring_stiffness, turned, turned_supports
from pinjoint.components.rod import bends
from pinjoint.components.table import flags
from pinjoint.components.theory import EXACT, FIRST_ORDER, THEORIES
from pinjoint.systems.islands import lowest_joined
from pinjoint.systems.statics.assembly import Assembly, Matrix, spread_by_ends
from pinjoint.systems.statics.behind import rest
from pinjoint.systems.statics.bending import Bending, Bent, at_limits, flows, yielding
from pinjoint.systems.statics.response import Branches, Piece, Response, of_axes

if TYPE_CHECKING:  # only large structures need it
    from scipy.sparse import csc_matrix


TURNS_ONLY = 1e-9  # m/rad: a motion that shifts particles by less is one of rotations
MOST_ITERATIONS = 60  # for the axial force of a rod with plastic hinges
UNBALANCED = 1e-13  # of the largest force, by the length of a rod: a moment that is round-off
AT_LIMIT = 1e-10  # share of its strength within which a rod counts as yielding
# Of the rods' stiffness at the same particle: a motion that is resisted less counts as not resisted.
SOFT = 1e-12


def largest(values: Array) -> float:
    """The largest absolute value in an array; 0 of an empty one."""
    return float(np.abs(values).max(initial=0.0))


def normalised(motion: Array) -> Array:
    """A motion (n, 2 or 3) scaled so that the particle that moves most moves by 1; one of rotations, turns by 1."""
    size = np.hypot(*motion[:, :2].T).max()
    if motion.shape[1] > 2 and size <= TURNS_ONLY * np.abs(motion[:, 2]).max():
        size = np.abs(motion[:, 2]).max()
    return motion / size


def upright(motion: Array) -> Array:
    """A normalised motion (n, 2 or 3) or its opposite: that of which the largest part, if any a shift, is positive."""
    shifts = np.abs(motion[:, :2]).max() > 0.5
    part = np.abs(motion) * np.array([1.0, 1.0, 0.0 if shifts else 1.0])[: motion.shape[1]]
    return motion if motion.ravel()[part.argmax()] > 0.0 else -motion


@dataclass(frozen=True)
class Structure:
    """The rods of a model and the directions in which its particles are free, as arrays.

    ends: rows of the particles at both ends, (rods, 2). difference: between their original positions.
    unknown: the free directions that are solved for, (n, 2): those of particles with rods, less one of
        every body that nothing holds along an axis (its translation is arbitrary). Where members bend,
        (n, 3) with the rotations of particles with rigid rod ends, as `fixed` with their clamps.
    body: number of the connected body of each particle, (n,).
    springs: stiffness of elastic supports, 0 in fixed directions, (n, 2) or (n, 3). angle: by which the axes of supports are
        turned (rad), (n,): `fixed`, `springs` and `unknown` are along these, fields along x and y.
    sense: 1 for cables (tension only) and struts, −1 for contacts (compression only), else 0. buckling_load: of struts
        (kN), infinite of others.
    own_weight: stiffness added to that of its rods in the `weight` of a particle (kN/m), (n,).
    flat: rods whose axis keeps its direction, such as contacts with a straight side.
    first_order: elongations and equilibrium about the original positions. inextensible: rows of the rods that keep their
        lengths, which first-order theory alone heeds.
    bending: of the rods; None where none bends. ends_yield: some have plastic moments, or have turned in plastic hinges.
    sparse: matrices are, above DENSE unknowns.
    """

    position: Array
    ends: Rows
    difference: Array
    original_length: Array
    rest_length: Array
    misfit: Array
    stiffness: Array
    tension_limit: Array
    compression_limit: Array
    sense: Array
    fixed: Flags
    springs: Array
    angle: Array
    unknown: Flags
    body: Rows
    own_weight: Array
    flat: Flags
    first_order: bool
    inextensible: Rows
    buckling_load: Array
    bending: Bending | None = None
    ends_yield: bool = False
    sparse: bool = True

    @classmethod
    def of(cls, model: Model, theory: str = EXACT) -> Structure:
        """The structure of a model in "first-order" or "exact" theory; without plasticity no rod yields."""
        if theory not in THEORIES:
            raise WrongValue("Theory is '{theory}'; it must be 'first-order' or 'exact'.", theory=theory)
        particles, rods = model.particles, model.rods
        yields = bool(model.settings.plasticity)
        firm = rods.inextensible & (theory == FIRST_ORDER)
        buckling_load = np.where(
            firm | (yields & np.isfinite(rods.compression_limit)), np.inf, rods.buckling_load
        )
        ends = rods.between.astype(np.intp)
        body = np.unique(lowest_joined(particles.count, ends), return_inverse=True)[1]
        bending = Bending.of(model, bows=theory == EXACT) if bends(model) else None
        width = 2 if bending is None else 3
        fixed = np.column_stack([particles.fixed, particles.fixed_rotation])[:, :width]
        springs = spring_stiffness(model)[:, :width]
        angle, held = np.where(turned_supports(model), particles.support_angle, 0.0), fixed | (springs > 0.0)
        held[angle != 0.0, :2] = True  # in part, along x and y
        return cls(
            position=particles.position.copy(),
            ends=ends,
            difference=rods.difference.copy(),
            original_length=np.where(rods.original_length < SMALLEST, 0.0, rods.original_length),
            rest_length=rods.rest_length.copy(),
            misfit=rods.misfit.copy(),
            stiffness=rods.stiffness.copy(),
            tension_limit=np.where(yields & ~firm, rods.tension_limit, np.inf),
            compression_limit=np.where(yields & ~firm, rods.compression_limit, np.inf),
            sense=(rods.tension_only | np.isfinite(buckling_load)).astype(np.float64),
            fixed=fixed,
            springs=springs,
            angle=angle,
            unknown=_held_by_rods(springs, ends, bending) & ~fixed & ~_arbitrary(held, body),
            body=body,
            own_weight=np.zeros(particles.count),
            flat=np.zeros(rods.count, dtype=bool),
            first_order=theory == FIRST_ORDER,
            inextensible=np.flatnonzero(firm),
            buckling_load=buckling_load,
            bending=bending,
            ends_yield=bool(np.isfinite(rods.moment_limit).any() or rods.plastic_rotation.any()),
        )

    def with_translations(self) -> Structure:
        """The same structure with the arbitrary translations of free bodies among the unknowns."""
        return replace(self, unknown=_held_by_rods(self.springs, self.ends, self.bending) & ~self.fixed)

    def unsupported(self) -> Structure:
        """The same structure without supports."""
        free = replace(self, fixed=np.zeros_like(self.fixed), springs=np.zeros_like(self.springs))
        return free.with_translations()

    @property
    def unyielding(self) -> Structure:
        """The same structure without limits to any force."""
        limitless, bending = np.full(len(self.ends), np.inf), self.bending
        if bending is not None:
            bending = replace(bending, moment_limit=np.full_like(bending.moment_limit, np.inf))
        return replace(self, tension_limit=limitless, compression_limit=limitless, bending=bending)

    @property
    def gives_way(self) -> bool:
        """True if some rod may yield, slacken or buckle by itself."""
        limits = self.tension_limit, self.compression_limit
        return bool(self.sense.any() or self.ends_yield or np.isfinite(limits).any())

    @property
    def struts(self) -> Flags:
        """Rods that may buckle by themselves."""
        return np.isfinite(self.buckling_load)

    def buckled(self, slack: Flags) -> Flags:
        """Of what is slack, the struts, in its shape."""
        return slack & (self.struts if slack.ndim == 1 else self.struts[:, None])

    @cached_property
    def softening(self) -> Array:
        """What remains of the stiffness EA of one-sided rods once they have given way: of struts P/2, in exact geometry."""
        return np.where(self.struts & (not self.first_order), 0.5 * self.buckling_load / self.stiffness, 0.0)

    def given_way(self, elastic: Array) -> Array:
        """The axial forces (rods,) of one-sided rods and struts that have given way, by what they would be before."""
        edge = self._edge
        return edge + self.softening * (elastic - edge)

    def stored_aside(self, response: Response) -> Array:
        """Twice what struts that have buckled store besides N² L₀/2EA (kN·m), (rods,): by bending, and at P."""
        load, force = np.where(self.struts, self.buckling_load, 0.0), response.axial_force
        beyond = self.stiffness * self.folded(response)
        stored = load**2 + 2.0 * load * beyond + self.softening * beyond**2 - force**2
        buckled = (beyond > 0.0) & (force > of_axes(response.elastic_force))
        return np.where(buckled, self.rest_length / self.stiffness * stored, 0.0)

    def folded(self, response: Response) -> Array:
        """By what share of their length the ends of struts come nearer by bending aside, (rods,)."""
        beyond: Array = -of_axes(response.elastic_force) - np.where(self.struts, self.buckling_load, np.inf)
        return np.maximum(beyond, 0.0) / self.stiffness

    @cached_property
    def _edge(self) -> Array:
        """The elastic force at which one-sided rods slacken, and struts buckle."""
        return np.where(self.struts, -self.buckling_load, 0.0)

    @property
    def supported(self) -> Flags:
        """Directions in which supports hold particles, rigidly or elastically."""
        return self.fixed | (self.springs > 0.0)

    def of_supports(self, field: Array) -> Array:
        """A field in fixed directions, else 0."""
        return self.along_axes(np.where(self.fixed, self.along_supports(field), 0.0))

    def along_supports(self, field: Array) -> Array:
        """A field along the axes of supports."""
        return turned(field, self.angle)

    def along_axes(self, field: Array) -> Array:
        """A field along x and y, of one along the axes of supports."""
        return turned(field, -self.angle)

    def of_unknowns(self, field: Array) -> Array:
        """A field in the directions of unknowns, else 0."""
        return self.spread(self.gather(field))

    def reactions(self, response: Response, load: Array) -> Array:
        """Forces of supports on the particles under a load (n, …)."""
        found: Array = self.of_supports(self.internal(response) - load) - response.spring_force
        return found + 0.0

    def unbalanced(self, response: Response, load: Array) -> float:
        """The largest force (kN) that nothing holds under a load (n, …)."""
        left = self.internal(response) - load
        return self.largest(left - self.of_supports(left))

    def grown(self, share: float) -> Structure:
        """The same structure with a share of its lack of fit and warmth."""
        bending = self.bending
        if bending is not None:
            bending = replace(bending, initial_slopes=share * bending.initial_slopes)
        return replace(self, misfit=share * self.misfit, bending=bending)

    # --- unknowns ----------------------------------------------------------------------------------

    @property
    def index(self) -> Rows:
        """Indices of the unknowns in a flattened field, (N,)."""
        return self.assembly.index

    @cached_property
    def assembly(self) -> Assembly:
        """Where the entries of rods' matrices go."""
        return Assembly.of(self.ends, self.unknown, sparse=self.sparse)

    @property
    def size(self) -> int:
        """The number of unknowns N."""
        return len(self.index)

    @property
    def width(self) -> int:
        """Coordinates of a particle: 2, or 3 where members bend."""
        return int(self.unknown.shape[1])

    def field(self, displacement: Array, rotation: Array) -> Array:
        """Displacements (n, 2) and rotations (n,) as one field; particles without rigid rod ends have no rotation."""
        if self.bending is None:
            return displacement
        rigid = flags(self.ends[self.bending.rigid], len(rotation))
        return np.column_stack([displacement, np.where(rigid, rotation, 0.0)])

    def rotation(self, field: Array) -> Array:
        """The rotations (or moments) in a field (n,); zeros where nothing bends."""
        return field[:, 2] if self.bending is not None else np.zeros(len(field))

    def end_moments(self, response: Response) -> Array:
        """Moments on the ends of all rods, (rods, 2)."""
        return response.bent.moment if response.bent is not None else np.zeros(self.ends.shape)

    @cached_property
    def lever(self) -> Array:
        """What forces in a field are multiplied by where they are compared, (n, 2), or (n, 3): moments, by 1/the shortest
        rod (1/m) at the particle."""
        lever = np.ones(self.unknown.shape)
        if self.bending is not None:
            shortest = np.full(len(self.position), np.inf)
            np.minimum.at(shortest, self.ends, self.rest_length[:, None])
            lever[:, 2] = 1.0 / shortest
        return lever

    @cached_property
    def measure(self) -> Array:
        """What unknowns are multiplied by where they are compared, (N,): rotations, by the mean length (m) of what bends."""
        measure = np.ones(self.unknown.shape)
        if self.bending is not None:
            bent = self.bending.rigid.any(axis=1)
            measure[:, 2] = self.rest_length[bent].mean() if bent.any() else 1.0
        return self.along_unknowns(measure)

    def largest(self, field: Array) -> float:
        """The largest force (kN) in a field of forces, moments counting by their levers."""
        return largest(field) if self.bending is None else largest(field * self.lever)

    def largest_force(self, response: Response) -> float:
        """The largest axial force (kN) of a rod, or end moment over its rest length."""
        pulled = largest(response.axial_force)
        if response.bent is None:
            return pulled
        return max(pulled, largest(response.bent.moment / self.rest_length[:, None]))

    def greatest(self, vector: Array) -> float:
        """The same of the unknowns' forces."""
        return largest(vector) if self.bending is None else largest(vector * self.along_unknowns(self.lever))

    def gather(self, field: Array) -> Array:
        """The unknowns in a field."""
        return self.along_unknowns(self.along_supports(field))

    def along_unknowns(self, values: Array) -> Array:
        """Of values along the axes of supports (n, …), or alike along all axes, those of unknowns."""
        return values.ravel()[self.index]

    @property
    def unknown_springs(self) -> Array:
        """The stiffness of springs along each unknown, (N,)."""
        return self.along_unknowns(self.springs)

    def spread(self, vector: Array) -> Array:
        """A vector of unknowns as a field, zero elsewhere."""
        field = np.zeros(self.unknown.shape)
        field.ravel()[self.index] = vector
        return self.along_axes(field)

    def fields(self, vectors: Array) -> Array:
        """Vectors of unknowns (N, k) as fields (k, n, 2)."""
        return np.array([self.spread(vector) for vector in vectors.T]).reshape(
            vectors.shape[1], *self.unknown.shape
        )

    def motions(self, vectors: Array) -> Array:
        """The same, the largest motion of each 1."""
        fields = self.fields(vectors)
        return np.array([normalised(field) for field in fields]).reshape(fields.shape)

    def relative(self, field: Array) -> Array:
        """Second end minus first end of every rod, (rods, 2)."""
        return field[self.ends[:, 1], :2] - field[self.ends[:, 0], :2]

    def turns(self, field: Array) -> Array:
        """The rotations at both ends of every rod, (rods, 2)."""
        return field[self.ends, 2]

    def move(self, vector: Array, response: Response) -> float:
        """The largest change of a rod, in length or direction relative to its reach, or of the slope of an end."""
        field = self.spread(vector)
        change, reach = np.hypot(*self.relative(field).T), response.reach
        moved = change > 0.0
        with np.errstate(divide="ignore"):  # the ends may be at the same place, as yet
            largest_move = float((change[moved] / reach[moved]).max(initial=0.0))
        if self.bending is None:
            return largest_move
        return max(largest_move, largest(self.slope_rates(field, response)))

    def elongation_rate(self, vector: Array, response: Response) -> Array:
        """Rate of elongation of the axis of every rod when the unknowns change at this rate."""
        field = self.spread(vector)
        rate: Array = (self.relative(field) * response.axis).sum(axis=1)
        if response.bent is not None:
            rate += (response.bent.bowed * self.slope_rates(field, response)).sum(axis=1)
        return rate

    def rates(self, vector: Array, response: Response, soft: Flags, share: float = 0.0) -> Array:
        """Rates of elongation of the axes when unknowns change at this rate, and the share of the distributed forces.

        Where ends yield, (rods, 3), with the rates at which those that are soft turn in their hinges, and of others the
        moment over `own_stiffness`.
        """
        rate = self.elongation_rate(vector, response)
        if soft.ndim == 1 or self.bending is None or response.bent is None:
            return rate
        ends = self.spread(vector)[self.ends].reshape(-1, 6, 1)
        hessian = self._hessian(response, soft)
        moment = (hessian[:, 2:] @ self._ways(response) @ ends)[:, :, 0]
        moment += share * self.bending.carried(response.bent, response.axis, response.length, False)[0]
        turned = flows(hessian[:, 2:, 2:], moment, soft[:, 1:])
        moment = moment - (hessian[:, 2:, 2:] @ turned[:, :, None])[:, :, 0]
        own = self.own_stiffness[:, 1:]
        held = np.divide(moment, own, out=np.zeros_like(moment), where=own > 0.0)
        rate = rate - (response.bent.bowed * turned).sum(axis=1)
        return np.column_stack([rate, np.where(soft[:, 1:], turned, held)])

    def deformation_rates(self, vector: Array, response: Response) -> Array:
        """Rates of what `Response.deformation` is, when the unknowns change at this rate."""
        rate = self.elongation_rate(vector, response)
        if response.flowing.ndim == 1:
            return rate
        return np.column_stack([rate, self.slope_rates(self.spread(vector), response)])

    def _ways(self, response: Response) -> Array:
        """What `Bending.ways` is, of these rods."""
        assert self.bending is not None
        return self.bending.ways(response.axis, response.length)

    def efforts(self, response: Response, parts: Flags, slack: Flags) -> tuple[Array, Array]:
        """What these of all that can yield, (rods, 3), of which nothing flows, have of forces by the unknowns (k, N), and by
        the deformations of each other (k, k)."""
        hessian, (rod, part) = self._hessian(response, slack), np.nonzero(parts)
        place = np.array([0, 2, 3])[part]
        by_ends = (hessian[rod, place][:, None] @ self._ways(response)[rod])[:, 0]
        together = np.where(rod[:, None] == rod, hessian[rod[:, None], place[:, None], place], 0.0)
        return self._in_full(by_ends, rod), together

    def slope_rates(self, field: Array, response: Response) -> Array:
        """Rates of the slopes of the rods' ends, (rods, 2), when all particles move at these rates."""
        assert self.bending is not None
        return self.bending.slope_rates(self.relative(field), self.turns(field), response.axis, response.length)

    @cached_property
    def extent(self) -> float:
        """The larger side of the box around the original positions (m), at least the longest rod."""
        box = float(np.ptp(self.position, axis=0).max()) if len(self.position) else 0.0
        return max(box, float(self.rest_length.max(initial=0.0)))

    @cached_property
    def weight(self) -> Array:
        """Sum of EA/L₀ of the rods at each unknown's particle (kN/m), the scale of its stiffness, (N,).

        Of rotations, of what rigid ends there resist (kN·m).
        """
        per_rod = self.stiffness / self.rest_length
        total = np.bincount(self.ends.ravel(), np.repeat(per_rod, 2), len(self.position)).astype(np.float64)
        weight = np.repeat(total + self.own_weight, 2).reshape(-1, 2)
        if self.bending is not None:
            of_ends = self.bending.end_stiffness[:, ::2].ravel()
            weight = np.column_stack([weight, np.bincount(self.ends.ravel(), of_ends, len(weight))])
        return self.along_unknowns(weight + self.springs)

    def effort(self, vector: Array, response: Response) -> float:
        """The energy (kN·m) beside which that of a motion is round-off: of rods that resist it with all they have.

        Where members bend, moving across their axes takes far less than along them, and the more so the more rods divide
        them: then of its parts along both axes, without regard to their signs; of bars, of all of it.
        """
        if self.bending is None:
            return float(vector @ (self.weight * vector))
        field, axis = self.spread(vector), np.abs(response.axis)
        change, turns = np.abs(self.relative(field)), np.abs(self.turns(field))
        bar = ~self.bending.end_stiffness.any(axis=1)
        along = np.where(bar, np.hypot(*change.T), (axis * change).sum(axis=1))
        leaning = (axis * change[:, ::-1]).sum(axis=1) / np.where(
            response.length > 0.0, response.length, np.inf
        )
        bent = self.bending.end_stiffness[:, ::2] * (turns + leaning[:, None]) ** 2
        sprung = (self.springs * self.along_supports(field) ** 2).sum()
        return float((self.stiffness / self.rest_length) @ along**2 + bent.sum() + sprung)

    def round_off_of_energy(self, vector: Array) -> float:
        """The energy (kN·m) of a motion that the rounding of short members' stiffness, 12 EI/L³, may bring about."""
        if self.bending is None:
            return 0.0
        summed = self._turned_by(np.abs(self.spread(vector)))
        return float(ROUND_OFF * (self.bending.end_stiffness[:, ::2] * summed**2).sum())

    # --- forces --------------------------------------------------------------------------------------

    @cached_property
    def unmoved(self) -> Response:
        """The rods at the original positions without plastic strain.

        Found without a rest: until it is, Python 3.11 lets no thread find that of any other structure.
        """
        return self._response(np.zeros(self.unknown.shape), np.zeros(len(self.ends)))

    @cached_property
    def initial_tangent(self) -> Matrix:
        """The tangent at the original positions, without axial forces and with taut cables."""
        return self.tangent(self.unmoved, np.zeros(len(self.ends), dtype=bool), geometric=False)

    @property
    def stiffnesses(self) -> Array:
        """k of every rod at the original positions, along the axes of supports, (rods, 2 × width, 2 × width)."""
        rigid = np.zeros(len(self.ends), dtype=bool)
        return self._turned(self.tangents(self.unmoved, rigid, geometric=False))

    def respond(
        self, displacement: Array, plastic_strain: Array, share: float = 0.0, piece: Piece | None = None
    ) -> Response:
        """Axial forces N = EA (ε − ε_p), ε = (L − L₀)/L₀, limited by yielding; both limits move with ε_p.

        share: of the distributed forces that acts between the ends. piece: of the laws, as if it went on for ever;
        None: by their laws.
        """
        rest()
        return self._response(displacement, plastic_strain, share, piece)

    def _response(
        self, displacement: Array, plastic_strain: Array, share: float = 0.0, piece: Piece | None = None
    ) -> Response:
        change = self.relative(displacement)
        stretch, axis, length = self._stretch(change)
        plastic_strain = self.yielding_parts(plastic_strain)
        elongation, permanent, turned = stretch + self.misfit, of_axes(plastic_strain), None
        if self.bending is not None:
            slopes = self.turns(displacement) - self.chords(displacement)[:, None]
            slopes = np.where(self.bending.rigid, slopes, 0.0)
            if self.ends_yield:
                slopes = slopes - plastic_strain[:, 1:]
                turned, flows_there = self._turned_in_hinges(elongation, slopes, axis, permanent, share, piece)
                slopes = slopes - turned
            elongation = elongation + self.bending.bow(slopes)[1]
        strain = elongation / self.rest_length
        elastic, slack, force = self._pull(strain, permanent, piece)
        flowing = (force != elastic) & ~slack
        bent = None
        if self.bending is not None:
            bent = self.bending.bent(slopes, force, axis, length, share, couples=not self.first_order)
        found = Response(
            elongation=elongation,
            strain=strain,
            length=length,
            axis=axis,
            elastic_force=elastic,
            axial_force=force,
            plastic_strain=np.where(
                flowing, strain - force / np.where(flowing, self.stiffness, 1.0), permanent
            ),
            flowing=flowing,
            slack=slack,
            round_off=self._round_off_of_forces(displacement, permanent, bent),
            bent=bent,
            share=share,
            spring_force=self._pull_of_springs(displacement) if self.is_sprung else 0.0,
        )
        return found if turned is None else self._with_ends(found, plastic_strain[:, 1:], turned, flows_there)

    def _pull(self, strain: Array, permanent: Array, piece: Piece | None) -> tuple[Array, Flags, Array]:
        """Axial forces as if no rod yielded, which are slack, and axial forces."""
        elastic = self.stiffness * (strain - permanent)
        if piece is not None:
            slack, flowing, edge = (of_axes(part) for part in (piece.slack, piece.flowing, piece.edge))
            firm = np.where(flowing, edge, elastic)
        else:
            slack = self.sense * (elastic - self._edge) < 0.0
            firm = np.clip(elastic, -self.compression_limit, self.tension_limit)
        return elastic, slack, np.where(slack, self.given_way(elastic), firm)

    # --- plastic hinges ------------------------------------------------------------------------------

    def yielding_parts(self, permanent: Array) -> Array:
        """What is permanent in all that can yield, of that of rods (rods,) or also of their ends, (rods, 3)."""
        if not self.ends_yield:
            return of_axes(permanent)
        return permanent if permanent.ndim > 1 else np.pad(permanent[:, None], ((0, 0), (0, 2)))

    @cached_property
    def own_stiffness(self) -> Array:
        """Of all that can yield, the force by its own deformation: EA/L₀ (rods,), where ends yield (rods, 3)."""
        along = self.stiffness / self.rest_length
        if self.bending is None or not self.ends_yield:
            return along
        return np.column_stack([along, self.bending.end_stiffness[:, ::2]])

    def _turned_in_hinges(
        self, stretch: Array, slopes: Array, axis: Array, permanent: Array, share: float, piece: Piece | None
    ) -> tuple[Array, Flags]:
        """By how much ends turn in plastic hinges, (rods, 2), and which do; slopes: if none did.

        stretch: of the chords, with misfit. The axial force of a rod whose ends flow follows from its bow, and this from the
        force: Newton's method, within what it has found the answer to be between.
        """
        bending = self.bending
        assert bending is not None
        turned, flowing = np.zeros_like(slopes), np.zeros(slopes.shape, dtype=bool)
        if piece is not None:
            flowing, edge = piece.flowing[:, 1:], piece.edge[:, 1:]
        elastic, _, axial = self._pull((stretch + bending.bow(slopes)[1]) / self.rest_length, permanent, piece)
        low, high = np.full_like(axial, -np.inf), np.full_like(axial, np.inf)
        for _ in range(MOST_ITERATIONS):
            moment = bending.end_moments(slopes, axial, axis, share)
            stiffness = bending.by_slopes(axial)
            if piece is None:
                sense = yielding(stiffness, moment, bending.moment_limit)
                flowing, edge = sense != 0.0, at_limits(sense, bending.moment_limit)
            if not flowing.any():
                break
            turned = flows(stiffness, moment - edge, flowing)
            if not bending.bowing.any():
                break
            bowed, bow = bending.bow(slopes - turned)
            elastic, _, pulled = self._pull((stretch + bow) / self.rest_length, permanent, piece)
            along = np.where(pulled == elastic, self.stiffness / self.rest_length, 0.0)
            miss = axial - pulled
            low, high = np.where(miss < 0.0, axial, low), np.where(miss > 0.0, axial, high)
            step = miss / (1.0 + along * (bowed * flows(stiffness, bowed, flowing)).sum(axis=1))
            if (np.abs(step) <= 4.0 * ROUND_OFF * (np.abs(axial) + along * (np.abs(stretch) + bow))).all():
                break
            following = axial - step
            beyond = (step != 0.0) & ~((following > low) & (following < high)) & np.isfinite(high - low)
            axial = following
            axial[beyond] = 0.5 * (low[beyond] + high[beyond])
        return turned, flowing

    def _with_ends(self, found: Response, permanent: Array, turned: Array, flowing: Flags) -> Response:
        """A response of rods, with what can yield of their ends beside."""
        assert self.bending is not None
        assert found.bent is not None
        moment, own = found.bent.moment, self.bending.end_stiffness[:, ::2]
        none = np.zeros_like(flowing)
        size = np.abs(found.bent.slopes + turned) + np.abs(permanent)
        size += (largest(found.bent.slopes) + largest(permanent)) * (own > 0.0)
        noise = 4.0 * ROUND_OFF * (own * size + np.abs(moment))
        noise += UNBALANCED * self.largest_force(found) * self.rest_length[:, None]
        untied = self.untied(flowing, np.abs(turned))
        tied = flowing & ~untied
        gained = np.where(tied & (own * np.abs(turned) <= noise), 0.0, turned)
        return replace(
            found,
            tied=np.column_stack([none[:, 0], tied]),
            elastic_force=np.column_stack([found.elastic_force, moment + own * turned]),
            plastic_strain=np.column_stack([found.plastic_strain, permanent + gained]),
            flowing=np.column_stack([found.flowing, untied]),
            slack=np.column_stack([found.slack, none]),
            round_off=np.column_stack([found.round_off, noise]),
        )

    def untied(self, flowing: Flags, turned: Array) -> Flags:
        """Ends that flow (rods, 2), less, at each joint where all do, the one that turns least in its hinge.

        If all did, nothing would hold the joint; which of them turn how much is not determined, but their sum.
        """
        if not flowing.any():
            return flowing
        assert self.bending is not None
        flowing, ends, rigid = flowing.copy(), self.ends, self.bending.rigid
        for joint in np.unique(ends[flowing]).tolist():
            here = (ends == joint) & rigid
            if self.unknown[joint, 2] and not self.springs[joint, 2] and flowing[here].all():
                rows = np.argwhere(here)
                flowing[tuple(rows[turned[here].argmin()])] = False
        return flowing

    def _pull_of_springs(self, displacement: Array) -> Array:
        return self.along_axes(self.springs * self.along_supports(displacement))

    @cached_property
    def is_sprung(self) -> bool:
        """True if some support is elastic."""
        return bool(self.springs.any())

    def chords(self, displacement: Array) -> Array:
        """How far the chords of rods have turned: atan2(D × Δ, D · (D + Δ)), and full turns if they bend; (rods,)."""
        difference, change = self.difference, self.relative(displacement)
        sine = difference[:, 0] * change[:, 1] - difference[:, 1] * change[:, 0]
        if self.first_order:
            squared: Array = np.where(self.original_length > 0.0, self.original_length, np.inf) ** 2
            return sine / squared
        cosine = (difference * (difference + change)).sum(axis=1)
        chord: Array = np.arctan2(sine, cosine)
        if self.bending is None:
            return chord
        return with_full_turns(chord, self.bending.turning_shares, self.turns(displacement))

    def _round_off_of_forces(self, displacement: Array, plastic_strain: Array, bent: Bent | None) -> Array:
        """By the sizes of what elastic strains are sums of, which may cancel: displacements, misfits, plastic strains."""
        moved = np.abs(displacement[:, :2]).sum(axis=1)
        summed = (moved[self.ends].sum(axis=1) + np.abs(self.misfit)) / self.rest_length
        round_off: Array = 4.0 * ROUND_OFF * self.stiffness * (summed + np.abs(plastic_strain))
        return round_off if bent is None else round_off + self._round_off_of_bows(displacement, bent)

    def _round_off_of_bows(self, displacement: Array, bent: Bent) -> Array:
        """What rounding of the rotations makes of the axial forces of rods that bow (kN)."""
        bows = (np.abs(bent.bowed) * np.abs(self.turns(displacement))).sum(axis=1)
        return 4.0 * ROUND_OFF * self.stiffness / self.rest_length * bows

    def _stretch(self, change: Array) -> tuple[Array, Array, Array]:
        """Changes of length from the original ones, unit vectors and lengths of the rods.

        change: of the differences between their ends, (rods, 2). |D + Δ| − |D| is computed as
        (2D + Δ)·Δ / (|D + Δ| + |D|), in which nothing cancels at small displacements.
        """
        original = self.original_length
        straight = self.difference / np.where(original > 0.0, original, 1.0)[:, None]
        if self.first_order:
            return (straight * change).sum(axis=1), straight, original
        present = self.difference + change
        length = np.hypot(present[:, 0], present[:, 1])
        total = length + original
        stretch = ((self.difference + present) * change).sum(axis=1) / np.where(total > 0.0, total, 1.0)
        axis = present / np.where(length > 0.0, length, 1.0)[:, None]
        if self.flat.any():
            axis = np.where(self.flat[:, None], straight, axis)
            stretch = np.where(self.flat, (straight * change).sum(axis=1), stretch)
            length = np.where(self.flat, original, length)
        return stretch, axis, np.where(length < SMALLEST, 0.0, length)  # whose inverse has no square

    def internal(self, response: Response) -> Array:
        """Forces (n, 2), or (n, 3), that hold the particles against the rods and what acts between their ends."""
        pull = response.axial_force[:, None] * response.axis
        if response.bent is None:
            return self.scatter(pull) + response.spring_force
        return self._sheared(response, pull, response.bent.moment, response.bent.shear) + response.spring_force

    def resistance(self, field: Array) -> Array:
        """Forces that hold the particles at small displacements from the original positions, by first-order theory."""
        response = self.unmoved
        stretched = (self.relative(field) * response.axis).sum(axis=1)
        pull = (self.stiffness / self.rest_length * stretched)[:, None] * response.axis
        if self.bending is None:
            return self.scatter(pull) + self._pull_of_springs(field)
        slopes = self.slope_rates(field, response)
        return self.held(self.bending.moments(slopes), pull) + self._pull_of_springs(field)

    def held(self, moment: Array, pull: Array | float = 0.0) -> Array:
        """The same against rods with moments on their ends (rods, 2), and axial forces as vectors (rods, 2)."""
        response = self.unmoved
        shear = moment.sum(axis=1) / np.where(response.length > 0.0, response.length, np.inf)
        return self._sheared(response, pull, moment, shear)

    def carried(self, response: Response, soft: Flags) -> Array:
        """What the whole distributed forces would add to the particles' forces, besides halves of them on both ends.

        soft: what flows or is slack meanwhile, where ends yield.
        """
        if self.bending is None or response.bent is None:
            return np.zeros(self.unknown.shape)
        bent, pull = response.bent, np.zeros_like(response.axis)
        moment, shear = self.bending.carried(bent, response.axis, response.length, not self.first_order)
        if soft.ndim > 1 and soft[:, 1:].any():
            hessian = self._hessian(response, soft)
            turned = flows(hessian[:, 2:, 2:], moment, soft[:, 1:])
            lost = (hessian[:, :, 2:] @ turned[:, :, None])[:, :, 0]
            moment, pull = moment - lost[:, 2:], -lost[:, :1] * response.axis
            inverse = 1.0 / np.where(response.length > 0.0, response.length, np.inf)
            shear = shear - (lost[:, 2:].sum(axis=1) - lost[:, 1]) * inverse
        return -self._sheared(response, pull, moment, shear)

    def _hessian(self, response: Response, soft: Flags) -> Array:
        """d² of the potential of rods by elongation and turning of the chord, and both slopes, (rods, 4, 4)."""
        assert self.bending is not None
        assert response.bent is not None
        along = self._along(response, soft)
        return self.bending.hessian(response.bent, along, response.axial_force, not self.first_order)

    def _along(self, response: Response, soft: Flags) -> Array:
        """EA/L₀, of soft rods none, or what is left of it, (rods,)."""
        left = self.softening * (of_axes(response.elastic_force) < 0.0)
        return np.where(of_axes(soft), left, 1.0) * (self.stiffness / self.rest_length)

    def _sheared(self, response: Response, pull: Array | float, moment: Array, shear: Array) -> Array:
        left = response.axis[:, ::-1] * [-1.0, 1.0]
        return self.scatter(pull - shear[:, None] * left, moment)

    def scatter(self, pull: Array, moment: Array | None = None) -> Array:
        """Forces (n, 2): each rod's vector on its second end, its opposite on the first; with moments (rods, 2), (n, 3)."""
        count = len(self.position)
        first, second = self.ends[:, 0], self.ends[:, 1]
        field = np.zeros(self.unknown.shape)
        for axis in range(2):
            field[:, axis] = np.bincount(second, pull[:, axis], count)
            field[:, axis] -= np.bincount(first, pull[:, axis], count)
        if moment is not None:
            field[:, 2] = np.bincount(self.ends.ravel(), moment.ravel(), count)
        return field

    @cached_property
    def _limits(self) -> tuple[Array, Array]:
        """The least and the greatest force of all that can yield, (rods,), where ends yield (rods, 3)."""
        low, high = -self.compression_limit, self.tension_limit
        if self.bending is None or not self.ends_yield:
            return low, high
        limit = self.bending.moment_limit
        return np.column_stack([low, -limit]), np.column_stack([high, limit])

    def at_limit(self, response: Response) -> Flags:
        """Rods whose axial force is at a strength; where ends yield, (rods, 3), and those at plastic moments."""
        force, (low, high) = response.force, self._limits
        pulled = np.isfinite(high) & (force >= high * (1.0 - AT_LIMIT) - response.round_off)
        pressed = np.isfinite(low) & (force <= response.round_off + low * (1.0 - AT_LIMIT))
        return pulled | pressed

    def branches(self, response: Response, scale: float) -> Branches:
        """The pieces of their laws that the rods are on; forces (kN) below AT_LIMIT × scale count as 0."""
        nothing, edge = AT_LIMIT * scale + response.round_off, self._edge
        sense, (low, high) = self.sense, self._limits
        if response.flowing.ndim > 1:
            sense, edge = (values[:, None] * [1.0, 0.0, 0.0] for values in (sense, edge))
        verge = (sense != 0.0) & (np.abs(response.elastic_force - edge) <= nothing)
        slack = response.slack & ~verge
        low = np.where(sense > 0.0, edge, low)
        high = np.where(sense < 0.0, 0.0, high)
        outward = np.where(self.at_limit(response), np.sign(response.force), 0.0)
        return Branches(
            force=np.where(slack, response.elastic_force, response.force),
            low=np.where(slack, np.where(sense > 0.0, -np.inf, 0.0), low),
            high=np.where(slack, np.where(sense > 0.0, edge, np.inf), high),
            outward=np.where(verge, -sense, outward),
            slack=slack,
            verge=verge,
        )

    def round_off(self, displacement: Array, response: Response) -> float:
        """The residual (kN) that rounding of the displacements alone causes."""
        size = np.abs(self.gather(displacement))
        pulled = 2.0 * ROUND_OFF * self.greatest(self.weight * size)
        if self.bending is None or response.bent is None:
            return pulled
        bows = largest(self._round_off_of_bows(displacement, response.bent))
        turned = self._turned_by(np.abs(displacement)) / self.rest_length[:, None]
        return max(pulled, bows, 2.0 * ROUND_OFF * largest(self.bending.end_stiffness[:, ::2] * turned))

    def _turned_by(self, sizes: Array) -> Array:
        """What slopes of ends are sums of, without regard to signs, by the sizes of a field; (rods, 2)."""
        length = np.where(self.original_length > 0.0, self.original_length, np.inf)
        turned: Array = sizes[self.ends, 2] + (sizes[self.ends, :2].sum(axis=(1, 2)) / length)[:, None]
        return turned

    # --- tangent -------------------------------------------------------------------------------------

    def tangent(self, response: Response, soft: Flags, *, geometric: bool = True) -> Matrix:
        """dF/du over the unknowns, the sum of what every rod and every spring adds."""
        matrix = self.matrix(self.tangents(response, soft, geometric=geometric))
        if not self.is_sprung:
            return matrix
        springs = self.unknown_springs
        if isinstance(matrix, np.ndarray):
            return matrix + np.diag(springs)
        from scipy.sparse import csc_matrix, diags

        return csc_matrix(matrix + diags(springs))

    def tangents(self, response: Response, soft: Flags, *, geometric: bool) -> Array:
        """dF/du of every rod over the coordinates of both ends, (rods, 2, width, 2, width).

        EA/L₀ a aᵀ (of soft rods none, or what is left of it) + N/L (1 − a aᵀ), and what bending adds.
        """
        along = self._along(response, soft)
        across = np.zeros_like(along)
        geometric = geometric and not self.first_order
        if geometric:
            length = np.where(self.flat, np.inf, response.length)
            across = np.where(length > 0.0, response.axial_force / np.where(length > 0.0, length, 1.0), 0.0)
        a = response.axis
        block = (along - across)[:, None, None] * (a[:, :, None] * a[:, None, :])
        block[:, 0, 0] += across
        block[:, 1, 1] += across
        signs = np.array([[1.0, -1.0], [-1.0, 1.0]])
        parts = signs[None, :, None, :, None] * block[:, None, :, None, :]
        if self.bending is not None and response.bent is not None:
            bars = parts
            flowing = soft[:, 1:] if soft.ndim > 1 else None
            parts = self.bending.stiffness(
                response.bent, along, response.axial_force, a, response.length, geometric, flowing
            ).reshape(-1, 2, 3, 2, 3)
            parts[:, :, :2, :, :2] += bars
        return parts

    def matrix(self, parts: Array) -> Matrix:
        """Sum of the rods' matrices (rods, …) of the coordinates of both ends, along the axes of supports."""
        return self.assembly.matrix(self._turned(parts).ravel())

    def _turned(self, parts: Array) -> Array:
        """Matrices of rods, (rods, 2 × width, 2 × width), of the coordinates along the axes of supports."""
        parts = parts.reshape(len(self.ends), 2 * self.width, 2 * self.width)
        if not self.angle.any():
            return parts
        return self._by_supports(self._by_supports(parts, self.ends).swapaxes(1, 2), self.ends)

    def _by_supports(self, by_ends: Array, ends: Rows) -> Array:
        """Of rows (k, …, coordinates of two particles) those by their coordinates along the axes of supports."""
        if not self.angle.any():
            return by_ends
        found = by_ends.copy()
        for end in range(2):
            shape = (-1, *(1,) * (by_ends.ndim - 2))
            cosine, sine = (part(self.angle[ends[:, end]]).reshape(shape) for part in (np.cos, np.sin))
            x, y = (by_ends[..., self.width * end + axis] for axis in (0, 1))
            found[..., self.width * end] = cosine * x + sine * y
            found[..., self.width * end + 1] = cosine * y - sine * x
        return found

    @property
    def deformations(self) -> int:
        """Rows of the compatibility matrix: one for each rod, each of its rigid ends, and each spring of supports."""
        rigid = 0 if self.bending is None else int(self.bending.rigid.sum())
        return len(self.ends) + rigid + int(self.sprung.sum())

    @property
    def sprung(self) -> Flags:
        """Which unknowns springs hold, (N,)."""
        return self.unknown_springs > 0.0

    def compatibility(self, response: Response) -> csc_matrix:
        """Deformations of rods and springs from the unknowns; its transpose is the equilibrium matrix.

        Elongations (rods, N); where members bend, those of the axes and below them the slopes of all rigid ends; last what
        springs hold.
        """
        by_ends, ends = self._elongations(response), self.ends
        if self.bending is not None:
            rigid = self.bending.rigid
            by_ends = np.concatenate([by_ends, self._ways(response)[:, 2:][rigid]])
            ends = np.concatenate([ends, np.repeat(self.ends, rigid.sum(axis=1), axis=0)])
        by_ends = self._by_supports(by_ends, ends)
        found = spread_by_ends(by_ends, ends, len(self.position))[:, self.index]
        if self.is_sprung:
            from scipy.sparse import identity, vstack

            found = vstack([found, identity(self.size, format="csr")[self.sprung]])
        return found.tocsc()

    @cached_property
    def reaches(self) -> Array:
        """What deformations are multiplied by, so that they are lengths: 1, slopes by the rest length."""
        reaches = [np.ones(len(self.ends)), self.measure[self.sprung]]
        if self.bending is not None:
            reaches.insert(1, np.repeat(self.rest_length, self.bending.rigid.sum(axis=1)))
        return np.concatenate(reaches)

    @property
    def scaled_compatibility(self) -> Array:
        """The compatibility matrix at the original positions in full, of lengths only: rotations are × their measure."""
        return self.compatibility(self.unmoved).toarray() * self.reaches[:, None] / self.measure

    def elongations(self, response: Response, rows: Rows) -> Array:
        """The elongations of some rods from the unknowns, in full, (k, N)."""
        return self._in_full(self._elongations(response)[rows], rows)

    def _in_full(self, by_ends: Array, rows: Rows) -> Array:
        """Of what is by the coordinates of both ends of these rods, (k, 2 × width), that by all unknowns, (k, N)."""
        matrix = np.zeros((len(rows), *self.unknown.shape))
        of_ends = self._by_supports(by_ends, self.ends[rows])
        matrix[np.arange(len(rows))[:, None], self.ends[rows]] = of_ends.reshape(-1, 2, self.width)
        return matrix.reshape(len(rows), -1)[:, self.index]

    def _elongations(self, response: Response) -> Array:
        """Elongations of the axes from the coordinates of both ends, (rods, 2 × width)."""
        axis = response.axis
        if response.bent is None:
            return np.concatenate([-axis, axis], axis=1)
        ways = self._ways(response)
        found: Array = ways[:, 0] + (response.bent.bowed[:, :, None] * ways[:, 2:]).sum(axis=1)
        return found


def _held_by_rods(springs: Array, ends: Rows, bending: Bending | None) -> Flags:
    """Both directions of particles with rods or springs, (n, 2); where members bend, and rotations at rigid ends, (n, 3)."""
    held = np.zeros(springs.shape, dtype=bool)
    held[ends, :2] = held[(springs[:, :2] > 0.0).any(axis=1), :2] = True
    if bending is not None:
        held[ends[bending.rigid], 2] = True
    return held


def _arbitrary(fixed: Flags, body: Rows) -> Flags:
    """One direction (n, 2) for each axis along which nothing holds a body: that of its first particle."""
    count = int(body.max(initial=-1)) + 1
    first = np.full(count, len(body))
    np.minimum.at(first, body, np.arange(len(body)))
    arbitrary = np.zeros_like(fixed)
    for axis in range(2):
        held = np.bincount(body, fixed[:, axis], count) > 0
        arbitrary[first[~held], axis] = True
    return arbitrary
