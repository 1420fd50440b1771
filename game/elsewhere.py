"""Elsewhere: another process compiles, one program after the other; a thread loads what is compiled by then."""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
import tempfile
import threading
from collections.abc import Mapping
from pathlib import Path

import msgspec

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import language, tr
from pinjoint.prepare import START, UNITS, Job, Task
from pinjoint.systems.physics.integrators import INTEGRATORS
from pinjoint.systems.program.compiler import GeneratedModule, interpreted_here, tell
from pinjoint.systems.program.writer import read_sources

INTERVAL = 0.05  # s between two looks
ENDING = 0.5  # s that what a thread is at may take before the window goes without it

Jobs = Mapping[Job, GeneratedModule]


def slower(problem: str) -> str:
    """The sentence that says why runs go on without machine code."""
    return tr("Runs go on without machine code, and slower: {problem}.", problem=problem)


class Elsewhere:
    """What is compiled in another process, and loaded by a thread of this one while its other threads go on.

    ended: the jobs that were done, with what went wrong, or "". lacking: those of which it waits for the documents.
    compiles: False if nothing ever is compiled. can_load: machine code could be loaded, so far.
    """

    def __init__(self, *, compiles: bool = True) -> None:
        self.ended: dict[Job, str] = {}
        self.lacking: list[Job] = []
        self._documents: Mapping[Job, bytes] = {}
        self._compiles = compiles
        self._needed: Jobs = {}
        self._later: Jobs = {}
        self.can_load = compiles
        self._process: subprocess.Popen[str] | None = None
        self._at_work: list[Job] = []
        self._urgent = False  # what is compiled now is needed
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def begin(self) -> None:
        """Begin to do what was asked for, if it has not begun."""
        if self._thread.ident is None:
            self._thread.start()

    def ask(self, needed: Jobs, later: Jobs, documents: Mapping[Job, bytes]) -> None:
        """Compile and load what is needed, in order, then what may be needed later; documents: of their models."""
        self._needed, self._later, self._documents = needed, later, documents

    @property
    def has_loaded_all(self) -> bool:
        """True if nothing that is needed runs interpreted any more."""
        return all(module.is_loaded for module in self._needed.values())

    @staticmethod
    def is_ready(module: GeneratedModule) -> bool:
        """True if it can be called without being rewritten first."""
        return module.is_loaded or "rewritten" in vars(module)

    def close(self) -> None:
        """Let go of what is still being compiled."""
        self._closed.set()
        if self._thread.ident is not None:
            self._thread.join(ENDING)
        if self._process is not None and self._process.poll() is None:
            self._end(self._process)

    # --- in the thread -------------------------------------------------------------------------------

    def _run(self) -> None:
        self._look()
        read_sources([integrator for integrator in INTEGRATORS.values() if integrator.mod is None])
        for library in ("pinjoint.systems.plasticity.kernels", "scipy.spatial", "scipy.sparse.linalg"):
            importlib.import_module(library)  # what edits and steps need, which takes several frames
        while not self._closed.wait(INTERVAL):
            self._look()

    def _look(self) -> None:
        if self._compiles:
            self._compile()
        self._load()

    def _load(self) -> None:
        """Load what is compiled, or else rewrite what will be interpreted; one program at a time."""
        wanted = [module for jobs in (self._needed, self._later) for module in jobs.values()]
        for module in (*interpreted_here(), *wanted):
            try:
                if module.is_loaded:
                    continue
                if self.can_load and module.is_compiled() and module.load_kept():
                    return
                if not self.is_ready(module):
                    module.rewrite_all()
                    return
            except Exception as error:  # such as a compiler that is damaged
                self.can_load = False
                tell(slower(tr("machine code cannot be loaded ({error})", error=error)))
                return

    def _compile(self) -> None:
        """Have the other process compile, what is needed first."""
        process, needed = self._process, self._left(self._needed)
        if process is not None and process.poll() is None:
            if not needed or (self._urgent and needed[0] in self._at_work):
                return
            self._end(process)
        elif process is not None:
            self._note_end(process)
            needed = self._left(self._needed)
        self._urgent, self._process = bool(needed), None
        self._at_work = needed or self._left(self._later)
        documents = {job: b"" if job[0] in UNITS else self._documents.get(job) for job in self._at_work}
        self.lacking = [job for job, document in documents.items() if document is None]
        if self._at_work and not self.lacking and not self._closed.is_set():
            try:
                self._process = started({job: held or b"" for job, held in documents.items()}, self._urgent)
            except OSError as error:  # no room for another process, or for what it is given
                self.ended |= dict.fromkeys(self._at_work, error.strerror or str(error))

    def _left(self, jobs: Jobs) -> list[Job]:
        return [job for job, module in jobs.items() if job not in self.ended and not module.is_compiled()]

    @staticmethod
    def _end(process: subprocess.Popen[str]) -> None:
        process.terminate()
        process.communicate()

    def _note_end(self, process: subprocess.Popen[str]) -> None:
        """Note what the other process did; a job at which it ended by itself is not tried again."""
        said = process.communicate()[0].splitlines()
        status = tr("the process that compiles ended with status {status}", status=process.returncode)
        self.ended |= dict(zip(self._at_work, [*said, *([status] if process.returncode else [])], strict=False))


def started(jobs: Mapping[Job, bytes], urgent: bool) -> subprocess.Popen[str]:
    """The process that compiles jobs for models; the window goes before it, and everything before what is not urgent.

    It imports from where this one does, but never from the folder that somebody happens to be in.
    """
    documents = list(dict.fromkeys(jobs.values()))
    mods = [str(mod.folder) for mod in EXTENSIONS.mods if mod.loaded and mod.folder]
    asked = [(job, documents.index(document)) for job, document in jobs.items()]
    task = Task(os.getpid(), language(), mods, not urgent, asked, documents)
    priority = "BELOW_NORMAL_PRIORITY_CLASS" if urgent else "IDLE_PRIORITY_CLASS"  # as Windows has it
    with tempfile.TemporaryFile() as given:
        given.write(msgspec.msgpack.encode(task))
        given.seek(0)
        return subprocess.Popen(
            [sys.executable, "-P", "-c", START, *_imported_from()],
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


_HOME = Path(__file__).parent


def _imported_from() -> list[str]:
    """Where this process imports from, but for the current folder, unless the program lies there."""
    elsewhere = {Path.cwd()} - {_HOME.parent}
    return [entry for entry in sys.path if entry and Path(entry).resolve() not in elsewhere]
