"""Free flight: takes the place of the step program where only constant forces and impacts move the particles."""

from __future__ import annotations

import math
import sys
import time
from collections import deque
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Array
from pinjoint.components.clock import FreeFlightState
from pinjoint.components.field import Role
from pinjoint.components.handle import Handle
from pinjoint.components.load import loads_end
from pinjoint.components.model import Model
from pinjoint.components.obstacles import obstacles
from pinjoint.systems.base import REVIEW_INTERVAL, Event, Law, StopReason
from pinjoint.systems.collision.columns import FLIGHT, PILE_COUNTS, PILE_NUMBERS, Number, Reason
from pinjoint.systems.collision.free.discs import EVENTS, HORIZONS, Discs, state_on
from pinjoint.systems.collision.impacts import MOST_KEPT, Impacts, TooManyImpacts
from pinjoint.systems.program.compiler import Choice, Unfinished
from pinjoint.systems.program.entries import Measure

EVENTS_AT_ONCE = 2**18  # of which the impacts are gathered
CHECK_INTERVAL = 128  # steps, at multiples of which a run may end at rest


class Flight:
    """The particles of one model on their exact paths from impact to impact.

    flying: the discs as they are in the midst of a step, if they fly already. measures: as of Program.
    unbalanced: force on each particle as last observed (kN).
    The paths are part of the model's state: clock.collision_state. laws: a hand's, for one, whose forces are held
    constant during a step, so that paths are exact within it.
    """

    module = EVENTS
    lasting = ""  # nothing changes with time for ever
    watches_events = False
    follows_state = False  # contacts keep particles at rest, too

    def __init__(self, model: Model, impacts: Impacts, laws: Sequence[Law] = ()) -> None:
        self.model = model
        self.measures = np.zeros(len(Measure))
        self.unbalanced = np.zeros((model.particles.count, 2))
        self.unbalanced_moment = np.zeros(model.particles.count)  # nothing turns
        self._impacts = impacts
        self._laws = laws
        for module in (EVENTS, HORIZONS):
            module.begin(model.particles.count)
        self.bind()

    @property
    def changes_end(self) -> float:
        """The time (s) at which the last load history ends."""
        return loads_end(self.model)

    @property
    def resists_motion(self) -> bool:
        """True if impacts take energy."""
        least = obstacles(self.model).restitution.min(initial=self.model.settings.restitution)
        return bool(least < 1.0)

    def take_events(self) -> list[tuple[Event, list[Handle], list[Handle]]]:
        """Nothing: a plan with events has a step program."""
        return []

    def bind(self) -> None:
        """The document changed: paths are found anew."""
        self.flying: Discs | None = None
        self._state_revision = -1

    @property
    def _fresh(self) -> bool:
        return self.flying is not None and self._state_revision == self.model.newest(Role.STATE)

    @property
    def discs(self) -> Discs:
        """The flying discs, in the present state of the model."""
        if not self._fresh:
            self._found: deque[Array] = deque()  # by a step that is not finished
            self._happened = 0
            particles, clock = self.model.particles, self.model.clock
            self.flying = Discs(
                particles.position,
                particles.velocity,
                particles.radius,
                np.where(particles.fixed, 0.0, 1.0 / particles.mass[:, None]),
                displacement=particles.displacement,
                acceleration=particles.mobility * (particles.constant_force + self._held_forces()),
                restitution=self.model.settings.restitution,
                time=clock.time,
                obstacles=obstacles(self.model),
                lost=clock.dissipated_impact,
            )
            saved = clock.collision_state
            if not self._laws and isinstance(saved, FreeFlightState) and self._fits(saved):
                self.flying.resume(saved)
            self._state_revision = self.model.newest(Role.STATE)
        assert self.flying is not None
        return self.flying

    def _fits(self, saved: FreeFlightState) -> bool:
        """True if saved paths lead through the present state, bit for bit."""
        particles, now = self.model.particles, self.model.clock.time
        count = particles.count + len(obstacles(self.model))
        shapes = (particles.count, FLIGHT.stop), (len(PILE_COUNTS) + len(PILE_NUMBERS),)
        if (saved.motion.shape, saved.pile.shape) != shapes or not (saved.contacts < count).all():
            return False
        place, velocity = state_on(saved.motion, now)
        return bool((place == particles.displacement).all() and (velocity == particles.velocity).all())

    # --- running -----------------------------------------------------------------------------------

    def advance(self, steps: int, until: float = math.inf) -> tuple[int, StopReason]:
        """Let the time of up to `steps` steps pass, none of which ends after `until` (s), as every stepper does.

        Steps are only the times at which the state is observed: the motion does not depend on them unless laws act.
        """
        return self._take(steps, until, math.inf)

    def land(self, target: float) -> StopReason:
        """Let time pass to exactly `target` (s)."""
        clock, reason = self.model.clock, StopReason.DONE
        while clock.time < target and reason is StopReason.DONE:
            _, reason = self._take(sys.maxsize, target, target)
        return reason

    def _take(self, steps: int, until: float, landing: float) -> tuple[int, StopReason]:
        if not self._laws:
            return self._pass(steps, until, landing)
        taken, reason = 0, StopReason.DONE
        while taken < steps and reason is StopReason.DONE and self._step_under_laws(until, landing):
            taken += 1
        return taken, reason

    def _step_under_laws(self, until: float, landing: float) -> int:
        """Take one step with the laws' forces held constant, and enter their work."""
        force, particles = self._held_forces(), self.model.particles
        self.flying, before = None, particles.displacement.copy()
        taken, _ = self._pass(1, until, landing)
        if taken:
            work = 1000.0 * float((force * (particles.displacement - before)).sum())
            self.model.writable("clock.work")[0] = self.model.clock.work + work
            self._state_revision = self.model.newest(Role.STATE)
        return taken

    def _held_forces(self) -> NDArray[np.float64]:
        """Of the laws, on each particle (kN)."""
        none = np.zeros((self.model.particles.count, 2))
        return sum((law.held_forces(self.model) for law in self._laws), none)

    def _pass(self, steps: int, until: float, landing: float) -> tuple[int, StopReason]:
        clock = self.model.clock
        first, origin, size = clock.steps - clock.origin_steps, clock.origin, clock.step_size
        steps = min(steps, REVIEW_INTERVAL - clock.steps % REVIEW_INTERVAL)
        if until < math.inf:
            whole = min((until - origin) / size * (1.0 + 1e-15), 2.0**62)
            steps = min(steps, max(math.floor(whole) - first, 0))
        target = origin + (first + steps) * size
        last = steps == 0 or origin + (first + steps + 1) * size > landing  # late in a run neither is exact
        if last and math.inf > landing > clock.time:
            return self._land(landing)
        if steps == 0:
            return 0, StopReason.DONE
        discs = self._fly(target)
        rest = self._steps_until_rest(discs)
        if rest <= steps:
            steps = int(rest)
        self._enter(discs, steps, origin + (first + steps) * size)
        if rest <= steps:
            return steps, StopReason.REST
        return steps, StopReason.DONE if clock.steps % REVIEW_INTERVAL else StopReason.REVIEW

    def _land(self, landing: float) -> tuple[int, StopReason]:
        discs = self._fly(landing)
        self._enter(discs, 1, landing)
        self.model.writable("clock.origin")[0] = landing
        self.model.writable("clock.origin_steps")[0] = self.model.clock.steps
        return 1, StopReason.DONE

    def _fly(self, target: float) -> Discs:
        """Advance the discs and record the impacts, the last ones where there are too many.

        Raises Unfinished; and TooManyImpacts, after which nothing has happened.
        """
        if self._fresh and self.discs.now > target:  # that step went further before it was left
            self.bind()
        discs, found, reason = self.discs, self._found, Reason.BUSY
        if self._laws:
            discs.numbers[Number.STOP] = target
        while reason is Reason.BUSY:
            reason, some = discs.advance(target, EVENTS_AT_ONCE)
            found.append(some)
            self._happened += len(some)
            if self._happened > self._impacts.most_awaited:
                self.bind()
                raise TooManyImpacts
            while sum(map(len, found)) - len(found[0]) >= MOST_KEPT:
                found.popleft()
            if reason is Reason.BUSY and not self._laws and time.perf_counter() > Choice.deadline:
                raise Unfinished
        if happened := self._happened:
            kept = np.concatenate(found)
            self._impacts.record(kept, happened - len(kept))
            self.model.writable("clock.collisions")[0] = self.model.clock.collisions + happened
        self._impacts.count_cut_short(discs.group)
        found.clear()
        self._happened = 0
        return discs

    def _steps_until_rest(self, discs: Discs) -> float:
        """In how many steps a check will find everything at rest; infinite if it moves."""
        if self._laws or not discs.at_rest:
            return math.inf
        clock = self.model.clock
        since = math.ceil((discs.last_change - clock.origin) / clock.step_size) + clock.origin_steps
        return -(-max(since, clock.steps + 1) // CHECK_INTERVAL) * CHECK_INTERVAL - clock.steps

    def _enter(self, discs: Discs, steps: int, now: float) -> None:
        """Put the state at a time into the model."""
        displacement, velocity = discs.state_at(now)
        self.model.writable("particles.displacement")[...] = displacement
        self.model.writable("particles.velocity")[...] = velocity
        self.model.writable("clock.dissipated_impact")[0] = discs.lost_at(now)
        self.model.writable("clock.time")[0] = now
        self.model.writable("clock.steps")[0] += steps
        self.model.writable("clock.collision_state")[0] = discs.state()
        self._state_revision = self.model.newest(Role.STATE)

    # --- reading -----------------------------------------------------------------------------------

    def commit(self) -> None:
        """Do nothing: free particles have no history."""

    @np.errstate(over="ignore", invalid="ignore")  # the check of the model reports forces that are too large
    def observe(self) -> None:
        """Bring forces, reactions and measures up to date."""
        particles = self.model.particles
        constant, fixed, velocity = particles.constant_force, particles.fixed, particles.velocity
        force = constant + self._held_forces() + 0.001 * self.discs.contact_forces()
        self.model.writable("particles.applied_force")[...] = force
        self.model.writable("particles.reaction")[...] = np.where(fixed, 0.0 - force, 0.0)
        free: NDArray[np.float64] = np.where(fixed, 0.0, force)
        self.unbalanced = force
        measures = self.measures
        measures[Measure.KINETIC] = 0.5 * (particles.mass[:, None] * velocity * velocity).sum()
        measures[Measure.POWER_NORM] = 1000.0 * (free * particles.mobility * free).sum()
        measures[Measure.POTENTIAL] = 1000.0 * (constant * particles.displacement).sum()
        measures[Measure.RESIDUAL] = np.abs(free).max(initial=0.0)
        measures[Measure.LARGEST_FORCE] = np.abs(constant).max(initial=0.0)
        measures[Measure.POWER] = 1000.0 * (free * velocity).sum()

    def conserved_energy(self) -> float:
        """0: flight keeps energy to round-off, contact to 1e-9 of it, and no check compares it."""
        return 0.0
