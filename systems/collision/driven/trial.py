"""A trial step: one step of a program that can be taken back and taken again."""

from __future__ import annotations

from collections.abc import Callable

from components.model import Model
from components.snapshot import Snapshot
from systems.base import StopReason
from systems.program.program import Program

Land = Callable[[float], StopReason]  # takes a short step to a time (s)


class TrialStep:
    """A step that begins with the present state; after `take_back` the model is in that state again.

    program: takes whole steps. until: the step does not end later (s). land: takes a short step to a time (s).
    before: the state in which the step begins; start: its time, s.
    """

    def __init__(self, model: Model, program: Program, until: float, land: Land) -> None:
        self.model = model
        self.program = program
        self.until = until
        self._land = land
        self.before = Snapshot.take(model)
        self.start = float(model.clock.time)

    def take(self, end: float | None) -> StopReason:
        """Take a whole step, or one that ends at a time (s); no step where that is after `until`."""
        if end is None:
            return self.program.advance(1, self.until)[1]
        return self._land(end) if end <= self.until else StopReason.DONE

    def take_back(self) -> None:
        """Restore the state in which the step begins."""
        self.before.restore(self.model)
