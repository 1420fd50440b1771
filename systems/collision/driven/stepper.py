"""Driven collisions: continuous collision detection inside the steps of an integrator.

The integrator takes its steps. When particles come near each other every step is examined: the paths of the particles
in it are taken as parabolas, whose first impact is found like that of free particles. The step is taken again to end
there, and after the impact forces are evaluated anew.
"""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from components.collision_state import PersistentContacts
from components.field import Role
from components.model import Model
from components.particle import Particle
from components.snapshot import Snapshot
from systems.base import StopReason
from systems.collision.columns import PairKind
from systems.collision.driven.compiled import DRIVEN
from systems.collision.driven.contacts import ContactStepper, complementary
from systems.collision.driven.crowds import ContactProblem, CrowdStepper
from systems.collision.driven.impact import TOUCHING_GAP, ImpactResolver
from systems.collision.driven.neighbours import NeighbourList
from systems.collision.driven.trial import TrialStep
from systems.collision.impacts import Impacts
from systems.collision.overlaps import part_overlaps
from systems.collision.system import persistent_contacts
from systems.program.program import Program

FEWEST_CLEAR_STEPS = 4  # a time without impacts that is shorter is not worth a search for it
UNKNOWN_FORCE_STEPS = 16  # steps taken at once without examination where laws of mods decide the forces
UNKNOWN_FORCE_SHARE = 8.0  # or as many steps as end within this part (1/8) of the time without impacts
MOST_IMPACT_TRIES = 60  # of the length of a step that ends at an impact


class Steps(Protocol):
    """The steps of a program, which end at no impact; see systems/run/program_steps.py."""

    @property
    def program(self) -> Program:
        """The program that takes the next steps."""

    def rebound(self) -> Program:
        """The program that takes the next steps, now that an impact changed the plan."""

    def land(self, target: float) -> StopReason:
        """Take the last, short step, to exactly the time `target` (s)."""


