"""Released structures: first-order theory of a model without some static unknowns, about its original positions.

A released bar is cut, an end of a rod at which the moment is released has a hinge, a support lets go in one direction.
Masses, loads and the displacements of the other supports stay.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from scipy.sparse import csc_matrix, diags

from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.components.rod import bends
from pinjoint.systems.statics.assembly import Matrix
from pinjoint.systems.statics.equations import ROUND_OFF, Array, Structure, largest, normalised
from pinjoint.systems.statics.explain import describe_motion
from pinjoint.systems.statics.factor import Factor, soft_count, soft_modes, unresisted
from pinjoint.systems.statics.theory import REFINEMENTS_OF_BENDING
from pinjoint.systems.statics.unknowns import ForceMethodError, Unknown

_NONE = np.zeros(0)


@dataclass(frozen=True)
class SetState:
    """Displacements (n, 2), in m, and axial forces (rods,), in kN, of a set by first-order theory.

    reaction: kN, kN·m, of the supports that are left, (n, 2 or 3). Where members bend, rotation: rad, (n,); end_moment:
    counter-clockwise on the ends of the rods, kN·m, (rods, 2); kink: by how much the joint has turned more than the
    released end of the rod beside it, rad, (rods, 2).
    """

    displacement: Array
    axial_force: Array
    reaction: Array = field(default_factory=lambda: _NONE)
    rotation: Array = field(default_factory=lambda: _NONE)
    end_moment: Array = field(default_factory=lambda: _NONE)
    kink: Array = field(default_factory=lambda: _NONE)

    @property
    def bending_moment(self) -> Array:
        """At the ends of the rods, positive where the side on their right is in tension, (rods, 2)."""
        moment: Array = self.end_moment * np.array([-1.0, 1.0])
        return moment


class Released:
    """First-order theory of a model without some unknowns, but with all masses, loads and moved supports.

    Raises ForceMethodError, with the motion, if a mechanism is left.
    """

    def __init__(self, model: Model, released: Sequence[Unknown] = ()) -> None:
        whole = Structure.of(model, "linear" if bends(model) else "exact")
        unknown_directions, along = whole.unknown.copy(), whole.stiffness / whole.rest_length
        self._hinges = np.zeros(whole.ends.shape, dtype=bool)
        for unknown in released:
            if unknown.of_bar:
                along[unknown.element.row] = 0.0
            elif unknown.of_end:
                self._hinges[unknown.element.row, unknown.axis] = True
            else:
                unknown_directions[unknown.element.row, unknown.axis] = True
        self.structure = structure = replace(whole, unknown=unknown_directions)
        self.model = model
        self._along = along
        self._held = whole.fixed & ~unknown_directions
        moved = structure.field(model.particles.displacement, model.particles.rotation)
        self._supports = np.where(self._held, moved, 0.0)
        response = structure.respond(np.zeros(whole.unknown.shape), model.rods.plastic_strain)
        first, second = self._supports[whole.ends, :2].swapaxes(0, 1)
        elongation = response.elongation + ((second - first) * whole.original_axis).sum(axis=1)
        self._prestress = along * elongation - np.where(along > 0.0, whole.stiffness, 0.0) * (
            model.rods.plastic_strain
        )
        self._compatibility = structure.compatibility(response)
        matrix = self._tangent()
        self._factor = Factor(matrix)
        if soft_count(matrix, structure.weight):
            self._refuse_mechanism(matrix, released)

    def _tangent(self) -> Matrix:
        structure = self.structure
        if structure.bending is None:
            return csc_matrix(self._compatibility.T @ diags(self._along) @ self._compatibility)
        return self._hinged.tangent(structure.unmoved, self._along == 0.0, geometric=False)

    @cached_property
    def _hinged(self) -> Structure:
        """The structure of which released ends of rods resist no slopes."""
        bending = self.structure.bending
        assert bending is not None
        stiffness = bending.end_stiffness.copy()
        for row in np.flatnonzero(self._hinges.any(axis=1)).tolist():
            start, mixed, end = stiffness[row]
            condensed = {
                (True, False): (0.0, 0.0, end - mixed**2 / start if start else end),
                (False, True): (start - mixed**2 / end if end else start, 0.0, 0.0),
            }
            stiffness[row] = condensed.get(tuple(self._hinges[row].tolist()), (0.0, 0.0, 0.0))
        return replace(self.structure, bending=replace(bending, end_stiffness=stiffness))

    def _refuse_mechanism(self, matrix: Matrix, released: Sequence[Unknown]) -> None:
        structure = self.structure
        modes = soft_modes(matrix, structure.weight)
        modes = unresisted(structure, structure.unmoved, matrix, modes)
        if not modes.shape[1]:
            return
        motions = structure.fields(modes)
        moves = describe_motion(self.model, motions)
        if released:
            message = tr(
                "Without {names} the structure is a mechanism: {moves} can move."
                " It is not a static unknown; choose a redundant rod or support.",
                names=", ".join(unknown.name for unknown in released),
                moves=moves,
            )
        else:
            message = tr(
                "The structure is a mechanism already ({moves} can move); support or brace it first.",
                moves=moves,
            )
        raise ForceMethodError(message, normalised(motions[0]))

    # --- states ------------------------------------------------------------------------------------

    def under(self, force: Array, *, prestressed: bool, couple: Array | None = None) -> SetState:
        """The state under forces (n, 2 or 3); prestressed: and under lack of fit, warmth, what acts between the ends of
        rods, and moved supports. couple: moments at released ends, counter-clockwise on the rod, (rods, 2)."""
        structure = self.structure
        initial = self._prestress if prestressed else np.zeros_like(self._prestress)
        supports = self._supports if prestressed else np.zeros_like(self._supports)
        if structure.bending is not None:
            return self._bent(force, initial, supports, prestressed, couple)
        right = structure.gather(force) - self._compatibility.T @ initial
        moved = self._factor.solve(right)
        axial = self._along * (self._compatibility @ moved) + initial
        return self._state(supports + structure.spread(moved), axial, None, force)

    def _bent(
        self, force: Array, initial: Array, supports: Array, prestressed: bool, couple: Array | None
    ) -> SetState:
        structure, rods = self.structure, self._hinged
        assert structure.bending is not None
        assert rods.bending is not None
        couple = np.zeros(structure.ends.shape) if couple is None else couple
        fixed_end = self._fixed_end if prestressed else np.zeros_like(couple)
        at_supports = structure.slope_rates(supports, structure.unmoved)
        first = self._carried_over(fixed_end, couple) + rods.bending.moments(at_supports)
        right = structure.gather(force - self._holding(initial, first))
        moved = self._factor.solve(right)
        for _ in range(REFINEMENTS_OF_BENDING):
            held = structure.gather(self._holding(*self._deformed(structure.spread(moved))))
            step = self._factor.solve(right - held)
            moved = moved + step
            if largest(step) <= ROUND_OFF * largest(moved):
                break
        field = structure.spread(moved)
        axial, moment = self._deformed(field)
        state = self._state(supports + field, axial + initial, moment + first, force)
        slopes = structure.slope_rates(supports + field, structure.unmoved)
        return replace(state, kink=np.where(self._hinges, slopes - self._own(fixed_end, couple, slopes), 0.0))

    def _deformed(self, field: Array) -> tuple[Array, Array]:
        """Axial forces (rods,) and moments on the ends (rods, 2) by small displacements (n, 3)."""
        structure, rods = self.structure, self._hinged
        assert rods.bending is not None
        stretched = (structure.relative(field) * structure.original_axis).sum(axis=1)
        return self._along * stretched, rods.bending.moments(structure.slope_rates(field, structure.unmoved))

    def _holding(self, axial: Array, moment: Array) -> Array:
        """Forces (n, 3) that hold the particles against rods with these axial forces and moments on their ends."""
        return self.structure.held(axial[:, None] * self.structure.original_axis, moment)

    @cached_property
    def _fixed_end(self) -> Array:
        """Moments on the ends of rods that hold their slopes at 0: by distributed forces and by warmth, (rods, 2)."""
        bending = self.structure.bending
        assert bending is not None
        x, y = self.structure.original_axis.T
        force = self.model.rods.distributed_force
        across: Array = force[:, 1] * x - force[:, 0] * y  # to the left of each rod (kN/m)
        return -bending.moments(bending.initial_slopes) - across[:, None] * bending.load_shares

    def _carried_over(self, fixed_end: Array, couple: Array) -> Array:
        """Moments on the ends while all slopes of ends that are not released are 0: those of hinges carry over."""
        assert self.structure.bending is not None
        start, mixed, end = self.structure.bending.end_stiffness.T
        stiff, one = np.stack([start, end], axis=1), self._hinges.sum(axis=1) == 1
        share = np.divide(mixed[:, None], stiff, where=stiff != 0.0, out=np.zeros_like(stiff))
        carried = np.where(self._hinges & one[:, None], share * (couple - fixed_end), 0.0)
        moment: Array = np.where(self._hinges, couple, fixed_end) + carried[:, ::-1]
        return moment

    def _own(self, fixed_end: Array, couple: Array, slopes: Array) -> Array:
        """The slopes of the rods themselves at released ends, to their chords, (rods, 2)."""
        assert self.structure.bending is not None
        start, mixed, end = self.structure.bending.end_stiffness.T
        right, other = couple - fixed_end, slopes[:, ::-1] * mixed[:, None]
        alone = np.divide(
            right - other, np.stack([start, end], axis=1), where=self._hinges, out=np.zeros_like(slopes)
        )
        both = self._hinges[:, 0] & self._hinges[:, 1]
        crossed = np.stack([end, start], axis=1) * right - mixed[:, None] * right[:, ::-1]
        together = np.divide(crossed, (start * end - mixed**2)[:, None], where=both[:, None], out=alone.copy())
        own: Array = np.where(both[:, None], together, alone)
        return own

    def _state(self, displacement: Array, axial: Array, moment: Array | None, force: Array) -> SetState:
        structure = self.structure
        if moment is None:
            held = structure.scatter(axial[:, None] * structure.original_axis)
            return SetState(displacement, axial, np.where(self._held, held - force, 0.0))
        reaction = np.where(self._held, self._holding(axial, moment) - force, 0.0)
        return SetState(displacement[:, :2], axial, reaction, displacement[:, 2], moment)
