"""Step programs of batches: a loop over variants that calls the compiled step program of a single run."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import Column
from pinjoint.sweeps.batched_model import BatchedModel
from pinjoint.systems.program.binding import bind
from pinjoint.systems.program.compiler import generated
from pinjoint.systems.program.program import Program

# One for all variants, besides what is written anew for each.
_SHARED = "fresh", "breaks", "until", "landing", "loads_end"
_RETURNS = {"advance": "taken[k], reason[k] = "}
_KEPT = {"observe": ("force",)}
_ALL, _FIRST = slice(None), np.zeros(1, dtype=np.intp)
_PIECES = 4  # for each thread, so that none waits long for another


class BatchProgram:
    """The compiled functions of a step program, called for one variant of a batched model after the other.

    Variants are independent: they are shared out among threads, and results do not depend on how many.

    varied_arrays: arrays of systems differ between variants.
    """

    def __init__(self, program: Program, threads: int, *, varied_arrays: bool = False) -> None:
        self.program = program
        self._varied = varied_arrays
        self.integrator = program.integrator
        self.threads = threads
        self._columns = program.columns
        functions = program.module.functions
        self._entries: dict[str, Callable[..., Any]] = {}
        for name in ("advance", "observe", "commit"):
            if name in functions:
                self._entries[name] = functions[name]
        self.has_history = "commit" in self._entries
        self._scratch_shapes = program.scratch
        self._parameters = {
            name: tuple(inspect.signature(entry).parameters) for name, entry in self._entries.items()
        }
        self._module = generated("the program of variants", self._source(), self._entries)

    def _scratch(self, entry: str) -> dict[str, tuple[int, ...]]:
        """Shapes of the arrays that an entry writes and nobody reads; observed forces are kept for each variant."""
        kept = _KEPT.get(entry, ())
        return {name: shape for name, shape in self._scratch_shapes.items() if name not in kept}

    def _source(self) -> str:
        lines = [
            '"""A step program for variants. Generated; safe to delete."""',
            "",
            "from pinjoint.systems.kernels import kept",
            "",
        ]
        for name, parameters in self._parameters.items():
            one_for_all = (*_SHARED, *self._scratch(name))
            arguments = [p if p in one_for_all else f"{p}[k]" for p in parameters]
            lines += [
                "@kept(nogil=True)",
                f"def {name}_each(variants, taken, reason, {', '.join(parameters)}):",
                "    for k in variants:",
                f"        {_RETURNS.get(name, '')}{name}({', '.join(arguments)})",
                "",
            ]
        return "\n".join(lines)

    def columns(self, model: BatchedModel) -> dict[str, Column]:
        """The columns that the compiled functions end with, by name."""
        made: dict[str, Column] = {}
        for name, bound in self._columns.items():
            table, _, column = name.partition("_")
            key = f"{table}.{column}"
            if model.has(key):
                made[name] = model[key]
            elif not self._varied:
                made[name] = np.repeat(bound[None], model.variants, axis=0)
        if self._varied:
            made |= self._arrays(model)
        for name, bound in self._columns.items():
            made[name] = made[name].view()
            made[name].flags.writeable = bound.flags.writeable
        return made

    def _arrays(self, model: BatchedModel) -> dict[str, Column]:
        """The arrays of the systems, made for each variant."""
        variants = [model.part(np.array([variant])).as_model() for variant in range(model.variants)]
        each = [
            {n: a for system in self.program.systems for n, a in bind(system, variant).stored_arrays.items()}
            for variant in variants
        ]
        return {name: np.array([arrays[name] for arrays in each]) for name in each[0]}

    def call(
        self, entry: str, variants: NDArray[np.intp], arguments: Mapping[str, Any], count: int
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Call an entry for some of `count` variants; returns the steps taken by each, and the reasons to stop.

        arguments: by name of the parameter, with one entry for each variant, but for those of all.
        """
        taken, reason = np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64)

        names = self._parameters[entry]

        def each(some: NDArray[np.intp], rows: slice = _ALL) -> None:
            scratch = {name: np.zeros(shape) for name, shape in self._scratch(entry).items()}
            given = scratch | {
                p: arguments[p] if p in _SHARED else arguments[p][rows] for p in names if p not in scratch
            }
            call = getattr(self._module.form, f"{entry}_each")
            call(some, taken[rows], reason[rows], *(given[p] for p in names))

        if not self._module.is_loaded:  # one by one, none with the arrays of others: machine code may follow
            for variant in variants.tolist():
                each(_FIRST, slice(variant, variant + 1))
            return taken, reason
        pieces = 1 if len(variants) < 2 * self.threads else self.threads * _PIECES
        self._share_out(each, np.array_split(variants, pieces))
        return taken, reason

    def _share_out(self, work: Callable[[NDArray[np.intp]], None], pieces: Sequence[NDArray[np.intp]]) -> None:
        """Let threads do the work on each piece."""
        if self.threads == 1 or len(pieces) == 1:
            for piece in pieces:
                work(piece)
        else:
            with ThreadPoolExecutor(self.threads) as pool:
                list(pool.map(work, pieces))
