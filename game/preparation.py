"""Preparation: another process compiles step programs, collisions and drawing before they are needed."""

from __future__ import annotations

import importlib
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from typing import Any

from components.model import Model
from components.obstacles import any_obstacles
from components.rod import is_warm, nodes
from game.mods import MODS
from game.prepare import WARM, Job, is_prepared, load_program
from systems import cache
from systems.base import Phase, StepSystem, System
from systems.collision.driven.compiled import DRIVEN
from systems.collision.free.discs import EVENTS, HORIZONS, PILES
from systems.collision.free.flight import may_pile
from systems.collision.system import Support, persistent_contacts
from systems.edit.pull import Pull
from systems.physics.integrators import INTEGRATORS
from systems.program.compiler import GeneratedModule, is_blank
from systems.program.program import has_program
from systems.program.writer import form_of, read_sources
from systems.render.raster import RASTER, Raster, load_raster
from systems.run.simulation import Simulation

Units = tuple[GeneratedModule, ...]  # that one process compiles
FREE: tuple[Units, ...] = (EVENTS,), (HORIZONS,)  # for free particles
PULLED: tuple[Units, ...] = (EVENTS,), (HORIZONS, PILES)  # for those that may pile up
AHEAD: tuple[Units, ...] = (RASTER,), (DRIVEN,), *PULLED  # which any model may come to need


class Preparation(System):
    """Compiles the step program of the open model as soon as the model is known, and the drawing.

    First a thread loads the compiler, which takes as long as a person needs to press a key. Compiled programs are
    loaded while nobody waits for another; then programs that other models may need are compiled.
    """

    name = "programs.preparation"
    phase = Phase.EVENTS
    reads = ("document", "state")
    writes = ("programs",)
    headless = False

    def __init__(self) -> None:
        self._frames = 0
        self._seen = -1  # the model's revision in the last frame
        self._structure = -1  # when anything was made or deleted last, as of the last frame
        self._compiler = threading.Thread(target=_load_libraries, daemon=True)
        self._blank = is_blank()  # the cache is empty, which is known without loading the compiler
        self._loaded = False  # whether the program was loaded in the last frame
        self._driven = False  # the kernels of driven collisions are loaded
        self._looked = -1  # the revision for which the program of a pulling hand was last looked up
        self._pulled: set[Job] = set()  # programs of a pulling hand that were looked up
        self._running: dict[Job, subprocess.Popen[bytes]] = {}
        self._since: dict[Job, float] = {}
        self._done: set[Job] = set()
        self._said = False  # that programs cannot be kept on disk

    def process(self, frame: Any) -> None:
        """Begin with what the session needs next; say once if nothing compiled can be kept."""
        if cache.TROUBLE and not self._said:
            self._said = True
            frame.session.notice = cache.TROUBLE[0]
        self._frames += 1
        if self._frames == 2:  # after the first picture
            self._compiler.start()
        simulation = frame.session.simulation
        before, self._structure = self._structure, simulation.model.structure
        if before != self._structure:  # what was made or deleted is seen first
            return
        seen, self._seen = self._seen, simulation.model.revision
        loaded, self._loaded = self._loaded, simulation.programs.ready
        if loaded and simulation.programs.ready and self._waits_for_meetings(simulation) is None:
            self._load_driven(simulation)
            if seen == self._seen and not frame.session.busy:
                self._load_pulled(simulation)
        elif self.waits_for(simulation) is None and seen == self._seen and _is_compiled(simulation):
            # As soon as what was done is seen: who needs the program first need not wait.
            simulation.program  # noqa: B018 (it is loaded when asked for)
        self._compile_ahead()

    def _load_driven(self, simulation: Simulation) -> None:
        """Load what driven collisions need, in a frame after the program was loaded and before anything meets."""
        if not self._driven and _may_meet(simulation):
            self._driven = True
            DRIVEN.load()

    def _compile_ahead(self) -> None:
        """Compile what any model may need, one process after the other, while nothing else is compiled."""
        if all(process.poll() is not None for process in self._running.values()):
            for units in AHEAD:
                if self._waits_for_units(units) is not None:
                    return

    def _load_pulled(self, simulation: Simulation) -> None:
        """While nothing happens, load the program that takes steps while a hand pulls; loading takes two frames."""
        if self._seen == self._looked or simulation.integrator.exact:
            return
        plan = simulation.plan
        pulled = (*_job(simulation, plan), Pull.name)
        if pulled in self._running and self._running[pulled].poll() is None:  # still compiling
            return
        self._looked = self._seen
        if pulled in self._pulled:
            return
        self._pulled.add(pulled)
        if is_prepared(pulled):
            load_program(pulled)

    def waits_for(self, simulation: Simulation) -> float | None:
        """Seconds since the program of a simulation was wanted, or None if it can be had at once."""
        if simulation.integrator.exact:  # it may be ready, but not for piles
            waits = [self._waits_for_units(units) for units in _units(simulation)]
            return max((waited for waited in waits if waited is not None), default=None)
        if simulation.programs.ready:
            return self._waits_for_meetings(simulation)
        job = _job(simulation, simulation.plan)
        waited = self._waits(job, lambda: _is_compiled(simulation))
        others = self._waits_for_meetings(simulation)
        if (
            waited is None and job in self._running
        ):  # a new kind of model: compile its program with a pulling hand, too
            self._waits((*job, Pull.name), lambda: False)
        return others if waited is None else waited

    def _waits_for_meetings(self, simulation: Simulation) -> float | None:
        """Seconds since the programs for contacts with structures were wanted; None if they are ready or not needed."""
        if not _may_meet(simulation):
            return None
        waited = self._waits_for_units((DRIVEN,))
        if not _may_rest(simulation.model):
            return waited
        names = (system.name for system in simulation.plan)
        plan = simulation.schedule.named((*names, Support.name))  # from when on something rests on something
        resting = self._waits(_job(simulation, plan), lambda: _has_program(simulation, plan))
        return resting if waited is None else waited

    def raster(self) -> Raster | None:
        """The raster of large pictures, as soon as it is compiled."""
        return load_raster() if self._waits_for_units((RASTER,)) is None else None

    def _waits_for_units(self, units: Units) -> float | None:
        return self._waits(tuple(unit.name for unit in units), lambda: _are_compiled(units))

    def _waits(self, job: Job, is_compiled: Callable[[], bool]) -> float | None:
        if job in self._done:
            return None
        waited = time.monotonic() - self._since.setdefault(job, time.monotonic())
        loading = self._compiler.ident is None or self._compiler.is_alive()
        if loading and not self._blank:
            return waited
        if job not in self._running and (loading or not is_compiled()):
            self._running[job] = _started(job)
        if loading or (job in self._running and self._running[job].poll() is None):
            return waited
        self._done.add(job)  # if the other process failed, this one compiles the program and reports the error
        return None

    def close(self) -> None:
        """Let go of what is still being compiled."""
        for process in self._running.values():
            if process.poll() is None:
                process.terminate()
                process.wait()


