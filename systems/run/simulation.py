"""Simulation: one model on its way through time, by fixed steps that no frame rate can change."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

from components.extremes import incomputable
from components.field import Column, Role, same
from components.load import loads_end
from components.model import ADDED, Model
from components.rod import is_warm
from components.snapshot import Snapshot
from components.world import Derivation
from systems.base import Driver, Phase, StepSystem, StopReason
from systems.catalogue import DRIVERS
from systems.collision.driven.stepper import DrivenCollisions
from systems.collision.free.flight import Flight
from systems.collision.impacts import Impacts
from systems.collision.overlaps import part_overlaps
from systems.collision.system import FreeFlight, detects_impacts, flies_free
from systems.edit.pull import Pull
from systems.physics.automatic import choose
from systems.program.binding import ProgramError
from systems.program.culprit import blame_mod, find_culprit
from systems.program.parallel import make_program
from systems.program.program import Program
from systems.program.writer import REVIEW_INTERVAL, form_of
from systems.run.checkpoint import Moment
from systems.run.energy import Account, Energy
from systems.run.sleep import Sleep
from systems.run.step_size import StepSize
from systems.schedule import Plan, Schedule

MOST_RETRIES = 6  # times that an automatic step is halved before a run is given up
FREE_FLIGHT = FreeFlight()

# What the clock is given when a run begins.
CHOSEN = ("step_size", "guard_energy", "initial_energy", "potential_reference")

ENDS = (StopReason.REST, StopReason.DIVERGED)  # of a run

MOVING = ("particles.displacement", "particles.velocity", "rods.plastic_strain")

OBSERVED = (
    "rods.axial_force",
    "rods.length",
    "rods.strain",
    "rods.yielding",
    "particles.applied_force",
    "particles.reaction",
)


class Simulation:
    """Advances one model and keeps its derived columns, its energy account and its last good state.

    reason: why the last advance ended; message: the same as a sentence, or "".
    note: what a person should know though the run goes on, or "".
    impacts: what collided so far.
    compute_seconds, compile_seconds: spent so far in steps, and in compiling or loading programs.
    scene: the one whose laws, commits and integrators act.
    watch: asked before steps are taken; returns after how many at most it wants to be asked again.
    """

    def __init__(self, model: Model, schedule: Schedule, scene: str = "simulation") -> None:
        self.model = model
        self.schedule = schedule
        self.scene = scene
        self.reason = StopReason.DONE
        self.message = ""
        self.note = ""
        self._rested = 0.0  # s, when it came to rest last
        self.impacts = Impacts(model)
        self._sleep = Sleep(model)
        self._step_size = StepSize(model, self._sleep, lambda: self.driver)
        self._account = Account(model, self._measured)
        self._driven_collisions = DrivenCollisions(model, self.impacts, self._short_step, self._rebind)
        self.compute_seconds = 0.0
        self.compile_seconds = 0.0
        self.watch: Callable[[], int] | None = None
        self._programs: dict[tuple[str, ...], Program | Flight] = {}
        self._driver: Driver | None = None
        self._program: Program | Flight | None = None
        self._binding = 0  # how often a program was bound
        self._present: tuple[int, Snapshot] | None = None  # the state at this revision
        self._collides = False
        self._armed = False  # the energy account and the step size fit the present document
        self._armed_revision = -1
        self._safe: Snapshot | None = None
        self._retries = 0
        model.before_change = self.before_change
        model.derive(Derivation(OBSERVED, self._sources(), lambda world: self.observe()))
        self.forget()  # a saved run goes on with the step size it had

    def _sources(self) -> tuple[str, ...]:
        tables = ["particles", "rods", "loads", "environment", "settings", "clock"]
        tables += [kind.table for kind in ADDED.values() if kind.table in self.model.tables]
        return tuple(
            f"{name}.{field.name}"
            for name in tables
            for field in self.model.tables[name].fields_in(Role.DOCUMENT, Role.STATE)
        )

    @property
    def plan(self) -> list[StepSystem]:
        """The laws and commits that act in its scene and that the model needs, in order."""
        return self.schedule.step_plan(self.scene, self.model)

    def planned(self) -> Plan:
        """All systems that run in its scene with its model, the integrator among them, and why the others do not."""
        found = self.schedule.plan(self.scene, self.model)
        phases, left_out = dict(found.phases), dict(found.left_out)
        for integrator in (*DRIVERS.values(), FREE_FLIGHT):
            if not self.schedule.is_active(integrator, self.scene):
                left_out[integrator.name] = self.schedule.inactive(integrator, self.scene)
            elif integrator is self.driver:
                phases[Phase.STEP] = (*phases[Phase.STEP], integrator)
            else:
                left_out[integrator.name] = f"{self.driver.name} integrates"
        return Plan(self.scene, phases, left_out)

    @contextmanager
    def in_scene(self, scene: str) -> Iterator[None]:
        """What is asked inside is answered as if the systems of a scene acted."""
        driver, before = self._driver, self.scene
        self._driver, self.scene = None, scene
        try:
            yield
        finally:
            self._driver, self.scene = driver, before

    def act_in(self, scene: str) -> None:
        """Let the systems of a scene act from now on. What they do otherwise counts as an edit."""
        if scene != self.scene:
            before, integrator = self.plan, self._integrator
            here, self.scene = self.scene, scene
            if self.plan != before or self._integrator is not integrator:
                self.scene = here  # the energy from which the edit starts is that under the laws until now
                self.before_change()
                self.scene = scene

    @property
    def _started(self) -> bool:
        return self.model.clock.step_size > 0.0

    # --- getting ready ---------------------------------------------------------------------------

    @property
    def driver(self) -> Driver:
        """The integrator that the settings ask for, or that suits the model; free particles need none."""
        if self._driver is None:
            free = flies_free(self.plan, self.model)
            self._driver = FREE_FLIGHT if free else self._integrator
        return self._driver

    @property
    def _integrator(self) -> Driver:
        """The one that the settings name; another where they name none, or that of a mod that is switched off."""
        named = DRIVERS.get(self.model.settings.integrator)
        off = named is None or (named.mod is not None and named.mod.off)
        if named is None or off or not self.schedule.is_active(named, self.scene):
            return DRIVERS[choose(self.model)]
        return named

    @property
    def integrator(self) -> str:
        """Its name."""
        return self.driver.name.rpartition(".")[2]

    @property
    def program(self) -> Program | Flight:
        """The step program, bound to the model as it is now."""
        if self._program is None:
            self._bind()
        assert self._program is not None
        return self._program

    @property
    def ready(self) -> bool:
        """False if the next step or observation needs a program that is not loaded yet."""
        return self._program is not None or self._key(self.plan) in self._programs

    @property
    def collides(self) -> bool:
        """True if particles of the model that the program is bound to may meet."""
        return self._collides

    @property
    def armed_revision(self) -> int:
        """Changes whenever the document that is run changed."""
        return self._armed_revision

    def forget(self) -> None:
        """The state was replaced (undo, a saved run) by one that fits the document, accounted for."""
        self._armed = self._started
        self._sleep.forget()
        self._program = None  # its plan may be another one: what is in contact is part of the state
        self._account.before_edit = None
        self._safe = None
        self._retries = 0
        self.reason, self.message = StopReason.DONE, ""

    def start_anew(self) -> None:
        """The state was replaced by one from before edits: a new run begins with it."""
        for name in CHOSEN:
            self.model.writable(f"clock.{name}")[0] = 0.0
        self.forget()

    def account_for_edits(self) -> None:
        """If the run was edited, account for it now, so that its state is complete."""
        if self._started:
            self._arm()

    @property
    def armed(self) -> bool:
        """True if all edits are accounted for and the step size fits the document."""
        return self._armed

    def moment(self, *tables: str) -> Moment:
        """The present, to return to: the state of these tables (none given: of all)."""
        return Moment(
            Snapshot.take(self.model, *tables) if tables else self.present(),
            self.model.clock.steps,
            self._armed,
            self._account.before_edit,
            self.stable_step,
            self.warning,
            self._binding,
        )

    def present(self) -> Snapshot:
        """All of the state now; the same as before if nothing has changed."""
        revision = self.model.newest(Role.STATE)
        if self._present is None or self._present[0] != revision:
            self._present = revision, Snapshot.take(self.model)
        return self._present[1]

    def resume(self, moment: Moment) -> None:
        """Return to a moment in which the document was as it is now."""
        program = self._program if moment.binding == self._binding else None
        moment.state.restore(self.model)
        self.forget()
        self._program = program
        self._armed, self._account.before_edit = moment.armed, moment.before_edit
        if moment.whole:  # else what limits the step is found out anew
            self._safe = moment.state
            self._step_size.stable, self._step_size.warning = moment.stable_step, moment.warning
        self._armed_revision = self.model.revision

    def wake(self) -> None:
        """Something acts on the model from outside: that it was at rest, or diverged, counts no more."""
        self.reason, self.message = StopReason.DONE, ""

    def before_change(self) -> None:
        """Before anything is edited, note the energy that the edit starts from; the program is void."""
        if self._armed:
            self._account.begin_edit()
            self._armed = False
        if self.model.clock.collision_state is not None:
            self.model.writable("clock.collision_state")[0] = None
        self._driver = self._program = None
        self._sleep.forget()

    def _arm(self) -> Program | Flight:
        """Get ready to run after edits: account for them, choose the step size, note a safe state."""
        if not self._armed:
            problem = incomputable(self.model)
            if not problem:
                self._part_overlaps()
                self.program.commit()  # what edits left beyond a strength yields
                self._account.close()
                self._review_sleep(edited=True)
                self.begin_step_size(self._step_size.first())
            self._armed = True
            self._armed_revision = self.model.revision
            self._safe = None
            self.reason, self.message = StopReason.DIVERGED if problem else StopReason.DONE, problem
        elif self._safe is None:
            self._step_size.look_up()
        if self._safe is None:
            self._safe = self.present()
        return self.program

    def _key(self, systems: list[StepSystem]) -> tuple[str, ...]:
        warmth = ("rods.misfit",) if is_warm(self.model) else ()
        return (
            *(system.name for system in systems),
            self.driver.name,
            form_of(self.model, self.driver),
            *warmth,
        )

    def _bind(self) -> None:
        """Take hold of the model by the program of its plan, without mods whose systems cannot join it."""
        while self._program is None:
            systems = self.plan
            self._collides = detects_impacts(systems)
            try:
                self._program = self._bound(systems)
                self._binding += 1
            except ProgramError as error:
                if not blame_mod(error):
                    raise
                self._driver = None  # it may be the one

    def _bound(self, systems: list[StepSystem]) -> Program | Flight:
        key = self._key(systems)
        if key in self._programs:
            self._programs[key].bind()
        else:
            self._programs[key] = self._made(systems)
            self.compile_seconds += self._programs[key].compile_seconds
        return self._programs[key]

    def _rebind(self) -> Program:
        """What takes the steps, now that an impact has changed the plan or woken something."""
        self._program = None
        stepper = self._stepper
        assert isinstance(stepper, Program)
        return stepper

    @property
    def _stepper(self) -> Program | Flight:
        """What takes the steps: the program, or while islands sleep one of the others."""
        program = self.program
        if not isinstance(program, Program) or not self._sleep.any_asleep:
            return program
        if self._sleep.disturb(program):
            self._step_size.limit_anew()
        return self._sleep.part(program)

    def _made(self, systems: list[StepSystem]) -> Program | Flight:
        if self.driver is FREE_FLIGHT:
            return Flight(self.model, self.impacts, next((s for s in systems if isinstance(s, Pull)), None))
        return make_program(self.model, systems, self.driver)

    def _part_overlaps(self) -> None:
        """Particles that edits left in one another's place are moved apart; a note says so."""
        self.note = ""
        if detects_impacts(self.plan):
            self.note = part_overlaps(self.model)

    def _measured(self) -> Column:
        """What the program measures in the present state."""
        self.observe()
        return self.program.measures

    # --- the step size ---------------------------------------------------------------------------

    @property
    def stable_step(self) -> float:
        """The largest stable step (s) that was found last."""
        return self._step_size.stable

    @property
    def warning(self) -> str:
        """That the steps are longer than is stable, or ""."""
        return self._step_size.warning

    @property
    def smooth(self) -> bool:
        """True if steps are not longer than what is shown at once, even where accuracy would allow it.

        Else they are too long to be watched, and to be interrupted.
        """
        return self._step_size.smooth

    @smooth.setter
    def smooth(self, smooth: bool) -> None:
        self._step_size.smooth = smooth

    def _review_step_size(self) -> None:
        """Change an automatic step size if what is stable changed much."""
        wanted = self._step_size.reviewed()
        if wanted is not None:
            self.begin_step_size(wanted)

    def begin_step_size(self, size: float) -> None:
        """From now on steps have this size; the guard against divergence compares with this moment."""
        model, clock = self.model, self.model.clock
        model.writable("clock.origin")[0] = clock.time
        model.writable("clock.origin_steps")[0] = clock.steps
        model.writable("clock.step_size")[0] = size
        self.observe()
        model.writable("clock.guard_energy")[0] = self.program.conserved_energy()

    # --- running -----------------------------------------------------------------------------------

    @property
    def halted(self) -> bool:
        """True if the run ended by itself, at rest or diverged, and nothing was edited since."""
        return self._armed and self.reason in ENDS

    def advance(self, steps: int, until: float = math.inf, landing: float = math.inf) -> int:
        """Take up to `steps` steps, none of which ends after `until` (s); returns how many.

        Stops at rest and before garbage. A step that would pass `landing` (s) may be cut to end there.
        """
        self._arm()
        started, clock = time.perf_counter(), self.model.clock
        first, done = clock.steps, 0
        while done < steps and not self.halted:
            ahead = min(steps - done, self._steps_to_review)
            if self.watch is not None:
                ahead = min(ahead, self.watch())
            taken, reason = self._take(ahead, until, landing)
            self._heed(reason)
            self._arm()
            now = clock.steps
            if self._sleep.is_due(now) and not self.halted:
                self._review_sleep()
            done = now - first
            if taken < max(ahead, 1) and reason is StopReason.DONE:
                break  # the next step would end later than allowed
        self.compute_seconds += time.perf_counter() - started
        return done

    def _take(self, steps: int, until: float, landing: float) -> tuple[int, StopReason]:
        """Take up to `steps` steps, looking out for what meets on the way if anything can."""
        program = self._stepper
        if not isinstance(program, Program):
            return program.advance(steps, until)
        if self._collides:
            return self._driven_collisions.advance(program, steps, until)
        return program.advance(steps, until, landing)

    def _heed(self, reason: StopReason) -> None:
        """Do what a program that returned for this reason asks for."""
        self.reason = reason
        if reason is StopReason.DONE:
            return
        if reason is StopReason.REST:
            self._rested = self.model.clock.time
            self.message = at_rest_since(self._rested)
        elif reason is StopReason.UNRESOLVED:
            self.reason = StopReason.DIVERGED
            if not self._go_on_without_mod():
                self._give_up("no time step, however small, leads on from there")
        elif reason is StopReason.DIVERGED and not (self._go_on_without_mod() or self._retry()):
            self._give_up("energy appeared from nowhere")
        elif reason is StopReason.REVIEW:
            before, self._safe, self._retries = self._safe, self.present(), 0
            if self._stood_still_since(before):
                self._heed(StopReason.REST)
            else:
                self._review_step_size()

    def _review_sleep(self, *, edited: bool = False) -> None:
        """Let islands at rest sleep, after edits or where a run is reviewed."""
        program = self.program
        if isinstance(program, Program) and (edited or self._sleep.may_happen(program)):
            others = self._sleep.review(program)
            if others and not edited:
                self._step_size.limit_anew()

    @property
    def _steps_to_review(self) -> int:
        """After how many steps to look which islands are at rest."""
        program = self.program
        return self._sleep.steps_to_review(program) if isinstance(program, Program) else sys.maxsize

    def _stood_still_since(self, before: Snapshot | None) -> bool:
        """True if all that happened since was lost in rounding: far from where it was drawn, a creep may be."""
        if before is None or self._safe is None or self._changes_end > self.model.clock.time:
            return False
        return all(same(before.columns[name], self._safe.columns[name]) for name in MOVING)

    @property
    def _changes_end(self) -> float:
        """The time (s) from which on nothing changes but by motion."""
        return self.program.changes_end if isinstance(self.program, Program) else loads_end(self.model)

    def _go_on_without_mod(self) -> bool:
        """If a mod made a number that is not finite, switch it off and return to the last good state."""
        assert self._safe is not None
        mod = find_culprit(self.program, self._safe) if isinstance(self.program, Program) else None
        if mod is None:
            return False
        self._safe.restore(self.model)
        self.before_change()  # what is lost with the mod counts as an edit
        self.reason = StopReason.DONE
        return True

    def _retry(self) -> bool:
        """An automatic step that proved too long (the geometry changed) is halved from the last safe state."""
        chosen = self.model.settings.time_step is not None or self.driver.estimates_error
        if chosen or self._retries == MOST_RETRIES:
            return False
        assert self._safe is not None
        size = self.model.clock.step_size
        self._safe.restore(self.model)
        self._sleep.forget()
        self.begin_step_size(0.5 * size)
        self._retries += 1
        self.reason = StopReason.DONE
        return True

    def run_to(self, target: float, *, whole_steps: bool = False) -> None:
        """Advance to exactly this time (s) by a last, short step; or only by whole steps that end by then."""
        self._arm()
        clock = self.model.clock
        while not self.halted and target - clock.time > 4.0 * math.ulp(target):
            landing = math.inf if whole_steps else target
            if self.advance(REVIEW_INTERVAL, target, landing) == 0 and not self.halted:
                if whole_steps:
                    return
                self._heed(self._land(target))

    def _land(self, target: float) -> StopReason:
        """Take the last, short step to a time (s)."""
        if isinstance(self.program, Program) and self._collides:
            return self._driven_collisions.land(self.program, target)
        return self._short_step(target)

    def _short_step(self, target: float) -> StopReason:
        """Take it without looking out for what meets."""
        clock, reason = self.model.clock, StopReason.DONE
        if self.driver.controlled:
            while clock.time < target and reason in (StopReason.DONE, StopReason.REVIEW):
                _, reason = self._stepper.advance(REVIEW_INTERVAL, target, target)
            return reason
        size = clock.step_size
        self.begin_step_size(target - clock.time)
        _, reason = self._stepper.advance(1)
        self.model.writable("clock.time")[0] = target
        self.begin_step_size(size)
        return reason

    @contextmanager
    def at(self, target: float) -> Iterator[None]:
        """The model as it is at a time (s) within the next step, inside the `with`; then as it was before."""
        self._arm()
        before = self.present()
        if target > self.model.clock.time:
            self._land(target)
        try:
            yield
        finally:
            before.restore(self.model)

    @contextmanager
    def aside(self, beginning: Snapshot) -> Iterator[None]:
        """What is run inside starts from another state, and is taken back as if it had not been."""
        before = self.moment()
        said = self.reason, self.message, self.note, self._armed_revision
        self.resume(replace(before, state=beginning, armed=False, before_edit=None))
        try:
            self._arm()
            yield
        finally:
            self.resume(before)
            self.reason, self.message, self.note, self._armed_revision = said

    def run_until_rest(self, limit: float) -> bool:
        """Advance until at rest, at most to the time `limit` (s); True if it came to rest."""
        self._arm()
        clock = self.model.clock
        while not self.halted and clock.time < limit:
            if self.advance(REVIEW_INTERVAL, limit) == 0:
                self.run_to(limit)
                break
        if not self.halted:
            self.message = self._why_not_at_rest(limit)
        return self.reason is StopReason.REST

    def _why_not_at_rest(self, limit: float) -> str:
        message = f"Not at rest within {limit:g} s of simulated time."
        if isinstance(self.program, Program) and self.program.lasting:
            return f"{message} {self.program.lasting} changes with time, so it never will be; run to a time instead."
        if not self.program.resists_motion:
            return f"{message} Nothing damps the motion, so it never will be; give rods damping or set a drag."
        if self._changes_end > limit:
            return f"{message} A load still changes; raise the limit."
        return f"{message} Raise the limit, or the damping of the rods or the drag."

    def _give_up(self, why: str) -> None:
        """Go back to the last good state and say what happened and what helps."""
        failed, size = self.model.clock.time, self.model.clock.step_size
        assert self._safe is not None
        self._safe.restore(self.model)
        self.message = (
            f"The simulation diverged near t = {failed:.6g} s: {why}. {self._step_size.remedy(size)}"
            f" The last good state, at t = {self.model.clock.time:.6g} s, was kept."
        )

    # --- reading ---------------------------------------------------------------------------------

    def observe(self) -> None:
        """Bring axial forces, lengths, reactions and energies up to date with the state."""
        self.program.observe()

    @property
    def energy(self) -> Energy:
        """The energy account now."""
        return self._account.energy(edited=not self._armed)

    @property
    def moved_until(self) -> float:
        """The time (s) up to which steps were taken; at rest, time may pass without any."""
        now = self.model.clock.time
        return min(self._rested, now) if self.reason is StopReason.REST else now

    @property
    def residual(self) -> float:
        """Largest unbalanced force on a free particle over the largest force of all, dampers apart."""
        unbalanced, largest = self._measured()[4:6].tolist()
        return float(unbalanced / largest) if largest > 0.0 else 0.0


def at_rest_since(time: float) -> str:
    """What to say of a model that came to rest at this time (s)."""
    return f"At rest since t = {time:.6g} s."
