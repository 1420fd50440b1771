"""How fast the step programs are: time per rod and step against a plain kernel and peers in the same run."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from components.model import Model
from game.catalogue import DRIVERS, step_systems
from game.document import document
from game.program import Program
from game.schedule import Schedule
from tests.benchmarks.models import lattice, truss
from tests.benchmarks.plain import arrays_of, elastic_verlet, full_verlet

STEP = 1e-6  # s, stable in all these models
KINDS: dict[str, dict[str, float]] = {
    "elastic": {"damping": 0.0},
    "elastic-plastic-damped": {"damping": 1.0, "tensile_strength": 1e6, "compressive_strength": 1e6},
}

Row = dict[str, Any]


def step_costs(*, quick: bool) -> list[Row]:
    """Nanoseconds per rod and step, by model: our program, a plain kernel, and peers."""
    sizes = (1_000, 100_000) if quick else (1_000, 10_000, 100_000)
    rows = []
    for kind, rods in KINDS.items():
        for model in [truss(**rods), *(lattice(size, **rods) for size in sizes)]:
            rows.append(_step_cost(kind, model))
    return rows


def _step_cost(kind: str, model: Model) -> Row:
    rods = model.rods.count
    steps = max(20, 300_000 // rods)
    ours = _program_runner(model, steps)
    plain = _plain_runner(model, steps, full=kind != "elastic")
    seconds, plain_seconds = _best_of_each(ours, plain)
    return {
        "kind": kind,
        "rods": rods,
        "us_per_step": seconds / steps * 1e6,
        "ns_per_rod": seconds / steps / rods * 1e9,
        "plain_ns_per_rod": plain_seconds / steps / rods * 1e9,
        "ratio_to_plain": seconds / plain_seconds,
    }


def _program_runner(model: Model, steps: int) -> Callable[[], None]:
    program = Program(model, Schedule(step_systems()).step_plan(model), DRIVERS["velocity_verlet"])
    model.writable("clock.step_size")[0] = STEP

    def run() -> None:
        left = steps
        while left > 0:
            left -= program.advance(left)[0]

    return run


def _plain_runner(model: Model, steps: int, *, full: bool) -> Callable[[], None]:
    kernel, arrays = (full_verlet if full else elastic_verlet), arrays_of(model, full=full)
    return lambda: kernel(steps, STEP, *arrays)


def _best_of_each(*runners: Callable[[], None], rounds: int = 7) -> list[float]:
    """The shortest time of each, taken in turns so that a disturbance hits all alike; first runs left out."""
    best = [np.inf] * len(runners)
    for runner in runners:
        runner()
    for _ in range(rounds):
        for index, runner in enumerate(runners):
            started = time.perf_counter()
            runner()
            best[index] = min(best[index], time.perf_counter() - started)
    return best


def peers(*, quick: bool) -> list[Row]:
    """The same triangle by the thesis' scheme, and lattices of springs by pymunk, per rod and step."""
    from tests.reference.thesis import Simulation as Thesis

    steps = 300 if quick else 2_000
    thesis = Thesis(document(truss(damping=1.0)))
    started = time.perf_counter()
    thesis.run(STEP, steps)
    seconds = time.perf_counter() - started
    rows = [
        {"peer": "thesis' scheme, one object per element", "rods": 3, "ns_per_rod": seconds / steps / 3 * 1e9}
    ]
    for size in (1_000,) if quick else (1_000, 10_000):
        rows.append(_pymunk_springs(size))
    return rows


def _pymunk_springs(size: int) -> Row:
    import pymunk

    model = lattice(size, damping=1.0)
    space = pymunk.Space(threaded=False)
    bodies = []
    for position, held in zip(model.particles.position.tolist(), model.particles.fixed.tolist(), strict=True):
        body = pymunk.Body(10.0, 1.0, body_type=pymunk.Body.STATIC if held[0] else pymunk.Body.DYNAMIC)
        body.position = tuple(position)
        bodies.append(body)
        space.add(body)
    held = model.particles.fixed[:, 0]
    for (a, b), length in zip(model.rods.between.tolist(), model.rods.rest_length.tolist(), strict=True):
        if held[a] and held[b]:
            continue
        space.add(pymunk.DampedSpring(bodies[a], bodies[b], (0, 0), (0, 0), length, 1.6e8 / length, 1e3))
    steps = max(3, 30_000 // model.rods.count)
    started = time.perf_counter()
    for _ in range(steps):
        space.step(STEP)
    seconds = time.perf_counter() - started
    return {
        "peer": "pymunk springs",
        "rods": model.rods.count,
        "ns_per_rod": seconds / steps / model.rods.count * 1e9,
    }


def start_up() -> list[Row]:
    """Seconds that a fresh process takes, with a warm cache: imports, and the first frame of the window."""
    return [
        {"what": "import numpy, esper", "seconds": _fresh("import numpy, esper")},
        {"what": "import game", "seconds": _fresh("import numpy, esper, game")},
        {"what": "first frame of the window, paused", "seconds": _fresh(_FIRST_FRAME.format(frames=1))},
        {"what": "first step in the window", "seconds": _fresh(_FIRST_FRAME.format(frames=3))},
    ]


_FIRST_FRAME = """
import os; os.environ["SDL_VIDEODRIVER"] = "dummy"
from game import models
from game.app import App
app = App(models.load("isostatic"))
if {frames} > 1: app.session.press("space")
for _ in range({frames}): app.frame(1 / 60)
"""


def _fresh(code: str) -> float:
    best = np.inf
    for _ in range(3):
        started = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.DEVNULL)
        best = min(best, time.perf_counter() - started)
    return float(best)


def bulk_creation() -> list[Row]:
    """Seconds to create particles and rods in bulk."""
    started = time.perf_counter()
    model = lattice(100_000)
    return [{"what": f"create {model.rods.count} rods in bulk", "seconds": time.perf_counter() - started}]


def report(*, quick: bool) -> dict[str, list[Row]]:
    """Everything this benchmark measures, by table."""
    return {
        "steps": step_costs(quick=quick),
        "peers": peers(quick=quick),
        "start": [*start_up(), *bulk_creation()],
    }
