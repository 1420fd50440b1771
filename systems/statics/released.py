"""Released structures: first-order theory of a model without some static unknowns, about its original positions.

A released bar is cut, an end of a rod at which the moment is released has a hinge, a support lets go in one direction.
Masses, loads and the displacements of the other supports stay.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.systems.statics.assembly import Matrix
from pinjoint.systems.statics.equations import Array, Structure, normalised
from pinjoint.systems.statics.explain import describe_motion
from pinjoint.systems.statics.factor import Factor, soft_count, soft_modes, unresisted
from pinjoint.systems.statics.theory import elastic_response, refined
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

    Raises ForceMethodError, with the motion, if a mechanism is left. whole: the structure with all its rods and joints,
    but as free at its supports as the released one.
    """

    def __init__(self, model: Model, released: Sequence[Unknown] = ()) -> None:
        whole = Structure.of(model, "linear")
        nothing = np.zeros(len(whole.ends), dtype=bool), np.zeros(whole.ends.shape, dtype=bool)
        bars, self._hinges, supports = (
            *(part.copy() for part in nothing),
            np.zeros(whole.fixed.shape, dtype=bool),
        )
        for unknown in released:
            if unknown.of_bar:
                bars[unknown.element.row] = True
            else:
                at = self._hinges if unknown.of_end else supports
                at[unknown.element.row, unknown.axis] = True
        self.model = model
        self.whole = whole.released(*nothing, supports)
        self.structure = whole.released(bars, self._hinges, supports)
        matrix = self.structure.initial_tangent
        self._factor = Factor(matrix)
        if soft_count(matrix, self.whole.weight):
            self._refuse_mechanism(matrix, released)

    def _refuse_mechanism(self, matrix: Matrix, released: Sequence[Unknown]) -> None:
        modes = soft_modes(matrix, self.whole.weight)
        modes = unresisted(self.whole, self.whole.unmoved, matrix, modes)
        if not modes.shape[1]:
            return
        motions = self.whole.fields(modes)
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

    def under(self, force: Array, *, prestressed: bool, couple: Array | None = None) -> SetState:
        """The state under forces (n, 2 or 3); prestressed: and under lack of fit, warmth, what acts between the ends of
        rods, and moved supports. couple: moments at released ends, counter-clockwise on the rod, (rods, 2)."""
        structure, fixed, particles = self.structure, self.structure.fixed, self.model.particles
        moved = structure.field(particles.displacement, particles.rotation)
        strain, rods, whole = self.model.rods.plastic_strain, structure, self.whole
        if not prestressed:
            moved, strain, rods, whole = 0.0 * moved, 0.0 * strain, *self._without_prestress
        supports, share = np.where(fixed, moved, 0.0), float(prestressed)
        initial = elastic_response(rods, supports, strain, share)
        held, moment = rods.internal(initial), np.zeros(structure.ends.shape)
        if couple is not None and self.whole.bending is not None:
            moment = couple + self.whole.bending.carried_over(couple, self._hinges)
            held = held + structure.held(np.zeros_like(structure.difference), moment)
        solution = refined(structure, self._factor, structure.gather(force - held))
        displacement = supports + structure.spread(solution)
        final = elastic_response(rods, displacement, strain, share)
        held = rods.internal(final)
        if structure.bending is None:
            return SetState(displacement, final.axial_force, np.where(fixed, held - force, 0.0))
        held = held + structure.held(np.zeros_like(structure.difference), moment)
        reaction, moment = np.where(fixed, held - force, 0.0), structure.end_moments(final) + moment
        state = SetState(displacement[:, :2], final.axial_force, reaction, displacement[:, 2], moment)
        rigid = whole.end_moments(whole.respond(displacement, strain, share))  # with all joints as they were
        assert whole.bending is not None
        return replace(state, kink=whole.bending.kinks(rigid - moment, self._hinges))

    @cached_property
    def _without_prestress(self) -> tuple[Structure, Structure]:
        """The released structure and the whole one without lack of fit and warmth."""
        return self.structure.grown(0.0), self.whole.grown(0.0)
