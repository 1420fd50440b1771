"""Batch: many variants of a small model on their way through time together, with the bits of single runs.

Each block of a stack goes as Simulation goes with one model, by its own steps and checks. A block whose way
leads to what only Simulation can deal with (it diverges, or never comes to rest) is left to a run of its own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from components.field import Column
from components.load import load_breaks, loads_end
from game.sweeps.batch_program import BatchProgram
from game.sweeps.stack import Stack
from systems.base import StopReason
from systems.islands import IMMOVABLE, islands
from systems.physics.rest import Stillness
from systems.physics.spectrum import spectra
from systems.program.program import ACCOUNT, CONTROL
from systems.program.writer import REVIEW_INTERVAL
from systems.run.energy import Energy
from systems.run.sleep import INTERVAL
from systems.run.step_size import automatic_step, first_step, is_outgrown, step_limit

Mask = NDArray[np.bool_]
_GOING_ON = (StopReason.DONE, StopReason.REVIEW)
_DISSIPATED = ("dissipated_damping", "dissipated_plastic", "dissipated_impact")


class Batch:
    """Runs the blocks of a stack that have one plan and one driver.

    resting, alone: which blocks are at rest, and which need a run of their own. rested: since when (s).
    measures: of each block in the state last observed, as those of Program.
    """

    def __init__(self, stack: Stack, program: BatchProgram) -> None:
        self.stack = stack
        self.program = program
        self.driver = program.driver
        blocks = stack.blocks
        self.resting, self.alone = np.zeros(blocks, dtype=bool), np.zeros(blocks, dtype=bool)
        self.rested = np.zeros(blocks)
        self.measures = np.zeros((blocks, 16))
        self.unbalanced = np.zeros_like(stack["particles.displacement"])
        self._may_sleep = bool(stack.single("settings.sleeping").any()) and program.program.follows_state
        self._may_sleep &= islands(stack.part(np.zeros(1, dtype=np.intp)).as_model()).max(initial=IMMOVABLE) > 1
        self.fixed_step = stack.single("settings.time_step")
        self._columns = program.columns(stack)
        self._breaks = np.array([*load_breaks(stack.as_model()), math.inf])
        self._loads_end = loads_end(stack.as_model())
        self._begin()

    def clock(self, name: str) -> Column:
        """A value of the clocks, shape (blocks,), writable."""
        return self.stack.single(f"clock.{name}")

    @property
    def _all(self) -> NDArray[np.intp]:
        return np.arange(self.stack.blocks)

    @property
    def _controls_error(self) -> Mask:
        return np.isnan(self.fixed_step) & self.driver.estimates_error

    # --- getting ready -----------------------------------------------------------------------------

    def _begin(self) -> None:
        """Account for what the blocks begin with, and choose their steps."""
        if self.program.has_history:
            self._call("commit", self._all, account=np.zeros((self.stack.blocks, len(ACCOUNT))))
        self.observe()
        kinetic, _, elastic, potential = self.measures.T[:4]
        dissipated = sum(self.clock(name) for name in _DISSIPATED)
        self.clock("initial_energy")[...] = kinetic + elastic + dissipated - self.clock("work")
        self.clock("potential_reference")[...] = potential
        self._leave_sleepers(self._all)
        frequency, decay, stable = self._limits()
        with np.errstate(invalid="ignore"):
            self.alone |= (stable == 0.0) | (self.fixed_step > stable)  # to be warned of
        sizes = self.fixed_step.copy()
        for block in np.flatnonzero(np.isnan(sizes) & ~self.alone).tolist():
            if self.driver.estimates_error:
                limit = self.clock("step_limit")[block] = step_limit(stable[block])
                sizes[block] = first_step(frequency[block], decay[block], limit)
            else:
                sizes[block] = automatic_step(stable[block], frequency[block], self._rods)
        self._begin_steps(np.flatnonzero(~self.alone), sizes)

    def _leave_sleepers(self, blocks: NDArray[np.intp]) -> None:
        """Leave those to runs of their own in which an island at rest would sleep now while others move."""
        if not (self._may_sleep and len(blocks)):
            return
        self.observe()
        model = self.stack.as_model()
        of_particle = islands(model)
        of_rod = of_particle[model.rods.between].max(axis=1, initial=IMMOVABLE)
        block = np.zeros(of_particle.max(initial=IMMOVABLE) + 1, dtype=np.intp)  # of each island
        block[of_particle] = np.repeat(self._all, len(of_particle) // self.stack.blocks)
        scales = self.clock("force_scale")[block], self.clock("energy_scale")[block]
        rest = Stillness.of(model, self.unbalanced.reshape(-1, 2)).at_rest(of_particle, of_rod, *scales)
        rest[IMMOVABLE] = False
        self.alone[np.intersect1d(block[rest], blocks)] = True

    @property
    def _rods(self) -> int:
        return self.stack.rods.count // self.stack.blocks

    def _limits(self) -> tuple[Column, Column, Column]:
        """Highest frequency, decay and largest stable step of each block, in the state last observed."""
        model = self.stack.as_model()
        frequency, decay = spectra(model, self.stack.rods.axial_force, self.stack.single("environment.drag"))
        stable = [
            self.driver.stable_step(f, d) if f > 0.0 or d > 0.0 else math.inf
            for f, d in zip(frequency.tolist(), decay.tolist(), strict=True)
        ]
        return frequency, decay, np.array(stable)

    def _begin_steps(self, blocks: NDArray[np.intp], sizes: Column) -> None:
        """From now on steps have these sizes; the guard against divergence compares with this moment."""
        if not len(blocks):
            return
        self.clock("origin")[blocks] = self.clock("time")[blocks]
        self.clock("origin_steps")[blocks] = self.clock("steps")[blocks]
        self.clock("step_size")[blocks] = sizes[blocks]
        self.observe()
        module = self.program.program.module
        conserved = module.conserved.py_func  # for all blocks at once
        energy = conserved(self.measures.T, self._clocks(ACCOUNT).T, self.clock("step_size"), module.SHADOW)
        self.clock("guard_energy")[blocks] = energy[blocks]

    # --- calling the program -------------------------------------------------------------------------

    def _clocks(self, names: Sequence[str]) -> Column:
        """Values of the clocks side by side, shape (blocks, names)."""
        found = np.zeros((self.stack.blocks, len(names)))
        for place, name in enumerate(names):
            found[:, place] = self.clock(name)
        return found

    def _put_clocks(self, names: Sequence[str], values: Column, blocks: NDArray[np.intp]) -> None:
        for place, name in enumerate(names):
            self.clock(name)[blocks] = values[blocks, place]

    def _call(self, entry: str, blocks: NDArray[np.intp], **arguments: Any) -> Any:
        given = {
            "time": self.clock("time"),
            "dt": self.clock("step_size"),
            "displacement": self.stack["particles.displacement"],
            "velocity": self.stack["particles.velocity"],
            "measures": self.measures,
        }
        return self.program.call(entry, blocks, given | arguments | self._columns, self.stack.blocks)

    def observe(self) -> None:
        """Bring the derived columns and the measures up to date."""
        stack = self.stack
        self._call(
            "observe",
            self._all,
            force=self.unbalanced,
            applied=stack["particles.applied_force"],
            reaction=stack["particles.reaction"],
            rods_axial_force=stack["rods.axial_force"],
            rods_length=stack["rods.length"],
            rods_strain=stack["rods.strain"],
            yielding=stack["rods.yielding"],
            fixed=stack["particles.fixed"],
            tension=stack["rods.tension_limit"],
            compression=stack["rods.compression_limit"],
            yields=stack.single("settings.plasticity"),
        )

    def _advance(
        self, blocks: NDArray[np.intp], steps: Any, until: float = math.inf, landing: float = math.inf
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Let blocks take up to so many steps, all or each, as Program.advance does."""
        time, size, total = (self.clock(name).copy() for name in ("time", "step_size", "steps"))
        first = total - self.clock("origin_steps")
        wanted = np.full(self.stack.blocks, steps, dtype=np.int64)
        if until < math.inf and not self.driver.controlled:  # of the others, steps may have no size
            left = ((until - time[blocks]) / size[blocks] * (1.0 + 1e-12)).astype(np.int64)
            wanted[blocks] = np.clip(left, 0, wanted[blocks])
        account, control = self._clocks(ACCOUNT), self._clocks(CONTROL)
        limit = self.clock("step_limit")
        taken, reason = self._call(
            "advance",
            blocks,
            steps=wanted,
            fresh=False,
            total=total,
            first=first,
            origin=self.clock("origin"),
            tolerance=np.where(self._controls_error, self.stack.single("settings.tolerance"), 0.0),
            limit=np.where(limit > 0.0, limit, math.inf),
            breaks=self._breaks,
            until=float(until),
            landing=float(landing),
            loads_end=self._loads_end,
            control=control,
            account=account,
        )
        moved = np.zeros(self.stack.blocks, dtype=bool)
        if self.driver.controlled:
            moved[blocks] = control[blocks, 0] > time[blocks]
            landed = moved & (control[:, 0] == landing)
            self._put_clocks(CONTROL, control, np.flatnonzero(moved))
            anew = np.flatnonzero(landed | (moved & self._controls_error))
            self.clock("origin")[anew] = control[anew, 0]
            self.clock("origin_steps")[anew] = (total + taken)[anew]
        else:
            moved[blocks] = taken[blocks] > 0
            reached = self.clock("origin") + (first + taken) * size
            self.clock("time")[moved] = reached[moved]
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
        """Run by whole steps that end by this time (s); for blocks at rest time passes without steps."""
        self._run(target, np.flatnonzero(~(self.alone | self.resting)))
        self.clock("time")[self.resting] = np.maximum(self.clock("time")[self.resting], target)

    def _run(self, until: float, blocks: NDArray[np.intp]) -> None:
        while len(blocks := blocks[until - self.clock("time")[blocks] > 4.0 * math.ulp(until)]):
            taken, reason = self._advance(blocks, self._steps_to_review, until)
            reason = reason[blocks]
            rest = blocks[reason == StopReason.REST]
            self.resting[rest] = True
            self.rested[rest] = self.clock("time")[rest]
            self.alone[blocks[reason > StopReason.REST]] = True
            self._review(blocks[reason == StopReason.REVIEW])
            blocks = blocks[np.isin(reason, _GOING_ON) & (taken[blocks] > 0)]
            self._leave_sleepers(blocks[self.clock("steps")[blocks] % INTERVAL == 0])
            blocks = blocks[~self.alone[blocks]]

    @property
    def _steps_to_review(self) -> Any:
        """Steps of each block until Simulation would stop next to look at it."""
        if not self._may_sleep:
            return REVIEW_INTERVAL
        return INTERVAL - self.clock("steps") % INTERVAL

    def _review(self, blocks: NDArray[np.intp]) -> None:
        """Change automatic steps if the stable step changed much."""
        blocks = blocks[np.isnan(self.fixed_step[blocks])]
        if not len(blocks):
            return
        self.observe()
        frequency, _, stable = self._limits()
        sizes = self.clock("step_size").copy()
        for block in blocks.tolist():
            if self.driver.estimates_error:
                self.clock("step_limit")[block] = step_limit(stable[block])
            else:
                wanted = automatic_step(stable[block], frequency[block], self._rods)
                if is_outgrown(sizes[block], wanted, stable[block]):
                    sizes[block] = wanted
        self._begin_steps(blocks[sizes[blocks] != self.clock("step_size")[blocks]], sizes)

    def land(self, target: float) -> None:
        """Take the last, short step to a time (s)."""
        blocks = np.flatnonzero((self.clock("time") < target) & ~self.alone)
        if not len(blocks):
            return
        if self.driver.controlled:
            while len(blocks):
                _, reason = self._advance(blocks, REVIEW_INTERVAL, target, target)
                blocks = blocks[(self.clock("time")[blocks] < target) & np.isin(reason[blocks], _GOING_ON)]
            return
        sizes = self.clock("step_size").copy()
        self._begin_steps(blocks, target - self.clock("time"))
        self._advance(blocks, 1)
        self.clock("time")[blocks] = target
        self._begin_steps(blocks, sizes)

    # --- reading -------------------------------------------------------------------------------------

    @property
    def energy(self) -> Energy:
        """The energy accounts in the state last observed; each entry has the shape (blocks,)."""
        kinetic, _, elastic, potential = self.measures.T[:4]
        entries: dict[str, Any] = {
            "initial": self.clock("initial_energy").copy(),
            "work": self.clock("work") + potential - self.clock("potential_reference"),
            "kinetic": kinetic,
            "elastic": elastic,
        }
        return Energy(**entries, **{name: self.clock(name).copy() for name in _DISSIPATED})  # type: ignore[arg-type]

    @property
    def residual(self) -> Column:
        """Largest unbalanced force over the largest force of all, in the state last observed."""
        unbalanced, largest = self.measures.T[4:6]
        found: Column = np.divide(unbalanced, largest, out=np.zeros(len(largest)), where=largest > 0.0)
        return found
