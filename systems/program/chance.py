"""Chance: kernels that draw random numbers, of which no run could be repeated."""

from __future__ import annotations

import inspect
import random
import sys
from collections.abc import Callable
from types import ModuleType
from typing import Any

from pinjoint.systems.interpreter import plain_function

_MODULES = ("random", "numpy.random")


def _generators() -> tuple[type, ...]:
    """The kinds of generators that there can be; importing numpy's, which takes 10 ms, is left to who uses them."""
    numpy = sys.modules.get("numpy.random")
    return (random.Random, *((numpy.RandomState, numpy.Generator) if numpy is not None else ()))


def _draws(found: Any) -> bool:
    """Whether a module, a generator or a method of one draws random numbers."""
    if isinstance(found, ModuleType):
        return found.__name__ in _MODULES
    return isinstance(getattr(found, "__self__", found), _generators())


def source_of_chance(kernel: Callable[..., Any]) -> str:
    """The first thing by which a compiled function, or one that it calls, draws random numbers; "" if there is none."""
    pending, seen = [kernel], set[int]()
    while pending:
        function = pending.pop()
        if id(function) in seen:
            continue
        seen.add(id(function))
        plain = plain_function(function)
        if not inspect.isfunction(plain):
            continue
        outside = inspect.getclosurevars(plain)
        for name, value in {**outside.globals, **outside.nonlocals}.items():
            attributes = plain.__code__.co_names if isinstance(value, ModuleType) else ()
            inside = {f"{name}.{n}": getattr(value, n) for n in attributes if hasattr(value, n)}
            for called, found in {name: value, **inside}.items():
                if _draws(found):
                    return called
                if hasattr(found, "py_func"):
                    pending.append(found)
    return ""
