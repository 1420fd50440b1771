"""How fast the step programs are: time per rod and step against a plain kernel, peers and the machine's ceiling.

All in the same run, in turns. `pinjoint bench speed --output DIR` also writes the tables as CSV and a picture.
"""

import gc
import math
import os
import subprocess
import sys
import tempfile
import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pymunk  # here, so that a missing peer is told before anything is measured

from pinjoint import Session
from pinjoint.components.model import Model
from pinjoint.documents import models
from pinjoint.documents.document import document
from pinjoint.systems.base import cores
from pinjoint.systems.program.writer import MANY, VERY_MANY
from tests.benchmarks import skipping
from tests.benchmarks.ceiling import BYTES_PER_PARTICLE, BYTES_PER_ROD, bandwidth, seconds_per_rod
from tests.benchmarks.models import lattice, truss
from tests.benchmarks.plain import arrays_of, elastic_verlet, full_verlet
from tests.benchmarks.timing import STEP, best_of_each, program_runner

KINDS: dict[str, dict[str, float]] = {
    "elastic": {"damping": 0.0},
    "elastic-plastic-damped": {"damping": 1.0, "tensile_strength": 1e6, "compressive_strength": 1e6},
}

Row = dict[str, Any]


def step_costs(*, quick: bool) -> list[Row]:
    """Nanoseconds of one core per rod and step, by model: our program, and a plain kernel."""
    sizes = (1_000, 100_000) if quick else (100, 1_000, 10_000, 100_000, 1_000_000)
    rows = []
    for kind, rods in KINDS.items():
        rows.append(_step_cost(kind, truss(**rods)))
        rows += [_step_cost(kind, lattice(size, **rods)) for size in sizes]
    return rows


def scaling(steps: list[Row]) -> list[Row]:
    """The exponent p of time per step ∝ rods^p from 1000 rods on, by least squares of the logarithms."""
    rows = []
    for kind in KINDS:
        large = [row for row in steps if row["kind"] == kind and row["rods"] > 900]
        rods, time_per_step = ([math.log(row[what]) for row in large] for what in ("rods", "us_per_step"))
        rows.append({"kind": kind, "exponent": float(np.polyfit(rods, time_per_step, 1)[0])})
    return rows


def ceilings(steps: list[Row]) -> list[Row]:
    """The least time that elastic rods could take here, by arithmetic and by memory, and how near we come.

    Memory: every step moves all columns once; arrays of the same size together are streamed for comparison.
    """
    arithmetic = seconds_per_rod() * 1e9
    rows = []
    for row in steps:
        if row["kind"] == "elastic" and row["rods"] > 900:
            moved = BYTES_PER_ROD + BYTES_PER_PARTICLE * row["particles"] / row["rods"]
            speed = bandwidth(moved * row["rods"])
            memory = moved / speed * 1e9
            rows.append(
                {
                    "rods": row["rods"],
                    "bytes_per_rod": moved,
                    "GB_per_s": speed / 1e9,
                    "memory_ns_per_rod": memory,
                    "arithmetic_ns_per_rod": arithmetic,
                    "ours_ns_per_rod": row["ns_per_rod"],
                    "share_of_ceiling": max(memory, arithmetic) / row["ns_per_rod"],
                }
            )
    return rows


