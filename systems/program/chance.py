"""Chance: kernels that draw random numbers, of which no run could be repeated."""

from __future__ import annotations

import inspect
import random
from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np

from systems.kernels import plain_function

_MODULES = (random, np.random)
_GENERATORS = (random.Random, np.random.RandomState, np.random.Generator)


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
                if any(found is module for module in _MODULES) or isinstance(
                    getattr(found, "__self__", found), _GENERATORS
                ):
                    return called
                if hasattr(found, "py_func"):
                    pending.append(found)
    return ""
