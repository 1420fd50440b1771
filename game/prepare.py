"""Compile ahead of need: `python -m game.prepare DRIVER FORM [warm] SYSTEM…` for a step program, `… free_flight PART…`
for collisions of free particles, `… driven` for those of driven particles, or `… raster` for drawing.

The window runs this in another process, because a compiler in its own would hold it up, in a thread too.
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Sequence

from components.model import Model
from components.particle import Particle
from components.rod import spawn_rods
from game.mods.command import load_as_asked
from game.session import Session
from systems.base import Driver, StepSystem
from systems.catalogue import DRIVERS
from systems.collision.driven.stepper import load_driven_collisions
from systems.collision.free.compiled import load_part
from systems.edit.pull import Hand
from systems.program.compiler import forget_unused
from systems.program.parallel import make_program
from systems.program.program import has_program
from systems.render.raster_program import load_raster

RASTER, FLIGHT, DRIVEN = "raster", "free_flight", "driven"
WARM = "warm"  # the program is for rods whose temperature may have changed

Job = tuple[str, ...]  # what to compile, in these words


def main(words: Sequence[str]) -> None:
    """Compile what is asked for into the cache."""
    job = tuple(load_as_asked(words))
    name = job[0]
    if name == RASTER:
        load_raster()
    elif name == FLIGHT:
        for part in job[1:]:
            load_part(part)
    elif name == DRIVEN:
        load_driven_collisions()
    else:
        load_program(job)
    forget_unused()


def load_program(job: Job) -> None:
    """Load the step program that is asked for, after compiling it if nobody has."""
    session, plan, driver, form = _example(job)
    make_program(session.model, plan, driver, form)


def is_prepared(job: Job) -> bool:
    """True if the step program that is asked for need only be loaded."""
    session, plan, driver, form = _example(job)
    return has_program(session.model, plan, driver, form)


def _example(job: Job) -> tuple[Session, list[StepSystem], Driver, str]:
    """The smallest model with the program that is asked for, and its plan, driver and form."""
    name, form, *systems = job
    model = Model()
    first, second = model.create(Particle, 2, position=[[0.0, 0.0], [1.0, 0.0]])
    if WARM in systems:
        systems.remove(WARM)
        spawn_rods(model, [[first.row, second.row]], temperature_change=1.0)
    session = Session(model)
    session.pull.take(Hand(first, 1.0, 0.0, (0.0, 0.0)))  # in case that the hand is part of it
    return session, session.schedule.named(systems), DRIVERS[name], form


if __name__ == "__main__":
    gc.disable()  # looking through all that the compiler makes would take a fifth of the time
    main(sys.argv[1:])
