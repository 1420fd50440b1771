"""The record of a run's impacts, as columns and as CSV."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pinjoint.components import written
from pinjoint.components.field import Column
from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.components.obstacles import obstacles
from pinjoint.components.table import read_only
from pinjoint.systems.collision.columns import Group

MOST_KEPT = 2**22  # impacts; of longer runs the earliest are forgotten
_COLUMNS = ("time", "first", "second", "impulse", "energy_lost", "x", "y")


class TooManyImpacts(Exception):
    """Steps hold more impacts than anybody waits for; those of the call have not happened."""


class Impacts:
    """The impacts of a model's run so far, earliest first; going back in time removes the later ones.

    time: s. first, second: rows of the two particles; the rows of obstacles, such as walls, follow those of the
    particles. impulse: N·s along the line of centres. energy_lost: J; of a joint impact, a share. x, y: the point of
    contact, m. Each is an array. most_awaited: of free discs in one call, beyond which it raises TooManyImpacts.
    cut_short: joint impacts of more reflections than are followed.
    """

    most_awaited = math.inf
    cut_short = 0

    def __init__(self, model: Model) -> None:
        self._model = model
        self._table = np.zeros((0, len(_COLUMNS)))
        self._first = self._count = model.clock.collisions  # of the run, in the table and after it

    def record(self, rows: NDArray[np.float64], forgotten: int = 0) -> None:
        """Add impacts, shape (k, 7), to the impacts that the clock has counted.

        forgotten: how many more came before them, which are counted, but not kept.
        """
        self._take_back()
        excess = max(len(rows) - MOST_KEPT, 0)
        rows, forgotten = rows[excess:], forgotten + excess
        if forgotten:
            self._first = self._count = self._count + forgotten
        kept = self._count - self._first
        if kept + len(rows) > MOST_KEPT:
            kept = max(MOST_KEPT // 2 - len(rows), 0)
            self._table = self._table[self._count - self._first - kept : self._count - self._first]
            self._first = self._count - kept
        if kept + len(rows) > len(self._table):
            larger = np.zeros((max(2 * len(self._table), kept + len(rows), 256), len(_COLUMNS)))
            larger[:kept] = self._table[:kept]
            self._table = larger
        self._table[kept : kept + len(rows)] = rows
        self._count += len(rows)

    def count_cut_short(self, group: Group) -> None:
        """Count what a kernel has counted in a group since the last call."""
        self.cut_short += int(group.cut_short[0])
        group.cut_short[0] = 0

    def _take_back(self) -> None:
        """Remove impacts that going back in time has undone."""
        counted = self._model.clock.collisions
        self.cut_short = self.cut_short if counted else 0
        if counted < self._first or counted > self._count:
            self._first = self._count = counted
        self._count = counted

    def __len__(self) -> int:
        self._take_back()
        return self._count - self._first

    def __getattr__(self, name: str) -> Column:
        if name not in _COLUMNS:
            raise AttributeError(
                tr(
                    "Impacts have no column '{name}'; they have {columns}.",
                    name=name,
                    columns=", ".join(_COLUMNS),
                )
            )
        column = self._table[: len(self), _COLUMNS.index(name)]
        if name in ("first", "second"):
            return column.astype(np.int64)
        return read_only(column)

    def as_csv(self) -> str:
        """One impact a line: time (s), the particles' names, impulse (N·s), energy lost (J), point (m)."""
        names = [*self._model.particles.names, *obstacles(self._model).names]
        impacts = self._table[: len(self)].tolist()
        rows = (
            [time, names[int(first)], names[int(second)], *others] for time, first, second, *others in impacts
        )
        return written.as_csv([_COLUMNS, *rows])
