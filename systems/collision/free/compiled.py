"""The compiled parts of the engine of flight: each is a program of its own, so that two are compiled at once.

`fly` lets events happen, `open_horizon` finds the impacts to come, `take_steps` moves piles (formed only
by particles under forces).
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import cache
from types import ModuleType
from typing import Any

from systems.collision.columns import Count
from systems.collision.free.discs import Discs
from systems.program.compiler import compile_module, is_compiled, note_compiled

EVENTS, HORIZONS, PILES = "fly", "open_horizon", "take_steps"

_SOURCE = '''\
"""A part of the engine of collisions. Generated; safe to delete."""

from numba import njit

entry = njit(error_model="numpy", _nrt=False, cache=True)


@entry
def {part}({arguments}):
    return kernel({arguments})
'''


def _program(part: str) -> tuple[str, dict[str, Callable[..., int]]]:
    """Source of a part, and what it calls."""
    from systems.collision.kernels.flight import fly, take_steps
    from systems.collision.kernels.horizon import open_horizon

    kernel = {EVENTS: fly, HORIZONS: open_horizon, PILES: take_steps}[part]
    arguments = ", ".join(inspect.signature(kernel.py_func).parameters)
    return _SOURCE.format(part=part, arguments=arguments), {"kernel": kernel}


@cache
def _module(part: str) -> ModuleType:
    return compile_module(*_program(part))


def has_parts(*parts: str) -> bool:
    """True if these parts need not be compiled any more, only loaded."""
    return all(is_compiled(*_program(part)) for part in parts)


@cache
def load_part(part: str) -> None:
    """Have a part called once: it is compiled then, or loaded from the cache."""
    discs = engine()([[0.0, 0.0]], [[0.0, 0.0]], [1.0], [[1.0, 1.0]])
    if part == HORIZONS:
        discs.open_horizon(discs.rows, discs.grid, discs.constraints, discs.queue, discs.numbers, discs.counts)
    else:
        discs.counts[Count.RENEW], discs.counts[Count.STEPPING] = 0, part == PILES
        discs.advance(discs.now - float(part == PILES))  # before the first step of a pile
    note_compiled(_module(part))


@cache
def engine() -> type[Discs]:
    """Discs whose parts are compiled once and for all; each by its first call, unless it is loaded before."""
    kernels: dict[str, Any] = {part: _module(part) for part in (EVENTS, HORIZONS, PILES)}
    return type("Compiled", (Discs,), {part: staticmethod(getattr(kernels[part], part)) for part in kernels})