class DrivenCollisions:
    """The stepper that takes the steps of a program of one model, and ends steps at impacts."""

    def __init__(self, model: Model, impacts: Impacts, steps: Steps) -> None:
        self.model = model
        self._steps = steps
        self._neighbours = NeighbourList(model)
        self._contacts = ContactStepper(model, self._neighbours)
        self._impacts = ImpactResolver(model, impacts, self._neighbours)
        self._crowds = CrowdStepper(model, self._neighbours, self._impacts)

    def advance(self, steps: int, until: float = math.inf) -> tuple[int, StopReason]:
        """Take up to `steps` steps that end by `until` (s), as every stepper does."""
        program = self._steps.program
        self._neighbours.look_up()
        clock = self.model.clock
        first = clock.steps
        while clock.steps - first < steps:
            taken, reason = self._clear_steps(program, steps - (clock.steps - first), until)
            if taken == 0 and reason is StopReason.DONE:
                taken, reason, program = self._examined_step(program, until)
            if reason is not StopReason.DONE or taken == 0:
                return clock.steps - first, reason
        return clock.steps - first, StopReason.DONE

    def land(self, target: float) -> StopReason:
        """Take a part of the next step, to a time (s): EVENT where an impact ends that step before."""
        program = self._steps.program
        self._neighbours.look_up()
        self._neighbours.clear_time(0.0)
        clock, reason = self.model.clock, StopReason.DONE
        while clock.time < target and reason in (StopReason.DONE, StopReason.REVIEW, StopReason.REST):
            end = min(target, clock.time + clock.step_size)
            _, reason, program = self._examined_step(program, end, landing=True)
        return reason

    def _clear_steps(self, program: Program, steps: int, until: float) -> tuple[int, StopReason]:
        """Take as many steps as cannot contain an impact, none of them examined; returns as `advance` does."""
        clock, known = self.model.clock, self._knows_forces(program)
        clear = self._neighbours.clear_time(min(until - clock.time, 2.0 * steps * clock.step_size))
        if clear < FEWEST_CLEAR_STEPS * clock.step_size:
            return 0, StopReason.DONE
        if not known and clear < UNKNOWN_FORCE_SHARE * steps * clock.step_size:
            unexamined = int(clear / (UNKNOWN_FORCE_SHARE * clock.step_size))
            steps = min(steps, max(UNKNOWN_FORCE_STEPS, unexamined))
        before = None if known else Snapshot.take(self.model)
        taken, reason = program.advance(steps, min(until, clock.time + clear))
        if before is not None and self._neighbours.outran:
            before.restore(self.model)
            return 0, StopReason.DONE
        return taken, reason

    def _knows_forces(self, program: Program) -> bool:
        """True if forces follow from the state alone, and no law of a mod is among them."""
        ours = all(system.mod is None for system in program.systems)
        return ours and program.follows_state and program.changes_end <= self.model.clock.time

    def _examined_step(
        self, program: Program, until: float, *, landing: bool = False
    ) -> tuple[int, StopReason, Program]:
        """Take one step, or the part of it up to the first impact, and resolve that impact.

        Returns the number of steps taken, why it stopped, and the program for the next step.
        """
        clock, steps = self.model.clock, self.model.clock.steps
        trial = TrialStep(self.model, program, until, self._steps.land)
        problem = self._crowds.problem()
        if problem is not None:
            reason = self._crowd_step(problem, trial, landing)
            return clock.steps - steps, reason, trial.program
        held = persistent_contacts(self.model)
        reason, impact = self._step_to_impact(trial, until if landing else None, held)
        if impact is None:
            return clock.steps - steps, reason, program
        met = impact <= clock.time
        reason, persists = self._resolve(trial, held, reason, impact)
        if persists or (held is not None and persistent_contacts(self.model) is None):
            program = self._steps.rebound()
        if landing and met and reason is not StopReason.DIVERGED:
            reason = StopReason.EVENT
        return max(clock.steps - steps, 1), reason, program

    def _crowd_step(self, problem: ContactProblem, trial: TrialStep, landing: bool) -> StopReason:
        """A step in which all impacts happen at the start; the program has the law of contact forces."""
        if persistent_contacts(self.model) is None:
            none = PersistentContacts(problem.pairs, np.zeros(len(problem.pairs)))
            self.model.writable("clock.collision_state")[0] = none
            trial.program = self._steps.rebound()
        reason = self._crowds.step(problem, trial, landing)
        if persistent_contacts(self.model) is None:
            trial.program = self._steps.rebound()
        return reason

    def _step_to_impact(
        self, trial: TrialStep, end: float | None, held: PersistentContacts | None
    ) -> tuple[StopReason, float | None]:
        """Take a step and find its first impact: why it stopped, and when that is (s; infinite: never).

        The step is halved until its paths differ little from parabolas. None instead of a time if no time passed.
        """
        clock = self.model.clock
        reason = self._contacts.step(trial, end)
        while math.isnan(after := self._neighbours.time_of_impact(trial.before, held)):
            half = 0.5 * (trial.start + clock.time)
            trial.take_back()
            reason = self._contacts.step(trial, half)
        if clock.time == trial.start or reason is StopReason.DIVERGED:
            return reason, None
        return reason, trial.start + after

    def _resolve(
        self, trial: TrialStep, held: PersistentContacts | None, reason: StopReason, impact: float
    ) -> tuple[StopReason, bool]:
        """End the step at the time of its first impact (s) and resolve what touches then.

        Returns why it stopped, and True if the plan may have changed. An impact at the start is one of particles that
        are pressed together from rest: at which speed they stay in contact is known from the step that was tried.
        """
        clock, rest_speed, tried = self.model.clock, None, self.model.clock.time
        at_start = impact == trial.start
        if at_start:
            rest_speed = self._impacts.rest_speed(trial.before)
            trial.take_back()
        elif impact <= clock.time:
            reason = self._end_at_impact(trial, held, impact)
        unchanged = self.model.newest(Role.STATE)
        persists = self._impacts.resolve(trial.before, rest_speed)
        if at_start and self.model.newest(Role.STATE) == unchanged:  # only round-off presses them together
            reason = self._contacts.step(trial, tried)
            persists = self._impacts.resolve(trial.before)
        return reason, persists

    def _end_at_impact(self, trial: TrialStep, held: PersistentContacts | None, time: float) -> StopReason:
        """Take the step again so that it ends where the first pair meets: Newton's method on the gap."""
        near, start, reason = self._neighbours, trial.start, StopReason.DONE
        end = self.model.clock.time
        for _ in range(MOST_IMPACT_TRIES):
            trial.take_back()
            reason = self._contacts.step(trial, time)
            if self.model.clock.time != time:
                break  # persistent contacts allowed only a part of the step
            kinds = near.kinds(trial.before.columns["particles.displacement"], held)
            pairs = near.pairs[kinds == PairKind.WATCHED]
            gap, normal = near.gaps(pairs, near.displacement)
            rate = near.rates(pairs, normal)
            with np.errstate(over="ignore"):  # far from each other, nearly at rest: infinitely late
                late = np.where(rate < 0.0, gap / np.where(rate < 0.0, rate, 1.0), -math.inf)
            first = int(np.argmax(late))  # the pair that met first, or is to meet first
            better = min(time - float(late[first]), end)
            if abs(gap[first]) <= TOUCHING_GAP * near.reach(pairs)[first] or better == time:
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
    near = NeighbourList(model)
    before = Snapshot.take(model)
    near.look_up()
    near.clear_time()
    model.writable("clock.time")[0] = 1e-3
    near.time_of_impact(before, None)
    gap, normal = near.gaps(near.pairs, near.displacement)
    complementary(near.compliance(near.pairs, normal, normal), gap, np.zeros(len(gap)))
    ImpactResolver(model, Impacts(model), near).resolve(before)


DRIVEN.warm_up = _warm_up
