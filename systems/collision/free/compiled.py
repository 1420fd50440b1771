"""The compiled units of free flight; each is a module of its own, so that two processes can compile two at once.

EVENTS lets events happen, HORIZONS finds the impacts to come, PILES takes the steps of piles, which only a hand that
pulls, or gravity, forms.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any

from systems.collision.columns import Count
from systems.collision.free.discs import Discs
from systems.program.compiler import CompiledUnit, entries_to


def _contents(name: str) -> tuple[str, dict[str, Callable[..., Any]]]:
    from systems.collision.kernels import flight, horizon

    return entries_to({name: horizon.open_horizon if name == "open_horizon" else getattr(flight, name)})


def _warm_up(name: str) -> None:
    discs = engine()([[0.0, 0.0]], [[0.0, 0.0]], [1.0], [[1.0, 1.0]])
    if name == "open_horizon":
        discs.open_horizon(discs.rows, discs.grid, discs.constraints, discs.queue, discs.numbers, discs.counts)
    else:
        steps = name == "take_steps"
        discs.counts[Count.RENEW], discs.counts[Count.STEPPING] = 0, steps
        discs.advance(discs.now - float(steps))  # before the first step of a pile


def _unit(name: str) -> CompiledUnit:
    return CompiledUnit(name, partial(_contents, name), partial(_warm_up, name))


EVENTS, HORIZONS, PILES = _unit("fly"), _unit("open_horizon"), _unit("take_steps")


@cache
def engine() -> type[Discs]:
    """Discs whose kernels are compiled; each by its first call, unless its unit was loaded before."""
    kernels: dict[str, Any] = {
        unit.name: staticmethod(getattr(unit.module, unit.name)) for unit in (EVENTS, HORIZONS, PILES)
    }
    return type("Compiled", (Discs,), kernels)
