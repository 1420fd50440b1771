"""Force method: static unknowns from the displacements of a released structure, by first-order theory about original
positions.

Set 1 is the real structure under the real load, set 2 the released structure (without the static unknowns) under the real
load, set 3 the released structure under a unit force alone. Superposition is exact in first-order theory.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pinjoint.components.model import Model
from pinjoint.components.numeric_range import incomputable
from pinjoint.systems.statics.equations import Array
from pinjoint.systems.statics.explain import cables_named
from pinjoint.systems.statics.external import external_forces
from pinjoint.systems.statics.released import Released, SetState
from pinjoint.systems.statics.unknowns import ForceMethodError, Unknown, refuse_unsuited

_ROUNDING = 1e-12  # of the geometric mean of their diagonal: smaller flexibilities are 0


@dataclass(frozen=True)
class Solution:
    """The force method for m unknowns at once.

    In the textbook's terms: gap δ₀ (m,), by how much the released structure opens or closes under the load where an unknown
    is released, positive in the direction of the unknown; flexibility δ (m, m), likewise per unit of unknown j in column j,
    symmetric with positive diagonal; prescribed c (m,), what the gap must be: the displacement of a moved support, else 0.
    δ₀ + δ X = c gives the unknowns X, `force`.

    In the thesis': delta_real, delta_base (m,), delta_unit (m, m), of which those of a bar are changes of the distance
    between its ends. All in m, rad, kN, kN·m.

    real, base: sets 1 and 2; units: set 3 of each unknown, under its unit force.
    """

    unknowns: tuple[Unknown, ...]
    delta_real: Array
    delta_base: Array
    delta_unit: Array
    force: Array
    real: SetState
    base: SetState
    units: tuple[SetState, ...]
    gap: Array
    flexibility: Array
    prescribed: Array

    @property
    def superposed(self) -> SetState:
        """Set 2 + Σ X × set 3, which equals set 1."""
        found = self.base
        for unknown, force, unit in zip(self.unknowns, self.force.tolist(), self.units, strict=True):
            parts = {name: part + force * getattr(unit, name) for name, part in vars(found).items()}
            if unknown.of_bar:
                parts["axial_force"][unknown.element.row] = force
            elif unknown.of_support:
                parts["reaction"][unknown.element.row, unknown.axis] = force
            found = replace(found, **parts)
        return found


def solve(model: Model, unknowns: Sequence[Unknown]) -> Solution:
    """δ₀ + Σ δ X = c, which for one unknown is Δ_real = Δ₀ + Δ₁ p. Raises ForceMethodError.

    Bar: Δ is the change of distance between its ends (apart +), the unit pair pulls them together, X > 0 is tension. The
    gap is that in the bar, which is cut: its own elongation, by which it closes, less Δ. Support: Δ and X along +x or +y or
    counter-clockwise, X acts on the structure. End of a rod: X is the bending moment, Δ = δ the angle by which the pair of
    unit moments turns joint and rod against each other.
    """
    problem = incomputable(model)
    if problem:
        raise ForceMethodError(problem)
    if model.rods.tension_only.any():
        raise ForceMethodError(
            "{cables} in tension only, and superposition needs rods that bear compression as well. Make cables that"
            " stay taut ordinary rods, and delete those that go slack.",
            cables=cables_named(model),
        )
    refuse_unsuited(model, unknowns)
    load = external_forces(model).at(1.0)
    whole = Released(model)
    real = whole.under(load, prestressed=True)
    released = Released(model, unknowns) if unknowns else whole
    base = released.under(load, prestressed=True)
    units = tuple(
        released.under(unit_force(model, unknown), prestressed=False, couple=unit_couple(model, unknown))
        for unknown in unknowns
    )
    delta_real, delta_base, *of_units = _deltas(model, unknowns, (real, base, *units))
    delta_unit = np.array(of_units).reshape(len(unknowns), len(unknowns)).T
    own, unstrained, prescribed = _own(model, unknowns)
    sign = np.array([-1.0 if unknown.of_bar else 1.0 for unknown in unknowns])
    flexibility = sign[:, None] * (delta_unit - np.diag(own)).reshape(delta_unit.shape)
    gap = sign * (delta_base - unstrained)
    force: Array = np.linalg.solve(flexibility, prescribed - gap).astype(np.float64)
    deltas = (delta_real, delta_base, delta_unit)
    size = np.sqrt(np.abs(np.diag(flexibility)))
    flexibility = np.where(np.abs(flexibility) > _ROUNDING * np.outer(size, size), flexibility, 0.0)
    return Solution(
        tuple(unknowns), *deltas, force, real, base, units, gap + 0.0, flexibility + 0.0, prescribed
    )


def _own(model: Model, unknowns: Sequence[Unknown]) -> tuple[Array, Array, Array]:
    """Of released bars their own L₀/EA (m/kN) and their Δ (m) without force; of released supports where they are held."""
    own, unstrained, prescribed = np.zeros((3, len(unknowns)))
    particles, rods = model.particles, model.rods
    for index, unknown in enumerate(unknowns):
        row = unknown.element.row
        if unknown.of_bar:
            own[index] = rods.rest_length[row] / rods.stiffness[row]
            unstrained[index] = rods.rest_length[row] * rods.plastic_strain[row] - rods.misfit[row]
        elif unknown.of_support:
            turned = unknown.axis == 2
            prescribed[index] = particles.rotation[row] if turned else particles.displacement[row, unknown.axis]
    return own, unstrained, prescribed


def unit_force(model: Model, unknown: Unknown) -> Array:
    """What a unit of an unknown does to the particles, (n, 2), where members bend (n, 3).

    1 kN along a released constraint, or 1 kN·m; a pair of 1 kN that pulls a released bar's ends together. That at the end
    of a rod acts on the rod, which hands it on to the joint: see `unit_couple`.
    """
    force = np.zeros((model.particles.count, 3 if model.rods.turning_shares.any() else 2))
    row = unknown.element.row
    if unknown.of_bar:
        first, second = model.rods.between[row]
        axis = _axis(model, unknown)
        force[first, :2] += axis
        force[second, :2] -= axis
    elif unknown.of_support:
        force[row, unknown.axis] = 1.0
    return force


def unit_couple(model: Model, unknown: Unknown) -> Array:
    """What a unit of an unknown does to the released ends of rods, counter-clockwise, (rods, 2)."""
    couple = np.zeros((model.rods.count, 2))
    if unknown.of_end:
        couple[unknown.element.row, unknown.axis] = (-1.0, 1.0)[unknown.axis or 0]
    return couple


def _axis(model: Model, unknown: Unknown) -> Array:
    row = unknown.element.row
    axis: Array = model.rods.difference[row] / model.rods.original_length[row]
    return axis


def _deltas(model: Model, unknowns: Sequence[Unknown], states: Iterable[SetState]) -> Iterator[Array]:
    """Δ of all unknowns in each of some states, (unknowns,)."""
    between, both = model.rods.between, np.eye(2)
    rows = np.array([unknown.element.row for unknown in unknowns], dtype=np.intp)
    axes = np.array([unknown.axis or 0 for unknown in unknowns], dtype=np.intp)
    bars = np.array([unknown.of_bar for unknown in unknowns], dtype=bool)
    of_ends = np.array([unknown.of_end for unknown in unknowns], dtype=bool)
    of_clamps = np.array([unknown.is_moment for unknown in unknowns], dtype=bool) & ~of_ends
    ends = [between[u.element.row] if u.of_bar else (0 if u.of_end else u.element.row,) * 2 for u in unknowns]
    first, second = np.array(ends, dtype=np.intp).reshape(-1, 2).T
    way = np.array([_axis(model, u) if u.of_bar else both[(u.axis or 0) % 2] for u in unknowns]).reshape(-1, 2)
    for state in states:
        moved = state.displacement
        found = ((moved[second] - np.where(bars[:, None], moved[first], 0.0)) * way).sum(axis=1)
        found[of_clamps] = state.rotation[rows[of_clamps]]
        if of_ends.any():
            kink = state.kink if len(state.kink) else np.zeros((model.rods.count, 2))
            found[of_ends] = kink[rows[of_ends], axes[of_ends]] * np.where(axes[of_ends] == 0, 1.0, -1.0)
        yield found
