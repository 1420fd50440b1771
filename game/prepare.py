"""Compile ahead of need: `python -m game.prepare UNIT…`, or `… INTEGRATOR FORM [warm] SYSTEM…` for a step program.

The window runs this in another process, because a compiler in its own would hold it up, in a thread too.
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Sequence

from components.model import Model
from components.particle import Particle
from components.rod import spawn_rods
from game import Session
from game.commands.with_mods import load_as_asked
from systems.base import Integrator, StepSystem
from systems.collision.driven.compiled import DRIVEN
from systems.collision.free.discs import EVENTS, HORIZONS, PILES
from systems.edit.pull import Hand
from systems.physics.integrators import INTEGRATORS
from systems.program.compiler import forget_unused
from systems.program.parallel import make_program
from systems.program.program import has_program
from systems.render.raster import RASTER

UNITS = {unit.name: unit for unit in (RASTER, EVENTS, HORIZONS, PILES, DRIVEN)}
WARM = "warm"  # the program is for rods whose temperature may have changed

Job = tuple[str, ...]  # names of units, or a step program: integrator, form, perhaps WARM, systems


def main(words: Sequence[str]) -> None:
    """Compile units or a step program into the cache."""
    job = tuple(load_as_asked(words))
    if job[0] in UNITS:
        for name in job:
            UNITS[name].load()
    else:
        load_program(job)
    forget_unused()


def load_program(job: Job) -> None:
    """Load a step program, compiled first if nobody has."""
    session, plan, integrator, form = _example(job)
    make_program(session.model, plan, integrator, form).load()


def is_prepared(job: Job) -> bool:
    """True if a step program need only be loaded."""
    session, plan, integrator, form = _example(job)
    return has_program(session.model, plan, integrator, form)


def _example(job: Job) -> tuple[Session, list[StepSystem], Integrator, str]:
    """The smallest model with a step program, and its plan, integrator and form."""
    name, form, *systems = job
    model = Model()
    first, second = model.create(Particle, 2, position=[[0.0, 0.0], [1.0, 0.0]])
    if WARM in systems:
        systems.remove(WARM)
        spawn_rods(model, [[first.row, second.row]], temperature_change=1.0)
    session = Session(model)
    session.pull.take(Hand(first, 1.0, 0.0, (0.0, 0.0)))  # in case the hand is part of the program
    return session, session.schedule.named(systems), INTEGRATORS[name], form


if __name__ == "__main__":
    gc.disable()  # looking through all that the compiler makes would take a fifth of the time
    main(sys.argv[1:])
