"""Elsewhere: another process compiles, one program after the other; a thread of this one loads what is compiled by then.

A compiler in the process of the window would hold it up, in a thread too. `START` begins the other one, whose standard
input holds a `Task`; a line for each job says why it could not be done, or is empty.
"""

from __future__ import annotations

import gc
import importlib
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import language, speak, tr
from pinjoint.components.mistake import reason_of
from pinjoint.components.model import Model
from pinjoint.documents.document import parse
from pinjoint.mods.loading import load
from pinjoint.systems.base import Integrator, StepSystem
from pinjoint.systems.catalogue import all_systems
from pinjoint.systems.collision.driven.neighbours import DRIVEN
from pinjoint.systems.collision.free.discs import EVENTS, HORIZONS, PILES
from pinjoint.systems.collision.overlaps import PARTING
from pinjoint.systems.physics.integrators import INTEGRATORS
from pinjoint.systems.program import cache
from pinjoint.systems.program.compiler import Choice, Compile, GeneratedModule, forget_unused, interpreted_here
from pinjoint.systems.program.interpreter import keep_rewritten
from pinjoint.systems.program.reordered import make_program
from pinjoint.systems.program.writer import read_sources
from pinjoint.systems.render.backends.raster import RASTER
from pinjoint.systems.schedule import Schedule

UNITS = {unit.name: unit for unit in (RASTER, PARTING, EVENTS, HORIZONS, PILES, DRIVEN)}
# Of `python -P -c`.
START = "import sys; sys.path[:] = sys.argv[1:]; from pinjoint.elsewhere import main; main()"
INTERVAL = 0.05  # s between two looks
# What edits and steps need, which takes several frames to import.
_SYSTEMS = ("pinjoint.systems.plasticity.kernels", "pinjoint.systems.statics.buckling")
_LIBRARIES = (*_SYSTEMS, "scipy.spatial", "scipy.sparse.linalg")
_ENDING = 0.5  # s that what a thread is at may take before the window goes without it

_HOME = Path(__file__).parent

Job = tuple[str, ...]  # the name of a unit, or a step program: integrator, form, traits of the model, systems


@dataclass(eq=False)
class Work:
    """A job and the module that it is about; None if that cannot be written.

    document: of the model, once it was described. ended: why the other process could not do it, or "" if it could; None
    until then. told, given_up: that was said; it cannot be compiled in this process either.
    """

    job: Job
    module: GeneratedModule | None
    document: bytes | None = None
    ended: str | None = None
    told: bool = False
    given_up: bool = False

    @property
    def problem(self) -> str:
        """Why it cannot be had from the other process; "" if it can, as far as is known."""
        if self.ended is None or self.module is None or self.module.is_compiled():
            return ""
        return self.ended or tr("what was got ready was not kept")


def tell_slower(problem: str) -> None:
    """Say why runs go on in their slow form, if they do."""
    if problem:
        cache.tell(tr("Runs go on, but more slowly than they could: {problem}.", problem=problem))


class Elsewhere:
    """What is compiled in another process, and loaded by a thread of this one while its other threads go on.

    needed, later: what is to be compiled and loaded, in order. lacking: of them, those whose documents are waited for.
    compiles: False if nothing ever is compiled. can_load: machine code could be loaded, so far.
    """

    def __init__(self, *, compiles: bool = True) -> None:
        self.needed: Sequence[Work] = ()
        self.later: Sequence[Work] = ()
        self.lacking: list[Work] = []
        self._compiles = compiles
        self.can_load = compiles
        self._process: subprocess.Popen[str] | None = None
        self._at_work: list[Work] = []
        self._urgent = False  # what is compiled now is needed
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def begin(self) -> None:
        """Begin to do what was asked for, if it has not begun."""
        if self._thread.ident is None:
            self._thread.start()

    @staticmethod
    def is_ready(module: GeneratedModule) -> bool:
        """True if it can be called without being rewritten first."""
        return module.is_loaded or "rewritten" in vars(module)

    def close(self) -> None:
        """Let go of what is still being compiled."""
        self._closed.set()
        if self._thread.ident is not None:
            self._thread.join(_ENDING)
        if self._process is not None and self._process.poll() is None:
            self._end(self._process)

    # --- in the thread -------------------------------------------------------------------------------

    def _run(self) -> None:
        read_sources([integrator for integrator in INTEGRATORS.values() if integrator.mod is None])
        libraries = list(_LIBRARIES)
        while not self._closed.wait(INTERVAL):
            self._look()
            keep_rewritten()
            modules = [work.module for work in self.needed if work.module is not None]
            if libraries and modules and all(map(self.is_ready, modules)):  # what a run begins with goes before
                importlib.import_module(libraries.pop(0))

    def _look(self) -> None:
        if self._compiles:
            self._compile()
        self._load()

    def _load(self) -> None:
        """Rewrite what a run begins with, interpreted; then load what is compiled, or else rewrite it; one at a time."""
        works = self.needed, self.later
        needed, later = ([work.module for work in some if work.module is not None] for some in works)
        unready = [module for module in needed if not self.is_ready(module)]
        for module in (*unready, *interpreted_here(), *needed, *later):
            try:
                if module.is_loaded:
                    continue
                # What has to be rewritten is, before anything is loaded, which takes its time.
                compiled = module not in unready and self.can_load and module.is_compiled()
                if compiled and module.load_kept():
                    return
                if not self.is_ready(module):
                    module.rewrite_all()
                    return
            except Exception as error:  # such as a compiler that is damaged
                self.can_load = False
                tell_slower(tr("what makes them fast cannot be loaded ({error})", error=error))
                return

    def _compile(self) -> None:
        """Have the other process compile, what is needed first."""
        process, needed = self._process, _left(self.needed)
        if process is not None and process.poll() is None:
            if not needed or (self._urgent and needed[0] in self._at_work):
                return
            self._end(process)
        elif process is not None:
            self._note_end(process)
            needed = _left(self.needed)
        self._urgent, self._process = bool(needed), None
        self._at_work = needed or _left(self.later)
        self.lacking = [work for work in self._at_work if work.document is None]
        if self._at_work and not self.lacking and not self._closed.is_set():
            try:
                self._process = started({w.job: w.document or b"" for w in self._at_work}, self._urgent)
            except OSError as error:  # no room for another process, or for what it is given
                for work in self._at_work:
                    work.ended = reason_of(error)

    @staticmethod
    def _end(process: subprocess.Popen[str]) -> None:
        process.terminate()
        process.communicate()

    def _note_end(self, process: subprocess.Popen[str]) -> None:
        """Note what the other process did; a job at which it ended by itself is not tried again."""
        said = process.communicate()[0].splitlines()
        status = tr("the process that gets it ready ended with status {status}", status=process.returncode)
        for work, ended in zip(self._at_work, [*said, *([status] if process.returncode else [])], strict=False):
            work.ended = ended


