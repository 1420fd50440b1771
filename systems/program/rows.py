"""Kernels row by row: what each row of a step system's kernel gives at the present state of a model."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from components.model import Model
from systems.base import Commit, Law, StepSystem
from systems.program.binding import Bound, bind

Numbers = NDArray[np.float64]

CALLS, TRIALS = 100_000, 5  # of which the fastest trial counts


class KernelRows:
    """Calls kernels one row at a time, the slow way, at the state in which a model is now."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.provided: dict[str, Any] = {"time": model.clock.time, "dt": model.clock.step_size}
        self.provided |= _geometry(model)
        self.provided["axial_force"] = np.zeros(model.rods.count)

    def of(self, bound: Bound) -> Numbers:
        """What the kernel gives for each row, shape (rows, results)."""
        rows = [np.atleast_1d(bound.function(*arguments)) for arguments in self._arguments(bound)]
        return np.array(rows, dtype=np.float64).reshape(len(rows), -1)

    def seconds_per_call(self, bound: Bound) -> float:
        """How long one call takes in a compiled loop over the rows, repeated; the best of several."""
        if not self._count(bound):
            return 0.0
        columns = [np.resize(column, (CALLS, *column.shape[1:])) for column in self._columns(bound)]
        loop = _compiled_loop(bound, columns)
        return min(_seconds(loop, columns) for _ in range(TRIALS)) / CALLS

    def _arguments(self, bound: Bound) -> Iterator[Sequence[Any]]:
        """The arguments of the kernel, row by row."""
        columns = [column.tolist() for column in self._columns(bound)]
        vectors = [[tuple(v) if isinstance(v, list) else v for v in column] for column in columns]
        rows = zip(*vectors, strict=True) if vectors else [()] * self._count(bound)
        if bound.each == "loads":
            values = bound.arrays[f"{bound.prefix}_values"]
            return ((time, values, first) for time, first in rows)
        return iter(rows)

    def _count(self, bound: Bound) -> int:
        if bound.each == "loads":
            return len(bound.arrays[f"{bound.prefix}_first"])
        return self.model.tables[bound.each or "rods"].count

    def _columns(self, bound: Bound) -> list[NDArray[Any]]:
        """One entry a row for each parameter; of a load, the time and where its values begin."""
        count = self._count(bound)
        if bound.each == "loads":
            return [np.full(count, self.provided["time"]), bound.arrays[f"{bound.prefix}_first"]]
        return [self._column(bound, parameter, count) for parameter in bound.parameters]

    def _column(self, bound: Bound, parameter: str, count: int) -> NDArray[Any]:
        if parameter in bound.arrays:
            return bound.arrays[parameter]
        if parameter in self.provided:
            return np.broadcast_to(self.provided[parameter], count)
        table, _, name = parameter.partition("_")
        column = self.model.column(f"{table}.{name}")
        return np.repeat(column, count, axis=0) if self.model.tables[table].kind.single else column


def _compiled_loop(bound: Bound, columns: Sequence[NDArray[Any]]) -> Callable[..., float]:
    """A compiled function of these columns that calls the kernel for each row and adds up what it gives."""
    from numba import njit

    names = [f"c{index}" for index in range(len(columns))]
    scope: dict[str, Any] = {"kernel": bound.function}
    arguments = [
        f"({n}[i, 0], {n}[i, 1])" if c.ndim > 1 else f"{n}[i]" for n, c in zip(names, columns, strict=True)
    ]
    if bound.each == "loads":
        scope["values"] = bound.arrays[f"{bound.prefix}_values"]
        arguments.insert(1, "values")
    pair = bound.each in ("particles", "")
    lines = [
        f"def loop({', '.join(names)}):",
        "    total = 0.0",
        f"    for i in range({CALLS}):",
        f"        made = kernel({', '.join(arguments)})",
        f"        total += {'made[0] + made[1]' if pair else 'made'}",
        "    return total",
    ]
    exec("\n".join(lines), scope)
    loop: Callable[..., float] = njit(error_model="numpy")(scope["loop"])
    return loop


def _seconds(loop: Callable[..., float], columns: Sequence[NDArray[Any]]) -> float:
    loop(*columns)
    started = time.perf_counter()
    loop(*columns)
    return time.perf_counter() - started


def in_turn(systems: Sequence[StepSystem], model: Model) -> Iterator[tuple[StepSystem, Numbers]]:
    """Each law and commit with what its kernel gives for each row, in the order of the step program."""
    rows = KernelRows(model)
    bound = [bind(system, model) for system in systems if isinstance(system, Law | Commit)]
    laws = sorted((b for b in bound if b.each), key=lambda b: b.system.name)
    commits = [b for b in bound if not b.each]
    late = [b for b in commits if "axial_force" in b.parameters]
    first = [b for b in laws if b.each != "rods"] + [b for b in commits if b not in late]
    summed = [b for b in laws if b.each == "rods" and not {"rate", "axial_force"} & set(b.parameters)]
    replacing = [b for b in bound if b.each == "rods" and b.replaces]
    rates = [b for b in laws if b.each == "rods" and "rate" in b.parameters]
    for b in (*first, *summed, *replacing, *late, *rates):
        given = rows.of(b)
        yield b.system, given
        if b in summed:
            rows.provided["axial_force"] = rows.provided["axial_force"] + given[:, 0]
        elif b in replacing:
            rows.provided["axial_force"] = given[:, 0]


def _geometry(model: Model) -> Mapping[str, Numbers]:
    """Elongation (m) and its rate (m/s) of every rod."""
    rods, particles = model.rods, model.particles
    shift = particles.displacement[rods.between[:, 1]] - particles.displacement[rods.between[:, 0]]
    drift = particles.velocity[rods.between[:, 1]] - particles.velocity[rods.between[:, 0]]
    now = rods.difference + shift
    length = np.hypot(now[:, 0], now[:, 1])
    both = length + rods.original_length
    with np.errstate(divide="ignore", invalid="ignore"):
        stretch = np.where(both > 0.0, ((rods.difference + now) * shift).sum(axis=1) / both, 0.0)
        rate = np.where(length > 0.0, (drift * now).sum(axis=1) / length, 0.0)
    return {"elongation": stretch + rods.misfit, "rate": rate}
