"""Simulation: one model on its way through time, by steps that no frame rate can change."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from time import monotonic
from typing import Any

from pinjoint.components.cases import idle_settlement
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import Column, Role
from pinjoint.components.language import joined, marked, tr
from pinjoint.components.latest import Latest
from pinjoint.components.model import Model
from pinjoint.components.numeric_range import immovable, incomputable
from pinjoint.components.rod import extensible_elsewhere, idle_moment
from pinjoint.components.snapshot import Snapshot
from pinjoint.components.world import Derivation
from pinjoint.systems.base import REVIEW_INTERVAL, Integrator, StepSystem, StopReason
from pinjoint.systems.collision.free.flight import Flight
from pinjoint.systems.collision.impacts import Impacts
from pinjoint.systems.collision.overlaps import PARTING, part_overlaps, work_ahead
from pinjoint.systems.physics.rest import may_rest, rests_unseen
from pinjoint.systems.program.compiler import Choice, Unfinished
from pinjoint.systems.program.entries import Measure
from pinjoint.systems.program.program import OBSERVED
from pinjoint.systems.run.checkpoint import Checkpoint
from pinjoint.systems.run.energy import Account, Energy
from pinjoint.systems.run.notes import (
    at_rest_since,
    contact_warning,
    energy_warning,
    overlap_warning,
    reflection_warning,
)
from pinjoint.systems.run.program_steps import DrivenSteps, ProgramSteps
from pinjoint.systems.run.programs import Dynamics, Programs
from pinjoint.systems.run.recovery import FAILURES, Recovery
from pinjoint.systems.run.sleep import Sleep
from pinjoint.systems.run.step_size import StepSize, begin_steps
from pinjoint.systems.schedule import Plan, Schedule

# Messages of runs that diverged, and of one that does not get on.
SAME = marked(
    "The simulation diverged near t = {time}: after each {steps} steps the model is in the same state again."
)
STUCK = marked(
    "After each {steps} steps the model is in the same state again, although forces are not balanced or errors of the time"
    " steps damped the motion: it jumps between the same states, or is lost in rounding. Choose another time step."
)

WORK_AT_ONCE = 2**22  # steps × elements, after which a run that is watched looks up
ENDS = (StopReason.REST, StopReason.DIVERGED)  # of a run


@dataclass(frozen=True)
class EventRecord:
    """An event of a run: its name, when (s), and the names of the elements whose quantity fell below 0 and rose."""

    event: str
    time: float
    fallen: tuple[str, ...]
    risen: tuple[str, ...]


class Simulation:
    """Advances one model and keeps its derived columns, its energy account and its last good state.

    reason: why the last advance ended; message: the same as a sentence, or "".
    note: what a person should know though the run goes on, or "".
    impacts: the impacts so far. compute_seconds: time spent in steps so far.
    armed: all edits are accounted for, and the step size fits the document. armed_revision: the revision
    of the model when edits were last accounted for.
    programs: the step programs of the model. step_size: the length of steps and what limits it.
    before_steps: functions called before steps are taken; each returns the number of steps until its next call.
    """

    def __init__(self, model: Model, schedule: Schedule, scene: str = "simulation") -> None:
        self.model = model
        self.schedule = schedule
        self.reason = StopReason.DONE
        self.message = ""
        self.note = ""
        self.compute_seconds = 0.0
        self.before_steps: list[Callable[[], int]] = []
        self._events: list[EventRecord] = []  # also those that undo took back, until time passes again
        self.impacts = Impacts(model)
        self.programs = Programs(model, schedule, self.impacts, scene)
        self._sleep = Sleep(model)
        self.step_size = StepSize(model, self.programs, self._sleep)
        taking = model, self.programs, self._sleep, self.step_size
        self._steps, self._driven_steps = ProgramSteps(*taking), DrivenSteps(*taking, self.impacts)
        self._account = Account(model, self._measured)
        self._recovery = Recovery(model, self.programs, self._sleep, self.step_size)
        self._announces = True
        # that a frame left, at this revision
        self._parting: tuple[int, Generator[None, None, str]] | None = None
        self._present = Latest[Snapshot]()  # the state, by revision
        self.armed = False
        self.armed_revision = -1
        model.before_change = self.before_change
        observed = tuple(f"{table}.{name}" for table, names in OBSERVED.items() for name in names)
        model.derive(Derivation(observed, self._sources(), lambda world: self.observe()))
        self.forget()  # a saved run goes on with the step size it had

    def __repr__(self) -> str:
        clock = self.model.clock
        return f"<Simulation of {self.model!r}: t = {float(clock.time):.6g} s after {clock.steps} steps>"

    def _sources(self) -> tuple[str, ...]:
        """The columns that the derived ones follow from."""
        tables = ["clock", "particles", "rods", "loads", "span_loads", "environment", "settings"]
        tables += [kind.table for kind in EXTENSIONS.kinds.values() if kind.table in self.model.tables]
        return tuple(
            f"{name}.{field.name}"
            for name in tables
            for field in self.model.tables[name].fields_in(Role.DOCUMENT, Role.STATE)
        )

    # --- what takes the steps ------------------------------------------------------------------------

    @property
    def plan(self) -> list[StepSystem]:
        """The step systems, integrators apart, that act in its scene and that the model needs, in order."""
        return self.programs.plan

    def planned(self, scene: str = "") -> Plan:
        """All systems that run in a scene (none given: its own) with its model, and why the others do not."""
        with self.programs.in_scene(scene or self.programs.scene):
            return self.programs.planned()

    def act_in(self, scene: str) -> None:
        """Let the systems of a scene act from now on. What they do otherwise counts as an edit."""
        if self.programs.differ_in(scene):
            self.before_change()  # the edit starts from the energy under the laws until now
        self.programs.scene = scene

    @property
    def integrator(self) -> Integrator:
        """The integrator that advances time, or exact flight."""
        return self.programs.integrator

    @property
    def program(self) -> Dynamics:
        """The program or flight that moves the model, bound to it as it is now."""
        return self.programs.dynamics

    @property
    def _stepper(self) -> Flight | ProgramSteps:
        """The stepper: exact flight, or the steps of a program, ended at impacts if any may come."""
        if isinstance(self.program, Flight):
            return self.program
        return self._driven_steps if self.programs.collides else self._steps

    # --- getting ready -------------------------------------------------------------------------------

    @property
    def _started(self) -> bool:
        return self.model.clock.step_size > 0.0

    def before_change(self) -> None:
        """Before anything is edited, note the energy that the edit starts from; the program is void."""
        if self.armed:
            self._account.begin_edit()
            self.armed = False
        self.stay()
        if self.model.clock.collision_state is not None:
            self.model.writable("clock.collision_state")[0] = None
        self.programs.void()
        self._sleep.forget()

    def _arm(self) -> None:
        """Get ready to run after edits: account for them, choose the step size, keep a safe state."""
        if not self.armed:
            problem = incomputable(self.model) or immovable(self.model)
            if not problem:
                parted = self._parted() if self.programs.collides else ""
                self.program.commit()  # rods that edits left beyond a strength yield
                self.note = joined(
                    [
                        self.programs.note,
                        parted,
                        idle_moment(self.model),
                        extensible_elsewhere(self.model),
                        idle_settlement(self.model, moving=True),
                    ]
                )
                self._account.close()
                self._sleep.review(self.program)
                self.step_size.begin(self.step_size.first())
            self.wake()
            if problem:
                self.reason, self.message = StopReason.DIVERGED, problem
            self.armed = True
            self.armed_revision = self.model.revision
            self._recovery.safe = None
        elif self._recovery.safe is None:
            self.step_size.look_up()
            if self.halted and not self._rests_still():
                self.wake()  # the file was changed by hand, or misses a mod
        if self._recovery.safe is None:
            self._recovery.safe = self._whole(self.present())
        self.programs.bind()

    def _parted(self) -> str:
        """Part what edits left in one place; returns a message, or "". Raises Unfinished, after which it can go on."""
        revision = self.model.newest(Role.DOCUMENT, Role.STATE)
        left, self._parting = self._parting, None
        if left is not None and left[0] == revision:
            parting = left[1]
        else:
            for module, work in zip((PARTING, self.program.module), work_ahead(self.model), strict=True):
                module.expect(work)
            parting = part_overlaps(self.model)
        try:
            while True:
                next(parting)
                if time.perf_counter() > Choice.deadline:
                    self._parting = revision, parting
                    raise Unfinished
        except StopIteration as end:
            return str(end.value)

    def account_for_edits(self) -> None:
        """If the run was edited, account for it now, so that its state is complete."""
        if self._started:
            self._arm()

    def wake(self) -> None:
        """Let the run go on although it was at rest or had diverged, since something acts on the model from outside."""
        if self.model.clock.at_rest:
            self.model.writable("clock.at_rest")[0] = False
        self.reason, self.message = StopReason.DONE, ""

    def _rests_still(self) -> bool:
        """True if what a state says of rest holds."""
        clock, measures = self.model.clock, self._measured()
        over = self.program.changes_end <= clock.time
        return over and may_rest(measures, clock.force_scale, clock.energy_scale)

    # --- going back ----------------------------------------------------------------------------------

    def forget(self) -> None:
        """Begin anew from a state that undo or a file put in place; all edits are accounted for in it."""
        self.programs.unbind()  # the plan may differ: persistent contacts are part of the state
        self._forget_run(self._started, None)

    def _forget_run(self, armed: bool, before_edit: Column | None) -> None:
        self.armed, self._account.before_edit = armed, before_edit
        self._sleep.forget()
        self._recovery.forget()
        self.reason, self.message = StopReason.DONE, ""
        if armed and self.model.clock.at_rest:
            self.reason, self.message = StopReason.REST, at_rest_since(self.moved_until)

    def start_anew(self) -> None:
        """Begin a new run with a state from before edits."""
        chosen = "step_size", "guard_energy", "largest_imbalance", "initial_energy", "potential_reference"
        for name in chosen:
            self.model.writable(f"clock.{name}")[0] = 0.0
        self.stay()
        self.forget()

    def present(self) -> Snapshot:
        """All of the state now; the same as before if nothing has changed."""
        return self._present.get(self.model.newest(Role.STATE), lambda: Snapshot.take(self.model))

    def checkpoint(self, *tables: str) -> Checkpoint:
        """A checkpoint of the present, with the state of these tables (none given: of all tables)."""
        return Checkpoint(
            Snapshot.take(self.model, *tables) if tables else self.present(),
            self.model.clock.time,
            self.armed,
            self._account.before_edit,
            self.step_size.stable,
            self.step_size.warning,
            self.programs.bindings,
        )

    def resume(self, checkpoint: Checkpoint) -> None:
        """Return to a checkpoint; the document must be the one that it was taken with."""
        checkpoint.state.restore(self.model)
        if not checkpoint.armed:
            self.stay()
        if checkpoint.binding != self.programs.bindings:
            self.programs.unbind()
        self._forget_run(checkpoint.armed, checkpoint.before_edit)
        if checkpoint.whole:  # else the stable step is determined anew
            self._recovery.safe = self._whole(checkpoint.state)
            self.step_size.stable, self.step_size.warning = checkpoint.stable_step, checkpoint.warning
        self.armed_revision = self.model.revision

    # --- running -------------------------------------------------------------------------------------

    @property
    def events(self) -> list[EventRecord]:
        """The events of this session's run so far, without those in time that was taken back."""
        return [event for event in self._events if event.time <= self.model.clock.time]

    @property
    def halted(self) -> bool:
        """True if the run ended by itself, at rest or diverged, and nothing was edited since."""
        return self.armed and self.reason in ENDS

    def advance(self, steps: int, until: float = math.inf) -> int:
        """Take up to `steps` whole steps, none of which ends after `until` (s); returns how many.

        Stops at rest and before garbage. A step that is under way is taken anew, as a whole.
        """
        if steps > 0 and not self.halted:
            self.rejoin()
        self._arm()
        started, clock = time.perf_counter(), self.model.clock
        first, done = clock.steps, 0
        if self._events and steps > 0:
            self._events = self.events
        while done < steps and not self.halted:
            complete = self._take(steps - done, until)
            done = clock.steps - first
            if not complete:
                break
        self.compute_seconds += time.perf_counter() - started
        return done

    def _take(self, steps: int, until: float) -> bool:
        """Take up to so many steps, up to the next that something waits for; False if the next would end too late."""
        ahead = min(steps, self._sleep.steps_to_review(self.program))
        for call in self.before_steps:
            ahead = min(ahead, call())
            self._arm()  # in case it edited the model
        if self.halted:
            return False
        taken, reason = self._stepper.advance(ahead, until)
        self._heed(reason)
        if reason not in FAILURES:  # else the state in which events happened was given up
            self._announce_events()
        self._arm()
        islands_due = self._sleep.is_due and not self.halted
        if islands_due and self._sleep.may_happen(self.program) and self._sleep.review(self.program):
            self.step_size.limit_anew()
        return taken >= max(ahead, 1) or reason is not StopReason.DONE

    def _heed(self, reason: StopReason) -> None:
        """React to the reason for which the stepper returned."""
        self.reason = StopReason.DONE if reason is StopReason.EVENT else reason
        if reason is StopReason.REST:
            self.model.writable("clock.at_rest")[0] = True
            self.message = at_rest_since(self.model.clock.time)
        elif reason is StopReason.REVIEW:
            self._review()
        elif self.reason is not StopReason.DONE:
            self._recover(reason)

    def _announce_events(self) -> None:
        """Call the handlers of the events that ended the step; handlers may edit the model."""
        if self.program.watches_events and self._announces:
            for event, *changed in self.program.take_events():
                elements: list[list[Any]] = changed  # that fell, and that rose
                names = (tuple(element.name for element in some) for some in elements)
                self._events.append(EventRecord(event.name, self.model.clock.time, *names))
                event.happen(self.model, *([e for e in some if e.exists] for some in elements))
                if event.mod is not None and event.mod.off:
                    self.before_change()  # it fails and acts no more, which counts as an edit

    def _review(self) -> None:
        """After a fixed number of steps: keep a safe state, see whether all stands still, adapt the step size."""
        clock, safe = self.model.clock, self._recovery.safe
        assert safe is not None
        since, before = float(safe.columns["clock.time"][0]), int(safe.columns["clock.steps"][0])
        moves = self._recovery.keep(self.present())
        if not moves and self.program.changes_end <= clock.time:
            energy = self.energy
            lost, damped = energy.imbalance, energy.dissipated_damping
            if rests_unseen(self.program.measures, lost, damped, clock.energy_scale):
                self._heed(StopReason.REST)  # all that happened was lost in rounding
                return
            if self.step_size.unstable:
                self.reason, self.message = StopReason.DIVERGED, self._recovery.give_up(SAME)
                return
            if not self.warning:
                self.note = tr(STUCK, steps=REVIEW_INTERVAL)
        self.step_size.review((clock.time - since) / max(clock.steps - before, 1))

    def _recover(self, reason: StopReason) -> None:
        """Return to the last good state and go on without a mod or with shorter steps, or give up."""
        unresolved = reason is not StopReason.DIVERGED
        if self._recovery.without_mod(reason):
            self.before_change()  # what is lost with the mod counts as an edit
        elif unresolved or not self._recovery.with_shorter_steps():
            why = marked("The simulation diverged near t = {time}: energy appeared from nowhere.")
            if unresolved:
                why = marked(
                    "The simulation diverged near t = {time}: no time step, however small, leads on from there."
                )
            self.reason, self.message = StopReason.DIVERGED, self._recovery.give_up(why)
            return
        self.reason = StopReason.DONE

    # --- moments within a step -----------------------------------------------------------------------

    def run_to(self, target: float, most_steps: int = sys.maxsize, *, whole: bool = False) -> int:
        """Let time pass up to exactly `target` (s), by at most so many steps; returns how many.

        The run is its whole steps. The moment of `target` within one is reached from the last whole step, which the run
        goes back to before it goes on; so what comes after does not depend on when anybody looked. whole: take whole
        steps alone. At rest time passes without any.
        """
        self._arm()
        clock, taken = self.model.clock, 0
        if clock.time < target:
            self.rejoin()
        while not self.halted and taken < most_steps and clock.time < target:
            if done := self.advance(min(most_steps - taken, REVIEW_INTERVAL), target):
                taken += done
            elif self.halted or whole or self.show(target):
                break
            else:  # an event ends the step before
                self._take(1, math.inf)
                taken += 1
        if self.reason is StopReason.REST and self.armed and clock.time < target:
            self._show_at_rest(target)
        return taken

    def run_until_rest(self, limit: float) -> bool:
        """Advance until at rest, at most to the time `limit` (s); True if it came to rest."""
        self._arm()
        clock = self.model.clock
        while not self.halted and clock.time < limit:
            if self.advance(REVIEW_INTERVAL, limit) == 0:
                self.run_to(limit)
                break
        if not self.halted:
            self.message = _why_not_at_rest(self.program, self.model.rods.count > 0, self.energy, limit)
        return self.reason is StopReason.REST

    def show(self, target: float) -> bool:
        """Show the moment `target` (s) within the next step; False if the step ends before, at an event, by failing, or
        since too many parts of it would lead there.
        """
        self.rejoin()
        started, before = time.perf_counter(), self.present()
        try:
            reason = self._stepper.land(target)
        except BaseException:  # interrupted, or a mod failed
            before.restore(self.model)
            raise
        happened = reason is StopReason.EVENT and (self.integrator.controlled or self.programs.collides)
        if happened or self.model.clock.time != target:
            before.restore(self.model)
            return False
        self._depart(before, begun=1)
        self.compute_seconds += time.perf_counter() - started
        return True

    def _show_at_rest(self, target: float) -> None:
        """Let time pass without steps."""
        before, clock = self.present(), self.model.clock
        self.model.writable("clock.time")[0] = target
        begin_steps(self.model, clock.step_size)
        self._depart(before, begun=0)

    def _depart(self, before: Snapshot, begun: int) -> None:
        """Note that the present moment was reached from this whole step, in so many steps that are under way."""
        steps = before.columns["clock.steps"][0] + begun
        for name in ("steps", "origin_steps"):
            self.model.writable(f"clock.{name}")[0] = steps
        self.model.writable("clock.departure")[0] = before

    def rejoin(self) -> None:
        """Go back to the whole step that the present moment was reached from, if it lies within the next."""
        departure = self.model.clock.departure
        if departure is not None:
            departure.restore(self.model)

    def _whole(self, state: Snapshot) -> Snapshot:
        """The present state, or that after the last whole step, if the present moment lies within the next."""
        departure = self.model.clock.departure
        return state if departure is None else departure

    def stay(self) -> None:
        """Let the run go on from the present moment, as something changes here: it ends the step that is under way."""
        if self.model.clock.departure is not None:
            self.model.writable("clock.departure")[0] = None

    @property
    def moment(self) -> tuple[int, float | None]:
        """Whole steps taken, and the time (s) of a moment within the next, by which `go_to` finds it again."""
        clock = self.model.clock
        return (clock.steps, None) if clock.departure is None else (clock.departure.steps, clock.time)

    def go_to(self, steps: int, within: float | None) -> None:
        """Let time pass to such a moment."""
        self.advance(max(steps - self.moment[0], 0))
        whole, now = self.moment
        if within is not None and whole == steps and now != within:  # also from another moment of the same step
            self.run_to(within)

    @contextmanager
    def watched(self) -> Iterator[None]:
        """Where a run inside the `with` is interrupted, it goes back to the last state that was kept.

        The present one may be in the midst of a step, or ahead of the clock.
        """
        model, kept, when = self.model, list[Checkpoint](), 0.0

        def look() -> int:
            nonlocal when
            if not kept or monotonic() - when > 0.5:  # s; as much an interrupt loses
                kept[:], when = [self.checkpoint()], monotonic()
            return max(WORK_AT_ONCE // (model.particles.count + model.rods.count + 1), 1)

        self.before_steps.append(look)
        try:
            yield
        except Exception:  # such as a mod's, which comes between two steps
            raise
        except BaseException:
            if kept:
                self.resume(kept[0])
            raise
        finally:
            self.before_steps.remove(look)

    def passed_since(self, then: Snapshot) -> bool:
        """True if the run has gone on since a state, by steps or within the one that is under way."""
        clock = self.model.clock
        within = clock.departure is not None and clock.time != then.columns["clock.time"][0]
        return bool(within or clock.steps != then.columns["clock.steps"][0])

    @contextmanager
    def aside(self, beginning: Snapshot) -> Iterator[None]:
        """A run inside the `with` starts from another state, and is taken back as if it had not been."""
        before, announces = self.checkpoint(), self._announces
        self._announces = False  # the events of this run were announced before
        said = self.reason, self.message, self.note, self.armed_revision
        self.resume(replace(before, state=beginning, armed=False, before_edit=None))
        try:
            self._arm()
            yield
        finally:
            self.resume(before)
            self._announces = announces
            self.reason, self.message, self.note, self.armed_revision = said

    # --- reading -------------------------------------------------------------------------------------

    def progress(self) -> tuple[float, int, int]:
        """The time (s) up to which everything has happened, steps and impacts; also in the midst of a step.

        It changes nothing, so that it can be asked at any moment.
        """
        clock, flying = self.model.clock, self.programs.flying
        if flying is None:
            return clock.time, clock.steps, clock.collisions
        return max(clock.time, flying.now), clock.steps, max(clock.collisions, flying.impacts)

    @property
    def warning(self) -> str:
        """What a person should know though the run goes on, or has come to rest; "" if nothing."""
        clock, warning = self.model.clock, "" if self.halted else self.step_size.warning
        told = "" if warning else energy_warning(clock.largest_imbalance, clock.energy_scale)
        if told:
            warning = joined([told, self.step_size.remedy(clock.step_size)])
        return joined([warning, *self._of_collisions(), self.note])

    def _of_collisions(self) -> list[str]:
        """What a person should know of impacts and contacts."""
        flying = self.programs.flying
        told = [contact_warning(*self._driven_steps.unclosed), reflection_warning(self.impacts.cut_short)]
        if flying is not None:
            told.append(overlap_warning(flying.deepest))
            if flying.created > 0.0:
                energy = self.energy
                told.append(energy_warning(-flying.created, max(abs(energy.initial), abs(energy.work))))
        return told

    @property
    def said(self) -> str:
        """Why the run ended, unless it was edited since, and what a person should know of it; "" if nothing."""
        message = self.message if self.armed else ""
        diverged = self.halted and self.reason is StopReason.DIVERGED
        return message if diverged else joined([message, self.warning])

    def observe(self) -> Dynamics:
        """Bring axial forces, lengths, reactions and energies up to date with the state; returns what knows them."""
        observer = self.programs.observer
        observer.observe()
        return observer

    def _measured(self) -> Column:
        """The measures of the present state."""
        return self.observe().measures

    @property
    def energy(self) -> Energy:
        """The energy account now."""
        return self._account.energy(edited=not self.armed)

    @property
    def moved_until(self) -> float:
        """The time (s) up to which steps were taken; at rest, time may pass without any."""
        clock, departure = self.model.clock, self.model.clock.departure
        if departure is None or not clock.at_rest:
            return clock.time
        return float(departure.columns["clock.time"][0])

    @property
    def residual(self) -> float:
        """Largest unbalanced force on a free particle over the largest force of all, dampers apart."""
        measures = self._measured()
        unbalanced, largest = measures[[Measure.RESIDUAL, Measure.LARGEST_FORCE]].tolist()
        return unbalanced / largest if largest > 0.0 else 0.0


def _why_not_at_rest(program: Dynamics, has_rods: bool, energy: Energy, limit: float) -> str:
    """The message of a run that did not come to rest by the time `limit` (s)."""
    if program.lasting:
        reason = tr(
            "{system} changes with time, so the model never comes to rest; run to a time instead.",
            system=program.lasting,
        )
    elif not program.resists_motion:
        reason = (
            tr(
                "Nothing damps the motion, so the model never comes to rest; give the rods damping or set a drag."
            )
            if has_rods
            else tr("Nothing damps the motion, so the model never comes to rest; set a drag.")
        )
    elif program.changes_end > limit:
        reason = tr("A load is still changing at that time; raise the limit.")
    elif energy.imbalance > energy.dissipated_damping:
        reason = tr(
            "Errors of the time steps, not dampers or drag, took most of the motion; make the time step smaller."
        )
    else:
        reason = (
            tr("Raise the limit, or the damping of the rods or the drag.")
            if has_rods
            else tr("Raise the limit, or the drag.")
        )
    return joined([tr("Not at rest within {limit:g} s of simulated time.", limit=limit), reason])
