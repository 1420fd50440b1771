"""Batches of a sweep: which variants can be computed together, and what they come to."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.commands.reports.results import reported
from pinjoint.components.field import Column, FieldError
from pinjoint.components.language import english
from pinjoint.components.rod import bends
from pinjoint.components.settings import AUTOMATIC
from pinjoint.documents.format import ModelError
from pinjoint.paths import ENERGIES, EVERY, PathError, Target, locate, settable
from pinjoint.sweeps.batch import Batch
from pinjoint.sweeps.batch_program import BatchProgram
from pinjoint.sweeps.batched_model import BatchedModel
from pinjoint.sweeps.measure import Measure
from pinjoint.sweeps.plan import Plan, Record
from pinjoint.sweeps.variant_runner import VariantRunner
from pinjoint.sweeps.variation import Random, Value
from pinjoint.systems import is_ours
from pinjoint.systems.physics.automatic import SMALL, stiffnesses, suited_to
from pinjoint.systems.program.binding import ProgramError
from pinjoint.systems.run.policy import at_rest_since, energy_is_off

MOST_NUMBERS = 2_000_000  # in the largest array of a batch: of stiffness, rods × directions of particles
# What makes another model of it, or lets its parts rest by themselves.
_ALONE = (
    *("particles.name", "particles.fixed", "rods.name", "loads.name", "settings.sleeping"),
    *(
        "rods.prescribed_bending_stiffness",
        "rods.second_moment",
        "rods.hinged",
    ),  # models that bend are computed one by one
)
_REPORTED = ("particles", "rods")


class Batches:
    """Computes variants of a plan together, where they differ in numbers only and none collide.

    size: how many variants to compute at a time; 1: they cannot be computed together.
    """

    def __init__(self, runner: VariantRunner, plan: Plan, threads: int) -> None:
        self._runner, self._plan, self._threads = runner, plan, threads
        self._programs: dict[Hashable, BatchProgram | None] = {}
        with runner.taken_back():
            runner.override(plan.overrides)
            self._targets = [locate(runner.model, path, settable)[0] for path in plan.varied]
            self._base = BatchedModel.of(runner.model, 1) if self._suits() else None
        self._loads_vary = any(target.table.name == "loads" for target in self._targets)
        rods, particles = runner.model.rods.count, runner.model.particles.count
        most = MOST_NUMBERS // max(2 * rods * particles, 1)
        self.size = max(min(most, 1024), 1) if self._base is not None else 1

    def _suits(self) -> bool:
        """True unless something about the plan asks for single runs."""
        model, plan = self._runner.model, self._plan
        placed = [v for v in plan.variations if not isinstance(v, Random) and ".position." in v.path]
        return (
            plan.analysis.load_factors is None
            and 0 < model.rods.count <= SMALL
            and not bends(model)
            and bool(np.isnan(model.rods.second_moment).all())
            and model.clock.step_size == 0.0  # it has not begun
            and len(placed) <= 1  # two could meet on the way, which is refused
            and all(is_ours(type(system).__module__) for system in self._runner.step_systems)
            and all(self._is_number(target) for target in self._targets)
        )

    @staticmethod
    def _is_number(target: Target) -> bool:
        name = f"{target.table.name}.{target.field.name}"
        plain = target.field.dtype in (float, int, bool) and name not in _ALONE
        return plain or name == "settings.integrator"

    # --- the variants ---------------------------------------------------------------------------------

    def records(self, numbers: Sequence[int]) -> dict[int, list[Record]]:
        """Records of these variants by number, without those that need a run of their own."""
        if self._base is None:
            return {}
        found: dict[int, list[Record]] = {}
        for batched, key, of_model in self._batched(numbers):
            program = self._program(key, of_model[0])
            if program is not None:
                found |= self._run(Batch(batched, program), of_model)
        return found

    def _batched(self, numbers: Sequence[int]) -> Iterator[tuple[BatchedModel, Hashable, list[int]]]:
        """Batched models of variants that have one plan and one integrator, what tells them apart, and their numbers."""
        assert self._base is not None
        groups: dict[Hashable, list[tuple[int, tuple[Value, ...]]]] = {}
        for number in numbers:
            values = self._plan.values(number)
            if self._allowed(values):
                groups.setdefault(tuple(map(_kind, values)), []).append((number, values))
        for kinds, variants in groups.items():
            batched = self._base.part(np.zeros(len(variants), dtype=np.intp))
            for place, target in enumerate(self._targets):
                self._put(batched, target, [values[place] for _, values in variants])
            batched.derive()
            sound = np.flatnonzero(~(batched.extreme() | _refused(batched)))
            batched = batched.part(sound)
            integrators = self._integrators(batched)
            for integrator in np.unique(integrators).tolist():
                at = np.flatnonzero(integrators == integrator)
                yield batched.part(at), (kinds, integrator), [variants[row][0] for row in sound[at].tolist()]

    def _allowed(self, values: Sequence[Value]) -> bool:
        try:
            for target, value in zip(self._targets, values, strict=True):
                target.field.check((value, value) if target.axis else value, "")
        except FieldError:
            return False
        return True

    @staticmethod
    def _put(batched: BatchedModel, target: Target, values: Sequence[Value]) -> None:
        column = batched[f"{target.table.name}.{target.field.name}"]
        stored = np.array([target.field.stored(value) for value in values], dtype=column.dtype)
        rows = slice(None) if target.element == EVERY else target.handles[0].row
        if target.axis:
            column[:, rows, target.field.axes.index(target.axis)] = (
                stored[:, None] if target.element == EVERY else stored
            )
        else:
            column[:, rows] = stored.reshape(-1, *(1,) * (column[:, rows].ndim - 1))

    @staticmethod
    def _integrators(batched: BatchedModel) -> NDArray[Any]:
        """The name of the integrator of each variant."""
        chosen = batched.single("settings.integrator").copy()
        chosen[(chosen == AUTOMATIC) & ~np.isnan(batched.single("settings.time_step"))] = "velocity_verlet"
        automatic = np.flatnonzero(chosen == AUTOMATIC)
        if len(automatic):
            found = stiffnesses(batched.as_model(), batched.single("environment.drag"))
            chosen[automatic] = [suited_to(stiffness) for stiffness in found[automatic].tolist()]
        return chosen

    def _program(self, key: Hashable, number: int) -> BatchProgram | None:
        """The program of variants that this one stands for; None: they need runs of their own."""
        if key not in self._programs:
            self._programs[key] = None
            refused = PathError, ModelError, ProgramError  # a run of its own says what is wrong
            with suppress(*refused), self._runner.taken_back():
                self._runner.override(self._plan.overrides_of(number))
                simulation = self._runner.simulation
                if not any(system.impulsive for system in simulation.plan):
                    self._programs[key] = BatchProgram(
                        simulation.programs.compiled, self._threads, varied_arrays=self._loads_vary
                    )
        return self._programs[key]

    # --- running them -----------------------------------------------------------------------------------

    def _run(self, batch: Batch, numbers: Sequence[int]) -> dict[int, list[Record]]:
        analysis = self._plan.analysis
        states: list[list[tuple[Any, ...]]] = []
        if analysis.times is None:
            batch.run_until_rest(analysis.limit)
            states.append(self._measured(batch))
        for target in analysis.times or ():
            batch.run_to(target)
            before = batch.model.state()
            batch.land(target)
            states.append(self._measured(batch))
            batch.model.restore(before)
        found: dict[int, list[Record]] = {}
        for variant in np.flatnonzero(~batch.alone).tolist():
            status = "at rest" if analysis.times is None else "time reached"
            message = english(at_rest_since(batch.rested[variant])) if batch.resting[variant] else ""
            found[numbers[variant]] = [(status, message, *state[variant]) for state in states]
        return found

    def _measured(self, batch: Batch) -> list[tuple[Any, ...]]:
        """The record of each variant in its present state: time, no load factor, measures."""
        batch.observe()
        energy, residual = batch.energy.as_dict(), batch.residual
        batch.alone |= ~_finite(batch, energy, residual)
        warned = energy_is_off(batch.clock("largest_imbalance"), batch.clock("energy_scale"))
        batch.alone |= warned  # runs of their own say so
        measured = (self._column(measure, batch, energy, residual) for measure in self._plan.measures)
        return list(zip(batch.clock("time").tolist(), [None] * batch.model.variants, *measured, strict=True))

    def _column(self, measure: Measure, batch: Batch, energy: dict[str, Any], residual: Column) -> list[Any]:
        section, *rest = measure.keys
        if section == "residual":
            return list(residual.tolist())
        if section == "collisions":
            return list(batch.clock("collisions").tolist())
        if section == "energy":
            return list(energy[str(rest[0])].tolist())
        row = self._runner.model.tables[str(section)][str(rest[0])].row
        column = batch.model[f"{section}.{rest[1]}"][(slice(None), row, *rest[2:])]
        return [None if value != value else value for value in column.tolist()]


def _kind(value: Value) -> Hashable:
    """The part of a value that decides which systems a model needs: its sign, or itself if it is no number."""
    if value is None or isinstance(value, bool | str):
        return value
    return "+" if value > 0.0 else "-" if value < 0.0 else "0"


def _refused(batched: BatchedModel) -> NDArray[np.bool_]:
    """Which blocks would be refused: a velocity along a constraint, a rod that shrinks to nothing."""
    pushed = batched["particles.fixed"] & (batched["particles.velocity"] != 0.0)
    shrunk = batched["rods.thermal_expansion"] * batched["rods.temperature_change"] <= -1.0
    refused: NDArray[np.bool_] = pushed.any(axis=(1, 2))
    return refused | shrunk.any(axis=1)


def _finite(batch: Batch, energy: dict[str, Any], residual: Column) -> NDArray[np.bool_]:
    """Which blocks have a state that can be reported."""
    columns = [residual, *(energy[name] for name in ENERGIES)]
    for table in _REPORTED:
        for field in reported(batch.model.as_model(), table):
            column = batch.model[f"{table}.{field.name}"]
            columns.append(np.where(np.isnan(column), 0.0, column) if field.nullable else column)
    finite = np.ones(batch.model.variants, dtype=bool)
    for column in columns:
        finite &= np.isfinite(column).reshape(len(finite), -1).all(axis=1)
    return finite
