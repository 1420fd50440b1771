"""Force method: hyperstatic forces from three displacements, by first-order theory about original positions.

Set 1 is the real structure under the real load, set 2 the primary structure (without the static unknown) under
the real load, set 3 the primary structure under a unit force alone. Superposition is exact in first-order theory.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import qr
from scipy.sparse import csc_matrix, diags

from components.model import Model
from components.numeric_range import incomputable
from components.particle import Particle
from components.rod import Rod
from components.suggestions import missing
from systems.statics.assembly import compatibility
from systems.statics.equations import Array, Structure, normalised
from systems.statics.explain import cables_named, describe_motion
from systems.statics.external import external_forces
from systems.statics.factor import Factor, soft_count, soft_modes

_KEPT = 1e6  # weight of supports against rods when redundants are chosen: rods are released first
_RANK = 1e-9  # relative size below which a pivot is zero


class ForceMethodError(ValueError):
    """A static unknown that cannot be used; the message names it, the reason and the remedy.

    motion: of the mechanism that its release would leave, (n, 2), the largest 1; None for other reasons.
    """

    def __init__(self, message: str, motion: Array | None = None) -> None:
        super().__init__(message)
        self.motion = motion


@dataclass(frozen=True)
class Unknown:
    """A static unknown: the force of a rod, or of a support in one direction (0: x, 1: y)."""

    element: Rod | Particle
    axis: int | None = None

    @property
    def name(self) -> str:
        """As on the command line: "AC", or "A.y"."""
        return self.element.name if self.axis is None else f"{self.element.name}.{'xy'[self.axis]}"


@dataclass(frozen=True)
class SetState:
    """Displacements (n, 2), in m, and axial forces (rods,), in kN, of a set by first-order theory."""

    displacement: Array
    axial_force: Array


@dataclass(frozen=True)
class Solution:
    """The force method for m unknowns at once.

    delta_real, delta_base: (m,), m; delta_unit: (m, m), m/kN, column j under unit force j; force: (m,), kN.
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

    @property
    def superposed(self) -> SetState:
        """Set 2 + Σ p × set 3, which equals set 1."""
        displacement, axial_force = self.base.displacement.copy(), self.base.axial_force.copy()
        for unknown, force, unit in zip(self.unknowns, self.force.tolist(), self.units, strict=True):
            displacement += force * unit.displacement
            axial_force += force * unit.axial_force
            if isinstance(unknown.element, Rod):
                axial_force[unknown.element.row] = force
        return SetState(displacement, axial_force)


def refuse_bending(model: Model) -> None:
    """Raise ForceMethodError if members bend, whose moments are no unknowns here yet."""
    for row in np.flatnonzero((model.rods.turning_shares > 0.0).any(axis=1))[:1]:
        raise ForceMethodError(
            f"The force method takes bars only as yet, but {model.describe(model.rods[row])} bends. Make it a bar"
            " (bending stiffness 0), or compare theory and simulation: pinjoint verify."
        )


def find_unknown(model: Model, name: str) -> Unknown:
    """The unknown called "AC" (a rod) or "A.y" (a support). Raises ForceMethodError."""
    if name in model.rods:
        return Unknown(model.rods[name])
    particle, _, axis = name.rpartition(".")
    if particle in model.particles and axis in ("x", "y"):
        element = model.particles[particle]
        if not element.fixed["xy".index(axis)]:
            raise ForceMethodError(
                f"{particle} is free along {axis}, so there is no reaction to release there."
            )
        return Unknown(element, "xy".index(axis))
    supports = [f"{p.name}.{a}" for p in model.particles for a, held in zip("xy", p.fixed, strict=True) if held]
    choices = [*model.rods.names, *supports]
    if name in model.particles:
        raise ForceMethodError(
            f"'{name}' is a particle; say which of its supports, such as {name}.x or {name}.y."
        )
    raise ForceMethodError(missing("rods and supports", name, choices))