def bending(*, quick: bool) -> list[Row]:
    """Nanoseconds of one core per rod and step: undamped trusses, and the same rods as members that bend, in turns."""
    stiff = KINDS["elastic"] | {"bending_stiffness": 100.0}
    rows = []
    for size in (0, 10_000) if quick else (0, 100, 1_000, 10_000, 100_000):
        pair = [lattice(size, **rods) if size else truss(**rods) for rods in (KINDS["elastic"], stiff)]
        rods = pair[0].rods.count
        steps = max(20, 2_000_000 // rods)
        pinned, bent = best_of_each(*(program_runner(model, steps) for model in pair), rounds=15)
        rows.append(
            {
                "rods": rods,
                "truss_ns_per_rod": pinned / steps / rods * 1e9,
                "bending_ns_per_rod": bent / steps / rods * 1e9,
                "bending_us_per_step": bent / steps * 1e6,
                "ratio": bent / pinned,
            }
        )
    return rows


def _step_cost(kind: str, model: Model) -> Row:
    rods = model.rods.count
    steps = max(20, 300_000 // rods)
    ours = program_runner(model, steps)
    plain = _plain_runner(model, steps, full=kind != "elastic")
    seconds, plain_seconds = best_of_each(ours, plain)
    return {
        "kind": kind,
        "rods": rods,
        "particles": model.particles.count,
        "us_per_step": seconds / steps * 1e6,
        "ns_per_rod": seconds / steps / rods * 1e9,
        "plain_ns_per_rod": plain_seconds / steps / rods * 1e9,
        "ratio_to_plain": seconds / plain_seconds,
    }


def sharing(*, quick: bool) -> list[Row]:
    """Nanoseconds per rod and step of one model on one core and on all, numbered in order and at random.

    Beside it a plain kernel, and the form of smaller models, which has one loop over all rods.
    """
    sizes = (100_000,) if quick else (30_000, 100_000, 1_000_000)
    return [
        _shared(kind, size, at_random)
        for kind in (["elastic"] if quick else KINDS)
        for size in sizes
        for at_random in (False, True)
    ]


def _shared(kind: str, size: int, at_random: bool) -> Row:
    models = [lattice(size, at_random=at_random, **KINDS[kind]) for _ in range(3)]
    steps, everything = max(20, 2_000_000 // size), cores()
    runners = {
        "plain": _plain_runner(models[0], steps, full=kind != "elastic"),
        "one_loop": program_runner(models[0], steps, form=MANY),
        "one_core": program_runner(models[1], steps, form=VERY_MANY),
        "all_cores": program_runner(models[2], steps, on=everything, form=VERY_MANY),
    }
    best = best_of_each(*runners.values(), rounds=15, clock=time.perf_counter)
    rods = models[0].rods.count
    costs = {f"{name}_ns_per_rod": t / steps / rods * 1e9 for name, t in zip(runners, best, strict=True)}
    return {
        "kind": kind,
        "rods": rods,
        "numbered": "at random" if at_random else "in order",
        **costs,
        "cores": everything,
        "speedup": min(best[:3]) / best[3],
    }


def _plain_runner(model: Model, steps: int, *, full: bool) -> Callable[[], None]:
    kernel, arrays = (full_verlet if full else elastic_verlet), arrays_of(model, full=full)
    return lambda: kernel(steps, STEP, *arrays)


def peers(*, quick: bool) -> list[Row]:
    """The same triangle by the thesis' program, and lattices of springs by pymunk, per rod and step."""
    from tests.reference.thesis import Simulation as Thesis

    steps = 300 if quick else 2_000
    thesis = Thesis(document(truss(damping=1.0)))
    started = time.perf_counter()
    thesis.run(STEP, steps)
    seconds = time.perf_counter() - started
    rows = [
        {"peer": "thesis' program, one object per element", "rods": 3, "ns_per_rod": seconds / steps / 3 * 1e9}
    ]
    for size in (1_000,) if quick else (1_000, 10_000):
        rows.append(_pymunk_springs(size))
    return rows


def _pymunk_springs(size: int) -> Row:
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
        {"what": "import pinjoint", "seconds": _fresh("import numpy, esper, pinjoint")},
        {"what": "first frame of the window, paused", "seconds": _fresh(_FIRST_FRAME.format(frames=1))},
        {"what": "first step in the window", "seconds": _fresh(_FIRST_FRAME.format(frames=3))},
    ]


_FIRST_FRAME = """
import os; os.environ["SDL_VIDEODRIVER"] = "dummy"
from pinjoint.documents import models
from pinjoint.app import App
app = App(models.load("isostatic"))
if {frames} > 1: app.session.press("space")
for _ in range({frames}): app.frame(1 / 60)
"""


def _fresh(code: str) -> float:
    best = np.inf
    usual = {**os.environ, "PYTHONDONTWRITEBYTECODE": ""}
    for _ in range(3):
        started = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], env=usual, check=True, stdout=subprocess.DEVNULL)
        best = min(best, time.perf_counter() - started)
    return float(best)


