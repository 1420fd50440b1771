"""Steps of a step program: of the whole, or while islands sleep of the awake part; alone, or ended at impacts.

Among particles that may meet, the integrator takes its steps, and each is looked through: the paths of the particles in
it are taken as parabolas, whose first impact is found like that of free particles. The step is taken again to end there,
and after the impact forces are evaluated anew. All of that happens in the step program and the kernel `collide` that it
calls; it returns to Python for room, and where something strikes what is asleep.
"""

from __future__ import annotations

import math

from pinjoint.components.model import Model
from pinjoint.systems.base import MOST_PARTS, StopReason
from pinjoint.systems.collision.driven.columns import Need, Real, Whole
from pinjoint.systems.collision.driven.neighbours import NeighbourList
from pinjoint.systems.collision.impacts import Impacts
from pinjoint.systems.program.program import Program
from pinjoint.systems.run.programs import Programs
from pinjoint.systems.run.recovery import FAILURES
from pinjoint.systems.run.sleep import Sleep
from pinjoint.systems.run.step_size import StepSize


class ProgramSteps:
    """The stepper of one model's step program, which end at no impact."""

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


class DrivenSteps(ProgramSteps):
    """The stepper of one model's step program that ends steps at impacts.

    unclosed: how many steps left contacts as they were, since no forces close them; and how far at most, in radii.
    """

    def __init__(
        self, model: Model, programs: Programs, sleep: Sleep, step_size: StepSize, impacts: Impacts
    ) -> None:
        super().__init__(model, programs, sleep, step_size)
        self._impacts = impacts
        self._neighbours = NeighbourList(model)
        self.unclosed = 0, 0.0

    def advance(self, steps: int, until: float = math.inf) -> tuple[int, StopReason]:
        first = self._model.clock.steps
        reason = self._take(steps, until, landing=False)
        return self._model.clock.steps - first, reason

    def land(self, target: float) -> StopReason:
        """Take a part of the next step, to a time (s): EVENT where an impact ends that step before.

        It ends earlier where it is hard, as that without impacts does.
        """
        clock, reason = self._model.clock, StopReason.DONE
        for _ in range(MOST_PARTS):
            if clock.time >= target or reason not in (StopReason.DONE, StopReason.REVIEW, StopReason.REST):
                break
            reason = self._take(1, min(target, clock.time + clock.step_size), landing=True)
        return reason

    def _take(self, steps: int, until: float, *, landing: bool) -> StopReason:
        """Take up to so many steps; landing: one that ends at `until` (s)."""
        program, near, clock = self.program, self._neighbours, self._model.clock
        near.look_up()
        near.load_contacts()
        near.driven.acceleration[near.driven.asleep] = 0.0  # programs of the rest do not look at what sleeps
        near.driven.real[Real.HELD_LIMIT] = self._step_size.longest_in_contact
        last = clock.steps + steps
        while True:
            near.driven.whole[Whole.LANDING] = landing
            try:
                reason, done = program.drive((near.driven, near.listing), last - clock.steps, until)
            finally:
                self._fetch_impacts()
            need = near.driven.whole[Whole.NEED]
            if need == Need.ROOM:
                near.make_room()
            elif need == Need.WAKE:
                near.store_contacts()
                self._programs.unbind()
                self._step_size.limit_anew()
                program = self.program
                if reason is not StopReason.DONE:
                    return reason
            elif done:
                near.store_contacts()
                return reason

    def _fetch_impacts(self) -> None:
        """Enter the impacts that were reported, and note how contacts closed."""
        driven = self._neighbours.driven
        whole = driven.whole
        self.unclosed = int(whole[Whole.UNCLOSED]), float(driven.real[Real.UNCLOSED])
        count = int(whole[Whole.REPORTED])
        if count:
            self._impacts.record(driven.report[:count])
            clock = self._model.clock
            self._model.writable("clock.collisions")[0] = clock.collisions + count
            whole[Whole.REPORTED] = 0
        self._impacts.count_cut_short(driven.group)