class _Linear:
    """First-order theory of a model without some unknowns, but with all masses, loads and moved supports."""

    def __init__(self, model: Model, released: Sequence[Unknown] = ()) -> None:
        whole = Structure.of(model)
        unknown_directions, along = whole.unknown.copy(), whole.stiffness / whole.rest_length
        for unknown in released:
            if unknown.axis is None:
                along[unknown.element.row] = 0.0
            else:
                unknown_directions[unknown.element.row, unknown.axis] = True
        self.structure = structure = replace(whole, unknown=unknown_directions)
        self.model = model
        self._along = along
        self._supports = np.where(whole.fixed & ~unknown_directions, model.particles.displacement, 0.0)
        response = structure.respond(np.zeros_like(whole.position), model.rods.plastic_strain)
        first, second = self._supports[whole.ends].swapaxes(0, 1)
        elongation = response.elongation + ((second - first) * whole.original_axis).sum(axis=1)
        self._prestress = along * elongation - np.where(along > 0.0, whole.stiffness, 0.0) * (
            model.rods.plastic_strain
        )
        self._compatibility = structure.compatibility(response)
        matrix = csc_matrix(self._compatibility.T @ diags(along) @ self._compatibility)
        self._factor = Factor(matrix)
        if soft_count(matrix, structure.weight) and (modes := soft_modes(matrix, structure.weight)).shape[1]:
            motions = structure.fields(modes)
            moves, names = describe_motion(model, motions), ", ".join(unknown.name for unknown in released)
            message = f"The structure is a mechanism already ({moves} can move); support or brace it first."
            if released:
                message = (
                    f"Without {names} the structure is a mechanism: {moves} can move."
                    " It is not a static unknown; choose a redundant rod or support."
                )
            raise ForceMethodError(message, normalised(motions[0]))

    def under(self, force: Array, *, prestressed: bool) -> SetState:
        """The state under forces (n, 2); prestressed: and under lack of fit and moved supports."""
        initial = self._prestress if prestressed else np.zeros_like(self._prestress)
        supports = self._supports if prestressed else np.zeros_like(self._supports)
        right = self.structure.gather(force) - self._compatibility.T @ initial
        moved = self._factor.solve(right)
        axial = self._along * (self._compatibility @ moved) + initial
        return SetState(supports + self.structure.spread(moved), axial)


def solve(model: Model, unknowns: Sequence[Unknown]) -> Solution:
    """Δ_real = Δ₀ + Σ Δ₁ p, for one unknown p = (Δ_real − Δ₀) / Δ₁. Raises ForceMethodError.

    Rod: Δ is the change of distance between its ends (apart +), the unit pair pulls them together, p > 0 is
    tension. Support: Δ and p along +x or +y, p is the force on the structure.

    Several unknowns are solved with the known part of Δ_real: the displacement of a moved support; for a rod,
    p L₀/EA less its lack of fit. So they are unique even where the primary structure has fewer rods than there are
    unknowns, and Δ₁ alone is singular.
    """
    problem = incomputable(model)
    if problem:
        raise ForceMethodError(problem)
    refuse_bending(model)
    if model.rods.tension_only.any():
        raise ForceMethodError(
            f"{cables_named(model)} in tension only: superposition needs linear behaviour. Let slack cables go"
            " and have taut ones bear compression too."
        )
    for unknown in unknowns:
        if unknown.axis is not None and not (model.rods.between == unknown.element.row).any():
            raise ForceMethodError(
                f"{unknown.name} is not a static unknown: no rod ends at {unknown.element.name}, so its reaction"
                " only balances what acts on it there. Choose a rod, or a support of the structure."
            )
    load = external_forces(model).at(1.0)
    whole = _Linear(model)
    real = whole.under(load, prestressed=True)
    released = _Linear(model, unknowns) if unknowns else whole
    base = released.under(load, prestressed=True)
    units = tuple(released.under(unit_force(model, unknown), prestressed=False) for unknown in unknowns)
    delta_real, delta_base, *of_units = _deltas(model, unknowns, (real, base, *units))
    delta_unit = np.array(of_units).reshape(len(unknowns), len(unknowns)).T
    own, unstrained = _flexibility(model, unknowns)
    force: Array = np.linalg.solve(delta_unit - np.diag(own), unstrained - delta_base).astype(np.float64)
    return Solution(tuple(unknowns), delta_real, delta_base, delta_unit, force, real, base, units)


