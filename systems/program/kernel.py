"""Kernels: functions of numbers and arrays that have two forms, plain Python and machine code, with the same bits.

A kernel is declared by one of these decorators; declaring needs no compiler.

    compiled   a kernel, which others call; it may also be called from Python, and tested, by itself
    part       the same, with further options of numba
    kept       a function by which Python enters a generated module, and the kernels that it calls: its machine code is
               kept on disk
    shared     a kernel whose loops over a `prange` are shared among cores

All of them: IEEE division (no exceptions), no fastmath, so that the same input gives the same bits. The plain form is
in systems/program/interpreter.py, machine code in systems/program/machine_code.py.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from enum import Enum
from functools import cached_property, partial, update_wrapper
from typing import Any

from pinjoint.systems.program.interpreter import interpreted

PLAIN = os.environ.get("PINJOINT_PLAIN_NUMBA", "") == "1"


class Use(Enum):
    """How a kernel is reached, which decides how it is compiled."""

    PART = "compiled"
    KEPT = "kept"
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
        # what numba makes of it, by itself and as a part of others: see machine_code.py
        self.machine: Any = None
        self.machine_part: Any = None
        update_wrapper(self, function)

    @cached_property
    def interpreted(self) -> Callable[..., Any]:
        """The plain form, to be called with arrays."""
        return interpreted(self.py_func)

    def __call__(self, *given: Any, **named: Any) -> Any:
        """Compute, interpreted."""
        return self.interpreted(*given, **named)


def _declared(use: Use, signature: str = "", **options: Any) -> Callable[[Callable[..., Any]], Kernel]:
    return partial(Kernel, use=use, signature=signature, error_model="numpy", **options)


compiled, shared = _declared(Use.PART), _declared(Use.SHARED)


def part(**options: Any) -> Callable[[Callable[..., Any]], Kernel]:
    """A decorator like `compiled`, with further options of numba."""
    return _declared(Use.PART, **options)


def kept(signature: str = "", **options: Any) -> Callable[[Callable[..., Any]], Kernel]:
    """A decorator like `part`, for functions by which Python enters generated modules.

    signature: compile for it at once, and never for another.
    """
    return _declared(Use.KEPT, signature, **options)


prange = range
