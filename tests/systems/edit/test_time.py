"""Going through time: steps, pace, restart."""

import pytest

from pinjoint import Session
from pinjoint.components.snapshot import Snapshot
from pinjoint.documents.history.timeline import Timeline
from pinjoint.editor.actions import time as actions
from pinjoint.systems.collision.free import flight
from pinjoint.systems.edit.pull import Hand
from tests.reference.models import model, particle
from tests.systems.edit import hand
from tests.systems.edit.hand import FRAME, assert_same_state, run_frames


def opened() -> Session:
    """A triangle that takes thousands of steps until it rests."""
    return hand.opened(integrator="velocity_verlet")


@pytest.fixture
def triangle() -> Session:
    return opened()


def test_steps_forward_and_back_are_the_same_bit_for_bit(triangle: Session) -> None:
    states = [Snapshot.take(triangle.model)]
    for _ in range(200):
        triangle.press("right")
        states.append(Snapshot.take(triangle.model))
    assert triangle.model.clock.steps == 200
    for step in (199, 198, 150, 129, 128, 127, 3):
        while triangle.model.clock.steps > step:
            triangle.press("left")
        assert_same_state(triangle, states[step])
    for _ in range(10):
        triangle.press("right")
    assert_same_state(triangle, states[13])


def test_stepping_back_through_a_run_in_frames(triangle: Session) -> None:
    triangle.press("space")
    run_frames(triangle, 600)
    triangle.press("space")
    last = triangle.model.clock.steps
    target = last - 321
    reference = opened()
    reference.run(steps=target)
    assert triangle.step(-321)
    assert_same_state(triangle, Snapshot.take(reference.model))
    triangle.press("shift+left")
    assert triangle.model.clock.steps < target - 1
    assert triangle.step(321 + target - triangle.model.clock.steps)
    assert triangle.model.clock.steps == last


def test_stepping_back_after_a_pull_does_not_pull_again(
    triangle: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    triangle.press("space")
    run_frames(triangle, 20)
    triangle.press("drag", triangle.point(1.0, 1.0))
    triangle.press("drag to", triangle.point(1.2, 1.0))
    run_frames(triangle, 10)
    triangle.press("drop")
    triangle.frame(FRAME)
    triangle.press("space")
    triangle.press("right")  # to the end of the step that is under way
    states = [Snapshot.take(triangle.model)]
    for _ in range(4):
        triangle.press("right")
        states.append(Snapshot.take(triangle.model))
    taken: list[Hand | None] = []
    monkeypatch.setattr(triangle.document.pull, "take", taken.append)
    for step in (3, 1, 0):
        while triangle.model.clock.steps > states[step].columns["clock.steps"][0]:
            triangle.press("left")
        assert_same_state(triangle, states[step])
    assert taken == []


def test_going_back_stops_where_something_was_edited_and_undo_goes_on(triangle: Session) -> None:
    triangle.run(steps=300)
    triangle.particles["B"].force = (10.0, 0.0)
    triangle.run(steps=50)
    assert not triangle.step(-100)
    assert triangle.model.clock.steps == 300
    triangle.press("left")
    assert "as far back" in triangle.notice


def test_moments_are_thinned_out_within_a_memory_bound(triangle: Session) -> None:
    timeline = Timeline(
        triangle.simulation, triangle.document.pull, memory=20 * triangle.simulation.checkpoint().state.nbytes
    )
    with timeline.recording():
        triangle.simulation.advance(20_000)
    assert triangle.simulation.halted
    steps = triangle.model.clock.steps
    assert steps > 1000
    assert timeline.kept <= 20
    reference = opened()
    reference.run(steps=777)
    assert timeline.go_to(777)
    assert_same_state(triangle, Snapshot.take(reference.model))
    assert timeline.kept <= 21


def test_pace_goes_from_a_hundred_thousandth_to_fast(triangle: Session) -> None:
    for _ in range(40):
        triangle.press("-")
    assert triangle.document.live.clock.factor == pytest.approx(1e-5, rel=1e-12)
    triangle.press("space")
    run_frames(triangle, 5)
    # Less than one step in five frames, yet time does not stand still: what is due is carried over.
    triangle.press("0")
    run_frames(triangle, 5)
    assert triangle.model.clock.steps > 0
    for _ in range(40):
        triangle.press("+")
    assert triangle.document.live.clock.factor == pytest.approx(1e3, rel=1e-12)


BOX = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
FAST = model(
    [particle("A", 0.5, 0.5, velocity=[1000.0, 300.0], radius=0.1), particle("B", 0.2, 0.8, radius=0.1)],
    [],
    components={"walls.Wall": [{"start": a, "end": b} for a, b in zip(BOX, BOX[1:] + BOX[:1], strict=True)]},
    settings={"restitution": 1.0, "time_step": 1.0},
)


@pytest.mark.parametrize("key", ["right", "shift+right"])
def test_a_step_with_too_many_impacts_is_refused_and_nothing_has_happened(
    key: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They hold more than a person can wait for."""
    monkeypatch.setattr(flight, "EVENTS_AT_ONCE", 50)
    session, other = Session.open(FAST), Session.open(FAST)
    with monkeypatch.context() as patch:
        patch.setattr(actions, "MOST_IMPACTS", 100)
        session.press(key)
    assert "more than 100 impacts" in session.notice
    assert (session.time, session.model.clock.collisions, len(session.impacts)) == (0.0, 0, 0)
    session.step()  # a script waits
    other.step()
    assert session.model.clock.collisions == other.model.clock.collisions > 1000
    assert session.particles["A"].velocity == other.particles["A"].velocity
    session.undo()
    assert session.time == 0.0
