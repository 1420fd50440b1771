"""How long a variant of a small model takes in a sweep, and what several workers make of it."""

from __future__ import annotations

import os
import time
from typing import Any

from game.report import Analysis
from game.sweeps.execution import outcomes
from game.sweeps.plan import Plan
from game.sweeps.run import plan_of
from game.sweeps.specimen import compute

ANALYSES = {"settled": Analysis(load_factors=(1.0,)), "run to rest": Analysis()}

Row = dict[str, Any]


def report(*, quick: bool) -> dict[str, list[Row]]:
    """The tables: milliseconds per variant of the triangle, here and by workers."""
    return {"variants": variants(100 if quick else 1000), "workers": workers(200 if quick else 10_000)}


def variants(count: int) -> list[Row]:
    """CPU time in this process, beside that of opening the model anew for each variant."""
    rows = []
    for name, analysis in ANALYSES.items():
        plan = _plan(analysis, count)
        compute(plan, [0])  # compiles
        started = time.process_time()
        compute(plan, range(count))
        kept = time.process_time()
        for number in range(count):
            compute(plan, [number])
        opened = time.process_time()
        rows.append(
            {
                "analysis": name,
                "variants": count,
                "cpu_ms_per_variant": (kept - started) * 1e3 / count,
                "opened_anew_cpu_ms": (opened - kept) * 1e3 / count,
            }
        )
    return rows


def workers(count: int) -> list[Row]:
    """By so many processes, beside what it takes until the first of them is done with something."""
    plan = _plan(ANALYSES["run to rest"], count)
    rows = []
    for processes in (1, os.cpu_count() or 1):
        started = time.perf_counter()
        arriving = outcomes(plan, range(count), processes, None)
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
