"""Compile ahead of need: `python -m game.prepare DRIVER FORM SYSTEM…` for a step program, `… free_flight` and
`… windows_and_piles` for collisions of free particles, `… encounters` for those of others, or `… raster` for drawing.

The window runs this in another process, because a compiler in its own would hold it up, in a thread too.
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Sequence

from components.model import Model
from components.particle import Particle
from game.catalogue import DRIVERS
from game.collisions.encounters import load_encounters
from game.collisions.flight_kernels import EVENTS, PILES, WINDOWS, load_part
from game.mods.command import load_as_asked
from game.program.cache import forget_unused
from game.program.in_blocks import make_program
from game.raster_program import load_raster
from game.session import Session
from systems.edit.pull import Hand

RASTER, FLIGHT, PILING, ENCOUNTERS = "raster", "free_flight", "windows_and_piles", "encounters"


def main(words: Sequence[str]) -> None:
    """Compile what is asked for into the cache."""
    name, *rest = load_as_asked(words)
    if name == RASTER:
        load_raster()
    elif name == FLIGHT:
        load_part(EVENTS)
    elif name == PILING:
        load_part(WINDOWS)
        load_part(PILES)
    elif name == ENCOUNTERS:
        load_encounters()
    else:
        model = Model()
        (particle,) = model.create(Particle, 1)
        session = Session(model)
        session.pull.take(Hand(particle, 1.0, 0.0, (0.0, 0.0)))  # in case that the hand is part of it
        form, *systems = rest
        make_program(model, session.schedule.named(systems), DRIVERS[name], form)
    forget_unused()


if __name__ == "__main__":
    gc.disable()  # looking through all that the compiler makes would take a fifth of the time
    main(sys.argv[1:])
