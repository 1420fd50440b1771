"""Elsewhere: another process compiles, one program after the other; a thread loads what is compiled by then."""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
import threading
from collections.abc import Mapping, Sequence

from components.language import tr
from game.mods import MODS
from game.prepare import LATER, NEXT, Job
from systems.physics.integrators import INTEGRATORS
from systems.program.compiler import GeneratedModule, interpreted_here, tell
from systems.program.writer import read_sources

INTERVAL = 0.05  # s between two looks

Jobs = Mapping[Job, GeneratedModule]


def slower(problem: str) -> str:
    """The sentence that says why runs go on without machine code."""
    return tr("Runs go on without machine code, and slower: {problem}.", problem=problem)


class Elsewhere:
    """What is compiled in another process, and loaded by a thread of this one while its other threads go on.

    ended: the jobs that were done, with what went wrong, or "". compiles: False if nothing ever is compiled.
    """

    def __init__(self, *, compiles: bool = True) -> None:
        self.ended: dict[Job, str] = {}
        self._compiles = compiles
        self._needed: Jobs = {}
        self._later: Jobs = {}
        self._can_load = compiles
        self._process: subprocess.Popen[str] | None = None
        self._at_work: list[Job] = []
        self._urgent = False  # what is compiled now is needed
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def begin(self) -> None:
        """Begin to do what was asked for, if it has not begun."""
        if self._thread.ident is None:
            self._thread.start()

    def ask(self, needed: Jobs, later: Jobs) -> None:
        """Compile and load what is needed, in order, then what may be needed later."""
        self._needed, self._later = needed, later

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
            self._thread.join()
        if self._process is not None and self._process.poll() is None:
            self._end(self._process)

    # --- in the thread -------------------------------------------------------------------------------

    def _run(self) -> None:
        self._look()
        read_sources([integrator for integrator in INTEGRATORS.values() if integrator.mod is None])
        for library in ("systems.plasticity.kernels", "scipy.spatial", "scipy.sparse.linalg"):
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
                if self._can_load and module.is_compiled() and module.load_kept():
                    return
                if not self.is_ready(module):
                    module.rewrite_all()
                    return
            except Exception as error:  # such as a compiler that is damaged
                self._can_load = False
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
        if self._at_work and not self._closed.is_set():
            self._process = started(self._at_work, self._urgent)

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


def started(jobs: Sequence[Job], urgent: bool) -> subprocess.Popen[str]:
    """The process that compiles these jobs; the window goes before it, and everything before what is not urgent."""
    mods = [word for mod in MODS if mod.loaded and mod.folder for word in ("--mods", str(mod.folder))]
    words = [word for job in jobs for word in (NEXT if urgent else LATER, *job)]
    priority = "BELOW_NORMAL_PRIORITY_CLASS" if urgent else "IDLE_PRIORITY_CLASS"  # as Windows has it
    return subprocess.Popen(
        [sys.executable, "-m", "game.prepare", *mods, "--no-mods", *words],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env=os.environ | {"PYTHONUTF8": "1"},
        encoding="utf-8",
        errors="replace",
        creationflags=getattr(subprocess, priority, 0),
    )
