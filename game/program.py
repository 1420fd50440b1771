"""Step programs: laws, commits and a driver, compiled into one and bound to the columns of a model."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from components.field import Column, Role
from components.load import load_breaks, loads_end
from components.model import Model
from game.program_binding import bind, explain
from game.program_cache import compile_module, is_compiled, note_compiled
from game.program_controlled import MARKS, ControlledWriter
from game.program_writer import Writer, form_of
from systems.base import ACCOUNTS, Driver, StepSystem, StopReason

_AT_STRENGTH = 1e-9  # relative distance from its strength at which a rod is said to yield
ACCOUNT = (
    *ACCOUNTS,
    "initial_energy",
    "potential_reference",
    "force_scale",
    "energy_scale",
    "guard_energy",
)
CONTROL = ("time", "step_size", "step_error", "largest_displacement", "largest_speed")


def _writer(model: Model, systems: Sequence[StepSystem], driver: Driver, form: str = "") -> Writer:
    joining = [system for system in systems if system.kernel]
    return (ControlledWriter if driver.controlled else Writer)(model, joining, driver, form or form_of(model))


def has_program(model: Model, systems: Sequence[StepSystem], driver: Driver) -> bool:
    """True if the program of this plan need not be compiled any more, only loaded."""
    writer = _writer(model, systems, driver)
    return is_compiled(writer.source(), writer.kernels)


def at_strength(axial_force: Column, tension_limit: Column, compression_limit: Column) -> Column:
    """Which rods are at a strength, as far as forces (kN) can tell."""
    pulled: Column = axial_force >= tension_limit * (1.0 - _AT_STRENGTH)
    return pulled | (axial_force <= -compression_limit * (1.0 - _AT_STRENGTH))


class Program:
    """A compiled step program, bound to the columns of one model.

    measures: kinetic, fᵀM⁻¹f, elastic, potential energy (J), residual, largest force, round-off (kN) of
        the state last observed.
    module: what is compiled.
    compile_seconds: what writing and compiling it took, or loading it from the cache.
    """

    def __init__(self, model: Model, systems: Sequence[StepSystem], driver: Driver, form: str = "") -> None:
        started = time.perf_counter()
        self.model = model
        self.systems = tuple(system for system in systems if system.kernel)
        self.driver = driver
        self._writer = _writer(model, systems, driver, form)
        self.module = compile_module(self._writer.source(), self._writer.kernels)
        self.measures = np.zeros(8)
        self._state_revision = -1
        self.bind()
        self._compile()
        self.compile_seconds = time.perf_counter() - started

    def _compile(self) -> None:
        """Call everything once, which makes numba compile it, or load it from the cache."""
        from numba.core.errors import NumbaError

        try:
            self.advance(0)
            self.observe()
            if self._writer.commits:  # of no rods, since a commit at all changes history
                state, columns = ([a[:0] for a in arrays] for arrays in (self._state(), self._columns))
                self.module.commit(0.0, 0.0, *state, np.zeros(len(ACCOUNT)), *columns)
        except NumbaError as error:
            raise explain(self._writer.bound, self.model, error) from error
        note_compiled(self.module)

    @property
    def columns(self) -> dict[str, Column]:
        """The columns and arrays that its compiled functions end with, by name, in order."""
        return dict(zip(self._writer.columns, self._columns, strict=True))

    @property
    def marks(self) -> int:
        """How many numbers it notes of each rod to locate events."""
        return MARKS * len(self._writer.branching)

    @property
    def form(self) -> str:
        """Which of the forms of program_writer.py it has."""
        return self._writer.form

    @property
    def resists_motion(self) -> bool:
        """True if something depends on velocity: dampers or drag."""
        return self._writer.rates

    def bind(self) -> None:
        """Take hold of the model's columns; needed after every change of its document."""
        particles, rods = self.model.particles.count, self.model.rods.count
        extra: dict[str, Any] = {}
        for system in self.systems:
            extra.update(bind(system, self.model).arrays)
        written = {w.replace(".", "_", 1) for b in self._writer.commits for w in b.system.writes}
        self._columns = [
            extra[name] if name in extra else self._column(name, name in written)
            for name in self._writer.columns
        ]
        self._force, self._resisting, self._predicted = (np.zeros((particles, 2)) for _ in range(3))
        self._direction = np.zeros((rods, 2))
        self._power, self._gained = np.zeros(len(ACCOUNTS)), np.zeros(len(ACCOUNTS))
        self._loads_end = loads_end(self.model)
        self._breaks = load_breaks(self.model)
        self._work = np.zeros((self.driver.particle_rows, particles, 2))
        self._rod_work = np.zeros((self.driver.rod_rows, rods))
        self._marks = np.zeros((rods, self.marks))
        self._stage_power = np.zeros(len(ACCOUNTS))
        self._state_revision = -1

    def _column(self, name: str, written: bool) -> Any:
        table, _, column = name.partition("_")
        return self.model.writable(f"{table}.{column}") if written else self.model.column(f"{table}.{column}")

    def advance(self, steps: int, until: float = math.inf, landing: float = math.inf) -> tuple[int, StopReason]:
        """Take up to `steps` steps; returns how many, and why it stopped.

        A driver that controls its steps takes none that would end after `until` (s), and one that would
        pass `landing` (s) is cut to end there; for others the steps are clock.step_size long.
        """
        if self.driver.controlled:
            return self._advance_controlled(steps, until, landing)
        clock = self.model.clock
        if until < math.inf:
            steps = min(steps, max(int((until - clock.time) / clock.step_size * (1.0 + 1e-12)), 0))
        fresh = self._state_revision == self.model.newest(Role.STATE)
        total, first = clock.steps, clock.steps - clock.origin_steps
        account = self._accounts()
        taken, reason = self._call(
            "advance",
            steps,
            fresh,
            total,
            first,
            clock.origin,
            clock.step_size,
            np.append(self._breaks, math.inf),
            self._loads_end,
            *self._state(),
            self._predicted,
            self._power,
            self._gained,
            account,
            self.measures,
        )
        if taken:
            for name, value in zip(ACCOUNT, account, strict=True):
                self.model.writable(f"clock.{name}")[0] = value
            self.model.writable("clock.steps")[0] = total + taken
            self.model.writable("clock.time")[0] = clock.origin + (first + taken) * clock.step_size
        self._state_revision = self.model.newest(Role.STATE)
        return taken, StopReason(reason)

    def _advance_controlled(self, steps: int, until: float, landing: float) -> tuple[int, StopReason]:
        clock, model = self.model.clock, self.model
        fresh = self._state_revision == model.newest(Role.STATE)
        total = clock.steps
        account = self._accounts()
        control = np.array([*self._of_clock(CONTROL), 0.0, 0.0])
        controls_error = self.driver.estimates_error and model.settings.time_step is None
        breaks = np.sort(np.append(self._breaks, [landing, math.inf]))
        taken, reason = self._call(
            "advance",
            steps,
            fresh,
            total,
            total - clock.origin_steps,
            clock.origin,
            model.settings.tolerance if controls_error else 0.0,
            clock.step_limit or math.inf,
            breaks,
            float(until),
            self._loads_end,
            control,
            np.zeros(7),
            *self._state(),
            self._work,
            self._rod_work,
            self._marks,
            self._power,
            self._gained,
            self._stage_power,
            account,
            self.measures,
        )
        if control[0] > clock.time:
            if control[0] == landing and not controls_error:
                taken += 1  # the piece that it takes to land
            for name, value in zip((*ACCOUNT, *CONTROL), (*account, *control), strict=False):
                model.writable(f"clock.{name}")[0] = value
            model.writable("clock.steps")[0] = total + taken
            if controls_error or control[0] == landing:
                model.writable("clock.origin")[0] = control[0]
                model.writable("clock.origin_steps")[0] = total + taken
        self._state_revision = model.newest(Role.STATE)
        return taken, StopReason(reason)

    def commit(self) -> None:
        """Let history take note of a state that no step has led to, outside the energy account."""
        if self._writer.commits:
            clock = self.model.clock
            self._call("commit", clock.time, clock.step_size, *self._state(), np.zeros(len(ACCOUNT)))

    def observe(self) -> None:
        """Bring the derived columns of rods and particles, and the measures, up to date."""
        model, clock = self.model, self.model.clock
        count = model.rods.count
        axial_force, length, strain = (
            model.writable(f"rods.{name}") for name in ("axial_force", "length", "strain")
        )
        displacement, velocity = model.particles.displacement, model.particles.velocity
        applied, force, resisting = (np.zeros_like(displacement) for _ in range(3))
        self._call(
            "observe",
            clock.time,
            clock.step_size,
            displacement,
            velocity,
            applied,
            force,
            resisting,
            np.zeros((count, 2)),
            np.zeros(len(ACCOUNTS)),
            self.measures,
            axial_force,
            length,
            strain,
        )
        self._derive_supports_and_yielding(axial_force, applied, force + resisting)

    def _derive_supports_and_yielding(self, axial_force: Column, applied: Column, net_force: Column) -> None:
        model = self.model
        model.writable("particles.applied_force")[...] = applied
        model.writable("particles.reaction")[...] = np.where(model.particles.fixed, 0.0 - net_force, 0.0)
        limits = model.rods.tension_limit, model.rods.compression_limit
        model.writable("rods.yielding")[...] = at_strength(axial_force, *limits) & model.settings.plasticity

    def conserved_energy(self) -> float:
        """What the integrator conserves, less the work done so far (J), in the state last observed."""
        dt = self.model.clock.step_size
        conserved = self.module.conserved.py_func  # by itself it would have to be compiled in every process
        return float(conserved(self.measures, self._accounts(), dt, self.module.SHADOW))

    def _accounts(self) -> Column:
        return np.array(self._of_clock(ACCOUNT))

    def _of_clock(self, names: Sequence[str]) -> list[float]:
        """Values of the clock, without the way over its handle, which takes longer than some runs."""
        table = self.model.tables["clock"]
        return [table.current(name)[0] for name in names]

    def _state(self) -> tuple[Column, ...]:
        displacement = self.model.writable("particles.displacement")
        velocity = self.model.writable("particles.velocity")
        return displacement, velocity, self._force, self._resisting, self._direction

    def _call(self, entry: str, *arguments: Any) -> Any:
        return getattr(self.module, entry)(*arguments, *self._columns)
