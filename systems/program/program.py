"""Step programs: laws, commits and an integrator, compiled into one and bound to the columns of a model."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import Column, Role
from pinjoint.components.handle import Handle
from pinjoint.components.language import marked
from pinjoint.components.load import load_breaks, loads_end
from pinjoint.components.model import Model
from pinjoint.systems.base import Event, Integrator, StepSystem, StopReason
from pinjoint.systems.collision.columns import Grid
from pinjoint.systems.collision.driven.columns import Phase, Real, Whole
from pinjoint.systems.collision.driven.neighbours import DRIVEN, between_steps, idle, lasting_forces
from pinjoint.systems.physics.bending import arm_of, levers
from pinjoint.systems.physics.kernels import conserved
from pinjoint.systems.program.binding import Bound, ProgramError, StepRole, bind
from pinjoint.systems.program.block_writer import BlockWriter
from pinjoint.systems.program.compiler import GeneratedModule, generated
from pinjoint.systems.program.controlled_writer import ControlledWriter
from pinjoint.systems.program.entries import ACCOUNT, ACCOUNTS, CONTROL, Mark, Measure, Search, Side
from pinjoint.systems.program.faults import check_plain_forms, explain
from pinjoint.systems.program.near_pairs import NearPairs
from pinjoint.systems.program.writer import PUSHED, STATE, VERY_MANY, Writer

_ORIGIN = ("origin", "step_limit")
_COUNTS = ("steps", "origin_steps")
MOTION = "particles.displacement", "particles.velocity"
TURNING = "particles.rotation", "particles.angular_velocity"  # what moves, too, in models that bend
OBSERVED = {
    "particles": ("applied_force", "reaction", "applied_moment", "reaction_moment"),
    "rods": ("axial_force", "length", "strain", "yielding", "end_moment"),
}
_GIVEN = {"fixed": "particles.fixed", "tension": "rods.tension_limit", "compression": "rods.compression_limit"}
_ACTING = (
    ("particles.applied_force", "particles.applied_moment"),
    ("particles.reaction", "particles.reaction_moment"),
)
_COLUMNS_OBSERVED = {  # by the parameter of observe() that they are
    **{f"rods_{name}": f"rods.{name}" for name in ("axial_force", "length", "strain")},
    "applied": "particles.applied_force",
    "reaction": "particles.reaction",
    "rods_end_moment": "rods.end_moment",
    "yielding": "rods.yielding",
    **_GIVEN,
}
_TANGENTS = 8  # rows of rod_work in models that bend: see rods.tangent_of_ends in templates
_REASONS = tuple(StopReason)


def _writer(model: Model, systems: Sequence[StepSystem], integrator: Integrator, form: str) -> Writer:
    joining = [system for system in systems if system.kernel or system.impulsive]
    plain = BlockWriter if form == VERY_MANY else Writer
    return (ControlledWriter if integrator.controlled else plain)(model, joining, integrator, form)


def module_of(
    model: Model, systems: Sequence[StepSystem], integrator: Integrator, form: str
) -> GeneratedModule:
    """The module of the program of a plan, in that form, which is only written."""
    return _module(_writer(model, systems, integrator, form))


def _module(writer: Writer) -> GeneratedModule:
    needs = (DRIVEN,) if writer.collides else ()
    return generated(marked("the step program"), writer.source(), writer.names, needs)


class Coordinates(NamedTuple):
    """An array of coordinates, shape (n, 3), and the columns that its numbers belong to.

    What moves is as it is; what turns is multiplied by `scale`, a power of two, so that no bits are lost.
    """

    whole: Column
    moves: Column
    turns: Column
    scale: float

    def load(self) -> None:
        """Take the numbers from the columns."""
        self.whole[:, :2] = self.moves
        np.multiply(self.turns, self.scale, out=self.whole[:, 2])

    def store(self) -> None:
        """Bring the columns up to date."""
        self.moves[...] = self.whole[:, :2]
        np.divide(self.whole[:, 2], self.scale, out=self.turns)


class Program:
    """A step program, bound to the columns of one model.

    source: the whole program as plain Python; to understand a step, read that of a small model first.
    measures: entries of Measure, of the state last observed.
    form: FEW, MANY or VERY_MANY: see writer.py. columns: what its functions end with, by name, in order.
    follows_state: forces follow from nothing but the state, loads and contacts apart, so that what is at rest stays so.
    lasting: the name of a system that changes with time, whether anything moves or not; "" if there is none.
    resists_motion: something depends on velocity: dampers or drag. watches_events: it stops where the quantity of an Event
    changes sign.
    failure: what a kernel raised in a step, and which, if one did.
    plan: the step systems that it was asked for.
    module: its functions. tolerance: of each step; 0 where the error is not controlled.
    """

    def __init__(self, model: Model, systems: Sequence[StepSystem], integrator: Integrator, form: str) -> None:
        self.model = model
        self.plan = tuple(systems)
        self.integrator = integrator
        self.form = form
        self._writer = _writer(model, systems, integrator, form)
        self.module = _module(self._writer)
        self.measures = np.zeros(len(Measure))
        self.follows_state = not self._writer.working and all(b.follows_state for b in self._writer.bound)
        self.lasting = next((b.system.name for b in self._writer.bound if b.follows_time), "")
        self.resists_motion = self._writer.rates
        self.watches_events = bool(self._writer.events)
        self.failure: ProgramError | None = None
        self._state_revision = -1
        self._changes = _by_table_and_role(model, (*self.motion, *self._writer.written.values()))
        self.bind()
        users = self.module.users
        users.add(self)
        self.module.warm_up = lambda: [program._call_all() for program in [*users][:1]]
        check_plain_forms(self._writer.kernels)
        self.module.begin(self._rows("rods"))
        if not self.module.is_loaded:
            self._call_all()

    def _call_all(self) -> None:
        """Call every function once, which makes numba compile it, or load it from the cache, if it is to be compiled."""
        try:
            self._take(0, math.inf, math.inf)
            self._observe()
            if self._writer.commits:  # with no rods: a commit changes history
                state = [self._arrays[name][:0] for name in STATE]
                self.module.form.commit(0.0, 0.0, *state, np.zeros(len(ACCOUNT)), *self._of_no_rods())
        except Exception as error:  # numba raises many kinds
            raise self._explained(error) from error

    def _explained(self, error: Exception) -> ProgramError:
        """What an error means, and which system it comes from."""
        compiled = self.module.is_loaded
        return explain(self._writer.kernels, self.integrator, self.model, error, compiled=compiled)

    def _of_no_rods(self) -> list[Column]:
        whole: dict[str, Any] = {
            "pair_reach": np.array([0.0, math.inf]),
            "pair_count": np.zeros(1, dtype=np.int64),
            "pair_grid": Grid.empty(0, 1),
            **{name: np.zeros(2, dtype=np.int64) for name in self._writer.columns if name.startswith("block_")},
        }  # no list, no block
        return [whole.get(name, column[:0]) for name, column in self.columns.items()]

    @property
    def source(self) -> str:
        """The Python that it is compiled from."""
        return self._writer.source()

    def bind(self) -> None:
        """Take hold of the model's columns; needed after every change of its document."""
        model = self.model
        extra: dict[str, Any] = {}
        for b in self._writer.bound:
            if type(b.system).arrays is not StepSystem.arrays:
                extra.update(bind(b.system, model).stored_arrays)
        extra |= {name: self._storage(path) for name, path in self._writer.written.items()}
        extra |= self._arranged(extra)
        self._near = NearPairs(model, [b.cutoff for b in self._writer.pairs]) if self._writer.pairs else None
        extra |= self._near.arrays if self._near is not None else {}
        if self._writer.collides:
            shape = self._rows("particles"), self._writer.coordinates
            extra |= {name: np.zeros(shape) for name in PUSHED}
            self._support = extra["support"][:, :2]
            self._support[:] = lasting_forces(model)[self._held_rows]
        self._arm = arm_of(model) if self._writer.bends else 1.0
        self._strays = np.zeros(0, dtype=np.intp)
        if self._writer.bends:
            particles = model.particles
            self._strays = np.flatnonzero((particles.turning == 0.0) & (particles.angular_velocity != 0.0))
            extra |= self._of_bending(extra)
        self._sides = [(b, self._sides_of(b)) for b in self._writer.events]
        extra |= {b.sides: sides for b, sides in self._sides}
        self.columns: dict[str, Any] = {
            name: extra[name] if name in extra else self._column(name.replace("_", ".", 1))
            for name in self._writer.columns
        }
        self._bind_clock()
        self.changes_end = math.inf if self.lasting else loads_end(model)
        self._breaks = np.array([*load_breaks(model), math.inf])
        self._arrays = {name: np.zeros(shape) for name, shape in self.scratch.items()}
        self._moved = self._joined(zip(MOTION, TURNING, strict=True), self._arm)
        for coordinates in self._moved:
            coordinates.load()
        moved = [c.whole for c in self._moved] or map(self._storage, MOTION)
        self._arrays |= zip(STATE, moved, strict=False)
        self._arrays |= {"control": self._control, "account": self._account, "measures": self.measures}
        self._bind_arguments()
        self._bind_observed()
        settings = model.settings
        controls = self.integrator.estimates_error and settings.time_step is None
        self.tolerance = settings.tolerance if controls else 0.0
        self._state_revision = -1

    # --- rotations ---------------------------------------------------------------------------------

    @np.errstate(all="ignore")  # numbers beyond computing are reported before a run
    def _of_bending(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """Columns with the rotations as third coordinates, and what compares them with displacements."""
        arm, column = self._arm, self._column
        mass, lever = column("particles.mass"), levers(self.model)[self._held_rows]
        loads = (b.prefix for b in self._writer.of[StepRole.LOAD])
        turning = arm * arm * column("particles.turning")
        return {
            "per_arm": np.array([1.0 / arm]),
            "lever": np.column_stack([np.ones((len(lever), 2)), arm * lever]),
            "particles_mobility": np.column_stack([column("particles.mobility"), turning]),
            "particles_masses": np.column_stack([mass, mass, column("particles.inertia") / (arm * arm)]),
            "particles_support_springs": np.column_stack(
                [column("particles.support_springs"), column("particles.rotation_spring") / (arm * arm)]
            ),
            "particles_constant_force": np.column_stack(
                [column("particles.constant_force"), column("particles.constant_moment") / arm]
            ),
            **{
                f"{load}_force": np.column_stack([given[f"{load}_force"], given[f"{load}_moment"] / arm])
                for load in loads
            },
        }

    def _joined(self, pairs: Iterable[tuple[str, str]], scale: float) -> list[Coordinates]:
        """Arrays of coordinates for pairs of columns, "table.field", of what moves and what turns; none without bending."""
        if not self._writer.bends:
            return []
        shape = self._rows("particles"), self._writer.coordinates
        held = self._storage
        return [Coordinates(np.zeros(shape), held(moves), held(turns), scale) for moves, turns in pairs]

    def _ready(self) -> Any:
        """The functions to call now, for which the program holds the state as the model has it.

        Before they run for the first time in machine code they may all be called, for the sake of the compiler, so that
        between two calls the state is with the model alone.
        """
        form = self.module.form
        self._load()
        return form

    def _load(self) -> None:
        """Before a call, bring what the program holds up to date with the model."""
        for coordinates in self._moved:
            coordinates.load()

    def _store(self) -> None:
        """After a call, bring the model's columns up to date."""
        for coordinates in self._moved:
            coordinates.store()

    # --- events ------------------------------------------------------------------------------------

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
        return self._unbalanced[:, :2]

    @property
    def unbalanced_moment(self) -> Column:
        """The same of moments on each particle (kN·m), shape (n,); none where nothing bends."""
        return self._arm * self._unbalanced[:, 2:].sum(axis=1)

    def _rows(self, table: str) -> int:
        """Number of elements of a table that the program holds."""
        return self.model.tables[table].count

    def _arranged(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """What of the arrays of systems, and of columns, is another by which rows it holds, and in what order."""
        return {}

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
        coordinates, of_rods = self._writer.coordinates, self.integrator.rod_rows
        return {
            **dict.fromkeys(("force", "resisting", "predicted"), (particles, coordinates)),
            "direction": (rods, coordinates),
            **dict.fromkeys(("power", "gained", "stage_power"), (len(ACCOUNTS),)),
            "work": (self.integrator.particle_rows, particles, coordinates),
            "rod_work": (_TANGENTS if of_rods and self._writer.bends else of_rods, rods),
            "marks": (max(rods, particles), len(Mark) * len([*self._writer.branching, *self._writer.events])),
            "search": (len(Search),),
        }

    def _after(self, first: str, entry: str, **given: Any) -> tuple[Any, ...]:
        """The arguments of a compiled function, bound by name, between its parameter `first` and the columns."""
        known = self._arrays | given
        code = self.module.functions[entry].py_func.__code__
        names = code.co_varnames[: code.co_argcount]
        return tuple(known[name] for name in names[names.index(first) + 1 : -len(self.columns)])

    def _bind_arguments(self) -> None:
        if not self._writer.collides:
            self._arguments = (*self._after("loads_end", "advance"), *self.columns.values())
            return
        known = self._arrays | self.columns
        copies: dict[str, Any] = {f"kept_{name}": np.zeros_like(known[name]) for name in self._writer.kept}
        copies |= {f"own_{name}": np.zeros_like(known["force"]) for name in ("acceleration", "support")}
        copies["every"] = np.arange(self._rows("particles"))
        self._arguments = (*self._after("loads_end", "drive", **copies), *self.columns.values())

    def _bind_observed(self) -> None:
        for path in _GIVEN.values():
            self.model.column(path)  # brings it up to date
        storage = {name: self._storage(path) for name, path in _COLUMNS_OBSERVED.items()}
        self._acting = self._joined(_ACTING, 1.0 / self._arm)
        if self._writer.bends:
            storage |= zip(("applied", "reaction"), (c.whole for c in self._acting), strict=True)
            storage["fixed"] = np.column_stack([storage["fixed"], self._column("particles.fixed_rotation")])
        else:
            self._forget_moments()
        apart = {name: np.zeros_like(self._arrays[name]) for name in (*STATE[2:], "power")}
        self._unbalanced = apart["force"]
        yields = self.model.settings.plasticity
        self._observed = self._after("dt", "observe", yields=yields, **storage, **apart)

    def _forget_moments(self) -> None:
        """Nothing bends: no moments are left of when something did."""
        for path in (*(turns for _, turns in _ACTING), "rods.end_moment"):
            table, _, name = path.partition(".")
            if self.model.tables[table].storage(name).any():
                self.model.writable(path)[...] = 0.0

    def advance(self, steps: int, until: float = math.inf, landing: float = math.inf) -> tuple[int, StopReason]:
        """Take up to `steps` steps; returns how many, and why it stopped.

        None ends after `until` (s), and one that would pass `landing` (s) is cut to end there.
        """
        try:
            return self._advance(steps, until, landing)
        except Exception as error:
            return self._failed(error)

    def _failed(self, error: Exception) -> tuple[int, StopReason]:
        """Note that a kernel of others raised an error, for which its mod is looked for; all other errors go on."""
        if isinstance(error, ProgramError) or all(b.is_ours for b in self._writer.kernels):
            raise error
        self.failure = self.failure or self._explained(error)
        self._mark_changes()
        return 0, StopReason.FAILED

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
        if self._writer.collides:
            real = self._idle[0].real
            real[Real.UNTIL], real[Real.END] = until, landing
            return self._enter(self._idle, steps, alone=True)
        origin, limit = self._origin.tolist()
        total, since = self._counts.tolist()
        time = self._control.item(0)
        form = self._ready()
        taken, reason = form.advance(
            steps,
            self._is_fresh,
            total,
            total - since,
            origin,
            self.tolerance,
            limit or math.inf,
            self._breaks,
            float(until),
            float(landing),
            self.changes_end,
            *self._arguments,
        )
        now = self._control.item(0)
        if taken or now > time:
            self._counts[0] = total + taken
            if self.tolerance or now == landing:
                self._origin[0], self._counts[1] = now, total + taken
            self._mark_changes()
        self._store()
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
        except Exception as error:
            taken, reason = self._failed(error)
        if not self.module.is_loaded:
            self.module.did(taken)
        waits = driven.whole[Whole.NEED] != 0
        return reason, not waits and (taken < wanted or wanted == steps or reason is not StopReason.DONE)

    def _enter(self, arrays: Any, steps: int, *, alone: bool) -> tuple[int, StopReason]:
        """Enter the program with these arrays; returns how many steps it took, and why it stopped."""
        form, driven = self._ready(), arrays[0]
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
            *between_steps(compiled=form.is_machine),
            *arrays,
            *self._motion,
            self.tolerance,
            limit,
            self._breaks,
            self.changes_end,
            *self._arguments,
        )
        self._counts[:] = whole[Whole.TOTAL], whole[Whole.SINCE]
        self._origin[0] = driven.real[Real.ORIGIN]
        self._mark_changes()
        self._store()
        self._state_revision = self.model.newest(Role.STATE) if whole[Whole.FRESH] else -1
        return int(whole[Whole.TOTAL]) - total, _REASONS[whole[Whole.REASON]]

    @cached_property
    def _idle(self) -> Any:
        """Arrays with which steps are taken as if nothing could meet."""
        return idle()

    @property
    def _held_rows(self) -> Any:
        """The model's row of each particle that it holds."""
        return slice(None)

    @property
    def _motion(self) -> tuple[Column, Column, Column]:
        """The model's row of each particle, of none if they are the same, and the model's displacements and velocities."""
        return np.zeros(0, dtype=np.int64), self._arrays["displacement"], self._arrays["velocity"]

    def _catch_up(self) -> None:
        """Before steps, bring the sides of events up to the present state, and make room for all near pairs.

        A particle that has no rigid ends any more has no rotation that could go on; it is left as it is until time passes,
        so that no picture changes the state.
        """
        if self._strays.size:
            self.model.writable("particles.angular_velocity")[self._strays] = 0.0
            self._strays = self._strays[:0]
        if self._sides and not self._is_fresh:
            for b, sides in self._sides:
                sides[:] = self._sides_of(b)
        if self._near is not None and self._near.grow():
            self.columns["pair_list"] = self._near.arrays["pair_list"]
            self._bind_arguments()

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
            self._ready().commit(time, 0.0, *outside, *self.columns.values())
            self._mark_changes()
            self._store()

    def observe(self) -> None:
        """Bring the derived columns of rods and particles, and the measures, up to date, unless a kernel fails."""
        try:
            self._observe()
        except Exception as error:  # the next step fails, too, and then the mod that did it is looked for
            self._failed(error)

    def _observe(self) -> None:
        if self._writer.collides and not self._is_fresh:  # the state was put back, or changed
            self._support[:] = lasting_forces(self.model)[self._held_rows]
        time, size = self._control[:2].tolist()
        self._ready().observe(time, size, *self._observed, *self.columns.values())
        for coordinates in self._acting:
            coordinates.store()
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
