"""Live: a simulation that is watched, advanced frame by frame at a pace that suits a person."""

from __future__ import annotations

from game.clock import FrameClock
from game.simulation import Simulation
from systems.physics.pace import natural_pace


class Live:
    """A simulation and the clock of its frames."""

    def __init__(self, simulation: Simulation) -> None:
        self.simulation = simulation
        self.clock = FrameClock()
        self._pace_revision = -1

    def frame(self, elapsed: float) -> None:
        """Take the steps of one frame that comes `elapsed` seconds after the last."""
        simulation = self.simulation
        if simulation.halted:
            return
        simulation.advance(0)
        self._find_pace()
        due = self.clock.steps(elapsed, simulation.model.clock.step_size)
        before = simulation.compute_seconds
        taken = simulation.advance(due)
        self.clock.took(taken, simulation.compute_seconds - before)

    def _find_pace(self) -> None:
        """Let the clock follow the pace that suits the model, found once after every edit."""
        revision = self.simulation.armed_revision
        if revision != self._pace_revision:
            self._pace_revision = revision
            self.clock.natural = natural_pace(self.simulation.model)
