"""How long a variant of a small model takes in a sweep: together with others, one by one, by several workers."""

import os
import time
from collections.abc import Callable
from typing import Any

from pinjoint.commands.reports.report import Analysis
from pinjoint.session import Session
from pinjoint.sweeps.execution import Worker, compute_all
from pinjoint.sweeps.plan import Plan, plan_of
from pinjoint.sweeps.run import sweep
from pinjoint.sweeps.variant_runner import VariantRunner
from pinjoint.systems.program.parallel import cores
from tests.benchmarks.models import lattice

ANALYSES = {"settled": Analysis(load_factors=(1.0,)), "run to rest": Analysis()}
STEP = 1e-6  # s
STEPS = {"dop853": 400, "velocity_verlet": 8000}  # the first is what small models are run by

Row = dict[str, Any]


def report(*, quick: bool) -> dict[str, list[Row]]:
    """The tables: a variant of the triangle, steps beside those of a large model, a whole sweep, workers."""
    return {
        "variants": variants(100 if quick else 1000),
        "steps": steps(10_000),
        "sweep": whole(10_000 if quick else 100_000),
        "workers": workers(200 if quick else 2000),
    }


def variants(count: int) -> list[Row]:
    """CPU time for each variant: computed together, one by one with one model, and with the model opened anew."""
    return [_variant(name, analysis, count) for name, analysis in ANALYSES.items()]


def _variant(name: str, analysis: Analysis, count: int) -> Row:
    plan, numbers = _plan(analysis, count), range(count)
    worker, runner = Worker(plan), VariantRunner(plan)
    together = _cpu(lambda: worker.together(numbers)) * 1e3 / count
    return {
        "analysis": name,
        "variants": count,
        "together_cpu_ms": together if worker.at_a_time > 1 else "–",
        "one_by_one_cpu_ms": _cpu(lambda: [runner.records(n) for n in numbers]) * 1e3 / count,
        "opened_anew_cpu_ms": _cpu(lambda: [VariantRunner(plan).records(n) for n in numbers]) * 1e3 / count,
    }


def steps(count: int) -> list[Row]:
    """CPU time of steps of so many elastic triangles beside that of a lattice with as many rods."""
    return [row for integrator, taken in STEPS.items() for row in _steps(count, integrator, taken)]


def _steps(count: int, integrator: str, taken: int) -> list[Row]:
    elastic = ("rods.*.damping=0", "rods.*.tensile_strength=0", "rods.*.compressive_strength=0")
    fixed = (f"settings.integrator={integrator}", f"settings.time_step={STEP}")
    vary = ["rods.*.stiffness~normal(164640,5%)"]
    analysis = Analysis(times=(STEP * taken,))
    plan = plan_of("isostatic", vary, ["residual"], analysis, (*elastic, *fixed), count, 1)
    worker = Worker(plan, cores())
    session = Session(lattice(3 * count, damping=0.0))
    session.model.settings.integrator, session.model.settings.time_step = integrator, STEP
    rows = []
    for name, rods, work in [
        ("batch of triangles", 3 * count, lambda: _together(worker, count)),
        ("one lattice", session.rods.count, lambda: session.simulation.advance(taken)),
    ]:
        seconds = _cpu(work)
        ns = seconds / taken / rods * 1e9
        about = {"integrator": integrator, "model": name, "rods": rods, "steps": taken}
        rows.append({**about, "cpu_seconds": seconds, "ns_per_rod": ns})
    return rows


def _together(worker: Worker, count: int) -> None:
    """As many at a time as a sweep computes."""
    for first in range(0, count, worker.at_a_time):
        worker.together(range(first, min(first + worker.at_a_time, count)))


def whole(count: int) -> list[Row]:
    """A Monte Carlo sweep of the triangle until at rest, from the beginning to the table."""
    vary, measures = ["rods.*.stiffness~normal(164640,5%)"], ["rods.*.axial_force"]
    sweep("isostatic", vary, measures, samples=min(count, 10_000))  # compiles
    began, cpu = time.perf_counter(), time.process_time()
    sweep("isostatic", vary, measures, samples=count)
    seconds = time.perf_counter() - began
    return [{"variants": count, "seconds": seconds, "cpu_seconds": time.process_time() - cpu}]


def workers(count: int) -> list[Row]:
    """Variants that are settled by so many processes, beside what it takes until one is done with something."""
    plan = _plan(ANALYSES["settled"], count)
    rows = []
    for processes in (1, os.cpu_count() or 1):
        started = time.perf_counter()
        arriving = compute_all(plan, range(count), processes, None)
        done = len(next(arriving).outcomes)
        first = time.perf_counter()
        done += sum(len(part.outcomes) for part in arriving)
        assert done == count
        rows.append(
            {
                "workers": processes,
                "variants": count,
                "first_after_s": first - started,
                "seconds": time.perf_counter() - started,
            }
        )
    return rows


def _plan(analysis: Analysis, samples: int) -> Plan:
    vary = ["rods.*.stiffness~normal(164640,5%)"]
    return plan_of("isostatic", vary, ["rods.*.axial_force"], analysis, (), samples, 1)


def _cpu(work: Callable[[], object]) -> float:
    """Seconds of the second time; the first compiles."""
    work()
    began = time.process_time()
    work()
    return time.process_time() - began
