"""Compile ahead of need, in a process of its own; `START` begins it, and standard input holds a `Task`.

The window runs this in another process, because a compiler in its own would hold it up, in a thread too. A line for
each job says why it could not be done, or is empty.
"""

from __future__ import annotations

import gc
import importlib
import os
import sys
import threading
import time
from collections.abc import Sequence

import msgspec

from pinjoint import Session
from pinjoint.components.language import speak, tr
from pinjoint.components.model import Model
from pinjoint.documents.document import parse
from pinjoint.documents.facts import gathered
from pinjoint.mods.loading import load
from pinjoint.systems import cache
from pinjoint.systems.base import Integrator, StepSystem
from pinjoint.systems.collision.driven.compiled import DRIVEN
from pinjoint.systems.collision.free.discs import EVENTS, HORIZONS, PILES
from pinjoint.systems.collision.overlaps import PARTING
from pinjoint.systems.physics.integrators import INTEGRATORS
from pinjoint.systems.program.compiler import Choice, Compile, forget_unused
from pinjoint.systems.program.parallel import make_program
from pinjoint.systems.render.raster import RASTER

UNITS = {unit.name: unit for unit in (RASTER, PARTING, EVENTS, HORIZONS, PILES, DRIVEN)}
START = (
    "import sys; sys.path[:] = sys.argv[1:]; from pinjoint.prepare import main; main()"  # for `python -P -c`
)

Job = tuple[str, ...]  # the name of a unit, or a step program: integrator, form, traits of the model, systems


class Task(msgspec.Struct, frozen=True):
    """Jobs, each with the document of its model. asker: the process that wants them. later: nobody waits for it."""

    asker: int
    language: str
    mods: list[str]  # their folders
    later: bool
    jobs: list[tuple[Job, int]]
    documents: list[bytes]


def main() -> None:
    """Compile jobs into the cache."""
    task = msgspec.msgpack.decode(sys.stdin.buffer.read(), type=Task)
    threading.Thread(target=_end_after, args=(task.asker,), daemon=True).start()
    if hasattr(os, "nice"):  # to what runs at the same time, the window above all
        os.nice(19 if task.later else 5)
    gc.disable()  # looking through all that the compiler makes would take a fifth of the time
    Choice.compile = Compile.ALWAYS
    load(task.mods)
    speak(task.language)
    for job, place in task.jobs:
        print(problem_of(job, task.documents[place]), flush=True)
    forget_unused()


def _end_after(parent: int) -> None:
    """End with the process that waits for this one, however that ends; where that is not told, after it is done."""
    while os.getppid() == parent:
        time.sleep(0.2)
    os._exit(1)


def described(model: Model) -> bytes:
    """A model as other processes read it. Raises ModelError."""
    return msgspec.json.encode(gathered(model))


def problem_of(job: Job, document: bytes) -> str:
    """Do a job for the model of a document; returns why it could not be done, "" if it could."""
    try:
        importlib.import_module("pinjoint.systems.machine_code")
    except Exception as error:  # numba is not there, or damaged
        return tr("numba cannot be imported ({error})", error=in_a_line(error))
    try:
        if job[0] in UNITS:
            UNITS[job[0]].load()
        else:
            make_program(*parts_of(job, document)).load()
    except Exception as error:  # numba raises many kinds
        return in_a_line(error)
    return cache.TROUBLE[0].partition(". ")[0] if cache.TROUBLE else ""


def in_a_line(error: Exception) -> str:
    return " ".join(str(error).split()).removesuffix(".") or type(error).__name__


def parts_of(job: Job, document: bytes) -> tuple[Model, Sequence[StepSystem], Integrator, str]:
    """What the step program of a job is made of, for the very model that asks for it."""
    integrator, form, _, *systems = job
    model = parse(msgspec.json.decode(document))
    return model, Session(model).schedule.named(systems), INTEGRATORS[integrator], form
