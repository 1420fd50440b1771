"""How long a variant of a small model takes in a sweep: by one model, opened anew, by several workers."""

import os
import time
from collections.abc import Callable
from typing import Any

from pinjoint.commands.analysis import Analysis
from pinjoint.sweeps.execution import VariantRunner, compute_all
from pinjoint.sweeps.plan import Plan, plan_of
from pinjoint.sweeps.run import sweep

ANALYSES = {"settled": Analysis(load_factors=(1.0,)), "run to rest": Analysis()}

Row = dict[str, Any]


def report(*, quick: bool) -> dict[str, list[Row]]:
    """The tables: a variant of the triangle, a whole sweep, workers."""
    return {
        "variants": [_variant(name, analysis, 100 if quick else 1000) for name, analysis in ANALYSES.items()],
        "sweep": whole(1000 if quick else 10_000),
        "workers": workers(200 if quick else 2000),
    }


def _variant(name: str, analysis: Analysis, count: int) -> Row:
    """CPU time for each variant: with one model, and with the model opened anew."""
    plan, numbers = _plan(analysis, count), range(count)
    runner = VariantRunner(plan)
    return {
        "analysis": name,
        "variants": count,
        "one_model_cpu_ms": _cpu(lambda: [runner.records(n) for n in numbers]) * 1e3 / count,
        "opened_anew_cpu_ms": _cpu(lambda: [VariantRunner(plan).records(n) for n in numbers]) * 1e3 / count,
    }


def whole(count: int) -> list[Row]:
    """A Monte Carlo sweep of the triangle until at rest, from the beginning to the table."""
    vary, measures = ["rods.*.stiffness~normal(164640,5%)"], ["rods.*.axial_force"]
    sweep("isostatic", vary, measures, samples=100)  # compiles
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
        done = len(next(arriving))
        first = time.perf_counter()
        done += sum(map(len, arriving))
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
