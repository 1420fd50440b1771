"""Step programs that hold a part of their model, or all of it in blocks that cores share; and which kind a model gets."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import Column, Role
from pinjoint.components.model import Model
from pinjoint.components.table import read_only
from pinjoint.systems.base import Integrator, StepSystem, cores
from pinjoint.systems.program.binding import bind
from pinjoint.systems.program.blocks import Layout, Numbers
from pinjoint.systems.program.program import OBSERVED, Program
from pinjoint.systems.program.writer import PUSHED, VERY_MANY, form_of

_SPINS = "10000"  # some 0.1 ms that a core waits awake: waking it costs as much as a step of 10 000 rods
_WORTHWHILE = 100_000  # rods from which a layer that takes 50 µs to start the cores is worth it


class ReorderedProgram(Program):
    """A step program with copies of its model's rows in an order of its own; every call brings the model up to date.

    moving: which particles it moves, shape (n,); it holds them, their rods and the other ends of these. None: all.
    """

    _versions: tuple[int, int] | None = None

    def __init__(
        self,
        model: Model,
        systems: Sequence[StepSystem],
        integrator: Integrator,
        form: str,
        moving: NDArray[np.bool_] | None = None,
    ) -> None:
        self.moving = moving
        super().__init__(model, systems, integrator, form)

    def move(self, moving: NDArray[np.bool_]) -> None:
        """Move these particles from now on."""
        self.moving = moving
        self.bind()

    def bind(self) -> None:
        """Take hold of the model's columns: copy them in order, in blocks if that is its form."""
        self._block_cores = np.ones(1, dtype=np.int64)
        whole = self._find_layout()
        self.layout = whole if self.moving is None else whole.part(self.moving)
        self._places = {"particles": self.layout.particles, "rods": self.layout.rods}
        self._held: dict[str, tuple[Column, Numbers, Column]] = {}
        super().bind()
        written = self._writer.written
        self._of_state = [self._held[path] for path in (*self.motion, *written.values())]
        derived = (f"{table}.{name}" for table, names in OBSERVED.items() for name in names)
        self._derived = [self._held[path] for path in derived if path in self._held]
        to_write = {*PUSHED, *written}
        columns = self.columns.items()
        self.columns = {name: array if name in to_write else read_only(array) for name, array in columns}
        self._bind_arguments()
        self._held_revision = -1

    @property
    def left_out(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Which particles and which rods it does not hold."""
        particles, rods = (np.ones(t.count, dtype=bool) for t in (self.model.particles, self.model.rods))
        particles[self.layout.particles] = rods[self.layout.rods] = False
        return particles, rods

    def _find_layout(self) -> Layout:
        """The layout of the whole model; that in blocks is found anew if positions or rods changed."""
        model = self.model
        if self.form != VERY_MANY:
            return Layout.in_order(model)
        versions = model.particles.version("position"), model.rods.version("between")
        if versions != self._versions:
            self._whole, self._versions = Layout.of(model), versions
        return self._whole

    def _rows(self, table: str) -> int:
        return len(self._places[table])

    def _column(self, path: str) -> Any:
        column, (table, _, _) = super()._column(path), path.partition(".")
        return column[self._places[table]] if table in self._places else column

    def _storage(self, path: str) -> Column:
        rows, own = self._places[path.partition(".")[0]], super()._storage(path)
        self._held[path] = own, rows, own[rows]
        return self._held[path][-1]

    def _arranged(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """The arrays of systems, and what follows from the layout."""
        arranged: dict[str, Any] = {
            "rods_between": self.layout.ends,
            "block_particles": self.layout.first_particle,
            "block_rods": self.layout.first_rod,
            "block_cores": self._block_cores,
        }
        self._of_kernels: list[tuple[Column, Numbers, Column]] = []
        for bound in [bind(b.system, self.model) for b in self._writer.bound]:
            if bound.each == "loads":
                arranged |= self._loads(bound.prefix, given)
                continue
            rows = self._places[bound.rows]
            for name, array in bound.stored_arrays.items():
                if name in self._writer.columns:
                    arranged[name] = array[rows]
                    self._of_kernels.append((array, rows, arranged[name]))
        return arranged

    def _loads(self, prefix: str, given: Mapping[str, Any]) -> dict[str, Any]:
        """The arrays of a law of loads on particles that it holds, in the order of these; the first load of each block."""
        on = self.layout.row[given[f"{prefix}_on"]]
        order = np.argsort(on, kind="stable")[np.count_nonzero(on < 0) :]
        names = [name for part in ("force", "moment", "first") if (name := f"{prefix}_{part}") in given]
        return {
            f"block_{prefix}": np.searchsorted(on[order], self.layout.first_particle),
            f"{prefix}_on": on[order].astype(np.uint32),
            **{name: given[name][order] for name in names},
        }

    @property
    def _held_rows(self) -> Any:
        return self._places["particles"]

    @property
    def _motion(self) -> tuple[Column, Column, Column]:
        rows = np.ascontiguousarray(self._places["particles"], dtype=np.int64)
        particles = self.model.tables["particles"]
        return rows, particles.storage("displacement"), particles.storage("velocity")

    @property
    def unbalanced(self) -> Column:
        everywhere = np.zeros((self.model.particles.count, 2))
        everywhere[self.layout.particles] = super().unbalanced
        return everywhere

    @property
    def unbalanced_moment(self) -> Column:
        everywhere = np.zeros(self.model.particles.count)
        everywhere[self.layout.particles] = super().unbalanced_moment
        return everywhere

    def _cores(self) -> int:
        """Number of cores that are worth using; results do not depend on it."""
        os.environ.setdefault("OMP_WAIT_POLICY", "passive")  # else idle threads spin for milliseconds
        os.environ.setdefault("GOMP_SPINCOUNT", _SPINS)
        import numba

        available = min(cores(), int(numba.config.NUMBA_NUM_THREADS))  # type: ignore[attr-defined]
        if available > 1:
            numba.set_num_threads(available)
            layer = numba.threading_layer()  # type: ignore[attr-defined]
            quick = layer in ("omp", "tbb")  # they start the cores in some microseconds
            if not quick and self._rows("rods") < _WORTHWHILE:
                return 1
        return available

    # --- the copies and the model's columns -----------------------------------------

    def _load(self) -> None:
        """Copy the arrays of systems, and the state if anything but this program changed it; see which cores are free."""
        if self.form == VERY_MANY and self.module.is_loaded:
            self._block_cores[0] = self._cores()
        changed = self._held_revision != self.model.newest(Role.STATE)
        for own, rows, held in (*self._of_kernels, *(self._of_state if changed else ())):
            np.take(own, rows, axis=0, out=held)
        super()._load()

    def _store(self) -> None:
        """Bring the model's columns of the state up to date with the copies."""
        super()._store()
        for own, rows, held in self._of_state:
            own[rows] = held
        self._held_revision = self.model.newest(Role.STATE)

    def _observe(self) -> None:
        super()._observe()
        for own, rows, held in self._derived:
            own[rows] = held


def make_program(
    model: Model, systems: Sequence[StepSystem], integrator: Integrator, form: str = ""
) -> Program:
    """The step program of a plan, in the form that suits the model or in another one."""
    form = form or form_of(model, integrator, systems)
    return (ReorderedProgram if form == VERY_MANY else Program)(model, systems, integrator, form)
