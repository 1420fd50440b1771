"""Run time against error for every integrator, scipy's, and the thesis' scheme, on problems with known answers."""

import math
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pinjoint import Session
from pinjoint.documents import models
from tests.benchmarks.motion import equations
from tests.benchmarks.problems import Array, Problem, problems

CONTROLLED = ("dop853", "esdirk4")
FIXED = ("velocity_verlet", "rk4", "semi_implicit_euler", "taylor2")
SCIPY = ("DOP853", "LSODA", "Radau")
THESIS = "thesis' program"
THESIS_STEP = 1e-7  # s, the thesis' own
LEVELS = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10)
FLOOR = 3e-12  # relative; below it the references themselves are not sure

Row = dict[str, Any]


class OutOfTime(Exception):
    """A peer that does not come to an end, as LSODA where the motion is not smooth."""


Run = Callable[[float], tuple[float, Array]]  # of a tolerance or step size: (seconds, displacements)


def report(*, quick: bool) -> dict[str, list[Row]]:
    """Every run, the fastest method at each error, and the thesis' scheme at its own step."""
    budget = 0.1 if quick else 0.4
    runs = [row for problem in problems(quick=quick) for row in runs_of(problem, budget)]
    tables = {"runs": runs, "fastest": fastest(runs), "at_the_thesis_step": at_the_thesis_step(runs)}
    return {title: rows for title, rows in tables.items() if rows}


def runs_of(problem: Problem, budget: float) -> Iterator[Row]:
    """All methods on one problem, each finer and finer until a run takes longer than the budget (s)."""
    exact = problem.exact()
    tolerances = [10.0**-k for k in range(2, 14)]
    for method in CONTROLLED:
        yield from _finer(problem, exact, method, "tolerance", tolerances, ours(problem, method), budget)
    for method in FIXED:
        yield from _finer(
            problem, exact, method, "step", _steps(problem, method), ours(problem, method), budget
        )
    for method in SCIPY:
        run = _scipys(problem, method, exact, 10.0 * budget)
        yield from _finer(problem, exact, f"scipy {method}", "tolerance", tolerances[:11], run, budget)
    cost = _cost_per_thesis_step(problem)
    sizes = [h for h in _steps(problem, "taylor2") if cost * problem.time / h < budget]
    if problem.title == "triangle's transient":
        sizes.append(THESIS_STEP)  # however long it takes, some seconds
    yield from _finer(problem, exact, THESIS, "step", sizes, _thesis(problem), math.inf)


def _finer(
    problem: Problem, exact: Array, method: str, kind: str, settings: Iterable[float], run: Run, budget: float
) -> Iterator[Row]:
    for setting in settings:
        try:
            seconds, found = run(setting)
        except OutOfTime:
            return
        error = float(np.linalg.norm(found - exact) / np.linalg.norm(exact))
        yield {
            "problem": problem.title,
            "method": method,
            "setting": kind,
            "value": setting,
            "seconds": seconds,
            "error": error,
        }
        if seconds > budget or error < FLOOR:
            return


def ours(problem: Problem, method: str) -> Run:
    """One of our integrators; its argument is the tolerance, or the step where that is fixed."""
    knob = "tolerance" if method in CONTROLLED else "time_step"

    def run(setting: float) -> tuple[float, Array]:
        choices = {"integrator": method, "collisions": False, knob: setting}
        session = Session.open(problem.document | {"settings": choices})
        simulation = session.simulation
        simulation.advance(0)
        beginning = simulation.checkpoint()

        def once() -> Array:
            simulation.run_to(problem.time)
            return session.particles.displacement

        return _timed(once, lambda: simulation.resume(beginning))

    return run


def _steps(problem: Problem, method: str) -> list[float]:
    """Fixed steps that divide the time: from the largest stable one on, each half of the last."""
    session = Session.open(problem.document | {"settings": {"integrator": method, "collisions": False}})
    session.simulation.advance(0)
    limit = session.simulation.step_size.stable
    longest = limit if 0.0 < limit < math.inf else problem.time / 64
    fewest = math.ceil(problem.time / longest) + 1
    return [problem.time / (fewest * 2**k) for k in range(20)]


def _scipys(problem: Problem, method: str, exact: Array, patience: float) -> Run:
    from scipy.integrate import solve_ivp

    rates, start = equations(models.load(problem.document))
    scale, size = float(np.abs(exact).max()), exact.size

    def run(tolerance: float) -> tuple[float, Array]:
        deadline = time.perf_counter() + patience

        def in_time(t: float, y: Array) -> Array:
            if time.perf_counter() > deadline:
                raise OutOfTime
            return rates(t, y)

        def once(right_hand_side: Callable[[float, Array], Array] = rates) -> Array:
            span = (0.0, problem.time)
            found = solve_ivp(right_hand_side, span, start, method, rtol=tolerance, atol=tolerance * scale)
            return found.y[:size, -1].reshape(-1, 2)

        once(in_time)
        return _timed(once)

    return run


def _thesis(problem: Problem) -> Run:
    from tests.reference.thesis import Simulation

    def run(step: float) -> tuple[float, Array]:
        document = problem.document | {"settings": {"collisions": False}}
        simulation = Simulation(document)
        started = time.perf_counter()
        simulation.run(step, round(problem.time / step))
        seconds = time.perf_counter() - started
        return seconds, np.array(list(simulation.result()["displacement"].values()))

    return run


