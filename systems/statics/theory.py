"""First-order theory about the original positions: linear answers, indeterminacy, mechanisms, self-stress,
influence lines. Lengths in m, forces in kN."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from pinjoint.components.arrays import ROUND_OFF, Array
from pinjoint.components.language import begun, plural, tr
from pinjoint.components.model import Model
from pinjoint.components.theory import FIRST_ORDER
from pinjoint.systems.statics.equations import SOFT, Structure, largest, normalised
from pinjoint.systems.statics.events import NoEquilibrium
from pinjoint.systems.statics.explain import describe_motion, rod_names
from pinjoint.systems.statics.external import External, loose_bodies
from pinjoint.systems.statics.factor import SURELY_HELD, pseudo_random, regular, soft_modes, unresisted
from pinjoint.systems.statics.response import Response, of_axes
from pinjoint.systems.statics.state import STABLE, Start, StaticState

_REFINEMENTS = 4  # of a linear solution
_REFINEMENTS_OF_BENDING = 40  # at most; few unless hundreds of rods divide a long member
PUSHED = 1e-9  # of a load: what of it moves a mechanism; less is round-off
_SELF_STRESSED = 1e-10  # share of the stiffness of inextensible rods by which others let them grow: none does
_IN_PART = 1e-3  # of the largest force of such a state: smaller ones are none
FULL = 600  # unknowns up to which all modes, eigenvalues and singular values are computed
_MOST_MODES = 20  # mechanisms or states of self-stress of larger structures


# --- linear theory -----------------------------------------------------------------------------------


class FirstOrder:
    """First-order theory of a structure: K u = f about the original positions, K factored once for all loads.

    measure: a structure of the same unknowns by whose stiffness motions are measured; None: the same.
    """

    def __init__(self, model: Model, structure: Structure, measure: Structure | None = None) -> None:
        self.model, self.structure = model, structure
        self._measure = measure or structure
        self._matrix = structure.initial_tangent
        self._factor = regular(self._matrix, self._measure.weight)

    @classmethod
    def of(cls, model: Model) -> FirstOrder:
        """That of a model."""
        return cls(model, Structure.of(model, FIRST_ORDER))

    @cached_property
    def held(self) -> bool:
        """True if every motion is resisted, and by so much that no digits are lost."""
        return regular(self._matrix, self._measure.weight, -SURELY_HELD).definite

    def solve(self, right: Array) -> Array:
        """The unknowns under forces along them, (N,) or (N, k), not refined."""
        return self._factor.solve(right)

    @cached_property
    def mechanisms(self) -> Array:
        """The motions of the unknowns that nothing resists, (N, k)."""
        if self.held:
            return np.zeros((self.structure.size, 0))
        count = regular(self._matrix, self._measure.weight, -SOFT).negative
        return unresisted(self._measure, self.structure.unmoved, self._matrix, self._factor, most=count)

    def equilibrium(
        self, load: Array, supports: Array, plastic_strain: Array, share: float, rods: Structure
    ) -> tuple[Array, Response]:
        """Displacements (n, …) and rods under a load (n, …), all elastic. Raises NoEquilibrium.

        supports: displacements of constrained directions, else 0. share: of the distributed forces. rods: the structure, or
        one of another lack of fit.
        """
        held, firm = elastic(rods, supports, plastic_strain, share), self.structure.inextensible
        permanent = of_axes(plastic_strain)
        longer = rods.rest_length * permanent - held.elongation
        by, forces = self._answer(load - rods.internal(held), longer[firm])
        found = elastic(rods, supports + by, plastic_strain, share)
        if len(firm):
            axial, strain, elongation = (
                part.copy() for part in (found.axial_force, found.strain, found.elongation)
            )
            axial[firm] += forces
            strain[firm], elongation[firm] = permanent[firm], (rods.rest_length * permanent)[firm]
            found = replace(found, axial_force=axial, strain=strain, elongation=elongation)
        return supports + by, found

    def deflection(self, load: Array, longer: Array | None = None) -> Array:
        """Displacements (n, …) of the free directions under a load (n, …), without those that nothing resists.

        longer: by how much inextensible rods grow all the same; None: not. Raises NoEquilibrium for cables, where the load
        moves a mechanism, and where inextensible rods are self-stressed.
        """
        return self._answer(load, np.zeros(len(self.structure.inextensible)) if longer is None else longer)[0]

    def _answer(self, load: Array, longer: Array) -> tuple[Array, Array]:
        """The same, and what the axial forces of inextensible rods are beside those by their EA: Lagrange's multipliers."""
        structure, model = self.structure, self.model
        if len(rows := np.flatnonzero((structure.sense != 0.0) & ~structure.struts)):
            cables = plural("{rods} acts", "{rods} act", len(rows), rods=begun(rod_names(model, rows)))
            message = tr(
                "{cables} in tension only, and linear theory needs rods that bear compression as well. Find the equilibrium"
                " instead; or make cables that stay taut ordinary rods, and delete those that go slack.",
                cables=cables,
            )
            raise NoEquilibrium("limit reached", message)
        right = structure.gather(load)
        solution, modes = self._refined(right), self.mechanisms
        work, weight = modes.T @ right, self._measure.weight
        pushed = largest(work) > PUSHED * np.sqrt(right @ (right / weight))
        if pushed or float(right @ solution) < SOFT * structure.effort(solution, structure.unmoved):
            solution = modes @ work if pushed else solution
            message = tr(
                "Mechanism: the load moves {motion}, and the resistance is less than {share:g} of the stiffness of the rods"
                " there. Add rods or supports there, or make the stiffnesses less unequal.",
                motion=describe_motion(model, structure.spread(solution)[None]),
                share=SOFT,
            )
            raise NoEquilibrium("mechanism", message, normalised(structure.spread(solution)))
        forces = np.zeros(len(longer))
        for _ in range(_REFINEMENTS if len(longer) else 0):
            along, moved, soft = self._constraints
            step = np.linalg.solve(soft, along @ solution - longer)
            solution, forces = solution - moved @ step, forces + step
            solution = solution + self._factor.solve(right - self._held(solution) - forces @ along)
        return structure.spread(solution - modes @ (modes.T @ (weight * solution))), forces

    @cached_property
    def _constraints(self) -> tuple[Array, Array, Array]:
        """The elongations of inextensible rods by the unknowns, A (k, N), K⁻¹Aᵀ and A K⁻¹Aᵀ. Raises NoEquilibrium."""
        structure, model = self.structure, self.model
        rows, modes, weight = structure.inextensible, self.mechanisms, self._measure.weight
        along = structure.elongations(structure.unmoved, rows)
        moved = self._factor.solve(np.ascontiguousarray(along.T))
        moved = moved - modes @ (modes.T @ (weight[:, None] * moved))
        soft, root = along @ moved, np.sqrt((self._measure.stiffness / self._measure.rest_length)[rows])
        values, vectors = np.linalg.eigh(root[:, None] * soft * root)
        if values[0] <= _SELF_STRESSED:
            stressed = rows[np.abs(vectors[:, 0]) > _IN_PART * np.abs(vectors[:, 0]).max()]
            message = tr(
                "The axial forces of {rods}, which are inextensible, cannot be told: they hold each other in a state of"
                " self-stress, alone or with supports. Let one of them have its EA.",
                rods=rod_names(model, stressed),
            )
            raise NoEquilibrium("limit reached", message)
        return along, moved, soft

    def _held(self, solution: Array) -> Array:
        """What holds the unknowns at small displacements; by relative motions, which lose fewer digits than the matrix."""
        if self.structure.bending is None:
            return np.asarray(self._matrix @ solution)
        return self.structure.gather(self.structure.resistance(self.structure.spread(solution)))

    def _refined(self, right: Array) -> Array:
        """The solution of K u = f to its last digits."""
        structure, solution = self.structure, self._factor.solve(right)
        for _ in range(_REFINEMENTS if structure.bending is None else _REFINEMENTS_OF_BENDING):
            step = self._factor.solve(right - self._held(solution))
            solution = solution + step
            if structure.bending is not None and largest(step) <= ROUND_OFF * largest(solution):
                break
        return solution