def _left(works: Sequence[Work]) -> list[Work]:
    return [w for w in works if w.module is not None and w.ended is None and not w.module.is_compiled()]


# --- the other process -------------------------------------------------------------------------------


class Task(msgspec.Struct, frozen=True):
    """Jobs, each with the document of its model. asker: the process that wants them. later: nobody waits for it."""

    asker: int
    language: str
    mods: list[str]  # their folders
    later: bool
    jobs: list[tuple[Job, int]]
    documents: list[bytes]


def started(jobs: Mapping[Job, bytes], urgent: bool) -> subprocess.Popen[str]:
    """The process that compiles jobs for models; the window goes before it, and everything before what is not urgent.

    It imports from where this one does, but never from the folder that somebody happens to be in, unless the program
    lies there.
    """
    documents = list(dict.fromkeys(jobs.values()))
    mods = [str(mod.folder) for mod in EXTENSIONS.mods if mod.loaded and mod.folder]
    asked = [(job, documents.index(document)) for job, document in jobs.items()]
    task = Task(os.getpid(), language(), mods, not urgent, asked, documents)
    priority = "BELOW_NORMAL_PRIORITY_CLASS" if urgent else "IDLE_PRIORITY_CLASS"  # as Windows has it
    here = {Path.cwd()} - {_HOME.parent}
    imported_from = [entry for entry in sys.path if entry and Path(entry).resolve() not in here]
    with tempfile.TemporaryFile() as given:
        given.write(msgspec.msgpack.encode(task))
        given.seek(0)
        return subprocess.Popen(
            [sys.executable, "-P", "-c", START, *imported_from],
            stdin=given,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            cwd=_HOME,
            env=os.environ | {"PYTHONUTF8": "1"},
            encoding="utf-8",
            errors="replace",
            creationflags=getattr(subprocess, priority, 0),
            start_new_session=True,  # Ctrl+C in a terminal is for the window, which then ends it
        )


def main() -> None:
    """Compile jobs into the cache."""
    task = msgspec.msgpack.decode(sys.stdin.buffer.read(), type=Task)

    def end_after_asker() -> None:
        """However that ends; where it is not told, this process ends when it is done."""
        while os.getppid() == task.asker:
            time.sleep(0.2)
        os._exit(1)

    threading.Thread(target=end_after_asker, daemon=True).start()
    if hasattr(os, "nice"):  # to what runs at the same time, the window above all
        os.nice(19 if task.later else 5)
    gc.disable()  # looking through all that the compiler makes would take a fifth of the time
    Choice.compile = Compile.ALWAYS
    load(task.mods)
    speak(task.language)
    for job, place in task.jobs:
        print(problem_of(job, task.documents[place]), flush=True)
    forget_unused()


def problem_of(job: Job, document: bytes) -> str:
    """Do a job for the model of a document; returns why it could not be done, "" if it could."""
    try:
        importlib.import_module("pinjoint.systems.program.machine_code")
    except Exception as error:  # numba is not there, or damaged
        return tr("numba cannot be imported ({error})", error=in_a_line(error))
    try:
        if job[0] in UNITS:
            UNITS[job[0]].load()
        else:
            program = make_program(*parts_of(job, document))  # which loading calls
            program.module.load()
    except Exception as error:  # numba raises many kinds
        return in_a_line(error)
    return cache.TROUBLE[0].partition(". ")[0] if cache.TROUBLE else ""


def in_a_line(error: Exception) -> str:
    return " ".join(str(error).split()).removesuffix(".") or type(error).__name__


def parts_of(job: Job, document: bytes) -> tuple[Model, Sequence[StepSystem], Integrator, str]:
    """What the step program of a job is made of, for the very model that asks for it."""
    integrator, form, _, *systems = job
    model = parse(msgspec.json.decode(document))
    return model, Schedule(all_systems()).named(systems), INTEGRATORS[integrator], form
