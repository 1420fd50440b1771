"""Rows of kernels: the kernel of a step system called by itself for each row of a model, to check it and to time it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import Vector
from pinjoint.components.language import marked
from pinjoint.components.model import Model
from pinjoint.systems.program.binding import PROVIDED, Bound, written_row
from pinjoint.systems.program.compiler import Choice, Compile, generated
from pinjoint.systems.program.near_pairs import pairs_within

Numbers = NDArray[np.float64]

CALLS, TRIALS = 100_000, 5  # the fastest trial counts


class KernelRows:
    """The rows of a model, in its present state, that a kernel is given; what only a step program provides is 0.

    Of pairs, turned: the second particle of each comes first; moved: `apart` is longer by this share (x, y) of its length.
    """

    def __init__(self, bound: Bound, model: Model, *, turned: bool = False, moved: Vector = (0.0, 0.0)) -> None:
        self._bound, self._model = bound, model
        pairs = pairs_within(model, bound.cutoff) if bound.each == "pairs" else np.zeros((0, 2), dtype=np.intp)
        self._pairs = pairs[:, :: -1 if turned else 1]
        self._moved = moved

    @property
    def apart(self) -> Numbers:
        """The vectors between the particles of each pair that a law of pairs acts on (m)."""
        apart = self._between("position") + self._between("displacement")
        return np.asarray(apart + np.hypot(*apart.T)[:, None] * self._moved)

    def results(self) -> Numbers:
        """What the kernel gives for each row, shape (rows, results)."""
        rows = [self._bound.function(*row) for row in self._rows()]
        return np.array(rows, dtype=np.float64).reshape(len(rows), -1)

    def seconds_per_call(self) -> float:
        """How long one call takes in a compiled loop over the rows, repeated; the best of several."""
        columns = self._columns()
        if any(not len(column) for column in columns):
            return 0.0
        columns = [np.resize(column, (CALLS, *column.shape[1:])) for column in columns]
        if self._bound.each == "loads":
            columns.append(self._bound.arrays[f"{self._bound.prefix}_values"])
        loop = _compiled_loop(self._bound, columns)
        seconds = []
        for _ in range(TRIALS):
            loop(*columns)
            started = time.perf_counter()
            loop(*columns)
            seconds.append(time.perf_counter() - started)
        return min(seconds) / CALLS

    def _rows(self) -> Iterator[Sequence[Any]]:
        columns = [map(_as_tuples, column.tolist()) for column in self._columns()]
        return zip(*columns, strict=True)

    def _columns(self) -> list[NDArray[Any]]:
        """One entry a row for each parameter; of a load, the time and where its values begin."""
        bound = self._bound
        if bound.each == "loads":
            first = bound.arrays[f"{bound.prefix}_first"]
            return [np.zeros(len(first)), first]
        return [self._column(parameter) for parameter in bound.parameters]

    def _column(self, parameter: str) -> NDArray[Any]:
        of_pairs = self._bound.each == "pairs"
        count = len(self._pairs) if of_pairs else self._model.tables[self._bound.rows].count
        if parameter in ("apart", "drift"):
            return self.apart if parameter == "apart" else self._between("velocity")
        if parameter in PROVIDED:
            return np.zeros(count)
        table, _, name = parameter.partition("_")
        own = self._bound.arrays.get(parameter)
        column = self._model.column(f"{table}.{name}") if own is None else own
        if own is None and self._model.tables[table].kind.single:
            return np.repeat(column, count, axis=0)
        return column[self._pairs] if of_pairs else column

    def _between(self, name: str) -> Numbers:
        """Differences of a column of the particles, of each pair."""
        column = self._model.column(f"particles.{name}")
        found: Numbers = column[self._pairs[:, 1]] - column[self._pairs[:, 0]]
        return found


def _as_tuples(value: Any) -> Any:
    """A row as kernels get it."""
    return tuple(map(_as_tuples, value)) if isinstance(value, list) else value


def _compiled_loop(bound: Bound, columns: Sequence[NDArray[Any]]) -> Callable[..., float]:
    """A function of these columns, of loads also their values, that calls the kernel for each row and adds up."""
    names = [f"c{index}" for index in range(len(columns))]
    arguments = [written_row(n, "i", c.shape[1:]) for n, c in zip(names, columns, strict=True)]
    if bound.each == "loads":
        arguments = ["c0[i]", "c2", "c1[i]"]
    pair = bound.each in ("particles", "pairs", "ends", "")
    lines = [
        "from pinjoint.systems.kernels import kept",
        "@kept()",
        f"def loop({', '.join(names)}):",
        "    total = 0.0",
        f"    for i in range({CALLS}):",
        f"        made = kernel({', '.join(arguments)})",
        f"        total += {'made[0] + made[1]' if pair else 'made'}",
        "    return total",
    ]
    module = generated(marked("the timing of a kernel"), "\n".join(lines), {"kernel": bound.function})
    loop: Callable[..., float] = (module.form if Choice.compile is Compile.NEVER else module.load()).loop
    return loop
