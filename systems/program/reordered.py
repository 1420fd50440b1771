"""Step programs that hold a part of their model, or all of it in another order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import Column, Role
from pinjoint.components.model import Model
from pinjoint.components.table import read_only
from pinjoint.systems.base import Integrator, StepSystem
from pinjoint.systems.program.binding import bind
from pinjoint.systems.program.blocks import Layout, Numbers
from pinjoint.systems.program.program import OBSERVED, Program
from pinjoint.systems.program.writer import PUSHED


class ReorderedProgram(Program):
    """A step program with copies of its model's rows in an order of its own; every call brings the model up to date.

    moving: which particles it moves, shape (n,); it holds them, their rods and the other ends of these. None: all.
    """

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
        """Take hold of the model's columns: copy them in order."""
        whole = self._find_layout()
        self.layout = whole if self.moving is None else whole.part(self.moving)
        self._places = {"particles": self.layout.particles, "rods": self.layout.rods}
        self._held: dict[str, tuple[Column, Numbers, Column]] = {}
        super().bind()
        written = [path for b in self._writer.commits for path in b.system.writes]
        self._of_state = [self._held[path] for path in (*self.motion, *written)]
        derived = (f"{table}.{name}" for table, names in OBSERVED.items() for name in names)
        self._derived = [self._held[path] for path in derived if path in self._held]
        ordered = self.columns | self._of_layout()
        ordered |= self._of_systems(ordered)
        to_write = {*PUSHED, *(path.replace(".", "_", 1) for path in written)}
        self._columns = [array if name in to_write else read_only(array) for name, array in ordered.items()]
        self._bind_arguments()
        self._held_revision = -1

    @property
    def left_out(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Which particles and which rods it does not hold."""
        particles, rods = (np.ones(t.count, dtype=bool) for t in (self.model.particles, self.model.rods))
        particles[self.layout.particles] = rods[self.layout.rods] = False
        return particles, rods

    def _find_layout(self) -> Layout:
        """The layout of the whole model."""
        return Layout.in_order(self.model)

    def _of_layout(self) -> dict[str, Any]:
        """The columns that follow from the layout."""
        return {"rods_between": self.layout.ends}

    def _rows(self, table: str) -> int:
        return len(self._places[table])

    def _column(self, path: str) -> Any:
        column, (table, _, _) = super()._column(path), path.partition(".")
        return column[self._places[table]] if table in self._places else column

    def _storage(self, path: str) -> Column:
        rows, own = self._places[path.partition(".")[0]], super()._storage(path)
        self._held[path] = own, rows, own[rows]
        return self._held[path][-1]

    def _of_systems(self, columns: Mapping[str, Any]) -> dict[str, Any]:
        """The arrays of the systems, in order."""
        ordered: dict[str, Any] = {}
        self._of_kernels: list[tuple[Column, Numbers, Column]] = []
        for system in self.systems:
            bound = bind(system, self.model)
            if bound.each == "loads":
                ordered |= self._loads(bound.prefix, columns)
                continue
            rows = self._places[bound.rows]
            for name, array in bound.stored_arrays.items():
                if name in columns:
                    ordered[name] = array[rows]
                    self._of_kernels.append((array, rows, ordered[name]))
        return ordered

    def _loads(self, prefix: str, ordered: Mapping[str, Any]) -> dict[str, Any]:
        """The arrays of a law of loads on particles that it holds, in the order of these."""
        on = self.layout.row[ordered[f"{prefix}_on"]]
        order = np.argsort(on, kind="stable")[np.count_nonzero(on < 0) :]
        return {
            f"{prefix}_on": on[order].astype(np.uint32),
            f"{prefix}_force": ordered[f"{prefix}_force"][order],
            f"{prefix}_first": ordered[f"{prefix}_first"][order],
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

    # --- the copies and the model's columns -----------------------------------------

    def _load(self) -> None:
        """Copy the arrays of systems, and the state if anything but this program changed it."""
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
