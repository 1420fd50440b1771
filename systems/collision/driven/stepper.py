"""Encounters: impacts and contacts of particles that rods or drag drive.

The integrator takes its steps; when particles come near each other every step is looked at: the paths in it
are taken as parabolas, whose first meeting is found like that of free particles, the step is taken again to end
there, and forces are evaluated anew after the impact.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol

import numpy as np

from components.field import Role
from components.model import Model
from components.particle import Particle
from components.paths import Paths, resting
from components.snapshot import Snapshot
from systems.base import StopReason
from systems.collision.columns import WATCHED
from systems.collision.driven.compiled import contents
from systems.collision.driven.contacts import Contacts, complementary
from systems.collision.driven.crowds import Crowds
from systems.collision.driven.impact import TOUCH, Strikes
from systems.collision.driven.neighbours import Vicinity
from systems.collision.free.flight import part_overlaps
from systems.collision.impacts import Impacts
from systems.collision.system import contacts_of
from systems.program.compiler import CompiledUnit
from systems.program.program import Program
from systems.program.stepper import Stepper

FEW = 4  # steps; a shorter time is not worth letting pass unwatched
SOME = 16  # steps that pass unwatched at once where others than ours decide what pushes particles
WARY = 8.0  # or as many as end in that part of the time in which nothing could meet
MOST_TRIES = 60  # of the length of a step that ends at an impact

Take = Callable[[float | None], StopReason]  # takes a step: a whole one, or up to a time (s)


class Steps(Stepper, Protocol):
    """The steps of a program, which end at no impact."""

    @property
    def program(self) -> Program:
        """What takes the next steps."""

    def rebound(self) -> Program:
        """What takes the next steps, now that an impact changed the plan."""


class Encounters:
    """The stepper that takes the steps of a program of one model, and ends them where particles meet."""

    def __init__(self, model: Model, impacts: Impacts, steps: Steps) -> None:
        self.model = model
        self._near = Vicinity(model)
        self._contacts = Contacts(model, self._near)
        self._strikes = Strikes(model, impacts, self._near)
        self._crowds = Crowds(model, self._near, self._strikes)
        self._steps = steps

    def advance(self, steps: int, until: float = math.inf, landing: float = math.inf) -> tuple[int, StopReason]:
        """Take up to `steps` steps that end by `until` (s), as every stepper does; none is cut at `landing`."""
        program = self._steps.program
        self._near.look_up()
        clock = self.model.clock
        first = clock.steps
        while clock.steps - first < steps:
            taken, reason = self._clear_steps(program, steps - (clock.steps - first), until)
            if taken == 0 and reason is StopReason.DONE:
                taken, reason, program = self._watched_step(program, until)
            if reason is not StopReason.DONE or taken == 0:
                return clock.steps - first, reason
        return clock.steps - first, StopReason.DONE

    def land(self, target: float) -> StopReason:
        """Take the last, short step to a time (s), in parts if there are impacts, or if steps are shorter."""
        program = self._steps.program
        self._near.look_up()
        self._near.clear_time(0.0)
        clock, reason = self.model.clock, StopReason.DONE
        while clock.time < target and reason in (StopReason.DONE, StopReason.REVIEW):
            end = min(target, clock.time + clock.step_size)
            _, reason, program = self._watched_step(program, end, landing=True)
        return reason

    def _clear_steps(self, program: Program, steps: int, until: float) -> tuple[int, StopReason]:
        """As many steps as nothing can meet in, none of which has to be watched; returns as `advance` does."""
        clock, known = self.model.clock, self._knows_forces(program)
        clear = self._near.clear_time(min(until - clock.time, 2.0 * steps * clock.step_size))
        if clear < FEW * clock.step_size:
            return 0, StopReason.DONE
        if not known and clear < WARY * steps * clock.step_size:
            steps = min(steps, max(SOME, int(clear / (WARY * clock.step_size))))
        before = None if known else Snapshot.take(self.model)
        taken, reason = program.advance(steps, min(until, clock.time + clear))
        if before is not None and self._near.outran:
            before.restore(self.model)
            return 0, StopReason.DONE
        return taken, reason

    def _knows_forces(self, program: Program) -> bool:
        """True if forces follow from the state alone, and by no law of a mod."""
        ours = all(system.mod is None for system in program.systems)
        return ours and program.follows_state and program.changes_end <= self.model.clock.time

    def _watched_step(
        self, program: Program, until: float, *, landing: bool = False
    ) -> tuple[int, StopReason, Program]:
        """One step, or the part of it up to the first impact, and what that does."""
        before, clock = Snapshot.take(self.model), self.model.clock
        start, steps, held = clock.time, clock.steps, contacts_of(self.model)

        def once(end: float | None) -> StopReason:
            if end is None:
                return program.advance(1, until)[1]
            return self._steps.land(end) if end <= until else StopReason.DONE

        crowd = self._crowds.found(until, landing)
        if crowd is not None:
            if held is None:
                self.model.writable("clock.paths")[0] = resting(crowd.pairs, np.zeros(len(crowd.pairs)))
                program = self._steps.rebound()
            reason = self._crowds.step(crowd, program, before, once, until, landing)
            if contacts_of(self.model) is None:
                program = self._steps.rebound()
            return clock.steps - steps, reason, program

        def take(target: float | None) -> StopReason:
            return self._contacts.step(program, before, once, target)

        reason = take(until if landing else None)
        while math.isnan(after := self._near.meeting(before, held)):
            half = 0.5 * (start + clock.time)
            before.restore(self.model)
            reason = take(half)
        if clock.time == start or reason is StopReason.DIVERGED:
            return clock.steps - steps, reason, program
        time, slow, tried = start + after, None, clock.time
        if time == start:  # what is pressed together from rest is told from the step that was tried
            slow = self._strikes.rest_speed(before)
            before.restore(self.model)
        elif time <= clock.time:
            reason = self._end_at_meeting(before, held, take, time)
        as_found = self.model.newest(Role.STATE)
        lasts = self._strikes.happen(before, slow)
        if time == start and self.model.newest(Role.STATE) == as_found:  # only round-off presses it
            reason = take(tried)
            lasts = self._strikes.happen(before)
        if lasts or (held is not None and contacts_of(self.model) is None):
            program = self._steps.rebound()
        return max(clock.steps - steps, 1), reason, program

    def _end_at_meeting(self, before: Snapshot, held: Paths | None, take: Take, time: float) -> StopReason:
        """Take the step again so that it ends where the first pair meets: Newton's method on the gap."""
        near, start, reason = self._near, float(before.columns["clock.time"][0]), StopReason.DONE
        end = self.model.clock.time
        for _ in range(MOST_TRIES):
            before.restore(self.model)
            reason = take(time)
            if self.model.clock.time != time:
                break  # contacts that last let it pass only a part of the step
            pairs = near.pairs[near.kinds(before.columns["particles.displacement"], held) == WATCHED]
            gap, normal = near.gaps(pairs, near.displacement)
            velocity = near.everywhere(near.velocity)
            relative = velocity[pairs[:, 1]] - velocity[pairs[:, 0]]
            rate = (normal * relative).sum(axis=1)
            with np.errstate(over="ignore"):  # far from each other, nearly at rest: late by for ever
                late = np.where(rate < 0.0, gap / np.where(rate < 0.0, rate, 1.0), -math.inf)
            first = int(np.argmax(late))  # the pair that met first, or is to meet first
            better = min(time - float(late[first]), end)
            if abs(gap[first]) <= TOUCH * near.reach(pairs)[first] or better == time:
                break
            if not start < better < time + (time - start):
                break
            time = better
        return reason


def _warm_up() -> None:
    """Call every compiled function once."""
    model = Model()
    model.create(Particle, 2, position=[(0.0, 0.0), (0.09, 0.0)], velocity=[(1.0, 0.0), (0.0, 0.0)])
    part_overlaps(model)
    near = Vicinity(model)
    strikes = Strikes(model, Impacts(model), near)
    before = Snapshot.take(model)
    near.look_up()
    near.clear_time()
    model.writable("clock.time")[0] = 1e-3
    near.meeting(before, None)
    gap, normal = near.gaps(near.pairs, near.displacement)
    complementary(near.compliance(near.pairs, normal, normal), gap, np.zeros(len(gap)))
    strikes.happen(before)


DRIVEN = CompiledUnit("driven_collisions", contents, _warm_up)
