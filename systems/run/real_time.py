"""Real time: a simulation that is watched, advanced frame by frame at a pace that suits a person."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager

from pinjoint.systems.physics.pace import natural_pace
from pinjoint.systems.program.compiler import Choice, Unfinished
from pinjoint.systems.run.simulation import Simulation

_LONGEST_FRAME = 0.1  # s of real time that one frame may catch up
BUDGET = 0.012  # s of a frame that steps may take
LONGEST_STEP = 0.02  # s after which a frame leaves a step in its midst, where that is possible
AT_ONCE = 0.003  # s for which steps are planned at once
_GROWTH = 8  # times as many steps at once, at most, as have ever been taken at once at what they cost now
FASTEST, SLOWEST = 1e3, 1e-5  # simulated seconds per second shown, times the natural pace at 1
MANY, SHARE = 2000, 0.1  # above MANY elements, a change of their number by a smaller share keeps the pace
SHORT = 0.125  # share of a frame that is left to the next where steps are as short: whole steps are shown


@contextmanager
def _in_time() -> Iterator[None]:
    """What is done within leaves off, where that is possible, when the frame has to be drawn."""
    Choice.deadline = time.perf_counter() + LONGEST_STEP
    try:
        yield
    finally:
        Choice.deadline = math.inf


class TimeScale:
    """Turns elapsed real time into simulated time, and remembers what whole steps leave of it.

    natural: simulated seconds per second shown that suit the model; factor: a person's choice on top.
    lagging: True while the machine cannot keep the pace; the picture then shows less time per second.
    ahead: simulated time (s) that has passed for the person since the end of the last step.
    """

    def __init__(self) -> None:
        self.natural = 1.0
        self.factor = 1.0
        self.lagging = False
        self.shown_pace = 1.0
        self.ahead = 0.0
        self.forget_cost()

    @property
    def pace(self) -> float:
        """Simulated seconds per second shown that is wanted."""
        return self.natural * self.factor

    def faster(self, times: float) -> None:
        """Multiply the pace, within limits."""
        self.factor = min(max(self.factor * times, SLOWEST), FASTEST)

    def due(self, elapsed: float) -> float:
        """Simulated time (s) to let pass in a frame that took `elapsed` seconds."""
        return min(elapsed, _LONGEST_FRAME) * self.pace

    def forget_cost(self) -> None:
        """Steps may cost another thing from now on: interpreted ones a hundred times as much as compiled ones."""
        self._seconds_per_step = 0.0
        self._most = 0  # steps that were taken at once

    def affordable(self, seconds: float) -> int:
        """Steps to take next where so many seconds are left: one at first, to learn what they cost, and never all.

        Impacts make steps ten times as long from one moment to the next.
        """
        fitting = min(AT_ONCE, seconds) / max(self._seconds_per_step, 1e-9)
        return int(min(fitting, _GROWTH * self._most)) if self._most else 1

    def cost(self, steps: int, seconds: float) -> None:
        """Learn what steps took that were taken at once."""
        if steps > 0:
            self._seconds_per_step = seconds / steps
            self._most = max(self._most, steps)

    def took(self, due: float, passed: float, *, lagging: bool) -> None:
        """Learn from a frame: time that was due and that passed in whole steps (s).

        lagging: the frame ended before all that was due had passed.
        """
        self.lagging = lagging
        wanted = self.ahead + due
        self.ahead = 0.0 if lagging else max(wanted - passed, 0.0)
        self.shown_pace = self.pace * passed / wanted if lagging else self.pace


class RealTimeRunner:
    """Advances a simulation by the time of each frame; `clock` says how fast.

    Whatever takes long in a large model (getting ready after an edit, finding the pace) has a frame to itself, so that
    pictures go on between.
    """

    def __init__(self, simulation: Simulation) -> None:
        self.simulation = simulation
        self.clock = TimeScale()
        self._pace_revision = -1
        self._pace_size = 0
        self._changes = -1  # of the forms of programs, when the cost of steps was last unknown
        self._unfinished = False  # the last frame left a step in its midst
        self._waited = False  # the last frame took no steps, so that the edit was drawn first

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
        try:
            with _in_time():
                simulation.advance(0)
        except Unfinished:
            return
        edited = revision != simulation.armed_revision
        if simulation.halted:  # the model cannot be computed
            return
        if edited and self._large:  # the edit is shown first
            return
        if self._find_pace() and self._large:
            return
        start, due = simulation.model.clock.time, clock.due(elapsed)
        lagging = self._take_steps(start + clock.ahead + due, self._steps_are_short(due))
        clock.took(due, simulation.model.clock.time - start, lagging=lagging)

    def _take_steps(self, target: float, whole: bool) -> bool:
        """Let time pass to a target (s) as far as the frame allows; True if it does not allow all of it."""
        simulation, clock, left = self.simulation, self.clock, BUDGET
        if self._changes != Choice.changes:
            self._changes = Choice.changes
            clock.forget_cost()
        try:
            with _in_time():
                some = max(clock.affordable(left), 1)
                while some > 0:
                    before = simulation.compute_seconds
                    taken = simulation.run_to(target, some, whole=whole or self._unfinished)
                    self._unfinished = False
                    seconds = simulation.compute_seconds - before
                    clock.cost(taken, seconds)
                    if taken < some:
                        return False
                    left -= seconds
                    some = clock.affordable(left) if left > 0.0 else 0
        except Unfinished:
            self._unfinished = True
            clock.forget_cost()
            return True
        return not simulation.halted and simulation.model.clock.time < target

    def _steps_are_short(self, due: float) -> bool:
        """True if whole steps follow the time of frames closely enough; in large models, each moment between is dear."""
        step: float = self.simulation.model.clock.step_size
        return step < (1.0 if self._large else SHORT) * due

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
