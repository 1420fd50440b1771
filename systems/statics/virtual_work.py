"""Virtual work: the displacements of the force method as sums over rods, with everything that is multiplied.

1 · δ = Σ n N L/EA + Σ ∫ m M dx/EI + Σ n ΔL + Σ ∫ m κ dx − Σ r c: n, m and the reactions r are those of a unit force on the
released structure; N, M those of the load there; ΔL and κ elongations and curvatures without force, by warmth and lack of
fit; c displacements of supports. Exact: N is constant along a rod or, with what acts along it, counts by its mean; m is
linear and M a parabola.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pinjoint.components.model import Model
from pinjoint.systems.statics.equations import Array, Rows
from pinjoint.systems.statics.force_method import Solution
from pinjoint.systems.statics.released import SetState


@dataclass(frozen=True)
class Work:
    """The table of virtual work for m unknowns; its terms are in m or rad.

    length, stiffness, bending_stiffness: L₀, EA, EI (rods,). base_axial: N₀ (rods,); unit_axial: n (m, rods).
    base_moment: M₀ (rods, 2), at the ends; unit_moment: m (m, rods, 2). load: q L₀², of which M₀ bulges by −1/8 at
    the middle (rods,). free: ΔL (rods,). curvature: κ (rods,). turned: L₀/EI, 0 of bars (rods,).

    of_base, of_bending, of_free: n N₀ L/EA, ∫ m M₀ dx/EI, and n ΔL with ∫ m κ dx (m, rods). settled: rows and axes of
    moved supports (k, 2); of_supports: −r c (m, k).
    """

    length: Array
    stiffness: Array
    bending_stiffness: Array
    base_axial: Array
    unit_axial: Array
    base_moment: Array
    unit_moment: Array
    load: Array
    free: Array
    curvature: Array
    turned: Array
    of_base: Array
    of_bending: Array
    of_free: Array
    settled: Rows
    of_supports: Array

    @property
    def gap(self) -> Array:
        """δ₀ (m,)."""
        parts = (self.of_base, self.of_bending, self.of_free, self.of_supports)
        total: Array = np.sum([part.sum(axis=1) for part in parts], axis=0)
        return total

    @property
    def flexibility(self) -> Array:
        """δ (m, m)."""
        every = range(len(self.unit_axial))
        terms = [[self.of_units(i, j) + self.of_unit_bending(i, j) for j in every] for i in every]
        total: Array = np.array(terms).reshape(len(every), len(every), -1).sum(axis=2)
        return total

    def of_units(self, i: int, j: int) -> Array:
        """n n' L/EA of two unknowns (rods,)."""
        terms: Array = self.unit_axial[i] * self.unit_axial[j] * self.length / self.stiffness
        return terms

    def of_unit_bending(self, i: int, j: int) -> Array:
        """∫ m m' dx/EI of two unknowns (rods,)."""
        terms: Array = self.turned * products(self.unit_moment[i], self.unit_moment[j])
        return terms


def virtual_work(model: Model, solution: Solution) -> Work:
    """The table of a solution."""
    rods, particles, count = model.rods, model.particles, len(solution.unknowns)
    length, stiffness = rods.rest_length.copy(), rods.stiffness.copy()
    unit_axial = np.array([unit.axial_force for unit in solution.units]).reshape(count, rods.count)
    for index, unknown in enumerate(solution.unknowns):
        if unknown.of_bar:
            unit_axial[index, unknown.element.row] = 1.0
    base_moment = _moments(model, [solution.base])[0]
    unit_moment = _moments(model, solution.units)
    x, y = (rods.difference / rods.original_length[:, None]).T
    load = (rods.distributed_force[:, 1] * x - rods.distributed_force[:, 0] * y) * length**2
    softness = length / stiffness
    bends = rods.bending_stiffness > 0.0
    turned = np.divide(length, rods.bending_stiffness, out=np.zeros(rods.count), where=bends)
    free = length * rods.plastic_strain - rods.misfit
    curvature = -rods.thermal_expansion * rods.temperature_gradient * bends
    settled = _settled(model, solution)
    reactions = np.array([unit.reaction[tuple(settled.T)] for unit in solution.units]).reshape(
        count, len(settled)
    )
    place = np.column_stack([particles.displacement, particles.rotation])[tuple(settled.T)]
    return Work(
        length,
        stiffness,
        rods.bending_stiffness.copy(),
        solution.base.axial_force,
        unit_axial,
        base_moment,
        unit_moment,
        load,
        free,
        curvature,
        turned,
        of_base=unit_axial * solution.base.axial_force * softness,
        of_bending=turned * products(unit_moment, base_moment, load),
        of_free=unit_axial * free + length * curvature * unit_moment.mean(axis=2),
        settled=settled,
        of_supports=-reactions * place,
    )


def products(m: Array, moments: Array, load: Array | float = 0.0) -> Array:
    """∫ m M dξ from 0 to 1 of rods: m linear, M as well, less the parabola ½ q L² ξ (1 − ξ); (…, rods, 2) and (rods,)."""
    straight = (
        m[..., 0] * (2.0 * moments[..., 0] + moments[..., 1])
        + m[..., 1] * (moments[..., 0] + 2.0 * moments[..., 1])
    ) / 6.0
    found: Array = straight - load * (m[..., 0] + m[..., 1]) / 24.0
    return found


def _moments(model: Model, states: Sequence[SetState]) -> Array:
    """Bending moments at the ends of the rods in some states, (states, rods, 2)."""
    none = np.zeros((model.rods.count, 2))
    found = [state.bending_moment if len(state.end_moment) else none for state in states]
    return np.array(found).reshape(len(states), model.rods.count, 2)


def _settled(model: Model, solution: Solution) -> Rows:
    """Rows and axes of the supports that have moved and are not released, (k, 2)."""
    particles = model.particles
    moved = np.where(particles.fixed, particles.displacement, 0.0)
    if len(solution.real.rotation):
        moved = np.column_stack([moved, np.where(particles.fixed_rotation, particles.rotation, 0.0)])
    for unknown in solution.unknowns:
        if unknown.of_support:
            moved[unknown.element.row, unknown.axis] = 0.0
    return np.argwhere(moved != 0.0)