def elastic(structure: Structure, displacement: Array, plastic_strain: Array, share: float) -> Response:
    """How rods respond of which none yields; what would is flowing."""
    found = structure.respond(displacement, plastic_strain, share)
    if found.flowing.ndim == 1:
        return replace(found, axial_force=found.elastic_force, plastic_strain=plastic_strain)
    if not (found.flowing | found.slack).any():
        return found
    as_if = structure.unyielding.respond(displacement, plastic_strain, share)
    return replace(as_if, flowing=found.flowing)


def linear(model: Model, start: Start | None = None, factor: float = 1.0) -> StaticState:
    """The direct stiffness method: first-order theory of a model, all rods elastic.

    start: a state (None: the present one) of which plastic strain acts as initial forces, like lack of fit, and
    displacements of constrained directions as moved supports. factor: of forces and loads; all else acts in full.
    Raises NoEquilibrium, naming the particles, for a mechanism or a free body that the load moves.
    """
    structure, start = Structure.of(model, FIRST_ORDER), start or Start.of(model)
    load = External.of(model).at(factor)
    for body in loose_bodies(structure, load):
        if body.pull:
            raise NoEquilibrium("mechanism", body.event(model, factor).message)
    supports = structure.of_supports(structure.field(start.displacement, start.rotation))
    theory = FirstOrder(model, structure)
    moved, elastic = theory.equilibrium(load, supports, start.permanent, factor, structure)
    forces = max(structure.largest(load), structure.largest_force(elastic))
    return StaticState.of(
        model,
        structure,
        elastic,
        moved,
        load,
        load_factor=factor,
        acting=load,
        dissipated_plastic=0.0,
        residual=structure.unbalanced(elastic, load) / forces if forces > 0.0 else 0.0,
        status=STABLE,
        message="",
        events=(),
    )


