"""A run that is watched: frames take as many steps as fit, and what is done to a large model is seen first."""

import math
from types import SimpleNamespace
from typing import Any

import pytest

from pinjoint.documents import models
from pinjoint.session import Session
from pinjoint.systems.collision.free import discs
from pinjoint.systems.physics.pace import natural_pace
from pinjoint.systems.program.compiler import Choice, Unfinished
from pinjoint.systems.run import real_time
from pinjoint.systems.run.real_time import BUDGET, RealTimeRunner
from tests.benchmarks.models import lattice
from tests.reference.bits import columns, different


class Machine:
    """In place of a simulation: `cost` says what a step takes by the clock; a step lets 1 µs pass."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, cost: float) -> None:
        self.model = SimpleNamespace(
            clock=SimpleNamespace(time=0.0, step_size=1e-6),
            particles=SimpleNamespace(count=3),
            rods=SimpleNamespace(count=3),
        )
        self.halted, self.armed, self.armed_revision = False, True, 0
        self.compute_seconds, self.cost = 0.0, cost
        monkeypatch.setattr(real_time, "natural_pace", lambda model: 1.0)

    def advance(self, steps: int) -> int:
        return steps

    def run_to(self, target: float, most: int, *, whole: bool) -> int:
        taken = min(most, round((target - self.model.clock.time) / 1e-6))
        self.model.clock.time += 1e-6 * taken
        self.compute_seconds += self.cost * taken
        return taken


@pytest.mark.parametrize("before", [1e-7, 1e-5, 0.02])
@pytest.mark.parametrize("after", [1e-7, 1e-5, 0.02])
def test_a_frame_is_short_from_the_moment_at_which_steps_cost_another_thing(
    monkeypatch: pytest.MonkeyPatch, before: float, after: float
) -> None:
    machine: Any = Machine(monkeypatch, before)
    runner = RealTimeRunner(machine)
    for _ in range(20):
        runner.frame(1 / 60)
    machine.cost = after
    Choice.changes += 1
    for _ in range(3):
        spent, passed = machine.compute_seconds, machine.model.clock.time
        runner.frame(1 / 60)
        assert machine.compute_seconds - spent <= max(BUDGET, after) * 1.5
        expected = 1 / 60 if after <= BUDGET / 20000 else 0.5e-6 * BUDGET / after
        assert machine.model.clock.time - passed >= expected * 0.999


@pytest.mark.parametrize("times", [10.0, 100.0])
def test_a_burst_of_impacts_keeps_no_frame(monkeypatch: pytest.MonkeyPatch, times: float) -> None:
    """Nothing says beforehand that steps become dear, or cheap again."""
    machine: Any = Machine(monkeypatch, 1e-5)
    runner = RealTimeRunner(machine)
    for _ in range(20):
        runner.frame(1 / 60)
    machine.cost *= times
    spent = machine.compute_seconds
    runner.frame(1 / 60)
    assert machine.compute_seconds - spent < real_time.AT_ONCE * times + BUDGET
    machine.cost /= times
    runner.frame(1 / 60)
    passed = machine.model.clock.time
    runner.frame(1 / 60)
    assert machine.model.clock.time - passed > 0.5e-6 * BUDGET / machine.cost


def test_what_does_not_fit_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    machine: Any = Machine(monkeypatch, 1e-5)
    runner = RealTimeRunner(machine)
    for _ in range(3):
        runner.frame(1 / 60)
    assert runner.clock.lagging
    assert runner.clock.shown_pace == pytest.approx(BUDGET / 1e-5 * 1e-6 * 60, rel=0.05)
    machine.cost = 1e-8
    for _ in range(3):
        runner.frame(1 / 60)
    assert not runner.clock.lagging
    assert runner.clock.shown_pace == 1.0


def test_a_step_that_is_left_in_its_midst_comes_to_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    """A pile that falls together has hundreds of impacts within one step."""
    whole = Session.open("pile")
    whole.run(steps=100)
    session = Session.open("pile")
    monkeypatch.setattr(real_time, "LONGEST_STEP", -1.0)  # so that each step is left as often as can be
    monkeypatch.setattr(discs, "WORK_AT_ONCE", 1)
    runner, left = RealTimeRunner(session.simulation), 0
    runner.clock.factor = 1000.0  # whole steps alone
    monkeypatch.setattr(runner.clock, "affordable", lambda seconds: int(seconds == BUDGET))
    clock = session.model.clock
    while clock.steps < 100:
        before = clock.steps
        runner.frame(1 / 60)
        left += clock.steps == before
    assert left > 0
    assert Choice.deadline == math.inf
    assert different(columns(session.model), columns(whole.model)) == []
    assert list(session.impacts.time) == list(whole.impacts.time)


def test_a_step_left_in_its_midst_is_taken_anew_where_less_is_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    session = Session.open("pile")
    session.run(steps=50)
    simulation, time = session.simulation, session.time
    monkeypatch.setattr(Choice, "deadline", 0.0)
    monkeypatch.setattr(discs, "WORK_AT_ONCE", 1)
    with pytest.raises(Unfinished):
        simulation.advance(50)
    monkeypatch.setattr(Choice, "deadline", math.inf)
    steps = session.model.clock.steps
    simulation.run_to(session.time + 0.5 * session.model.clock.step_size)
    other = Session.open("pile")
    other.run(steps=steps)
    other.simulation.run_to(other.time + 0.5 * other.model.clock.step_size)
    assert time < session.time
    assert different(columns(session.model), columns(other.model)) == []


# --- edits -----------------------------------------------------------------------------------------------

FRAME = 1.0 / 60.0


def test_an_edit_of_a_large_model_is_shown_before_the_run_gets_ready() -> None:
    session = Session(lattice(2_500, damping=1.0))
    session.press("space")
    session.frame(FRAME)
    assert not session.simulation.armed
    for _ in range(6):
        session.frame(FRAME)
    assert session.model.clock.steps > 0
    session.particles[0].force = (0.0, -1.0)
    session.frame(FRAME)
    assert not session.simulation.armed
    session.frame(FRAME)
    assert session.simulation.armed
    before = session.model.clock.steps
    for _ in range(6):
        session.frame(FRAME)
    assert session.model.clock.steps > before


def test_a_small_model_goes_on_at_once() -> None:
    session = Session.open("hyperstatic")
    session.press("space")
    session.frame(FRAME)
    assert session.model.clock.steps > 0


# --- the pace that suits a model -------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", ["pendulum", "newtons_cradle", "collision_vi", "billiards_break", "ball_on_frame"]
)
def test_what_moves_freely_is_shown_in_real_time(name: str) -> None:
    assert natural_pace(models.load(name)) == 1.0


@pytest.mark.parametrize("name", ["isostatic", "tower", "eulers_columns", "snap_through", "portal"])
def test_structures_are_shown_in_slow_motion(name: str) -> None:
    assert natural_pace(models.load(name)) <= 0.5


def test_a_pendulum_that_hangs_straight_is_no_structure() -> None:
    """Its load stretches it only, but a hand will swing it."""
    particles = [{"name": "A", "position": [0, 0], "fixed": [True, True]}, {"name": "B", "position": [0, -1]}]
    rods, weight = [{"name": "AB", "between": ["A", "B"]}], {"acceleration": [0, -9.81]}
    content = {"format": "pinjoint model", "version": 1, "particles": particles, "rods": rods}
    assert natural_pace(Session.open(content | {"environment": weight}).model) == 1.0
