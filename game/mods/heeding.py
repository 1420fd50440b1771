"""Heeding: what follows where a mod fails: a run without its laws is not the one that a script asked for."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from pinjoint.components import written
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import joined, tr
from pinjoint.mods.mod import Mod, ModError
from pinjoint.systems.run.simulation import Simulation


def switched_off() -> list[Mod]:
    """The mods that were loaded and failed since."""
    return [mod for mod in EXTENSIONS.mods if mod.loaded and mod.off]


def check_mods(known: list[Mod] | None = None, time: float | None = None) -> None:
    """Raise ModError if a mod failed, besides those that are known to. time: where a run stopped therefore (s)."""
    for mod in switched_off():
        if mod not in (known or []):
            said = tr("The mod '{name}' was switched off: {problem}", name=mod.name, problem=mod.problem)
            stopped = "" if time is None else tr("The run stopped at t = {time}.", time=written.time(time))
            raise ModError(joined([said, stopped]))


def blamed_on_mod(error: BaseException) -> bool:
    """Switch off the mod from whose code an error came past all guards; False if it came from no mod's."""
    for mod in EXTENSIONS.mods:
        if mod.loaded and not mod.off and mod.place_of(error):
            mod.fail(tr("code that the program called"), error)
            return True
    return False


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
