"""Live: a simulation that is watched, advanced frame by frame at a pace that suits a person."""

from __future__ import annotations

from systems.physics.pace import natural_pace
from systems.run.frame_clock import FrameClock
from systems.run.simulation import Simulation

MANY, SHARE = 2000, 0.1  # elements from which on a change by a smaller share leaves the pace as it is


class Live:
    """A simulation and the clock of its frames."""

    def __init__(self, simulation: Simulation) -> None:
        self.simulation = simulation
        self.clock = FrameClock()
        self._pace_revision = -1
        self._pace_size = 0
        self._waited = False  # for a picture

    def frame(self, elapsed: float) -> None:
        """Take the steps of one frame that comes `elapsed` seconds after the last."""
        simulation, clock = self.simulation, self.clock
        if simulation.halted:
            return
        waited, self._waited = self._waited, False
        if self._large and not simulation.armed and not waited:
            self._waited = True  # a picture shows the edit before anything is got ready
            return
        revision = simulation.armed_revision
        simulation.advance(0)
        edited = revision != simulation.armed_revision
        if simulation.halted:  # the model cannot be computed
            return
        if edited and self._large:  # the edit is shown first
            return
        if self._find_pace() and self._large:
            return
        start, before = simulation.model.clock.time, simulation.compute_seconds
        due = clock.due(elapsed)
        taken = simulation.advance(clock.affordable, start + clock.ahead + due)
        clock.took(due, simulation.model.clock.time - start, taken, simulation.compute_seconds - before)

    @property
    def _size(self) -> int:
        return self.simulation.model.particles.count + self.simulation.model.rods.count

    @property
    def _large(self) -> bool:
        """True if getting ready, finding the pace and taking steps would take too long in one frame."""
        return self._size > MANY

    def _find_pace(self) -> bool:
        """Let the clock follow the pace that suits the model, found after every edit; True if it was.

        One more or less of many elements hardly changes it, and finding it takes longer than a frame then.
        """
        revision, size = self.simulation.armed_revision, self._size
        if revision == self._pace_revision:
            return False
        self._pace_revision = revision
        self.clock.ahead = 0.0
        if self._large and abs(size - self._pace_size) < SHARE * size:
            return False
        self._pace_size = size
        self.clock.natural = natural_pace(self.simulation.model)
        return True