def _cost_per_thesis_step(problem: Problem) -> float:
    from tests.reference.thesis import Simulation

    simulation = Simulation(problem.document | {"settings": {"collisions": False}})
    started = time.perf_counter()
    simulation.run(1e-12, 10)
    return (time.perf_counter() - started) / 10


def _timed(run: Callable[[], Array], reset: Callable[[], None] = lambda: None) -> tuple[float, Array]:
    """The shortest time (s) of up to a hundred runs, fewer if they take long, and the result."""
    best, spent = math.inf, 0.0
    for _ in range(100):
        reset()
        started = time.perf_counter()
        found = run()
        seconds = time.perf_counter() - started
        best, spent = min(best, seconds), spent + seconds
        if spent > 0.2:
            break
    return best, found


# --- what they say ---------------------------------------------------------------------------------------


def fastest(runs: Sequence[Row]) -> list[Row]:
    """By problem and error: the least time in which one of ours, and one of scipy's, is at least as exact."""
    rows = []
    for problem in dict.fromkeys(row["problem"] for row in runs):
        of_problem = [row for row in runs if row["problem"] == problem]
        for level in LEVELS:
            peers = [row for row in of_problem if row["method"].startswith("scipy")]
            mine = [row for row in of_problem if row["method"] in CONTROLLED + FIXED]
            best, peer = _least(mine, level), _least(peers, level)
            rows.append(
                {
                    "problem": problem,
                    "error": level,
                    "ours": best["method"] if best else "–",
                    "ms": 1e3 * best["seconds"] if best else math.nan,
                    "scipy": peer["method"].removeprefix("scipy ") if peer else "–",
                    "scipy_ms": 1e3 * peer["seconds"] if peer else math.nan,
                    "ratio": peer["seconds"] / best["seconds"] if best and peer else math.nan,
                }
            )
    return rows


def at_the_thesis_step(runs: Sequence[Row]) -> list[Row]:
    """The triangle's transient: the thesis' program at its own step, and what reaches its error soonest."""
    own = [row for row in runs if row["method"] == THESIS and row["value"] == THESIS_STEP]
    if not own:
        return []
    thesis = own[0]
    same = [row for row in runs if row["problem"] == thesis["problem"]]
    mine = _least([row for row in same if row["method"] in CONTROLLED + FIXED], thesis["error"])
    peer = _least([row for row in same if row["method"].startswith("scipy")], thesis["error"])
    return [
        {
            "method": row["method"],
            "ms": 1e3 * row["seconds"],
            "error": row["error"],
            "times_faster": thesis["seconds"] / row["seconds"],
        }
        for row in (thesis, peer, mine)
        if row
    ]


def _least(rows: Iterable[Row], level: float) -> Row | None:
    return min((row for row in rows if row["error"] <= level), key=lambda row: row["seconds"], default=None)


def draw(tables: dict[str, list[Row]], path: Path) -> None:
    """Run time against error, log–log, one small panel per problem."""
    from matplotlib.figure import Figure

    runs = tables["runs"]
    titles = list(dict.fromkeys(row["problem"] for row in runs))
    methods = [*CONTROLLED, *FIXED, *(f"scipy {name}" for name in SCIPY), THESIS]
    columns = 4 if len(titles) > 4 else len(titles)
    lines = -(-len(titles) // columns)
    figure = Figure(figsize=(3.0 * columns, 2.7 * lines + 0.7), layout="constrained")
    panels = figure.subplots(lines, columns, squeeze=False).ravel()
    for panel, title in zip(panels, titles, strict=False):
        for number, method in enumerate(methods):
            points = [
                (r["error"], r["seconds"]) for r in runs if r["problem"] == title and r["method"] == method
            ]
            points = [(error, seconds) for error, seconds in points if 1e-14 < error < 1.0]
            if points:
                panel.loglog(*zip(*points, strict=True), label=method, **_style(number, method))
        panel.set_title(title, fontsize=10)
        panel.grid(visible=True, alpha=0.3)
        panel.invert_xaxis()
        panel.tick_params(labelsize=8)
    for panel in panels[len(titles) :]:
        panel.axis("off")
    figure.supxlabel("relative error of the displacements at the end", fontsize=10)
    figure.supylabel("run time (s)", fontsize=10)
    known = {
        text: line for panel in panels for line, text in zip(*panel.get_legend_handles_labels(), strict=True)
    }
    figure.legend(known.values(), known.keys(), loc="outside upper center", ncols=5, fontsize=8)
    figure.savefig(path, dpi=110)


def _style(number: int, method: str) -> dict[str, Any]:
    """Ours in solid colours, peers dashed in greys."""
    if method in CONTROLLED + FIXED:
        return {"color": f"C{number}", "marker": "o", "markersize": 3, "linewidth": 1.6}
    peer = number - len(CONTROLLED + FIXED)
    return {
        "color": f"{0.15 * peer:.2f}",
        "linestyle": "--",
        "marker": "xv+s"[peer],
        "markersize": 4,
        "linewidth": 1,
    }