# --- indeterminacy -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Indeterminacy:
    """Degrees of static indeterminacy: in all, internal (of the rods) and external (of the supports).

    mechanisms: number of independent motions that deform no rod, those of free bodies included (kinematic
    indeterminacy). rank: of the compatibility matrix.
    """

    static: int
    internal: int
    external: int
    mechanisms: int
    rank: int

    @classmethod
    def of(cls, model: Model) -> Indeterminacy:
        """Degrees by the rank r of the compatibility matrix, with supports and without; cables count as taut.

        m rods between particles with f free directions have m − r states of self-stress and f − r mechanisms. A rigid end of
        a rod that bends counts as one more of the m, and so does a spring of a support; a rotation as a direction.
        """
        structure = Structure.of(model, FIRST_ORDER).with_translations()
        unsupported, rank = structure.unsupported(), _rank(structure)
        static, internal = structure.deformations - rank, unsupported.deformations - _rank(unsupported)
        return cls(static, internal, static - internal, structure.size - rank, rank)


def mechanisms(model: Model) -> Array:
    """Motions (k, n, 2 or 3) that deform no rod, the largest of each 1; of large structures at most 20."""
    structure = Structure.of(model, FIRST_ORDER).with_translations()
    if structure.size <= FULL:
        modes = _null_space(structure.scaled_compatibility) / structure.measure[:, None]
    else:
        structure = _rigid(structure)
        matrix = structure.initial_tangent
        count = regular(matrix, structure.weight, -SOFT).negative
        modes = soft_modes(matrix, structure.weight, most=min(_MOST_MODES, count))
    return structure.motions(_localised(modes))


def self_stress(model: Model) -> Array:
    """Axial forces (k, rods) in equilibrium without load, the largest of each 1; of large ones at most 20.

    Where members bend, and beside them the moments on all rigid ends, in the order of the rods (k, rods + ends).
    """
    structure = Structure.of(model, FIRST_ORDER).with_translations()
    compatibility = structure.compatibility(structure.unmoved)
    if structure.size <= FULL:
        states = _null_space(structure.scaled_compatibility.T) * structure.reaches[:, None]
    else:  # any forces, less those that balance their unbalanced part
        count = min(_MOST_MODES, structure.deformations - _rank(structure))
        states = pseudo_random(structure.deformations, count)
        factor = regular((compatibility.T @ compatibility).tocsc(), np.ones(structure.size))
        for _ in range(_REFINEMENTS):
            states = states - compatibility @ factor.solve(compatibility.T @ states)
    states = _localised(states)[: structure.deformations - int(structure.sprung.sum())]
    return (states / np.abs(states).max(axis=0, initial=0.0)).T