def besides_steps() -> list[Row]:
    """µs that a run of a triangle costs besides its steps: what it takes for one, less what a step takes."""
    choices = {"time_step": STEP, "collisions": False}
    session = Session.open(document(truss(damping=0.0)) | {"settings": choices})
    simulation = session.simulation
    runs: dict[str, Callable[[int], object]] = {
        "Session.run, with its entry for undo": lambda steps: session.run(steps=steps),
        "the engine alone": simulation.advance,
    }
    rows = []
    for title, run in runs.items():
        one, many = (min(_seconds(run, steps) for _ in range(200)) for steps in (1, 1001))
        rows.append({"run": title, "us_besides_steps": 1e6 * (one - (many - one) / 1000)})
    return rows


def _seconds(run: Callable[[int], object], steps: int) -> float:
    started = time.perf_counter()
    run(steps)
    return time.perf_counter() - started


def memory() -> list[Row]:
    """Bytes per element: of its columns, and of its entity, handle and name beside them."""
    tracemalloc.start()
    model = lattice(10_000)
    gc.collect()
    whole, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    tables = model.rods, model.particles
    columns = {table.name: sum(table.column(name)[:1].nbytes for name in table.fields) for table in tables}
    allocated = sum(len(table.entity) * (columns[table.name] + table.entity.itemsize) for table in tables)
    beside = (whole - allocated) / sum(table.count for table in tables)
    return [
        {"what": f"columns of {name}", "bytes_per_element": float(size)} for name, size in columns.items()
    ] + [{"what": "entity, handle and name", "bytes_per_element": beside}]


def large_models(*, quick: bool) -> list[Row]:
    """Seconds of one core to create particles and rods in bulk, and to open them from a file."""
    began = time.process_time()
    model = lattice(100_000 if quick else 1_000_000)
    created = time.process_time() - began
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "lattice.json"
        models.save(model, path)
        count, began = model.rods.count, time.process_time()
        del model
        Session.open(path)
        opened = time.process_time() - began
    return [
        {"what": f"create {count} rods in bulk", "seconds": created},
        {"what": f"open {count} rods from a file", "seconds": opened},
    ]


def report(*, quick: bool) -> dict[str, list[Row]]:
    """Everything this benchmark measures, by table."""
    steps = step_costs(quick=quick)
    return {
        "steps": steps,
        "scaling": scaling(steps),
        "ceiling": ceilings(steps),
        "bending": bending(quick=quick),
        "cores": sharing(quick=quick),
        "skipping": skipping.report(),
        "besides_steps": besides_steps(),
        "memory": memory(),
        "peers": peers(quick=quick),
        "start": [*start_up(), *large_models(quick=quick)],
    }


def draw(tables: dict[str, list[Row]], path: Path) -> None:
    """Nanoseconds per rod and step over the number of rods, as a PNG."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.5), layout="constrained")
    axes = figure.add_subplot(xscale="log", yscale="log", xlabel="rods", ylabel="ns per rod and step, one core")
    for kind in KINDS:
        rows = [row for row in tables["steps"] if row["kind"] == kind]
        rods = [row["rods"] for row in rows]
        (line,) = axes.plot(rods, [row["ns_per_rod"] for row in rows], "o-", label=kind)
        plain = [row["plain_ns_per_rod"] for row in rows]
        axes.plot(rods, plain, ":", color=line.get_color(), label=f"{kind}, plain kernel")
    ceiling = tables["ceiling"]
    least = [max(row["memory_ns_per_rod"], row["arithmetic_ns_per_rod"]) for row in ceiling]
    axes.plot([row["rods"] for row in ceiling], least, "k--", label="elastic, this machine's ceiling")
    for row in tables["peers"]:
        axes.plot([row["rods"]], [row["ns_per_rod"]], "x", label=row["peer"])
    axes.legend(fontsize="small")
    figure.savefig(path, dpi=150)
