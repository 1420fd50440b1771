"""Driven collisions: continuous collision detection inside the steps of an integrator.

The integrator takes its steps. Each is looked through: the paths of the particles in it are taken as parabolas, whose
first impact is found like that of free particles. The step is taken again to end there, and after the impact forces are
evaluated anew. All of that happens in the step program and the kernel `collide` that it calls; it returns to Python
for room, and where something strikes what is asleep.
"""

from __future__ import annotations

import math
from typing import Protocol

from pinjoint.components.model import Model
from pinjoint.systems.base import MOST_PARTS, StopReason
from pinjoint.systems.collision.driven.columns import Need, Real, Whole
from pinjoint.systems.collision.driven.neighbours import NeighbourList
from pinjoint.systems.collision.impacts import Impacts
from pinjoint.systems.program.program import Program


class Steps(Protocol):
    """The steps of a program, which end at no impact; see systems/run/program_steps.py."""

    @property
    def program(self) -> Program:
        """The program that takes the next steps."""

    def rebound(self) -> Program:
        """The program that takes the next steps, now that an impact woke something."""

    @property
    def longest_in_contact(self) -> float:
        """The longest step (s) while contacts persist."""


class DrivenCollisions:
    """The stepper that takes the steps of a program of one model, and ends steps at impacts.

    unclosed: how many steps left contacts as they were, since no forces close them; and how far at most, in radii.
    """

    def __init__(self, model: Model, impacts: Impacts, steps: Steps) -> None:
        self.model = model
        self._steps = steps
        self._impacts = impacts
        self._neighbours = NeighbourList(model)
        self.unclosed = 0, 0.0

    def advance(self, steps: int, until: float = math.inf) -> tuple[int, StopReason]:
        """Take up to `steps` steps that end by `until` (s), as every stepper does."""
        first = self.model.clock.steps
        reason = self._take(steps, until, landing=False)
        return self.model.clock.steps - first, reason

    def land(self, target: float) -> StopReason:
        """Take a part of the next step, to a time (s): EVENT where an impact ends that step before.

        It ends earlier where it is hard, as ProgramSteps.land() does.
        """
        clock, reason = self.model.clock, StopReason.DONE
        for _ in range(MOST_PARTS):
            if clock.time >= target or reason not in (StopReason.DONE, StopReason.REVIEW, StopReason.REST):
                break
            reason = self._take(1, min(target, clock.time + clock.step_size), landing=True)
        return reason

    def _take(self, steps: int, until: float, *, landing: bool) -> StopReason:
        """Take up to so many steps; landing: one that ends at `until` (s)."""
        program, near, clock = self._steps.program, self._neighbours, self.model.clock
        near.look_up()
        near.load_contacts()
        near.driven.acceleration[near.driven.asleep] = 0.0  # programs of the rest do not look at what sleeps
        near.driven.real[Real.HELD_LIMIT] = self._steps.longest_in_contact
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
                program = self._steps.rebound()
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
            clock = self.model.clock
            self.model.writable("clock.collisions")[0] = clock.collisions + count
            whole[Whole.REPORTED] = 0
        self._impacts.count_cut_short(driven.group)
