"""Contacts: the forces between particles that stay in contact while other forces drive them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from components.model import Model
from components.paths import Paths
from components.snapshot import Snapshot
from game.collisions.strikes import NO_CROWD, NO_MOTION
from game.program.program import Program
from systems.base import StopReason
from systems.collision.complementarity import complementary
from systems.collision.system import Support, contacts_of, support_forces
from systems.collision.vicinity import Vicinity
from systems.near import Floats, Rows

HELD = 1e-13  # of the smaller radius, within which particles in contact are kept
MOST_TRIES = 60  # of the forces in a step


class Contacts:
    """Takes steps in which particles in lasting contact push each other so that they touch at the end."""

    def __init__(self, model: Model, vicinity: Vicinity) -> None:
        self.model = model
        self._near = vicinity

    def step(
        self,
        program: Program,
        before: Snapshot,
        take: Callable[[float | None], StopReason],
        until: float | None,
    ) -> StopReason:
        """One step from a moment before, taken by `take`: a whole one, or up to a time (s).

        Forces F ≥ 0, constant during the step, are sought by Broyden's method, which begins with the compliance
        h²/2 Nᵀ M⁻¹ N; contacts whose force is 0 may open. All tries end at the same time: where the error is
        controlled, other forces would choose another step, and gaps would jump with them.
        """
        contacts = contacts_of(self.model)
        if contacts is None:
            _push(program, self.model, 0.0)
            return take(until)
        pairs, forces = contacts.contacts, contacts.forces
        start = before.columns["particles.displacement"]
        _, normal = self._near.gaps(pairs, start)
        size = self._near.size[pairs].min(axis=1)
        held = HELD * size
        slope: Floats | None = None
        tried: tuple[Floats, Floats] | None = None
        for turn in range(MOST_TRIES):
            if turn > 0:
                before.restore(self.model)
            self._note_energy(float((forces * size).sum()))
            _push(program, self.model, support_forces(normal, pairs, forces, self.model.particles.count))
            reason = take(until)
            h = self.model.clock.time - before.columns["clock.time"][0]
            if h == 0.0 or reason is StopReason.DIVERGED:
                return reason
            if program.driver.controlled:
                until = self.model.clock.time
            gap, _ = self._near.gaps(pairs, self.model.particles.displacement)
            if not (np.where(forces > 0.0, np.abs(gap), -gap) > held).any():
                break
            if slope is None:
                slope = 0.5 * h * h * self._compliance(pairs, normal)
            elif tried is not None:
                slope = _improved(slope, forces - tried[0], gap - tried[1])
            tried = forces, gap
            forces = complementary(slope, gap, forces)
            if np.array_equal(forces, tried[0]):
                break
        lasts = (forces > 0.0) | (gap <= held)
        paths = Paths(NO_MOTION, pairs[lasts], forces[lasts], NO_CROWD)
        self.model.writable("clock.paths")[0] = paths
        return reason

    def _note_energy(self, energy: float) -> None:
        """Energies (J) are small or large beside what forces in contact would do along the radii of what they hold.

        What begins in contact is supplied none, and would be told neither to rest nor from what appears from nowhere.
        """
        if energy > self.model.clock.energy_scale:
            self.model.writable("clock.energy_scale")[0] = energy

    def _compliance(self, pairs: Rows, normal: Floats) -> Floats:
        """Nᵀ M⁻¹ N: how fast a unit force in one contact opens another, 1/kg."""
        columns = np.zeros((len(pairs), len(self._near.position), 2))
        rows = np.arange(len(pairs))
        columns[rows, pairs[:, 1]] += normal
        columns[rows, pairs[:, 0]] -= normal
        flat = (columns * np.sqrt(self._near.weight)).reshape(len(pairs), -1)
        product: Floats = flat @ flat.T
        return product


def _push(program: Program, model: Model, force: Floats | float) -> None:
    """Push the particles by these forces (kN) in the next step."""
    for system in program.systems:
        if isinstance(system, Support):
            system.push(model, force)


def _improved(slope: Floats, moved: Floats, changed: Floats) -> Floats:
    """Broyden's update of how gaps follow forces."""
    updated: Floats = slope + np.outer(changed - slope @ moved, moved) / float(moved @ moved)
    return updated
