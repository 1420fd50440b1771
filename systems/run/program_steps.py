"""Steps of a step program: of the whole, or while islands sleep of the awake part."""

from __future__ import annotations

import math

from pinjoint.components.model import Model
from pinjoint.systems.base import MOST_PARTS, StopReason
from pinjoint.systems.program.program import Program
from pinjoint.systems.run.programs import Programs
from pinjoint.systems.run.recovery import FAILURES
from pinjoint.systems.run.sleep import Sleep
from pinjoint.systems.run.step_size import StepSize


class ProgramSteps:
    """The stepper of one model's step program, without collision detection."""

    def __init__(self, model: Model, programs: Programs, sleep: Sleep, step_size: StepSize) -> None:
        self._model = model
        self._programs = programs
        self._sleep = sleep
        self._step_size = step_size

    @property
    def program(self) -> Program:
        """The program that takes the next steps."""
        whole = self._programs.compiled
        if not self._sleep.any_asleep:
            return whole
        if self._sleep.disturb(whole):
            self._step_size.limit_anew()
        return self._sleep.part(whole)

    def rebound(self) -> Program:
        """The program that takes the next steps, now that an impact woke something."""
        self._programs.unbind()
        self._step_size.limit_anew()
        return self.program

    @property
    def longest_in_contact(self) -> float:
        """The longest step (s) while contacts persist."""
        return self._step_size.longest_in_contact

    def advance(self, steps: int, until: float = math.inf) -> tuple[int, StopReason]:
        """Take up to `steps` steps, as every stepper does."""
        return self.program.advance(steps, until)

    def land(self, target: float) -> StopReason:
        """Take the last, short step, to exactly the time `target` (s), or a part of it where that takes too many:
        what happens asks for shorter steps then, which the whole ones that follow take.
        """
        clock, reason = self._model.clock, StopReason.DONE
        last = clock.steps + MOST_PARTS
        while clock.time < target and clock.steps < last and reason not in (StopReason.EVENT, *FAILURES):
            _, reason = self.program.advance(last - clock.steps, target, target)
        return reason
