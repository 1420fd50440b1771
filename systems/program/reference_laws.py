"""Reference laws: what the kernel of each step system gives, row by row, in the present state of a model.

It is the step of a program taken apart, to find which kernel gave a number that is not finite, and to time one.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import Vector
from pinjoint.components.language import marked
from pinjoint.components.model import Model
from pinjoint.components.rod import bends
from pinjoint.systems.base import StepSystem
from pinjoint.systems.program.binding import Bound, ProgramError, StepRole, bind, by_role, written_row
from pinjoint.systems.program.compiler import Choice, Compile, generated
from pinjoint.systems.program.faults import failure_of, form_of, wrong_result
from pinjoint.systems.program.loops import RodLoop
from pinjoint.systems.program.names import DRIFT, SHIFT, SPUN, TURNED
from pinjoint.systems.program.near_pairs import pairs_within
from pinjoint.systems.program.pasting import fragment
from pinjoint.systems.program.templates import rods

Numbers = NDArray[np.float64]

_OF_PAIRS = {
    "apart": ("particles.position", "particles.displacement"),
    "drift": ("particles.velocity",),
}
_OF_RODS = (
    *("between", "difference", "original_length", "misfit"),
    *("rest_length", "turning_shares", "bowing"),
)
_OF_ENDS = ("slope_start", "slope_end", "rate_start", "rate_end")

CALLS, TRIALS = 100_000, 5  # the fastest trial counts


class KernelRows:
    """Calls kernels one row at a time, in the present state of a model.

    Of pairs, turned: the second particle of each comes first; moved: `apart` is longer by this share (x, y) of its length.
    """

    def __init__(self, model: Model, *, turned: bool = False, moved: Vector = (0.0, 0.0)) -> None:
        self.model = model
        self._turned, self._moved = turned, moved
        self.provided: dict[str, Any] = {"time": model.clock.time, "dt": model.clock.step_size}
        self.provided |= _geometry(model)
        self.provided["axial_force"] = np.zeros(model.rods.count)

    def of(self, bound: Bound) -> Numbers:
        """What the kernel gives for each row, shape (rows, results)."""
        called = form_of(bound)
        try:
            rows = [called(*arguments) for arguments in self._arguments(bound)]
        except Exception as error:
            raise ProgramError(failure_of(bound, error), bound.system) from error
        if problem := next(filter(None, (wrong_result(bound, row) for row in rows)), ""):
            raise ProgramError(problem, bound.system)
        return np.array(rows, dtype=np.float64).reshape(len(rows), -1)

    def seconds_per_call(self, bound: Bound) -> float:
        """How long one call takes in a compiled loop over the rows, repeated; the best of several."""
        if not self._count(bound):
            return 0.0
        columns = [np.resize(column, (CALLS, *column.shape[1:])) for column in self._columns(bound)]
        if bound.each == "loads":
            columns.append(bound.arrays[f"{bound.prefix}_values"])
        loop = _compiled_loop(bound, columns)
        return min(_seconds(loop, columns) for _ in range(TRIALS)) / CALLS

    def _arguments(self, bound: Bound) -> Iterator[Sequence[Any]]:
        """The arguments of the kernel, row by row."""
        columns = [list(map(_as_tuples, column.tolist())) for column in self._columns(bound)]
        rows = zip(*columns, strict=True) if columns else [()] * self._count(bound)
        if bound.each == "loads":
            values = bound.arrays[f"{bound.prefix}_values"]
            return ((time, values, first) for time, first in rows)
        return iter(rows)

    def _count(self, bound: Bound) -> int:
        if bound.each == "pairs":
            return len(pairs_within(self.model, bound.cutoff))
        if bound.each == "loads":
            return len(bound.arrays[f"{bound.prefix}_first"])
        return self.model.tables[bound.rows].count

    def _columns(self, bound: Bound) -> list[NDArray[Any]]:
        """One entry a row for each parameter; of a load, the time and where its values begin."""
        count = self._count(bound)
        if bound.each == "loads":
            return [np.full(count, self.provided["time"]), bound.arrays[f"{bound.prefix}_first"]]
        if bound.each == "pairs":
            return [self._of_pairs(bound, parameter) for parameter in bound.parameters]
        return [self._column(bound, parameter, count) for parameter in bound.parameters]

    def apart(self, bound: Bound) -> Numbers:
        """The vectors between the particles of each pair that a law of pairs acts on (m)."""
        return self._of_pairs(bound, "apart")

    def _of_pairs(self, bound: Bound, parameter: str) -> NDArray[Any]:
        """One entry for each pair of particles that a law of pairs acts on."""
        pairs = pairs_within(self.model, bound.cutoff)[:, :: -1 if self._turned else 1]
        if parameter in _OF_PAIRS:
            values = np.sum([self.model.column(name) for name in _OF_PAIRS[parameter]], axis=0)
            between: NDArray[Any] = values[pairs[:, 1]] - values[pairs[:, 0]]
            moved = self._moved if parameter == "apart" else (0.0, 0.0)
            return np.asarray(between + np.hypot(*between.T)[:, None] * moved)
        if parameter in bound.arrays or parameter.startswith("particles_"):
            return self._column(bound, parameter, self.model.particles.count)[pairs]
        return self._column(bound, parameter, len(pairs))

    def _column(self, bound: Bound, parameter: str, count: int) -> NDArray[Any]:
        if parameter in bound.arrays:
            return bound.arrays[parameter]
        if parameter in self.provided:
            return np.broadcast_to(self.provided[parameter], count)
        table, _, name = parameter.partition("_")
        column = self.model.column(f"{table}.{name}")
        return np.repeat(column, count, axis=0) if self.model.tables[table].kind.single else column


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


def _seconds(loop: Callable[..., float], columns: Sequence[NDArray[Any]]) -> float:
    loop(*columns)
    started = time.perf_counter()
    loop(*columns)
    return time.perf_counter() - started


def in_turn(systems: Sequence[StepSystem], model: Model) -> Iterator[tuple[StepSystem, Numbers]]:
    """Each law and commit with what its kernel gives for each row, in the order of the step program."""
    rows = KernelRows(model)
    for role, some in by_role(bind(system, model) for system in systems).items():
        for b in some:
            given = rows.of(b)
            yield b.system, given
            if getattr(b.system, "potential", ""):
                yield b.system, rows.of(bind(b.system, model, "potential"))
            if role is StepRole.SUMMED:
                rows.provided["axial_force"] = rows.provided["axial_force"] + given[:, 0]
            elif role is StepRole.REPLACING:
                rows.provided["axial_force"] = given[:, 0]


def _geometry(model: Model) -> Mapping[str, Numbers]:
    """Elongation (m) and its rate (m/s) of every rod, by the lines that step programs consist of, as plain Python."""
    turns = bends(model)
    names = ("elongation", "rate", *(_OF_ENDS if turns else ()))
    kept = [f"{name}s[r] = {name}" for name in names]
    geometry = [*fragment(rods.geometry, misfit="rods_misfit[r]"), *fragment(rods.rate)]
    geometry += [*fragment(rods.bent), *fragment(rods.slope_rates)] if turns else []
    columns = {f"rods_{name}": model.rods.column(name) for name in _OF_RODS}
    state = {name: model.particles.column(name) for name in ("displacement", "velocity")}
    state |= {name: model.particles.column(name)[:, None] for name in ("rotation", "angular_velocity")}
    found = {f"{name}s": np.zeros(model.rods.count) for name in names}
    gather = SHIFT | DRIFT | (TURNED | SPUN if turns else {})
    with np.errstate(all="ignore"):
        exec(
            "\n".join(RodLoop(gather, [*geometry, *kept]).one_by_one()),
            {"math": math, **columns, **state, **found},
        )
    return {name: found[f"{name}s"] for name in names}