def _may_meet(simulation: Simulation) -> bool:
    """True if particles that do not fly free may meet."""
    plan = simulation.plan
    return not simulation.integrator.exact and any(system.impulsive for system in plan)


def _may_rest(model: Model) -> bool:
    """True if something that is no structure may come to rest on one, or a structure on a wall, and none does yet."""
    return persistent_contacts(model) is None and (any_obstacles(model) or not nodes(model).all())


def _are_compiled(units: Units) -> bool:
    return all(unit.is_compiled() for unit in units)


def _units(simulation: Simulation) -> tuple[Units, ...]:
    """The units that its free particles need."""
    plan = simulation.plan
    return PULLED if may_pile(simulation.model, any(isinstance(system, Pull) for system in plan)) else FREE


def _job(simulation: Simulation, plan: Sequence[StepSystem]) -> Job:
    form = form_of(simulation.model, simulation.integrator, plan)
    warmth = (WARM,) if is_warm(simulation.model) else ()
    return simulation.integrator.key, form, *warmth, *(system.name for system in plan)


def _is_compiled(simulation: Simulation) -> bool:
    """True if its program need only be loaded."""
    if simulation.integrator.exact:
        return all(_are_compiled(units) for units in _units(simulation))
    return _has_program(simulation, simulation.plan)


def _has_program(simulation: Simulation, plan: Sequence[StepSystem]) -> bool:
    return has_program(simulation.model, plan, simulation.integrator)


def _load_libraries() -> None:
    """Import what steps need besides their programs, which takes several frames."""
    importlib.import_module("systems.machine_code")
    for units in AHEAD:  # imports kernels, which takes several frames
        _are_compiled(units)
    read_sources([integrator for integrator in INTEGRATORS.values() if integrator.mod is None])
    importlib.import_module("systems.plasticity.kernels")
    for library in ("scipy.spatial", "scipy.sparse.linalg"):
        importlib.import_module(library)


def _started(job: Job) -> subprocess.Popen[bytes]:
    mods = [word for mod in MODS if mod.loaded and mod.folder for word in ("--mods", str(mod.folder))]
    command = [sys.executable, "-m", "game.prepare", *mods, "--no-mods", *job]
    return subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