def _rank(structure: Structure) -> int:
    if structure.size == 0 or len(structure.ends) == 0:
        return 0
    if structure.size > FULL:
        structure = _rigid(structure)
        return structure.size - regular(structure.initial_tangent, structure.weight, -SOFT).negative
    matrix = structure.scaled_compatibility
    return int(np.linalg.matrix_rank(matrix, rtol=_tolerance(matrix)))


def _rigid(structure: Structure) -> Structure:
    """The same structure, so stiff in bending that only mechanisms are soft, however many rods divide its members."""
    if structure.bending is None:
        return structure
    per_slope = structure.bending.end_stiffness
    most = per_slope.max(axis=1, keepdims=True)
    wanted = (structure.stiffness / structure.rest_length)[:, None] * structure.extent**2
    stiff = np.divide(wanted * per_slope, most, out=np.zeros_like(per_slope), where=most > 0.0)
    return replace(structure, bending=replace(structure.bending, end_stiffness=stiff))


def _tolerance(matrix: Array) -> float:
    """Of the largest singular value: smaller ones are round-off."""
    return 8.0 * max(matrix.shape) * ROUND_OFF


def _null_space(matrix: Array) -> Array:
    """Orthonormal basis (columns, k) of the null space of a matrix."""
    if 0 in matrix.shape:
        return np.eye(matrix.shape[1])
    from scipy.linalg import null_space

    return null_space(matrix, _tolerance(matrix))


def _localised(basis: Array) -> Array:
    """Another basis (size, k) of the same space: each vector is 1 in one place where all others are 0."""
    if basis.shape[1] == 0:
        return basis
    from scipy.linalg import qr

    pivots = qr(basis.T, mode="r", pivoting=True)[1][: basis.shape[1]]
    return np.linalg.solve(basis[pivots].T, basis.T).T


# --- influence -------------------------------------------------------------------------------------------


def influence_line(theory: FirstOrder, quantity: str, row: int, axis: int = 0, share: float = 0.0) -> Array:
    """What a unit force on each particle along x and y, where members bend and a moment, does to a quantity, (n, …).

    quantity, row: "axial_force" or "shear" of a rod, its "bending_moment" at a share of its length; by axis (2: turning)
    of a particle its "reaction" or "reaction_moment", its "displacement" or "rotation". Of a force, by
    Müller-Breslau, it is the deflection that a unit displacement in its place causes; of a displacement, by Maxwell, that
    under a unit load there. Raises NoEquilibrium.
    """
    structure, unit = theory.structure, np.zeros(theory.structure.fixed.shape)
    if quantity == "axial_force":
        pull = np.zeros_like(structure.difference)
        pull[row] = structure.stiffness[row] / structure.rest_length[row] * structure.unmoved.axis[row]
        return theory.deflection(structure.scatter(pull), (structure.inextensible == row).astype(np.float64))
    if quantity in ("shear", "bending_moment"):
        assert structure.bending is not None
        kinks = np.zeros(structure.ends.shape)
        kinks[row] = 1.0 / structure.original_length[row] if quantity == "shear" else (share - 1.0, share)
        return theory.deflection(structure.held(structure.bending.moments(kinks)))
    unit[row, axis] = 1.0
    unit = structure.along_axes(unit)
    if quantity in ("displacement", "rotation"):
        return theory.deflection(unit)
    if spring := float(structure.springs[row, axis]):
        return -spring * theory.deflection(unit)
    longer = (structure.relative(unit) * structure.unmoved.axis).sum(axis=1)[structure.inextensible]
    return theory.deflection(structure.resistance(unit), longer) - unit
