"""Preparation: what must be compiled is, in another process, before it is needed; the window goes on meanwhile."""

from __future__ import annotations

import importlib
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from game.flight import has_flight
from game.mods import MODS
from game.prepare import FLIGHT, RASTER
from game.program import has_program
from game.program_cache import load_compiler
from game.program_writer import form_of
from game.raster_program import has_raster, load_raster
from systems.base import Phase, System
from systems.edit.pull import Pull

if TYPE_CHECKING:
    from game.simulation import Simulation
    from systems.render.raster import Raster

Job = tuple[str, ...]  # what `python -m game.prepare` is asked for


class Preparation(System):
    """Has the step program of the model that is open compiled as soon as it is known, and the drawing.

    First the compiler itself is loaded, in a thread: that takes as long as a person takes to press a key.
    What is compiled is loaded as soon as nobody waits for anything else.
    """

    name = "programs.preparation"
    phase = Phase.EVENTS

    def __init__(self) -> None:
        self._frames = 0
        self._seen = -1  # the model's revision in the last frame
        self._compiler = threading.Thread(target=_load_libraries, daemon=True)
        self._running: dict[Job, subprocess.Popen[bytes]] = {}
        self._since: dict[Job, float] = {}
        self._done: set[Job] = set()

    def process(self, frame: Any) -> None:
        """Begin with what the session needs next."""
        self._frames += 1
        if self._frames == 2:  # the first picture comes first
            self._compiler.start()
        self._load(frame.session.simulation)

    def _load(self, simulation: Simulation) -> None:
        """As soon as its program is compiled, and what was done is seen: who needs it first need not wait."""
        seen, self._seen = self._seen, simulation.model.revision
        if self.waits_for(simulation) is None and not simulation.ready and seen == self._seen:
            plan = simulation.schedule.step_plan(simulation.model)
            if has_program(simulation.model, plan, simulation.driver):
                simulation.program  # noqa: B018 (it is loaded when asked for)

    def waits_for(self, simulation: Simulation) -> float | None:
        """Seconds since the program of a simulation was wanted, or None if it can be had at once."""
        if simulation.ready:
            return None
        model, plan = simulation.model, simulation.schedule.step_plan(simulation.model)
        if simulation.integrator == FLIGHT:
            return self._waits((FLIGHT,), has_flight)
        job = simulation.integrator, form_of(model, simulation.driver), *(system.name for system in plan)
        waited = self._waits(job, lambda: has_program(model, plan, simulation.driver))
        if waited is None and job in self._running:  # then it is new, with a hand that pulls as well
            self._waits((*job, Pull.name), lambda: False)
        return waited

    def raster(self) -> Raster | None:
        """What draws large pictures, as soon as it is compiled."""
        return load_raster() if self._waits((RASTER,), has_raster) is None else None

    def _waits(self, job: Job, is_compiled: Callable[[], bool]) -> float | None:
        if job in self._done:
            return None
        waited = time.monotonic() - self._since.setdefault(job, time.monotonic())
        if self._compiler.ident is None or self._compiler.is_alive():
            return waited
        if job not in self._running and not is_compiled():
            self._running[job] = _started(job)
        if job in self._running and self._running[job].poll() is None:
            return waited
        self._done.add(job)  # and if it could not be compiled there, it is tried, and explained, here
        return None

    def close(self) -> None:
        """Let go of what is still being compiled."""
        for process in self._running.values():
            if process.poll() is None:
                process.terminate()
                process.wait()


def _load_libraries() -> None:
    """What steps need besides their programs."""
    load_compiler()
    importlib.import_module("scipy.spatial")


def _started(job: Job) -> subprocess.Popen[bytes]:
    mods = [word for mod in MODS if mod.loaded and mod.folder for word in ("--mods", str(mod.folder))]
    command = [sys.executable, "-m", "game.prepare", *mods, "--no-mods", *job]
    return subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
