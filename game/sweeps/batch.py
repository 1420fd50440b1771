"""Batch: many variants of a small model on their way through time together, with the bits of single runs.

Each variant takes its own steps and checks by the same policies as Simulation. A variant that only Simulation can deal
with (it diverges, or never comes to rest) is computed by a run of its own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import Column
from pinjoint.components.load import load_breaks, loads_end
from pinjoint.sweeps.batch_program import BatchProgram
from pinjoint.sweeps.batched_model import BatchedModel
from pinjoint.systems.base import REVIEW_INTERVAL, StopReason
from pinjoint.systems.entries import ACCOUNT, CONTROL, Measure
from pinjoint.systems.islands import IMMOVABLE, islands
from pinjoint.systems.physics.kernels import conserved
from pinjoint.systems.physics.rest import RestMeasure
from pinjoint.systems.physics.spectrum import spectra
from pinjoint.systems.program.program import COLUMNS_OBSERVED
from pinjoint.systems.run.energy import ENTRIES, Energy, energy_of, opened
from pinjoint.systems.run.policy import (
    ENDING,
    ERROR_CONTROL,
    GOING_ON,
    Limits,
    StepPolicy,
    begin_steps,
    is_before,
    is_sleep_review,
    residual,
    steps_to_sleep_review,
)

Rows = NDArray[np.intp]


class Batch:
    """Runs the variants of a batched model that have one plan and one integrator.

    resting, alone: which variants are at rest, and which need a run of their own. rested: since when (s).
    measures: of each variant in the state last observed, as those of Program.
    """

    def __init__(self, model: BatchedModel, program: BatchProgram) -> None:
        self.model = model
        self.program = program
        self.integrator = program.integrator
        variants = model.variants
        self.resting, self.alone = np.zeros(variants, dtype=bool), np.zeros(variants, dtype=bool)
        self.rested = np.zeros(variants)
        self.measures = np.zeros((variants, len(Measure)))
        self.unbalanced = np.zeros_like(model["particles.displacement"])
        self._may_sleep = bool(model.single("settings.sleeping").any()) and program.program.follows_state
        self._may_sleep &= islands(model.part(np.zeros(1, dtype=np.intp)).as_model()).max(initial=IMMOVABLE) > 1
        fixed, rods = model.single("settings.time_step"), model.rods.count // variants
        self._policies = [
            StepPolicy(self.integrator, None if math.isnan(size) else size, rods) for size in fixed.tolist()
        ]
        self._controls_error = np.isnan(fixed) & self.integrator.estimates_error
        self._columns = program.columns(model)
        self._breaks = np.array([*load_breaks(model.as_model()), math.inf])
        self._loads_end = loads_end(model.as_model())
        self._begin()

    def clock(self, name: str) -> Column:
        """A value of the clocks, shape (variants,), writable."""
        return self.model.single(f"clock.{name}")

    @property
    def _all(self) -> Rows:
        return np.arange(self.model.variants)

    # --- getting ready -----------------------------------------------------------------------------

    def _begin(self) -> None:
        """Account for what the variants begin with, and choose their steps."""
        if self.program.has_history:
            self._call("commit", self._all, account=np.zeros((self.model.variants, len(ACCOUNT))))
        self.observe()
        for name, values in zip(ENTRIES, opened(self.measures.T, self.clock), strict=True):
            self.clock(name)[...] = values
        self._leave_sleepers(self._all)
        for name in ERROR_CONTROL:
            self.clock(name)[...] = 0.0
        sizes = np.zeros(self.model.variants)
        for variant, (policy, limits) in enumerate(zip(self._policies, self._limits(), strict=True)):
            self.alone[variant] |= policy.is_doubtful(limits)  # to be warned of
            if not self.alone[variant]:
                sizes[variant], self.clock("step_limit")[variant] = policy.first(limits)
        self._begin_steps(np.flatnonzero(~self.alone), sizes)
        self._reviewed = np.array([self.clock("time"), self.clock("steps")])

    def _leave_sleepers(self, variants: Rows) -> None:
        """Leave to runs of their own the variants in which an island at rest would sleep now while others move."""
        if not (self._may_sleep and len(variants)):
            return
        self.observe()
        model = self.model.as_model()
        of_particle = islands(model)
        of_rod = of_particle[model.rods.between].max(axis=1, initial=IMMOVABLE)
        variant = np.zeros(of_particle.max(initial=IMMOVABLE) + 1, dtype=np.intp)  # of each island
        variant[of_particle] = np.repeat(self._all, len(of_particle) // self.model.variants)
        scales = self.clock("force_scale")[variant], self.clock("energy_scale")[variant]
        rest = RestMeasure.of(model, self.unbalanced.reshape(-1, 2)).at_rest(of_particle, of_rod, *scales)
        rest[IMMOVABLE] = False
        self.alone[np.intersect1d(variant[rest], variants)] = True

    def _limits(self) -> list[Limits]:
        """The limits of each variant in the state last observed."""
        model, drag = self.model.as_model(), self.model.single("environment.drag")
        frequency, decay = spectra(model, self.model.rods.axial_force, drag)
        return [
            Limits.of(self.integrator, f, d) for f, d in zip(frequency.tolist(), decay.tolist(), strict=True)
        ]

    def _begin_steps(self, variants: Rows, sizes: Column) -> None:
        """From now on steps have these sizes; the guard against divergence compares with this moment."""
        if not len(variants):
            return
        begin_steps(self.clock, variants, sizes[variants])
        self.observe()
        conserved_by_all = conserved.py_func  # arrays of all variants in place of numbers
        guard = float(self.integrator.guard)
        energy = conserved_by_all(self.measures.T, self._clocks(ACCOUNT).T, self.clock("step_size"), guard)
        self.clock("guard_energy")[variants] = energy[variants]

    # --- calling the program -------------------------------------------------------------------------

    def _clocks(self, names: Sequence[str]) -> Column:
        """Values of the clocks, shape (variants, names)."""
        return np.stack([self.clock(name).astype(np.float64) for name in names], axis=1)

    def _put_clocks(self, names: Sequence[str], values: Column, variants: Rows) -> None:
        for place, name in enumerate(names):
            self.clock(name)[variants] = values[variants, place]

    def _call(self, entry: str, variants: Rows, **arguments: Any) -> Any:
        given = {
            "time": self.clock("time"),
            "dt": self.clock("step_size"),
            "displacement": self.model["particles.displacement"],
            "velocity": self.model["particles.velocity"],
            "measures": self.measures,
        }
        return self.program.call(entry, variants, given | arguments | self._columns, self.model.variants)

    def observe(self) -> None:
        """Bring the derived columns and the measures up to date."""
        columns = {name: self.model[path] for name, path in COLUMNS_OBSERVED.items()}
        yields = self.model.single("settings.plasticity")
        self._call("observe", self._all, force=self.unbalanced, yields=yields, **columns)

    def _advance(
        self, variants: Rows, steps: Any, until: float = math.inf, landing: float = math.inf
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Let variants take up to so many steps, all or each, as Program.advance does."""
        time, total = (self.clock(name).copy() for name in ("time", "steps"))
        first = total - self.clock("origin_steps")
        wanted = np.full(self.model.variants, steps, dtype=np.int64)
        account, control = self._clocks(ACCOUNT), self._clocks(CONTROL)
        limit = self.clock("step_limit")
        taken, reason = self._call(
            "advance",
            variants,
            steps=wanted,
            fresh=False,
            total=total,
            first=first,
            origin=self.clock("origin"),
            tolerance=np.where(self._controls_error, self.model.single("settings.tolerance"), 0.0),
            limit=np.where(limit > 0.0, limit, math.inf),
            breaks=self._breaks,
            until=float(until),
            landing=float(landing),
            loads_end=self._loads_end,
            control=control,
            account=account,
        )
        moved = np.zeros(self.model.variants, dtype=bool)
        moved[variants] = control[variants, 0] > time[variants]
        landed = moved & (control[:, 0] == landing)
        self._put_clocks(CONTROL, control, np.flatnonzero(moved))
        anew = np.flatnonzero(landed | (moved & self._controls_error))
        self.clock("origin")[anew] = control[anew, 0]
        self.clock("origin_steps")[anew] = (total + taken)[anew]
        self._put_clocks(ACCOUNT, account, np.flatnonzero(moved))
        self.clock("steps")[moved] = (total + taken)[moved]
        return taken, reason

    # --- running -------------------------------------------------------------------------------------

    def run_until_rest(self, limit: float) -> None:
        """Run until at rest, at most `limit` s of simulated time."""
        ends = self.clock("time") + limit
        for end in np.unique(ends).tolist():
            self._run(end, np.flatnonzero((ends == end) & ~self.alone))
        self.alone |= ~self.resting

    def run_to(self, target: float) -> None:
        """Run by whole steps that end by this time (s); for variants at rest time passes without steps."""
        self._run(target, np.flatnonzero(~(self.alone | self.resting)))
        self.clock("time")[self.resting] = np.maximum(self.clock("time")[self.resting], target)

    def _run(self, until: float, variants: Rows) -> None:
        while len(variants := variants[is_before(self.clock("time")[variants], until)]):
            # Each variant goes on until Simulation would next review it.
            steps = steps_to_sleep_review(self.clock("steps")) if self._may_sleep else REVIEW_INTERVAL
            taken, reason = self._advance(variants, steps, until)
            reason = reason[variants]
            rest = variants[reason == StopReason.REST]
            self.resting[rest] = True
            self.rested[rest] = self.clock("time")[rest]
            self.alone[variants[reason > StopReason.REST]] = True
            self._review(variants[reason == StopReason.REVIEW])
            variants = variants[np.isin(reason, GOING_ON) & (taken[variants] > 0)]
            self._leave_sleepers(variants[is_sleep_review(self.clock("steps")[variants])])
            variants = variants[~self.alone[variants]]

    def _review(self, variants: Rows) -> None:
        """Change automatic steps if the stable step changed much."""
        variants = np.array([v for v in variants.tolist() if self._policies[v].fixed is None], dtype=np.intp)
        if not len(variants):
            return
        self.observe()
        limits, sizes = self._limits(), self.clock("step_size").copy()
        time, steps = self.clock("time"), self.clock("steps")
        mean = (time - self._reviewed[0]) / np.maximum(steps - self._reviewed[1], 1)
        self._reviewed[:, variants] = time[variants], steps[variants]
        for variant in variants.tolist():
            policy = self._policies[variant]
            self.alone[variant] |= policy.crawls(limits[variant], mean[variant])  # to be warned of
            if policy.controls_error:
                self.clock("step_limit")[variant] = policy.limit(limits[variant])
            else:
                sizes[variant] = policy.reviewed(limits[variant], sizes[variant]) or sizes[variant]
        self._begin_steps(variants[sizes[variants] != self.clock("step_size")[variants]], sizes)

    def land(self, target: float) -> None:
        """Take the last, short step to a time (s)."""
        variants = np.flatnonzero((self.clock("time") < target) & ~self.alone)
        while len(variants):
            _, reason = self._advance(variants, REVIEW_INTERVAL, target, target)
            failed = np.isin(reason[variants], ENDING)
            self.alone[variants[failed]] = True
            variants = variants[(self.clock("time")[variants] < target) & ~failed]

    # --- reading -------------------------------------------------------------------------------------

    @property
    def energy(self) -> Energy:
        """The energy accounts in the state last observed; each entry has the shape (variants,)."""
        initial, work, reference = map(self.clock, ENTRIES)
        entries = initial.copy(), work, reference
        return energy_of(self.measures.T, lambda name: self.clock(name).copy(), entries)

    @property
    def residual(self) -> Column:
        """Largest unbalanced force over the largest force of all, in the state last observed."""
        return residual(self.measures.T)
