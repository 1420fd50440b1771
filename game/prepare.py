"""Compile ahead of need: `python -m game.prepare [later] JOB , JOB …`; each job is a unit or a step program.

`UNIT`, or `INTEGRATOR FORM [warm] SYSTEM…` for a step program. The window runs this in another process, because a
compiler in its own would hold it up, in a thread too. A line for each job says why it could not be done, or is empty.
"""

from __future__ import annotations

import gc
import importlib
import os
import sys
from collections.abc import Sequence
from itertools import groupby

from components.language import tr
from components.model import Model
from components.particle import Particle
from components.rod import spawn_rods
from game import Session
from game.commands.with_mods import load_as_asked
from systems import cache
from systems.collision.driven.compiled import DRIVEN
from systems.collision.free.discs import EVENTS, HORIZONS, PILES
from systems.physics.integrators import INTEGRATORS
from systems.program.compiler import Choice, Compile, forget_unused
from systems.program.parallel import make_program
from systems.program.program import Program
from systems.render.raster import RASTER

UNITS = {unit.name: unit for unit in (RASTER, EVENTS, HORIZONS, PILES, DRIVEN)}
WARM = "warm"  # the program is for rods whose temperature may have changed
NEXT, LATER = ",", "later"  # between jobs, and before those that nobody waits for

Job = tuple[str, ...]  # the name of a unit, or a step program: integrator, form, perhaps WARM, systems


def main(words: Sequence[str]) -> None:
    """Compile jobs into the cache."""
    jobs = load_as_asked(words)
    if hasattr(os, "nice"):  # to what runs at the same time, the window above all
        os.nice(19 if jobs[0] == LATER else 5)
    for between, job in groupby(jobs, lambda word: word in (NEXT, LATER)):
        if not between:
            print(problem_of(tuple(job)), flush=True)
    forget_unused()


def problem_of(job: Job) -> str:
    """Do a job; returns why it could not be done, "" if it could."""
    try:
        importlib.import_module("systems.machine_code")
    except Exception as error:  # numba is not there, or damaged
        return tr("numba cannot be imported ({error})", error=_in_a_line(error))
    try:
        compile_job(job)
    except Exception as error:  # numba raises many kinds
        return _in_a_line(error)
    return cache.TROUBLE[0].partition(". ")[0] if cache.TROUBLE else ""


def _in_a_line(error: Exception) -> str:
    return " ".join(str(error).split()).removesuffix(".") or type(error).__name__


def compile_job(job: Job) -> None:
    """Load what a job is about, compiled first if nobody has."""
    if job[0] in UNITS:
        UNITS[job[0]].load()
    else:
        example(job).load()


def example(job: Job) -> Program:
    """The step program of a job, of the smallest model that has one."""
    name, form, *systems = job
    model = Model()
    first, second = model.create(Particle, 2, position=[[0.0, 0.0], [1.0, 0.0]])
    if WARM in systems:
        systems.remove(WARM)
        spawn_rods(model, [[first.row, second.row]], temperature_change=1.0)
    session = Session(model)
    return make_program(model, session.schedule.named(systems), INTEGRATORS[name], form)


if __name__ == "__main__":
    gc.disable()  # looking through all that the compiler makes would take a fifth of the time
    Choice.compile = Compile.ALWAYS
    main(sys.argv[1:])
