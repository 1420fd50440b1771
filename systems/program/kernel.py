"""Kernels: functions of numbers and arrays that have two forms, plain Python and machine code, with the same bits.

A kernel is declared by one of these decorators; declaring needs no compiler.

    compiled   a kernel that may also be called from Python, and tested, by itself
    part       a kernel that only other kernels call
    kept       a function of a generated module, that calls kernels, whose machine code is kept on disk
    entry      one by which Python enters a program that consists of parts
    shared     one whose loops over a `prange` are shared among cores

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


compiled, shared = _declared(Use.BY_ITSELF), _declared(Use.SHARED)


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


prange = range
