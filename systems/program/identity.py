"""The identity of generated modules: all that decides what machine code of them does, as a name in the cache."""

from __future__ import annotations

import hashlib
import importlib.metadata
import inspect
import os
import platform
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from enum import IntEnum
from functools import cache
from types import CodeType, ModuleType
from typing import Any

import numpy as np

from pinjoint.systems.program.interpreter import plain_function
from pinjoint.systems.program.kernel import PLAIN

_LAYOUT = 10  # of what is kept on disk: raise it where former files are of no use any more


def meaning_of(functions: Iterable[Callable[..., Any]]) -> str:
    """All that decides what these compiled functions compute: code, options, what they refer to or call.

    Read from the functions in memory: their files may have changed since they were imported.
    """
    parts: list[str] = []
    for function in reached_from(functions):
        if isinstance(function, type):
            parts.append(_constant(function))
            continue
        plain = plain_function(function)
        parts += [
            f"{plain.__module__}.{plain.__qualname__}",
            repr(getattr(function, "targetoptions", {})),
            _described(plain.__code__),
            *(f"{name} = {_constant(value)}" for name, value in sorted(used_by(plain).items())),
        ]
    return "\n".join(parts)


def reached_from(functions: Iterable[Callable[..., Any]]) -> Iterator[Callable[..., Any]]:
    """These functions and all compiled ones that they call, each once."""
    pending, seen = [function for function in functions if callable(function)], set[Callable[..., Any]]()
    while pending:
        function = pending.pop()
        if function not in seen:
            seen.add(function)
            yield function
            if not isinstance(function, type):
                used = used_by(plain_function(function))
                pending += [value for _, value in sorted(used.items()) if hasattr(value, "py_func")]


def used_by(plain: Callable[..., Any]) -> dict[str, Any]:
    """The names that a function takes from outside: closure, globals, and attributes of modules among these."""
    outside = inspect.getclosurevars(plain)
    used: dict[str, Any] = {**outside.globals, **outside.nonlocals}
    for name, value in list(used.items()):
        if isinstance(value, ModuleType):
            names = plain.__code__.co_names
            used |= {f"{name}.{n}": getattr(value, n) for n in names if hasattr(value, n)}
    return used


def _described(code: CodeType) -> str:
    constants = [_described(c) if isinstance(c, CodeType) else repr(c) for c in code.co_consts]
    return repr((code.co_code, code.co_names, code.co_varnames, constants))


def _constant(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return repr((value.dtype.str, value.shape, value.tobytes()))
    if isinstance(value, type) and issubclass(value, IntEnum):
        return repr((value.__name__, [(member.name, member.value) for member in value]))
    if isinstance(value, tuple):  # of arrays, too, whose own words leave out most of what is long
        return f"{type(value).__name__}{getattr(value, '_fields', '')}({', '.join(map(_constant, value))})"
    plain = isinstance(value, bool | int | float | complex | str | None | np.generic)
    return repr(value) if plain else type(value).__name__


def key_of(source: str, kernels: Mapping[str, Callable[..., Any]]) -> str:
    """numba's own cache would notice neither edits of functions that a cached one calls, nor another processor."""
    meaning = meaning_of(kernels[name] for name in sorted(kernels))
    constants = [
        f"{name} = {_constant(value)}" for name, value in sorted(kernels.items()) if not callable(value)
    ]
    about = source, meaning, *constants, *_circumstances(), f"plain: {PLAIN}", f"layout: {_LAYOUT}"
    return "pinjoint_program_" + hashlib.sha256("\n".join(about).encode()).hexdigest()[:24]


@cache
def _circumstances() -> tuple[str, ...]:
    """What else machine code depends on: compiler, interpreter, and processor, as far as is known without the compiler."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8", errors="replace") as file:
            lines = file.read(8192).splitlines()
        processor = [line for line in lines if line.startswith(("model name", "flags", "Features"))][:2]
    except OSError:
        processor = [platform.processor()]
    try:
        compiler = importlib.metadata.version("numba")
    except importlib.metadata.PackageNotFoundError:
        compiler = ""
    bounds = f"bounds are checked: {os.environ.get('NUMBA_BOUNDSCHECK', '')}"
    return compiler, sys.version, platform.machine(), bounds, *processor
