"""What mods cost: a law of a mod against the same law of ours, and the machinery at the start and in each frame."""

import os
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

from numba import njit

from pinjoint import Session
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.model import Model
from pinjoint.documents.document import document
from pinjoint.mods import Mod
from pinjoint.mods.guard import Guard
from pinjoint.systems.base import StepSystem, System
from pinjoint.systems.catalogue import step_systems
from pinjoint.systems.physics.integrators import INTEGRATORS
from pinjoint.systems.physics.system import Drag
from pinjoint.systems.program.program import Program
from pinjoint.systems.program.reordered import make_program
from pinjoint.systems.schedule import Schedule
from tests.benchmarks.models import lattice

STEP = 1e-6  # s

Row = dict[str, Any]


@njit(error_model="numpy")
def drag(particles_mass, particles_velocity, environment_drag):
    """The same as pinjoint.systems.physics.kernels.drag."""
    factor = -0.001 * environment_drag * particles_mass
    return factor * particles_velocity[0], factor * particles_velocity[1]


class DragOfMod(Drag):
    """The same as ours, as a mod declares it."""

    name = "bench.drag"
    kernel = drag


def _program(model: Model, law: System) -> Program:
    systems = [system for system in step_systems() if system.name != "physics.drag"]
    plan = Schedule([*systems, law]).step_plan("simulation", model)
    assert any(isinstance(system, Drag) for system in plan)
    model.writable("clock.step_size")[0] = STEP
    return make_program(model, plan, INTEGRATORS["velocity_verlet"])


def kernels(*, quick: bool) -> list[Row]:
    """ns per rod and step with air drag of ours and of a mod, in turns, the best of several each."""
    rows = []
    for size in (1_000,) if quick else (1_000, 100_000):
        ours, theirs = (lattice(size, damping=0.0) for _ in range(2))
        ours.environment.drag = theirs.environment.drag = 0.5
        mod: StepSystem = Guard(Mod("bench", "bench")).wrapped(DragOfMod())  # type: ignore[assignment]
        programs = [_program(ours, Drag()), _program(theirs, mod)]
        steps = max(4_000_000 // size, 4)
        seconds = [min(times) for times in zip(*(_in_turns(programs, steps) for _ in range(9)), strict=True)]
        each = [1e9 * s / steps / ours.rods.count for s in seconds]
        assert document(ours)["particles"] == document(theirs)["particles"]
        ratio = each[1] / each[0]
        rows.append({"rods": ours.rods.count, "ours_ns": each[0], "mod_ns": each[1], "ratio": ratio})
    return rows


def _in_turns(programs: list[Program], steps: int) -> list[float]:
    return [_seconds(lambda program=program: program.advance(steps)) for program in programs]  # type: ignore[misc]


def _seconds(work: Callable[[], Any]) -> float:
    started = time.perf_counter()
    work()
    return time.perf_counter() - started


def machinery() -> list[Row]:
    """ms that importing and running the machinery takes at the start without mods, the least of several."""
    code = (
        "import pinjoint, time; from pinjoint.mods import load; t = time.perf_counter(); load(installed=True)\n"
    )
    code += "print(time.perf_counter() - t)"
    environment = os.environ | {"PINJOINT_DATA": os.devnull}
    imports, loads = [], []
    for _ in range(5):
        command = [sys.executable, "-X", "importtime", "-c", code]
        done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
        lines = [line.split("|") for line in done.stderr.splitlines() if line.count("|") == 2]
        own = [
            line
            for line in lines
            if line[2].strip().startswith(("pinjoint.mods", "pinjoint.included", "packaging"))
        ]
        imports.append(sum(int(line[0].split(":")[1]) for line in own) / 1000.0)
        loads.append(1000.0 * float(done.stdout))
    return [{"imports_ms": min(imports), "looking_for_mods_ms": min(loads)}]


def frames(*, quick: bool) -> list[Row]:
    """µs of a frame in pause with what is written as mods are, and without, in turns."""
    with_mods = Session.open("isostatic")
    kept = list(EXTENSIONS.systems), list(EXTENSIONS.panels)
    EXTENSIONS.systems.clear()
    without = Session.open("isostatic")
    EXTENSIONS.systems.extend(kept[0])
    count, best = 200 if quick else 2000, [float("inf")] * 2
    for _ in range(5):
        for at, (session, panels) in enumerate(((with_mods, kept[1]), (without, []))):
            EXTENSIONS.panels[:] = panels
            took = _seconds(lambda session=session: [session.frame(0.0) for _ in range(count)])  # type: ignore[misc]
            best[at] = min(best[at], 1e6 * took / count)
    EXTENSIONS.panels[:] = kept[1]
    return [{"with_us": best[0], "without_us": best[1], "difference_us": best[0] - best[1]}]


def report(*, quick: bool) -> dict[str, list[Row]]:
    """All tables."""
    return {"kernels": kernels(quick=quick), "start": machinery(), "frames": frames(quick=quick)}