def _flexibility(model: Model, unknowns: Sequence[Unknown]) -> tuple[Array, Array]:
    """Of every released element: its own L₀/EA (m/kN), and its Δ (m) when it is without force."""
    own, unstrained = np.zeros(len(unknowns)), np.zeros(len(unknowns))
    for index, unknown in enumerate(unknowns):
        if isinstance(unknown.element, Rod):
            rod = unknown.element
            own[index] = rod.rest_length / rod.stiffness
            unstrained[index] = rod.rest_length * rod.plastic_strain - rod.misfit
        elif unknown.axis is not None:
            unstrained[index] = unknown.element.displacement[unknown.axis]
    return own, unstrained


def unit_force(model: Model, unknown: Unknown) -> Array:
    """1 kN along a released constraint, or a pair of 1 kN that pulls a released rod's ends together."""
    force = np.zeros((model.particles.count, 2))
    if unknown.axis is not None:
        force[unknown.element.row, unknown.axis] = 1.0
        return force
    first, second = model.rods.between[unknown.element.row]
    axis = _axis(model, unknown)
    force[first] += axis
    force[second] -= axis
    return force


def _axis(model: Model, unknown: Unknown) -> Array:
    row = unknown.element.row
    axis: Array = model.rods.difference[row] / model.rods.original_length[row]
    return axis


def _deltas(model: Model, unknowns: Sequence[Unknown], states: Iterable[SetState]) -> Iterator[Array]:
    """Δ of all unknowns in each of some states, (unknowns,)."""
    between, both = model.rods.between, np.eye(2)
    ends = [between[u.element.row] if u.axis is None else (u.element.row,) * 2 for u in unknowns]
    first, second = np.array(ends, dtype=np.intp).reshape(-1, 2).T
    way = np.array([_axis(model, u) if u.axis is None else both[u.axis] for u in unknowns]).reshape(-1, 2)
    is_rod = np.array([u.axis is None for u in unknowns], dtype=bool)[:, None]
    for state in states:
        moved = state.displacement
        yield ((moved[second] - np.where(is_rod, moved[first], 0.0)) * way).sum(axis=1)


def redundants(model: Model) -> list[Unknown]:
    """Unknowns whose release leaves an isostatic structure, by pivoted QR of the equilibrium matrix.

    Rods before supports. As many as the degree of static indeterminacy; none if it is isostatic.
    """
    refuse_bending(model)
    structure = Structure.of(model)
    used = np.zeros(model.particles.count, dtype=bool)
    used[structure.ends] = True
    supports = np.argwhere(structure.fixed & used[:, None])
    of_supports = np.zeros((2 * model.particles.count, len(supports)))
    of_supports[2 * supports[:, 0] + supports[:, 1], np.arange(len(supports))] = _KEPT
    of_rods = compatibility(structure.ends, structure.original_axis, model.particles.count).toarray().T
    factor, order = qr(np.hstack([of_rods, of_supports]), mode="r", pivoting=True)
    sizes = np.abs(np.diag(factor))
    rank = int((sizes > _RANK * sizes.max(initial=0.0) / _KEPT).sum())
    found = []
    for column in sorted(order[rank:].tolist()):
        if column < model.rods.count:
            found.append(Unknown(model.rods[column]))
        else:
            row, direction = supports[column - model.rods.count].tolist()
            found.append(Unknown(model.particles[row], direction))
    return found
