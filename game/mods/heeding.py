"""Heeding: a run that goes on without the laws of a mod which failed is not the one that a script asked for."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from game.mods.loading import MODS
from game.mods.mod import Mod, ModError
from systems.run.simulation import Simulation


def switched_off() -> list[Mod]:
    """The mods that were loaded and failed since."""
    return [mod for mod in MODS if mod.loaded and mod.off]


def check_mods(known: list[Mod] | None = None, time: float | None = None) -> None:
    """Raise ModError if a mod failed, besides those that are known to. time: where a run stopped therefore (s)."""
    for mod in switched_off():
        if mod not in (known or []):
            stopped = "" if time is None else f" The run stopped at t = {time:.6g} s."
            raise ModError(f"The mod '{mod.name}' was switched off: {mod.problem}{stopped}")


@contextmanager
def heeding_mods(simulation: Simulation) -> Iterator[None]:
    """A run inside the `with` stops, by ModError, before the first step without a mod that failed meanwhile."""
    known = switched_off()

    def heed() -> int:
        check_mods(known, simulation.model.clock.time)
        return sys.maxsize

    simulation.before_steps.append(heed)
    try:
        yield
    finally:
        simulation.before_steps.remove(heed)
    heed()
