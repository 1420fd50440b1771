"""Kernels: functions of numbers and arrays that have two forms, plain Python and machine code, with the same bits.

A kernel is declared by one of these decorators; declaring needs no compiler.

    compiled   a kernel that may also be called from Python, and tested, by itself
    part       a kernel that only other kernels call
    kept       a function of a generated module, that calls kernels, whose machine code is kept on disk
    entry      one by which Python enters a program that consists of parts
    shared     one with a loop that cores share

All of them: IEEE division (no exceptions), no fastmath, so that the same input gives the same bits. The plain form is
in systems/interpreter.py, machine code in systems/machine_code.py.
"""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable
from enum import Enum
from functools import cached_property, partial, update_wrapper
from types import ModuleType
from typing import Any

PLAIN = os.environ.get("PINJOINT_PLAIN_NUMBA", "") == "1"


class Use(Enum):
    """How a kernel is reached, which decides how it is compiled."""

    BY_ITSELF = "compiled"
    PART = "part"
    KEPT = "kept"
    ENTRY = "entry"
    SHARED = "shared"


class Kernel:
    """A function that can be interpreted, or compiled to machine code.

    py_func: what was declared. targetoptions: of numba. signature: the types that it is compiled for, if declared.
    """

    def __init__(self, function: Callable[..., Any], use: Use, signature: str = "", **options: Any) -> None:
        self.py_func = function
        self.use = use
        self.signature = signature
        self.targetoptions = options
        update_wrapper(self, function)

    @cached_property
    def interpreted(self) -> Callable[..., Any]:
        """The plain form, to be called with arrays."""
        from systems.interpreter import interpreted

        return interpreted(self)

    @cached_property
    def machine(self) -> Callable[..., Any]:
        """The compiled form; what calls it first has it compiled, or loaded from the cache."""
        from systems.machine_code import dispatcher_of

        dispatcher: Callable[..., Any] = dispatcher_of(self)
        return dispatcher

    def __call__(self, *given: Any) -> Any:
        """Compute, interpreted."""
        return self.interpreted(*given)


def _declared(use: Use, signature: str = "", **options: Any) -> Callable[[Callable[..., Any]], Kernel]:
    return partial(Kernel, use=use, signature=signature, error_model="numpy", **options)


compiled = _declared(Use.BY_ITSELF)


def part(**options: Any) -> Callable[[Callable[..., Any]], Kernel]:
    """A decorator like `compiled`, with further options of numba, for functions that only compiled ones call."""
    return _declared(Use.PART, **options)


def kept(signature: str = "", **options: Any) -> Callable[[Callable[..., Any]], Kernel]:
    """A decorator like `compiled`, for functions of generated modules.

    signature: compile for it at once, and never for another.
    """
    return _declared(Use.KEPT, signature, **options)


def entry(**options: Any) -> Callable[[Callable[..., Any]], Kernel]:
    """A decorator like `compiled`, with further options, for functions by which Python enters a program of parts."""
    return _declared(Use.ENTRY, **options)


def shared() -> Callable[[Callable[..., Any]], Kernel]:
    """A decorator like `compiled`, for functions whose loops over a `prange` are shared among cores."""
    return _declared(Use.SHARED)


prange = range


def plain_function(function: Callable[..., Any]) -> Callable[..., Any]:
    """What a kernel, or a function that numba's own decorators made, was declared as; other functions as they are."""
    return getattr(function, "py_func", function)


def used_by(plain: Callable[..., Any]) -> dict[str, Any]:
    """The names that a function takes from outside: closure, globals, and attributes of modules among these."""
    outside = inspect.getclosurevars(plain)
    used: dict[str, Any] = {**outside.globals, **outside.nonlocals}
    for name, value in list(used.items()):
        if isinstance(value, ModuleType):
            names = plain.__code__.co_names
            used |= {f"{name}.{n}": getattr(value, n) for n in names if hasattr(value, n)}
    return used
