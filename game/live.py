"""Live: a simulation that is watched, advanced frame by frame at a pace that suits a person."""

from __future__ import annotations

from game.clock import FrameClock
from game.simulation import Simulation
from systems.physics.pace import natural_pace

MANY, SHARE = 2000, 0.1  # elements from which on a change by a smaller share leaves the pace as it is


class Live:
    """A simulation and the clock of its frames."""

    def __init__(self, simulation: Simulation) -> None:
        self.simulation = simulation
        self.clock = FrameClock()
        self._pace_revision = -1
        self._pace_size = 0

    def frame(self, elapsed: float) -> None:
        """Take the steps of one frame that comes `elapsed` seconds after the last."""
        simulation, clock = self.simulation, self.clock
        if simulation.halted:
            return
        simulation.advance(0)
        if simulation.halted:  # it cannot be computed
            return
        self._find_pace()
        start, before = simulation.model.clock.time, simulation.compute_seconds
        due = clock.due(elapsed)
        taken = simulation.advance(clock.affordable, start + clock.ahead + due)
        clock.took(due, simulation.model.clock.time - start, taken, simulation.compute_seconds - before)

    def _find_pace(self) -> None:
        """Let the clock follow the pace that suits the model, found after every edit.

        One more or less of many elements hardly changes it, and finding it takes longer than a frame then.
        """
        revision, model = self.simulation.armed_revision, self.simulation.model
        size = model.particles.count + model.rods.count
        hardly_changed = size > MANY and abs(size - self._pace_size) < SHARE * size
        if revision != self._pace_revision:
            self.clock.ahead = 0.0
            if not hardly_changed:
                self._pace_size = size
                self.clock.natural = natural_pace(model)
        self._pace_revision = revision
