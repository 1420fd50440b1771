"""Step programs: laws, commits and an integrator, compiled into one and bound to the columns of a model."""

from __future__ import annotations

import math
import time
import weakref
from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import Column, Role
from pinjoint.components.handle import Handle
from pinjoint.components.language import marked
from pinjoint.components.load import load_breaks, loads_end
from pinjoint.components.model import Model
from pinjoint.systems.base import Event, Integrator, StepSystem, StopReason
from pinjoint.systems.collision.driven.columns import Phase, Real, Whole
from pinjoint.systems.entries import ACCOUNT, ACCOUNTS, CONTROL, Mark, Measure, Search, Side
from pinjoint.systems.physics.bending import levers
from pinjoint.systems.physics.kernels import conserved
from pinjoint.systems.program.binding import Bound, ProgramError, bind, find
from pinjoint.systems.program.block_writer import BlockWriter
from pinjoint.systems.program.compiler import Between, GeneratedModule, generated
from pinjoint.systems.program.controlled_writer import ControlledWriter
from pinjoint.systems.program.faults import check_plain_forms, explain
from pinjoint.systems.program.near_pairs import NearPairs
from pinjoint.systems.program.writer import VERY_MANY, Writer, sides_of

_ORIGIN = ("origin", "step_limit")
_COUNTS = ("steps", "origin_steps")
MOTION = "particles.displacement", "particles.velocity"
TURNING = "particles.rotation", "particles.angular_velocity"  # what moves, too, in models that bend
OBSERVED = {
    "particles": ("applied_force", "reaction", "applied_moment", "reaction_moment"),
    "rods": ("axial_force", "length", "strain", "yielding", "end_moment"),
}
_OF_BENDING = "particles.applied_moment", "particles.reaction_moment", "rods.end_moment"
_GIVEN = {
    "fixed": "particles.fixed",
    "clamped": "particles.fixed_rotation",
    "tension": "rods.tension_limit",
    "compression": "rods.compression_limit",
}
COLUMNS_OBSERVED = {  # by the parameter of observe() that they are
    **{f"rods_{name}": f"rods.{name}" for name in ("axial_force", "length", "strain")},
    "applied": "particles.applied_force",
    "reaction": "particles.reaction",
    "applied_moment": "particles.applied_moment",
    "reaction_moment": "particles.reaction_moment",
    "rods_end_moment": "rods.end_moment",
    "yielding": "rods.yielding",
    **_GIVEN,
}
_TANGENTS = 8  # rows of rod_work in models that bend: see templates/turning.py
_REASONS = tuple(StopReason)


def _writer(model: Model, systems: Sequence[StepSystem], integrator: Integrator, form: str) -> Writer:
    joining = [system for system in systems if system.kernel or system.impulsive]
    plain = BlockWriter if form == VERY_MANY else Writer
    return (ControlledWriter if integrator.controlled else plain)(model, joining, integrator, form)


def module_of(
    model: Model, systems: Sequence[StepSystem], integrator: Integrator, form: str
) -> GeneratedModule:
    """The module of the program of a plan, in that form, which is only written."""
    return _module(_writer(model, systems, integrator, form), _between(systems))


def _module(writer: Writer, between: Between | None) -> GeneratedModule:
    needs = (between.module,) if between is not None else ()
    return generated(marked("the step program"), writer.source(), writer.names, needs)


def _between(systems: Iterable[StepSystem]) -> Between | None:
    """What acts between the steps of a program of these systems."""
    found: list[Any] = [find(system.between, system) for system in systems if system.between]
    return found[0] if found else None


