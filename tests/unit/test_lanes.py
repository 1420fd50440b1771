"""Functions for lanes, made from those for one: run as plain Python, lane by lane the same."""

from __future__ import annotations

import ast
import math
from typing import Any

import numpy as np
import pytest

from game.sweeps.lanes import LaneFunction, functions, lanes_for

LANES = 3
SOURCE = '''
LIMIT = 0.5
SLOW = True

@compiled
def pull(dt, displacement, force, rods_between, rods_stiffness):
    """What becomes of forces, and the largest stretch."""
    most = 0.0
    for i in range(force.shape[0]):
        for d in range(2):
            total = 0.0
            for j in range(2):
                total += (j + 1) * displacement[i, d]
            force[i, d] = dt * total
    if SLOW:
        most += dt
    for r in range(rods_between.shape[0]):
        a = rods_between[r, 0]
        b = rods_between[r, 1]
        stretch = displacement[b, 0] - displacement[a, 0]
        if stretch > LIMIT:
            stretch = math.sqrt(stretch)
        part = rods_stiffness[r] * stretch
        force[a, 0] += part
        force[b, 0] -= part
        most = max(most, stretch)
    return most
'''


def run(source: str, *given: Any) -> Any:
    scope: dict[str, Any] = {"math": math, "LANES": LANES, "LIMIT": 0.5, "SLOW": True}
    scope |= dict.fromkeys(("compiled", "apart"), lambda function: function)
    exec(source, scope)
    return scope["pull"](*given)


@pytest.mark.parametrize("constants", [{}, {"SLOW": True}])
def test_each_lane_is_what_it_is_alone(constants: dict[str, Any]) -> None:
    made = LaneFunction(functions(SOURCE)["pull"], ("dt",), constants=constants)
    rng = np.random.default_rng(0)
    between = np.array([[0, 1], [1, 2], [0, 2]], dtype=np.uint32)
    dt, displacement, stiffness = rng.random(LANES), rng.random((3, 2, LANES)), rng.random((3, LANES))
    force, result = np.full((3, 2, LANES), 7.0), np.full(LANES, 7.0)
    spare = np.zeros((made.spares, LANES))
    run(made.source, dt, displacement, force, between, stiffness, spare, result)
    for lane in range(LANES):
        expected = np.full((3, 2), 7.0)
        most = run(SOURCE, dt[lane], displacement[..., lane], expected, between, stiffness[:, lane])
        assert np.array_equal(force[..., lane], expected)
        assert result[lane] == most


CALLS = """
def square(dt, work):
    for i in range(work.shape[0]):
        work[i] *= dt
    for i in range(work.shape[0]):
        work[i] *= dt
    last = work[0]
    for i in range(work.shape[0]):
        last += dt
    return last


def pull(dt, work):
    most = 0.0
    for step in range(2):
        twice = 2.0 * dt + step
        last = square(twice, work)
        most += last - twice
    return most
"""


def test_calls_hand_over_all_lanes_and_what_they_return_comes_back() -> None:
    known = functions(CALLS)
    square = LaneFunction(known["square"], ("dt",))
    made = LaneFunction(known["pull"], ("dt",), {"square": square})
    assert made.spares > square.spares > 0  # none of the caller's is used by whom it calls
    rng = np.random.default_rng(0)
    dt, work = rng.random(LANES), rng.random((4, LANES))
    given, result = work.copy(), np.zeros(LANES)
    run("\n\n".join([square.source, made.source]), dt, given, np.zeros((made.spares, LANES)), result)
    for lane in range(LANES):
        alone = work[:, lane].copy()
        assert result[lane] == run(CALLS, dt[lane], alone)
        assert np.array_equal(given[:, lane], alone)


def test_loops_over_lanes_are_innermost_and_what_is_looked_up_is_looked_up_once() -> None:
    source = LaneFunction(functions(SOURCE)["pull"], ("dt",)).source
    for loop in (n for n in ast.walk(ast.parse(source)) if isinstance(n, ast.For)):
        if ast.unparse(loop.target) == "lane":
            assert not any(isinstance(n, ast.For) for n in ast.walk(loop) if n is not loop)
            assert "rods_between" not in ast.unparse(loop)


def test_larger_models_have_fewer_lanes() -> None:
    assert [lanes_for(particles) for particles in (3, 25, 50, 100, 200)] == [128, 128, 64, 32, 32]
