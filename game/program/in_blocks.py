"""Step programs of very large models, which hold them in blocks."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from components.field import Column, Role
from components.model import Model
from game.cores import cores
from game.program.binding import bind
from game.program.layout import Layout, Numbers
from game.program.program import OBSERVED, Program
from game.program.writer import VERY_MANY, form_of
from systems.base import Driver, StepSystem, StopReason

_STATE = ("particles.displacement", "particles.velocity")
_QUICK = ("omp", "tbb")  # threading layers that start the cores in some microseconds
_WORTHWHILE = 100_000  # rods from which another, that takes 50 of them, is worth it


def make_program(model: Model, systems: Sequence[StepSystem], driver: Driver, form: str = "") -> Program:
    """The step program of a plan, in the form that suits the model or in another one."""
    form = form or form_of(model, driver)
    return (BlockProgram if form == VERY_MANY else Program)(model, systems, driver, form)


class BlockProgram(Program):
    """A step program that holds its model in blocks, and brings its columns up to date after every call."""

    _arranged: tuple[int, int] | None = None

    def bind(self) -> None:
        """Take hold of the model's columns: arrange them anew."""
        layout = self._arrange()
        self._places = {"particles": layout.particles, "rods": layout.rods}
        self._held: dict[str, tuple[Column, Numbers, Column]] = {}
        super().bind()
        written = [path for b in self._writer.commits for path in b.system.writes]
        self._of_state = [self._held[path] for path in (*_STATE, *written)]
        self._told = [self._held[f"{table}.{name}"] for table, names in OBSERVED.items() for name in names]
        self._block_cores = np.ones(1, dtype=np.int64)
        arranged = self.columns | {
            "rods_between": layout.ends,
            "block_particles": layout.first_particle,
            "block_rods": layout.first_rod,
            "block_cores": self._block_cores,
        }
        self._columns = list((arranged | self._of_systems(arranged)).values())
        self._held_revision = -1

    def _arrange(self) -> Layout:
        """The layout of the model, found anew where that changed which it follows from."""
        model = self.model
        versions = model.particles.version("position"), model.rods.version("between")
        if versions != self._arranged:
            self._layout, self._arranged = Layout.of(model), versions
        return self._layout

    def _column(self, path: str) -> Any:
        table, _, _ = path.partition(".")
        if table == "block":
            return None
        column = super()._column(path)
        return column[self._places[table]] if table in self._places else column

    def _storage(self, path: str) -> Column:
        rows, own = self._places[path.partition(".")[0]], super()._storage(path)
        self._held[path] = own, rows, own[rows]
        return self._held[path][-1]

    def _of_systems(self, columns: Mapping[str, Any]) -> dict[str, Any]:
        """The arrays of the systems, arranged."""
        arranged: dict[str, Any] = {}
        self._arrays: list[tuple[Column, Numbers, Column]] = []
        for system in self.systems:
            bound = bind(system, self.model)
            if bound.each == "loads":
                arranged |= self._loads(bound.prefix, columns)
                continue
            rows = self._places[bound.each or "rods"]
            for name, array in bound.arrays.items():
                if name in columns:
                    arranged[name] = array[rows]
                    self._arrays.append((array, rows, arranged[name]))
        return arranged

    def _loads(self, prefix: str, arranged: Mapping[str, Any]) -> dict[str, Any]:
        """The arrays of a law of loads, in the order of the blocks that they act in."""
        on = self._layout.row[arranged[f"{prefix}_on"]]
        order = np.argsort(on, kind="stable")
        return {
            f"{prefix}_on": on[order].astype(np.uint32),
            f"{prefix}_force": arranged[f"{prefix}_force"][order],
            f"{prefix}_first": arranged[f"{prefix}_first"][order],
            f"block_{prefix}": np.searchsorted(on[order], self._layout.first_particle),
        }

    def _cores(self) -> int:
        """How many cores are worth it; results do not depend on it."""
        os.environ.setdefault("OMP_WAIT_POLICY", "passive")  # else they wait for each other at full speed
        import numba

        available = min(cores(), int(numba.config.NUMBA_NUM_THREADS))  # type: ignore[attr-defined]
        if available > 1:
            numba.set_num_threads(available)
            layer = numba.threading_layer()  # type: ignore[attr-defined]
            if layer not in _QUICK and self.model.rods.count < _WORTHWHILE:
                return 1
        return available

    # --- the state, in blocks and in the model's columns ---------------------------------------------

    def _of_no_rods(self) -> list[Column]:
        nothing = dict.fromkeys(("block_particles", "block_rods"), np.zeros(2, dtype=np.intp))
        return list((self.columns | nothing).values())

    def _load(self) -> None:
        """Bring what is held up to date, if anything else changed the state, and systems' own arrays."""
        self._block_cores[0] = self._cores()
        changed = self._held_revision != self.model.newest(Role.STATE)
        for own, rows, held in (*self._arrays, *(self._of_state if changed else ())):
            np.take(own, rows, axis=0, out=held)

    def _store(self) -> None:
        """Bring the columns of the state up to date with what is held."""
        for own, rows, held in self._of_state:
            own[rows] = held
        self._held_revision = self.model.newest(Role.STATE)

    def advance(self, steps: int, until: float = math.inf, landing: float = math.inf) -> tuple[int, StopReason]:
        """Take up to `steps` steps, as every program does."""
        self._load()
        taken, reason = super().advance(steps, until, landing)
        if taken:
            self._store()
        return taken, reason

    def commit(self) -> None:
        """Let history take note of a state that no step has led to, outside the energy account."""
        self._load()
        super().commit()
        self._store()

    def observe(self) -> None:
        """Bring the derived columns of rods and particles, and the measures, up to date."""
        self._load()
        super().observe()
        for own, rows, held in self._told:
            own[rows] = held