class Program:
    """A step program, bound to the columns of one model.

    source: the whole program as plain Python; to understand a step, read that of a small model first.
    measures: entries of Measure, of the state last observed.
    follows_state: forces follow from nothing but the state, loads and contacts apart, so that what is at rest stays so.
    failure: what a kernel raised in a step, and which, if one did.
    impulsive: the systems without a kernel that act by impacts. between: what acts between its steps.
    module: its functions. tolerance: of each step; 0 where the error is not controlled.
    compile_seconds: time that writing it took, and compiling it, or loading it from the cache, if that was done at once.
    """

    def __init__(self, model: Model, systems: Sequence[StepSystem], integrator: Integrator, form: str) -> None:
        started = time.perf_counter()
        self.model = model
        self.systems = tuple(system for system in systems if system.kernel)
        self.impulsive = tuple(system for system in systems if system.impulsive and not system.kernel)
        self.integrator = integrator
        self._writer = _writer(model, systems, integrator, form)
        self.between = _between(systems)
        self.module = _module(self._writer, self.between)
        self.measures = np.zeros(len(Measure))
        self.follows_state = not self._writer.working and all(b.follows_state for b in self._writer.bound)
        self.failure: ProgramError | None = None
        self._state_revision = -1
        written = [path for b in self._writer.commits for path in b.system.writes]
        self._changes = _by_table_and_role(model, (*self.motion, *written))
        self.bind()
        present = weakref.ref(self)  # the module lives longer
        self.module.warm_up = lambda: program._call_all() if (program := present()) is not None else None
        check_plain_forms(self._writer.kernels)
        self.module.begin(self._rows("rods"))
        if not self.module.is_loaded:
            self._call_all()
        self.compile_seconds = time.perf_counter() - started

    def load(self) -> None:
        """Go on with machine code from now on: compiled first if nobody has."""
        self.module.load()

    def _call_all(self) -> None:
        """Call every function once, which makes numba compile it, or load it from the cache, if it is to be compiled."""
        try:
            self._take(0, math.inf, math.inf)
            self._observe()
            if self._writer.commits:  # with no rods: a commit changes history
                state = [self._arrays[name][:0] for name in self._writer.state]
                self.module.form.commit(0.0, 0.0, *state, np.zeros(len(ACCOUNT)), *self._of_no_rods())
        except Exception as error:  # numba raises many kinds
            raise self._explained(error) from error

    def _explained(self, error: Exception) -> ProgramError:
        """What an error means, and which system it comes from."""
        compiled = self.module.is_loaded
        return explain(self._writer.kernels, self.integrator, self.model, error, compiled=compiled)

    def _of_no_rods(self) -> list[Column]:
        whole = {"pair_reach": np.array([0.0, math.inf])}  # of no pairs there is no list
        return [whole.get(name, column[:0]) for name, column in self.columns.items()]

    @property
    def columns(self) -> dict[str, Column]:
        """The columns and arrays that its compiled functions end with, by name, in order."""
        return dict(zip(self._writer.columns, self._columns, strict=True))

    @property
    def source(self) -> str:
        """The Python that it is compiled from."""
        return self._writer.source()

    @property
    def form(self) -> str:
        """FEW, MANY or VERY_MANY: see writer.py."""
        return self._writer.form

    @property
    def resists_motion(self) -> bool:
        """True if something depends on velocity: dampers or drag."""
        return self._writer.rates

    @property
    def lasting(self) -> str:
        """The name of a system that changes with time, whether anything moves or not; "" if there is none."""
        return next((b.system.name for b in self._writer.bound if b.follows_time), "")

    def bind(self) -> None:
        """Take hold of the model's columns; needed after every change of its document."""
        model = self.model
        extra: dict[str, Any] = {}
        for system in self.systems:
            if type(system).arrays is not StepSystem.arrays:
                extra.update(bind(system, model).stored_arrays)
        written = {w.replace(".", "_", 1): w for b in self._writer.commits for w in b.system.writes}
        extra |= {name: self._storage(path) for name, path in written.items()}
        self._near = NearPairs(model, [b.cutoff for b in self._writer.pairs]) if self._writer.pairs else None
        extra |= self._near.arrays if self._near is not None else {}
        if self.between is not None:
            self._support = np.ascontiguousarray(self.between.support(model)[self._held_rows])
            extra |= {"support": self._support, "unpushed": np.zeros_like(self._support)}
        if self._writer.bends:
            self._stop_turning()
            turning = self._column("particles.turning")
            extra |= {
                "lever": np.ascontiguousarray(levers(self.model)[self._held_rows]),
                "particles_turning": turning.reshape(-1, 1),
            }
        self._sides = [(b, self._sides_of(b)) for b in self._writer.events]
        extra |= {sides_of(b): sides for b, sides in self._sides}
        self._columns = [
            extra[name] if name in extra else self._column(name.replace("_", ".", 1))
            for name in self._writer.columns
        ]
        self._bind_clock()
        self.changes_end = math.inf if self.lasting else loads_end(model)
        self._breaks = np.array([*load_breaks(model), math.inf])
        self._arrays = {name: np.zeros(shape) for name, shape in self.scratch.items()}
        self._arrays |= {path.partition(".")[2]: self._storage(path) for path in MOTION}
        if self._writer.bends:
            self._arrays |= {path.partition(".")[2]: self._storage(path).reshape(-1, 1) for path in TURNING}
            self._arrays["search"][Search.REACH] = self.model.rods.rest_length.max()
        self._arrays |= {"control": self._control, "account": self._account, "measures": self.measures}
        self._bind_arguments()
        self._bind_observed()
        settings = model.settings
        controls = self.integrator.estimates_error and settings.time_step is None
        self.tolerance = settings.tolerance if controls else 0.0
        self._state_revision = -1

    # --- events ------------------------------------------------------------------------------------

    @property
    def watches_events(self) -> bool:
        """True if it stops where the quantity of an Event changes sign."""
        return bool(self._writer.events)

    def _sides_of(self, b: Bound) -> NDArray[np.uint8]:
        """Of each row of an event, whether its quantity is negative, as the state has it."""
        table, noted = self.model.tables[b.each], self.model.clock.events or {}
        sides = np.zeros(table.count, dtype=np.uint8)
        for name in noted.get(b.system.name, ()):
            if name in table:
                sides[table[name].row] = Side.NEGATIVE
        return sides

    def take_events(self) -> list[tuple[Event, list[Handle], list[Handle]]]:
        """The events since the last call, in order, with the elements that fell and that rose; the state notes them."""
        found, noted = [], dict(self.model.clock.events or {})  # those of other scenes stay
        for b, sides in self._sides:
            assert isinstance(b.system, Event)
            elements = self.model.tables[b.each].handles
            fell, rose = (np.flatnonzero(sides == side).tolist() for side in (Side.FELL, Side.ROSE))
            if fell or rose:
                found.append((b.system, [elements[row] for row in fell], [elements[row] for row in rose]))
            sides[fell], sides[rose] = Side.NEGATIVE, Side.POSITIVE
            negative = np.flatnonzero(sides == Side.NEGATIVE).tolist()
            noted[b.system.name] = tuple(elements[row].name for row in negative)
        if found:
            self.model.writable("clock.events")[0] = noted
        return found

    @property
    def motion(self) -> tuple[str, ...]:
        """The columns of the state that steps change, history apart."""
        return (*MOTION, *TURNING) if self._writer.bends else MOTION

    @property
    def unbalanced(self) -> Column:
        """The sum of all forces on each particle but those of dampers and drag (kN), as last observed."""
        return self._unbalanced

    @property
    def unbalanced_moment(self) -> Column:
        """The same of moments on each particle (kN·m), shape (n,); none where nothing bends."""
        moment: Column = self._unbalanced_moment[:, 0]
        return moment

    def _rows(self, table: str) -> int:
        """Number of elements of a table that the program holds."""
        return self.model.tables[table].count

    def _column(self, path: str) -> Any:
        """A column, "table.field", to read."""
        return self.model.column(path)

    def _storage(self, path: str) -> Column:
        """A column, "table.field", to write to; after doing so, _mark_changes()."""
        table, _, name = path.partition(".")
        return self.model.tables[table].storage(name)

    def _bind_clock(self) -> None:
        clock = self.model.tables["clock"]
        self._account, self._control = clock.together(ACCOUNT), clock.together(CONTROL)
        self._origin = clock.together(_ORIGIN)
        self._counts = clock.together(_COUNTS)

    @property
    def scratch(self) -> dict[str, tuple[int, ...]]:
        """Shapes of the arrays that its functions write to and nobody reads afterwards, by name."""
        particles, rods = self._rows("particles"), self._rows("rods")
        turns = self._writer.bends
        return {
            **dict.fromkeys(("force", "resisting", "predicted"), (particles, 2)),
            "direction": (rods, 3 if turns else 2),
            **dict.fromkeys(("moment", "twisting", "predicted_spin"), (particles if turns else 0, 1)),
            "turns": (self.integrator.particle_rows if turns else 0, particles, 1),
            **dict.fromkeys(("power", "gained", "stage_power"), (len(ACCOUNTS),)),
            "work": (self.integrator.particle_rows, particles, 2),
            "rod_work": (_TANGENTS if turns and self.integrator.rod_rows else self.integrator.rod_rows, rods),
            "marks": (
                max(rods, particles),
                len(Mark) * len([*self._writer.branching, *self._writer.events]),
            ),
            "search": (len(Search),),
        }

    def _after(self, first: str, entry: str, **given: Any) -> tuple[Any, ...]:
        """The arguments of a compiled function, bound by name, between its parameter `first` and the columns."""
        known = self._arrays | given
        code = self.module.functions[entry].py_func.__code__
        names = code.co_varnames[: code.co_argcount]
        return tuple(known[name] for name in names[names.index(first) + 1 : -len(self._columns)])

    def _bind_arguments(self) -> None:
        if self.between is None:
            self._arguments = (*self._after("loads_end", "advance"), *self._columns)
            return
        kept = {
            "force": self._arrays["force"],
            "resisting": self._arrays["force"],
            "power": self._arrays["power"],
        }
        known = self._arrays | self.columns
        kept |= {name: known[name] for name in self._writer.kept}
        copies: dict[str, Any] = {f"kept_{name}": np.zeros_like(array) for name, array in kept.items()}
        copies |= {f"own_{name}": np.zeros_like(kept["force"]) for name in ("acceleration", "support")}
        copies["every"] = np.arange(self._rows("particles"))
        self._arguments = (*self._after("loads_end", "drive", **copies), *self._columns)

    def _bind_observed(self) -> None:
        for path in _GIVEN.values():
            self.model.column(path)  # brings it up to date
        storage = {name: self._storage(path) for name, path in COLUMNS_OBSERVED.items()}
        storage["applied_moment"] = storage["applied_moment"].reshape(-1, 1)
        if not self._writer.bends:
            self._forget_moments()
        names = ("force", "resisting", "direction", "power", "moment", "twisting")
        apart = {name: np.zeros_like(self._arrays[name]) for name in names}
        self._unbalanced, self._unbalanced_moment = apart["force"], apart["moment"]
        yields = self.model.settings.plasticity
        self._observed = self._after("dt", "observe", yields=yields, **storage, **apart)

    def _stop_turning(self) -> None:
        """A particle that has no rigid ends any more has no rotation that could go on."""
        particles = self.model.particles
        stray = (particles.turning == 0.0) & (particles.angular_velocity != 0.0)
        if stray.any():
            self.model.writable("particles.angular_velocity")[stray] = 0.0

    def _forget_moments(self) -> None:
        """Nothing bends: no moments are left of when something did."""
        for path in _OF_BENDING:
            table, _, name = path.partition(".")
            if self.model.tables[table].storage(name).any():
                self.model.writable(path)[...] = 0.0

    def advance(self, steps: int, until: float = math.inf, landing: float = math.inf) -> tuple[int, StopReason]:
        """Take up to `steps` steps; returns how many, and why it stopped.

        An integrator that controls its steps takes none that would end after `until` (s), and one that would
        pass `landing` (s) is cut to end there; for others the steps are clock.step_size long.
        """
        try:
            return self._advance(steps, until, landing)
        except ProgramError:
            raise
        except Exception as error:
            if all(b.is_ours for b in self._writer.kernels):
                raise
            return self._failed(error)

    def _failed(self, error: Exception) -> tuple[int, StopReason]:
        """End a step in which a kernel raised an error as one that led nowhere, so that its mod is looked for."""
        self.failure = self.failure or self._explained(error)
        self._arrays["displacement"][...] = math.nan
        self._mark_changes()
        return 0, StopReason.DIVERGED

    def _advance(self, steps: int, until: float, landing: float) -> tuple[int, StopReason]:
        if self.module.is_loaded:
            return self._take(steps, until, landing)
        total = 0
        while True:  # portions: machine code may follow
            some = min(steps - total, self.module.portion)
            taken, reason = self._take(some, until, landing)
            self.module.did(taken)
            total += taken
            if taken < some or total == steps or reason is not StopReason.DONE:
                return total, reason

    def _take(self, steps: int, until: float, landing: float) -> tuple[int, StopReason]:
        """Take up to `steps` steps, in one call."""
        self._catch_up()
        controlled, (time, size) = self.integrator.controlled, self._control[:2].tolist()
        if until < math.inf and not controlled:
            steps = min(steps, max(int((until - time) / size * (1.0 + 1e-12)), 0))
            if steps == 0:
                return 0, StopReason.DONE
        if self.between is not None:
            real = self._idle[0].real
            real[Real.UNTIL], real[Real.END] = until, landing
            return self._enter(self._idle, steps, alone=True)
        origin, limit = self._origin.tolist()
        total, since = self._counts.tolist()
        chosen = (self.tolerance, limit or math.inf) if controlled else (size,)
        bounds = (float(until), float(landing)) if controlled else ()
        taken, reason = self.module.form.advance(
            steps,
            self._is_fresh,
            total,
            total - since,
            origin,
            *chosen,
            self._breaks,
            *bounds,
            self.changes_end,
            *self._arguments,
        )
        if taken and not controlled:
            self._control[0] = origin + (total - since + taken) * size
        now = self._control.item(0)
        if taken or now > time:
            self._counts[0] = total + taken
            if controlled and (self.tolerance or now == landing):
                self._origin[0], self._counts[1] = now, total + taken
            self._mark_changes()
        self._state_revision = self.model.newest(Role.STATE)
        return taken, _REASONS[reason]

    # --- among particles that may meet -----------------------------------------------------------------

    def drive(self, arrays: Any, steps: int, until: float) -> tuple[StopReason, bool]:
        """Take up to so many steps that end by `until` (s) as the arrays of what is in between say; returns why it stopped,
        and whether they are done: Whole.NEED may say what is needed before it goes on.
        """
        driven = arrays[0]
        wanted = steps if self.module.is_loaded else min(steps, self.module.portion)
        if driven.whole[Whole.PHASE] == Phase.BETWEEN:
            self._catch_up()
        driven.real[Real.UNTIL] = until
        driven.real[Real.PUSH] = self.integrator.push if self.integrator.mod is None else 0.0
        try:
            taken, reason = self._enter(arrays, wanted, alone=False)
        except ProgramError:
            raise
        except Exception as error:
            if all(b.is_ours for b in self._writer.kernels):
                raise
            return self._failed(error)[1], True
        if not self.module.is_loaded:
            self.module.did(taken)
        waits = driven.whole[Whole.NEED] != 0
        return reason, not waits and (taken < wanted or wanted == steps or reason is not StopReason.DONE)

    def _enter(self, arrays: Any, steps: int, *, alone: bool) -> tuple[int, StopReason]:
        """Enter the program with these arrays; returns how many steps it took, and why it stopped."""
        form, driven = self.module.form, arrays[0]
        assert self.between is not None
        whole, (total, since) = driven.whole, self._counts.tolist()
        origin, limit = self._origin.tolist()
        limit = limit or math.inf
        whole[Whole.ALONE], whole[Whole.WANTED] = alone, steps
        whole[Whole.TOTAL] = whole[Whole.FIRST] = total
        whole[Whole.SINCE], whole[Whole.FRESH], whole[Whole.NEED] = since, self._is_fresh, 0
        if whole[Whole.PHASE] == Phase.BETWEEN:  # else the step that is under way may have ended for a reason
            whole[Whole.REASON] = StopReason.DONE
        driven.real[Real.ORIGIN] = origin
        form.drive(
            *self.between.functions(compiled=form.is_machine),
            *arrays,
            *self._motion,
            *((self.tolerance, limit) if self.integrator.controlled else ()),
            self._breaks,
            self.changes_end,
            *self._arguments,
        )
        self._counts[:] = whole[Whole.TOTAL], whole[Whole.SINCE]
        self._origin[0] = driven.real[Real.ORIGIN]
        self._mark_changes()
        self._state_revision = self.model.newest(Role.STATE) if whole[Whole.FRESH] else -1
        return int(whole[Whole.TOTAL]) - total, _REASONS[whole[Whole.REASON]]

    @cached_property
    def _idle(self) -> Any:
        """Arrays with which steps are taken as if nothing could meet."""
        assert self.between is not None
        return self.between.idle()

    @property
    def _held_rows(self) -> Any:
        """The model's row of each particle that it holds."""
        return slice(None)

    @property
    def _motion(self) -> tuple[Column, Column, Column]:
        """The model's row of each particle, of none if they are the same, and the model's displacements and velocities."""
        return np.zeros(0, dtype=np.int64), self._arrays["displacement"], self._arrays["velocity"]

    def _catch_up(self) -> None:
        """Before steps, bring the sides of events and the list of near pairs up to the present state."""
        if self._sides and not self._is_fresh:
            for b, sides in self._sides:
                sides[:] = self._sides_of(b)
        if self._near is not None:
            self._renew(self._near)

    def _renew(self, near: NearPairs) -> None:
        """Have the list of near pairs made anew in another state, and room for all of them."""
        if near.outgrown:
            near.grow()
            place = self._writer.columns.index("pair_other")
            self._columns[place] = near.arrays["pair_other"]
            self._bind_arguments()
        elif not self._is_fresh and near.is_far:
            near.begin()

    @property
    def _is_fresh(self) -> bool:
        """True if the forces are still those of the present state."""
        return self._state_revision == self.model.newest(Role.STATE)

    def _mark_changes(self) -> None:
        for table, names, role in self._changes:
            self.model.tables[table].mark(names, role)

    def commit(self) -> None:
        """Bring history up to date in a state that no step has led to, outside the energy account."""
        if self._writer.commits:
            time = float(self._control[0])
            outside = self._after("dt", "commit", account=np.zeros(len(ACCOUNT)))
            self.module.form.commit(time, 0.0, *outside, *self._columns)
            self._mark_changes()

    def observe(self) -> None:
        """Bring the derived columns of rods and particles, and the measures, up to date, unless a kernel fails."""
        try:
            self._observe()
        except ProgramError:
            raise
        except Exception as error:  # the next step fails, too, and then the mod that did it is looked for
            if all(b.is_ours for b in self._writer.kernels):
                raise
            self.failure = self._explained(error)

    def _observe(self) -> None:
        if self.between is not None and not self._is_fresh:  # the state was put back, or changed
            self._support[:] = self.between.support(self.model)[self._held_rows]
        time, size = self._control[:2].tolist()
        self.module.form.observe(time, size, *self._observed, *self._columns)
        for table, names in OBSERVED.items():
            self.model.tables[table].mark(names, Role.DERIVED)

    def conserved_energy(self) -> float:
        """The energy that the integrator conserves, less the work done so far (J), in the state last observed."""
        guard = float(self.integrator.guard)
        return float(conserved(self.measures, self._account, float(self._control[1]), guard))


def _by_table_and_role(model: Model, written: Iterable[str]) -> list[tuple[str, list[str], Role]]:
    """Table, arrays and role of the columns that steps change, those of commits included."""
    paths = [f"clock.{name}" for name in (*CONTROL, *_ORIGIN, *_COUNTS, *ACCOUNT)]
    paths += written
    found: dict[tuple[str, Role], list[str]] = {}
    for path in dict.fromkeys(paths):
        table, _, name = path.partition(".")
        found.setdefault((table, model.tables[table].fields[name].role), []).append(name)
    return [(table, model.tables[table].arrays_of(names), role) for (table, role), names in found.items()]
