"""What the lessons on moments, sway, plastic hinges and repeated loads say: textbooks' numbers against the program."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq, linprog

from pinjoint import Session
from pinjoint.components.model import Model
from pinjoint.documents import models
from pinjoint.documents.document import document
from pinjoint.lessons import progress
from pinjoint.lessons.course import Course
from pinjoint.lessons.judging import copy_of
from pinjoint.lessons.tasks import Lesson
from pinjoint.scripts.expectation import read
from pinjoint.scripts.script import Script
from pinjoint.systems.statics.settle import settle

FIXED, WIND = 64.0 / 8.0**2, 1.6 * np.array([40.0, 30.0])  # M_p/L²; of the gusts, at feet and corners
SWAY = brentq(lambda u: u * math.tan(u) - 12.0, 0.1, 1.57)
BRACED = brentq(lambda u: u * u * math.sin(u) / (math.sin(u) - u * math.cos(u)) + 4.0, 3.2, 4.4)


@pytest.fixture(autouse=True)
def nothing_kept() -> Iterator[None]:
    """No progress of this person changes."""
    with progress.not_kept():
        yield


def begun(name: str, task: int) -> tuple[Session, Course]:
    session = Session(Model())
    session.course = course = Course(session, Lesson(Script(name)))
    course.begin(task - 1)
    return session, course


def truth(name: str, task: int) -> tuple[Session, str]:
    """A copy in which a task is judged, and what it asks."""
    session, course = begun(name, task)
    return copy_of(session, document(session.model), course.task.after), "".join(course.task.asked[:1])


@pytest.mark.parametrize(
    ("name", "task", "by_hand", "within"),
    [
        ("12_frames", 6, 40.0 / 2.0 * 4.0, 1e-3),
        ("19_plastic_hinges", 1, 12.0 * FIXED / 10.0, 1e-9),
        ("19_plastic_hinges", 3, 14.0 * 8.0**2 / 8.0 - 64.0, 1e-9),
        ("19_plastic_hinges", 4, 16.0 * FIXED / 10.0, 1e-9),
        ("19_plastic_hinges", 6, 6.0 * 70.0 / (4.0 * 40.0 + 3.0 * 40.0), 1e-9),
        ("20_loads_that_come_again", 1, WIND[0] - 60.0, 5e-3),
    ],
)
def test_the_number_that_is_asked_is_that_of_the_formula(
    name: str, task: int, by_hand: float, within: float
) -> None:
    assert read(*truth(name, task)) == pytest.approx(by_hand, rel=within)


def test_a_beam_sinks_five_times_as_fast_after_its_clamps_have_yielded() -> None:
    model = models.load("fixed_beam_collapse")
    sunk = [s.displacement[1, 1] for s in settle(model, [0.5, 1.0, 1.3, 1.5], "first-order").states]
    assert (sunk[3] - sunk[2]) / 0.2 == pytest.approx(5.0 * (sunk[1] - sunk[0]) / 0.5, rel=1e-9)


def test_the_frame_sways_and_braced_it_bulges_by_the_stability_functions() -> None:
    """β = EI_b h/(EI_c L) = 2: u tan u = 6 β, and u² sin u/(sin u − u cos u) = −2 β."""
    free = truth("14_buckling", 4)[0]
    load = 1000.0 / 4.0**2 / 50.0
    assert read(free, "statics.buckling") == pytest.approx(SWAY**2 * load, rel=1e-3)
    assert free.buckling(2).factors[1] == pytest.approx(BRACED**2 * load, rel=2e-3)
    for braced in (held, with_a_diagonal):
        assert read(Session.open(braced(document(free.model))), "statics.buckling") == pytest.approx(
            BRACED**2 * load, rel=2e-3
        )
    [slider] = free.model.sliders  # of a spring at C, which hinders the sway as a roller does
    free.particles["C"].support_springs = slider.last, 0.0
    assert read(free, "statics.buckling") == pytest.approx(BRACED**2 * load, rel=2e-3)
    assert [f"{50.0 * u * u * load:.4g}" for u in (SWAY, BRACED)] == [
        "131.5",
        "916.3",
    ]  # as its description says
    assert [round(math.pi / u, 2) for u in (SWAY, BRACED)] == [2.17, 0.82]
    assert abs((BRACED / SWAY) ** 2 - 7.0) < 0.05


def held(content: dict[str, Any]) -> dict[str, Any]:
    return content | {
        "particles": [p | {"fixed": [True, False]} if p["name"] == "C" else p for p in content["particles"]]
    }


def with_a_diagonal(content: dict[str, Any]) -> dict[str, Any]:
    return content | {"rods": [*content["rods"], {"name": "brace", "between": ["A", "C"], "stiffness": 5e5}]}


def turned(model: Model, factors: list[float]) -> np.ndarray[Any, Any]:
    """The plastic rotations of the feet after each load step, (steps, 2)."""
    states = settle(model, factors, "first-order").states
    assert len(states) == len(factors)
    return np.array([[s.plastic_rotation[0, 0], s.plastic_rotation[2, 1]] for s in states])


def test_gusts_from_one_side_shake_down_and_those_from_both_do_not() -> None:
    model = truth("20_loads_that_come_again", 1)[0].model
    one = turned(model, [1.6, 0.0, 1.6, 0.0, 1.6])
    assert np.abs(one[0]).min() > 1e-4
    assert one == pytest.approx(np.tile(one[0], (5, 1)), rel=1e-6)
    both = np.diff(turned(model, [1.6, -1.6, 1.6, -1.6, 1.6]), axis=0)[1:]
    assert both == pytest.approx(np.array([1.0, -1.0, 1.0])[:, None] * both[0], rel=1e-6)
    assert np.abs(both).min() > np.abs(one[0]).max()
    left = settle(model, [1.6, 0.0], "first-order").final.diagrams["bending_moment"]
    assert np.abs(left[0]) == pytest.approx([WIND[0] - 60.0, 4.0 * 35.0 * 1.6 / 2.0 - 60.0 - WIND[1]], rel=5e-3)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_hinge_beside_the_support_is_best_where_moments_are_equal(side: float) -> None:
    """q L² (3 − 2 √2)/2 at L (3 − 2 √2) from G, on either side; at the joint 1 m beside it, q 5²/8."""
    session = truth("21_challenges_hinges", 1)[0]
    session.rods["6" if side < 0 else "7"].hinged = (True, False) if side < 0 else (False, True)
    assert read(session, "largest rods.*.largest_moment.value") == pytest.approx(31.25, rel=1e-6)
    session.particles["F" if side < 0 else "H"].position = (6.0 + side * 6.0 * (3.0 - 2.0 * 2.0**0.5), 0.0)
    best = 10.0 * 36.0 * (3.0 - 2.0 * 2.0**0.5) / 2.0
    assert read(session, "largest rods.*.largest_moment.value") == pytest.approx(best, rel=1e-6)


def test_the_portal_needs_less_than_equal_members_and_no_less_than_linear_programming() -> None:
    """Least sum of M_p: M_C − (M_B + M_D)/2 = V L/4, M_B − M_A + M_E − M_D = H h."""
    ends = ((0, 1), (1, 2), (2, 3), (3, 4))
    rows = [
        [sign * (m == end) for m in range(5)] + [-(k == rod) for k in range(4)]
        for rod, pair in enumerate(ends)
        for end in pair
        for sign in (1, -1)
    ]
    balance = [[0, -0.5, 1, -0.5, 0, 0, 0, 0, 0], [-1, 1, 0, -1, 1, 0, 0, 0, 0]]
    bounds = [(None, None)] * 5 + [(20.0, None)] * 4
    best = linprog([0] * 5 + [1] * 4, rows, [0] * 16, balance, [90.0, 120.0], bounds)
    session = truth("21_challenges_hinges", 2)[0]
    assert read(session, "statics.collapse") == pytest.approx(6.0 * 60.0 / 300.0, rel=1e-9)
    for rod, moment in zip(session.rods, best.x[5:], strict=True):
        rod.plastic_moment = float(moment)
    assert best.fun < 199.0
    assert read(session, "statics.collapse") == pytest.approx(1.0, rel=1e-9)
    session, course = begun("21_challenges_hinges", 2)
    for rod, moment in zip(session.rods, best.x[5:], strict=True):
        rod.plastic_moment = 1.000001 * float(moment)
    course.check()
    assert course.accepted, course.said


def test_wind_bends_the_beam_from_tension_below_to_tension_above() -> None:
    session = truth("12_frames", 5)[0]
    beam = session.rods["BC"]
    assert beam.bending_moment == pytest.approx((80.0, -80.0), rel=1e-3)
    assert beam.shear[0] == pytest.approx(beam.shear[1], rel=1e-9)
