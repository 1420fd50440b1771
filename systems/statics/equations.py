"""Equilibrium equations of pin-jointed rods in exact geometry, as functions of the displacements.

The unknowns are the displacements of particles with rods in their free directions: a vector of shape (N,),
or a field (n, 2) over all particles. Lengths in m, forces in kN.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, TypeAlias, Union

import numpy as np
from numpy.typing import NDArray

from components.field import FieldError
from components.model import Model
from components.rod import bends
from systems.islands import lowest_joined

if TYPE_CHECKING:  # only large structures need it
    from scipy.sparse import csc_matrix

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Rows = NDArray[np.intp]
Matrix: TypeAlias = Union[Array, "csc_matrix"]  # full up to DENSE unknowns, else sparse

SYMMETRIC = {"SymmetricMode": True}  # pivots on the diagonal
DENSE = 100  # unknowns up to which full matrices are faster

AT_LIMIT = 1e-10  # share of its strength within which a rod counts as yielding
ROUND_OFF = float(np.finfo(np.float64).eps)


def refuse_bending(model: Model) -> None:
    """Raise FieldError if members bend, which statics does not know yet."""
    if bends(model):
        named = model.describe(model.rods[int(np.flatnonzero(model.rods.turning_shares.any(axis=1))[0])])
        raise FieldError(
            f"Statics computes bars only, but {named} bends. Run the model until rest, or set the bending stiffness to 0."
        )


def largest(values: Array) -> float:
    """The largest absolute value in an array; 0 of an empty one."""
    return float(np.abs(values).max(initial=0.0))


def normalised(motion: Array) -> Array:
    """A motion (n, 2) scaled so that the particle that moves most moves by 1."""
    scaled: Array = motion / np.hypot(*motion.T).max()
    return scaled


@dataclass(frozen=True)
class Response:
    """The state of the rods at given displacements, by return mapping from a given plastic strain; (rods,).

    elastic_force: the trial force, before yielding. plastic_strain: after yielding. axis: unit vectors from
    first to second end, (rods, 2). flowing: rods that yield now. slack: one-sided rods without force.
    round_off: what rounding alone makes of elastic_force (kN).
    """

    elongation: Array
    strain: Array
    length: Array
    axis: Array
    elastic_force: Array
    axial_force: Array
    plastic_strain: Array
    flowing: Flags
    slack: Flags
    round_off: Array

    @property
    def soft(self) -> Flags:
        """Rods whose force does not change when their length does a little."""
        return self.flowing | self.slack

    @property
    def reach(self) -> Array:
        """What motions are measured by (m): the length, of slack cables that at which they tighten.

        A slack cable may shrink to a point and turn over without anything changing.
        """
        tightens: Array = np.where(self.slack, self.length - self.elongation, 0.0)
        return np.maximum(self.length, tightens)


@dataclass(frozen=True)
class Branches:
    """The linear piece of its law that each rod is on; shape (rods,).

    force: elastic of slack rods, else axial (kN). low, high: the forces at which the piece ends. outward: the
    sense of elongation, 1 or −1, in which a rod at an end of its piece leaves it; 0 elsewhere. verge:
    one-sided rods that are about to tighten or slacken. slack: the other one-sided rods without force.
    """

    force: Array
    low: Array
    high: Array
    outward: Array
    slack: Flags
    verge: Flags


@dataclass(frozen=True)
class Structure:
    """The rods of a model and the directions in which its particles are free, as arrays.

    ends: rows of the particles at both ends, (rods, 2). difference: between their original positions.
    unknown: the free directions that are solved for, (n, 2): those of particles with rods, less one of
        every body that nothing holds along an axis (its translation is arbitrary).
    body: number of the connected body of each particle, (n,).
    sense: 1 for cables (tension only), −1 for contacts (compression only), else 0.
    own_weight: stiffness added to that of its rods in the `weight` of a particle (kN/m), (n,).
    flat: rods whose axis keeps its direction, such as contacts with a straight side.
    linear: first-order theory: elongations and equilibrium about the original positions.
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
    unknown: Flags
    body: Rows
    own_weight: Array
    flat: Flags
    linear: bool

    @classmethod
    def of(cls, model: Model, geometry: str = "exact") -> Structure:
        """The structure of a model in "exact" or "linear" geometry; without plasticity no rod yields.

        Raises FieldError if members bend.
        """
        if geometry not in ("exact", "linear"):
            raise ValueError(f"Geometry is '{geometry}'; it must be 'exact' or 'linear'.")
        refuse_bending(model)
        particles, rods = model.particles, model.rods
        yields = bool(model.settings.plasticity)
        ends = rods.between.astype(np.intp)
        body = _bodies(particles.count, ends)
        fixed = particles.fixed.copy()
        return cls(
            position=particles.position.copy(),
            ends=ends,
            difference=rods.difference.copy(),
            original_length=rods.original_length.copy(),
            rest_length=rods.rest_length.copy(),
            misfit=rods.misfit.copy(),
            stiffness=rods.stiffness.copy(),
            tension_limit=rods.tension_limit.copy() if yields else np.full(rods.count, np.inf),
            compression_limit=rods.compression_limit.copy() if yields else np.full(rods.count, np.inf),
            sense=rods.tension_only.astype(np.float64),
            fixed=fixed,
            unknown=_held_by_rods(particles.count, ends) & ~fixed & ~_arbitrary(fixed, body),
            body=body,
            own_weight=np.zeros(particles.count),
            flat=np.zeros(rods.count, dtype=bool),
            linear=geometry == "linear",
        )

    def with_translations(self) -> Structure:
        """The same structure with the arbitrary translations of free bodies among the unknowns."""
        return replace(self, unknown=_held_by_rods(len(self.position), self.ends) & ~self.fixed)

    # --- unknowns ----------------------------------------------------------------------------------

    @cached_property
    def index(self) -> Rows:
        """Indices of the unknowns in a flattened field, (N,), in an order that keeps factors sparse."""
        index = np.flatnonzero(self.unknown.ravel())
        if len(index) <= DENSE:
            return index
        from scipy.sparse import csc_matrix, identity
        from scipy.sparse.linalg import splu

        links = compatibility(self.ends, np.ones((len(self.ends), 2)), len(self.position))[:, index]
        pattern = csc_matrix(abs(links).T @ abs(links) + identity(len(index)))
        order = splu(pattern, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=SYMMETRIC).perm_c
        return index[np.argsort(order)]

    @property
    def size(self) -> int:
        """The number of unknowns N."""
        return len(self.index)

    def gather(self, field: Array) -> Array:
        """The unknowns in a field."""
        return field.ravel()[self.index]

    def spread(self, vector: Array) -> Array:
        """A vector of unknowns as a field, zero elsewhere."""
        field = np.zeros(self.unknown.shape)
        field.ravel()[self.index] = vector
        return field

    def fields(self, vectors: Array) -> Array:
        """Vectors of unknowns (N, k) as fields (k, n, 2)."""
        return np.array([self.spread(vector) for vector in vectors.T]).reshape(
            vectors.shape[1], *self.unknown.shape
        )

    def relative(self, field: Array) -> Array:
        """Second end minus first end of every rod, (rods, 2)."""
        return field[self.ends[:, 1]] - field[self.ends[:, 0]]

    def move(self, vector: Array, reach: Array) -> float:
        """The largest change of a rod, in length or direction, relative to its reach."""
        change = np.hypot(*self.relative(self.spread(vector)).T)
        moved = change > 0.0
        with np.errstate(divide="ignore"):  # the ends may be at the same place, as yet
            return float((change[moved] / reach[moved]).max(initial=0.0))

    def elongation_rate(self, vector: Array, response: Response) -> Array:
        """Rate of elongation of every rod when the unknowns change at this rate."""
        rate: Array = (self.relative(self.spread(vector)) * response.axis).sum(axis=1)
        return rate

    @cached_property
    def original_axis(self) -> Array:
        """Unit vectors from the first original position to the second, (rods, 2); 0 where they are the same."""
        length = self.original_length[:, None]
        return np.divide(self.difference, length, out=np.zeros_like(self.difference), where=length > 0.0)

    @cached_property
    def extent(self) -> float:
        """The larger side of the box around the original positions (m), at least the longest rod."""
        box = float(np.ptp(self.position, axis=0).max()) if len(self.position) else 0.0
        return max(box, float(self.rest_length.max(initial=0.0)))

    @cached_property
    def weight(self) -> Array:
        """Sum of EA/L₀ of the rods at each unknown's particle (kN/m), the scale of its stiffness, (N,)."""
        per_rod = self.stiffness / self.rest_length
        total = np.bincount(self.ends.ravel(), np.repeat(per_rod, 2), len(self.position)).astype(np.float64)
        return self.gather(np.repeat(total + self.own_weight, 2).reshape(-1, 2))

    # --- forces --------------------------------------------------------------------------------------

    @cached_property
    def unmoved(self) -> Response:
        """The rods at the original positions without plastic strain."""
        return self.respond(np.zeros(self.unknown.shape), np.zeros(len(self.ends)))

    @cached_property
    def initial_tangent(self) -> Matrix:
        """The tangent at the original positions, without axial forces and with taut cables."""
        return self.tangent(self.unmoved, np.zeros(len(self.ends), dtype=bool), geometric=False)

    def respond(self, displacement: Array, plastic_strain: Array) -> Response:
        """Axial forces N = EA (ε − ε_p), ε = (L − L₀)/L₀, limited by yielding; both limits move with ε_p."""
        stretch, axis, length = self._stretch(self.relative(displacement))
        elongation = stretch + self.misfit
        strain = elongation / self.rest_length
        elastic = self.stiffness * (strain - plastic_strain)
        slack = self.sense * elastic < 0.0
        force = np.where(slack, 0.0, np.clip(elastic, -self.compression_limit, self.tension_limit))
        flowing = (force != elastic) & ~slack
        return Response(
            elongation=elongation,
            strain=strain,
            length=length,
            axis=axis,
            elastic_force=elastic,
            axial_force=force,
            plastic_strain=np.where(flowing, strain - force / self.stiffness, plastic_strain),
            flowing=flowing,
            slack=slack,
            round_off=self._round_off_of_forces(displacement, plastic_strain),
        )

    def _round_off_of_forces(self, displacement: Array, plastic_strain: Array) -> Array:
        """By the sizes of what elastic strains are sums of, which may cancel: displacements, misfits, plastic strains."""
        moved = np.abs(displacement).sum(axis=1)
        summed = (moved[self.ends].sum(axis=1) + np.abs(self.misfit)) / self.rest_length
        round_off: Array = 4.0 * ROUND_OFF * self.stiffness * (summed + np.abs(plastic_strain))
        return round_off

    def _stretch(self, change: Array) -> tuple[Array, Array, Array]:
        """Changes of length from the original ones, unit vectors and lengths of the rods.

        change: of the differences between their ends, (rods, 2). |D + Δ| − |D| is computed as
        (2D + Δ)·Δ / (|D + Δ| + |D|), in which nothing cancels at small displacements.
        """
        original = self.original_length
        straight = self.difference / np.where(original > 0.0, original, 1.0)[:, None]
        if self.linear:
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
        return stretch, axis, length

    def internal(self, response: Response) -> Array:
        """Forces (n, 2) that hold the particles against the rods' pull."""
        return self.scatter(response.axial_force[:, None] * response.axis)

    def scatter(self, pull: Array) -> Array:
        """Forces (n, 2): each rod's vector on its second end, its opposite on the first."""
        count = len(self.position)
        first, second = self.ends[:, 0], self.ends[:, 1]
        field = np.empty((count, 2))
        for axis in range(2):
            field[:, axis] = np.bincount(second, pull[:, axis], count)
            field[:, axis] -= np.bincount(first, pull[:, axis], count)
        return field

    def at_limit(self, response: Response) -> Flags:
        """Rods whose axial force is at a strength."""
        force, tension, compression = response.axial_force, self.tension_limit, self.compression_limit
        pulled = np.isfinite(tension) & (force >= tension * (1.0 - AT_LIMIT) - response.round_off)
        pressed = np.isfinite(compression) & (force <= response.round_off - compression * (1.0 - AT_LIMIT))
        return pulled | pressed

    def branches(self, response: Response, scale: float) -> Branches:
        """The pieces of their laws that the rods are on; forces (kN) below AT_LIMIT × scale count as 0."""
        nothing = AT_LIMIT * scale + response.round_off
        verge = (self.sense != 0.0) & (np.abs(response.elastic_force) <= nothing)
        slack = response.slack & ~verge
        low = np.where(self.sense > 0.0, 0.0, -self.compression_limit)
        high = np.where(self.sense < 0.0, 0.0, self.tension_limit)
        outward = np.where(self.at_limit(response), np.sign(response.axial_force), 0.0)
        return Branches(
            force=np.where(slack, response.elastic_force, response.axial_force),
            low=np.where(slack, np.where(self.sense > 0.0, -np.inf, 0.0), low),
            high=np.where(slack, np.where(self.sense > 0.0, 0.0, np.inf), high),
            outward=np.where(verge, -self.sense, outward),
            slack=slack,
            verge=verge,
        )

    def round_off(self, displacement: Array) -> float:
        """The residual (kN) that rounding of the displacements alone causes."""
        size = np.abs(self.gather(displacement))
        return 2.0 * ROUND_OFF * float((self.weight * size).max(initial=0.0))

    # --- tangent -------------------------------------------------------------------------------------

    def tangent(self, response: Response, soft: Flags, *, geometric: bool = True) -> Matrix:
        """dF/du over the unknowns: Σ EA/L₀ a aᵀ (not of soft rods) + Σ N/L (1 − a aᵀ)."""
        along = np.where(soft, 0.0, self.stiffness / self.rest_length)
        across = np.zeros_like(along)
        if geometric and not self.linear:
            length = np.where(self.flat, np.inf, response.length)
            across = np.where(length > 0.0, response.axial_force / np.where(length > 0.0, length, 1.0), 0.0)
        a = response.axis
        block = (along - across)[:, None, None] * (a[:, :, None] * a[:, None, :])
        block[:, 0, 0] += across
        block[:, 1, 1] += across
        return self._assembled(block)

    def _assembled(self, block: Array) -> Matrix:
        """Sum of the rods' 2 × 2 blocks: + at its ends, − between them."""
        signs = np.array([[1.0, -1.0], [-1.0, 1.0]])
        parts = (signs[None, :, None, :, None] * block[:, None, :, None, :]).ravel()
        if self.size <= DENSE:
            kept, place = self._dense_pattern
            full = np.bincount(place, parts[kept], self.size**2).astype(np.float64)
            return full.reshape(self.size, self.size)
        from scipy.sparse import csc_matrix

        kept, slot, rows, starts = self._sparse_pattern
        values = np.bincount(slot, parts[kept], len(rows))
        return csc_matrix((values, rows, starts), shape=(self.size, self.size))

    @cached_property
    def _dense_pattern(self) -> tuple[Rows, Rows]:
        """Those of the rods' 16 entries that are between unknowns, and the place of each in the flat matrix."""
        number = np.full(self.unknown.size, -1, dtype=np.intp)
        number[self.index] = np.arange(self.size, dtype=np.intp)
        own = number.reshape(-1, 2)[self.ends].reshape(-1, 4)
        row = np.repeat(own, 4, axis=1).ravel()
        column = np.tile(own, (1, 4)).ravel()
        kept = np.flatnonzero((row >= 0) & (column >= 0))
        return kept, column[kept] * self.size + row[kept]

    @cached_property
    def _sparse_pattern(self) -> tuple[Rows, Rows, NDArray[np.int32], NDArray[np.int32]]:
        """The same for compressed columns: entries, the slot of each, and the slots' rows and starts."""
        kept, place = self._dense_pattern
        places, slot = np.unique(place, return_inverse=True)
        counts = np.bincount(places // self.size, minlength=self.size)
        starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
        return kept, slot, (places % self.size).astype(np.int32), starts

    def compatibility(self, response: Response) -> csc_matrix:
        """Elongations of rods from the unknowns, (rods, N); its transpose is the equilibrium matrix."""
        return compatibility(self.ends, response.axis, len(self.position))[:, self.index].tocsc()

    def elongations(self, response: Response, rows: Rows) -> Array:
        """Some rows of the compatibility matrix in full, (k, N)."""
        matrix = np.zeros((len(rows), *self.unknown.shape))
        for sign, end in zip((-1.0, 1.0), self.ends[rows].T, strict=True):
            matrix[np.arange(len(rows)), end] = sign * response.axis[rows]
        return matrix.reshape(len(rows), -1)[:, self.index]


def compatibility(ends: Rows, axis: Array, particles: int) -> csc_matrix:
    """Elongations from the displacements of all particles, (rods, 2n)."""
    from scipy.sparse import csc_matrix

    columns = 2 * ends[:, [0, 0, 1, 1]] + np.array([0, 1, 0, 1])
    entries = np.concatenate([-axis, axis], axis=1)
    rows = np.repeat(np.arange(len(ends)), 4)
    return csc_matrix((entries.ravel(), (rows, columns.ravel())), (len(ends), 2 * particles))


def _held_by_rods(particles: int, ends: Rows) -> Flags:
    """Both directions of particles with rods, (n, 2)."""
    held = np.zeros((particles, 2), dtype=bool)
    held[ends] = True
    return held


def _bodies(particles: int, ends: Rows) -> Rows:
    return np.unique(lowest_joined(particles, ends), return_inverse=True)[1]


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
