"""Lane programs: a step program for many blocks of a stack side by side; see game/sweeps/lanes.py."""

from __future__ import annotations

import ast
import importlib
import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from types import FunctionType, ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from components.field import Column
from game.sweeps.lanes import LaneFunction, functions, head, is_common
from systems.program.compiler import compile_module, note_compiled
from systems.program.program import Program

_NUMBERS = ("steps", "total", "first", "origin", "tolerance", "limit", "dt")  # one for each block
_SHARED = ("breaks", "until", "landing", "loads_end")
_CARRIED = ("control", "displacement", "velocity", "account")  # what steps change, besides what commits write
_MEASURES = 16
_PACK = "packed_float64"  # what steps change lies in its first rows
_ROWS = 6  # of numbers that the loop keeps for each lane


class LaneProgram:
    """Lets up to so many blocks take steps at a time, with the bits that `advance` of a step program gives each.

    scratch: shapes of what a step program writes to and nobody else reads.
    """

    def __init__(self, program: Program, scratch: Mapping[str, tuple[int, ...]], lanes: int) -> None:
        self._lanes = lanes
        self._columns = list(program.columns)
        self._given = _parameters(program.module.advance.py_func)
        self._single = [p for p in self._given if p not in (*_NUMBERS, *_SHARED, "fresh")]
        self._carried = (*(name for name in _CARRIED if name in self._single), *program.written)
        self._scratch = {**scratch, "measures": (_MEASURES,)}
        self._packs = self._packed(program)
        loop = importlib.import_module(program.integrator.side_by_side)
        self._loop = _sources(loop)
        self._parameters = self._parameters_of_loop()
        known = functions(program.source)
        self._functions = _for_lanes(known, loop.VARYING, vars(program.module))
        source = [head(program.source), f"LANES = {lanes}\napart = part(apart=True)"]
        source += [ast.unparse(known[name]) for name in loop.AS_THEY_ARE]
        source += [function.source for function in self._functions]
        source += [self._alone(), *self._aside(), *self._pasted()]
        called = {**program.names, "single": program.module.advance}
        self._module = compile_module("\n\n".join(source) + "\n", called)

    # --- source ---------------------------------------------------------------------------------------

    def _packed(self, program: Program) -> dict[str, list[str]]:
        """Arrays that lie together, by the name of what they lie in: one copy is quicker, and compiled sooner.

        All of one kind do, of numbers those first that steps change.
        """
        packs: dict[str, list[str]] = {_PACK: list(self._carried)}
        for name, column in program.columns.items():
            if not (is_common(name) or name in self._carried):
                packs.setdefault(f"packed_{column.dtype.name}", []).append(name)
        return packs

    @property
    def _takes(self) -> list[str]:
        """What alone() takes at last."""
        return ["kept", *self._packs, *map(_copied, self._packs), *map(_copied, self._single)]

    def _pasted(self) -> list[str]:
        """The driver's loop for lanes, with the columns for *columns."""
        columns, single = ", ".join(self._columns), ", ".join(self._takes)
        texts = {"*columns": columns, "*single": single, "*everything": f"{columns}, {single}"}
        parts = []
        for name, source in self._loop.items():
            for star, text in texts.items():
                source = source.replace(star, text)
            parts.append(f"@{'entry(nogil=True)' if name == 'advance' else 'compiled'}\n{source}")
        return parts

    def _parameters_of_loop(self) -> list[str]:
        own = ast.parse(self._loop["advance"]).body[0]
        assert isinstance(own, ast.FunctionDef)
        return [*(argument.arg for argument in own.args.args), *self._columns, *self._takes]

    def _alone(self) -> str:
        """A step of one lane by the program of a single run, on copies of its numbers."""
        so_far = {p: f"{p}[lane] + taken[lane]" for p in ("total", "first")}
        given = {p: f"{p}[lane]" for p in _NUMBERS} | {p: p for p in _SHARED} | so_far
        given |= {p: _copied(p) for p in self._single} | {"steps": "1", "fresh": "False"}
        taken_over = [p for p in self._given if p in (*_NUMBERS, *_SHARED) and p != "steps"]
        lines = [
            f"def alone(lane, {', '.join((*taken_over, 'taken', *self._takes))}):",
            *(
                f"    for k in range({pack}.shape[0]):\n        {_copied(pack)}[k] = {pack}[k, lane]"
                for pack in self._packs
            ),
            f"    done, why = single({', '.join(given[p] for p in self._given)})",
            *self._each_carried(f"{_PACK}[k, lane] = {_copied(_PACK)}[k]"),
            "    return done, why",
        ]
        return "@compiled\n" + "\n".join(lines)

    def _aside(self) -> list[str]:
        """Functions that put aside what steps change of a lane, and that put it back."""
        return [
            "\n".join(["@compiled", f"def {name}(lane, {', '.join(self._takes)}):", *self._each_carried(line)])
            for name, line in [
                ("keep", f"kept[k, lane] = {_PACK}[k, lane]"),
                ("restore", f"{_PACK}[k, lane] = kept[k, lane]"),
            ]
        ]

    @staticmethod
    def _each_carried(line: str) -> list[str]:
        return ["    for k in range(kept.shape[0]):", f"        {line}"]

    # --- calling it -----------------------------------------------------------------------------------

    def advance(
        self,
        blocks: NDArray[np.intp],
        arguments: Mapping[str, Any],
        taken: NDArray[np.int64],
        reason: NDArray[np.int64],
    ) -> None:
        """Let these blocks take steps; `arguments` of all blocks by name, results into the other arrays.

        Some may take fewer than they should although nothing stops them, so that others can join them.
        """
        count = self._lanes
        lanes = np.resize(blocks, count)
        given = {name: arguments[name] for name in _SHARED if name in self._given}
        given |= {name: arguments[name][lanes] for name in _NUMBERS if name in self._given}
        for pack, names in self._packs.items():
            given |= self._laid_out(pack, [(name, arguments[name]) for name in names], lanes)
        for name in filter(is_common, self._columns):
            given[name] = given[_copied(name)] = arguments[name][lanes[0]]
        for name, shape in self._scratch.items():
            given[name], given[_copied(name)] = np.zeros((*shape, count)), np.zeros(shape)
        given["kept"] = np.zeros((sum(given[_copied(name)].size for name in self._carried), count))
        given["spare"] = np.zeros((max(f.spares for f in self._functions), count))
        given["numbers"] = np.zeros((_ROWS, count))
        going = (np.arange(count) < len(blocks)) & (given["steps"] > 0)
        given["plain"], given["going"] = np.zeros(count, dtype=bool), going
        given |= {name: np.zeros(count, dtype=np.int64) for name in ("coming", "taken", "reason")}
        self._module.advance(*(given[name] for name in self._parameters))
        note_compiled(self._module)
        for name in self._carried:
            arguments[name][blocks] = np.moveaxis(given[name], -1, 0)[: len(blocks)]
        taken[blocks], reason[blocks] = given["taken"][: len(blocks)], given["reason"][: len(blocks)]

    def _laid_out(
        self, pack: str, arrays: Sequence[tuple[str, Column]], lanes: NDArray[np.intp]
    ) -> dict[str, Column]:
        """Arrays of these blocks as lanes in one array, room for a copy of one of them in another, and views."""
        sizes = [math.prod(array.shape[1:]) for _, array in arrays]
        together = np.empty((sum(sizes), len(lanes)), dtype=arrays[0][1].dtype)
        single = np.empty(sum(sizes), dtype=together.dtype)
        made = {pack: together, _copied(pack): single}
        ends = np.cumsum(sizes).tolist()
        for (name, array), size, end in zip(arrays, sizes, ends, strict=True):
            shape = array.shape[1:]
            made[name] = together[end - size : end].reshape(*shape, len(lanes))
            made[name][...] = np.moveaxis(array[lanes], 0, -1)
            made[_copied(name)] = single[end - size : end].reshape(shape)
            made[_copied(name)].flags.writeable = array.flags.writeable
        return made


def _copied(name: str) -> str:
    """What an array is called of which alone() has a copy for one lane."""
    return f"{name}_alone"


def _parameters(function: Callable[..., Any]) -> list[str]:
    return list(inspect.signature(function).parameters)


def _sources(module: ModuleType) -> dict[str, str]:
    """The functions of a module, in order, by name."""
    found = [f for f in vars(module).values() if isinstance(f, FunctionType)]
    return {function.__name__: inspect.getsource(function) for function in found}


def _for_lanes(
    known: Mapping[str, ast.FunctionDef], varying: Mapping[str, Sequence[str]], constants: Mapping[str, Any]
) -> list[LaneFunction]:
    """Functions of a program, by name, for lanes; `varying`: in which order, and which numbers each lane has."""
    chosen = {name: value for name, value in constants.items() if name.isupper() and isinstance(value, int)}
    made: dict[str, LaneFunction] = {}
    for name in varying:
        if name in known:
            made[name] = LaneFunction(known[name], varying[name], made, chosen)
    return list(made.values())
