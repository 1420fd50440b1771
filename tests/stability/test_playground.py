"""The playground: models that a person pulls and throws about; `pulled` checks them for an hour."""

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.editor.scenes.load import PLAYED
from pinjoint.systems.physics.pace import natural_pace
from pinjoint.systems.run import real_time
from tests.stability.pulled import pulled_at_random
from tests.systems.edit.hand import FRAME, run_frames


@pytest.fixture(autouse=True)
def keeps_the_pace(monkeypatch: pytest.MonkeyPatch) -> None:
    """Frames take all the steps that are due, on any machine."""
    for limit in ("BUDGET", "LONGEST_STEP", "AT_ONCE"):
        monkeypatch.setattr(real_time, limit, 10.0)


def opened(name: str) -> Session:
    """As a click on its picture opens it."""
    session = Session.open("isostatic")
    session.resize(1280, 800)
    session.press("d")
    session.type(name)
    session.press("return")
    return session


def drag(session: Session, name: str, by: tuple[float, float], frames: int, held: int = 0) -> None:
    particle = session.particles[name]
    x, y = np.add(particle.position, particle.displacement).tolist()
    session.press("drag", session.point(x, y))
    for number in range(1, frames + 1):
        session.press("drag to", session.point(x + by[0] * number / frames, y + by[1] * number / frames))
        session.frame(FRAME)
    run_frames(session, held)
    session.press("drop")


def place(session: Session, name: str) -> tuple[float, float]:
    x, y = np.add(session.particles[name].position, session.particles[name].displacement).tolist()
    return x, y


@pytest.mark.parametrize("name", PLAYED)
def test_it_runs_at_once_in_real_time_and_says_what_to_do(name: str) -> None:
    session = opened(name)
    assert session.scene == "simulation"
    assert session.notice == session.model.description.partition(". ")[0] + "."
    assert session.notice.startswith(("Drag", "Flick", "Pull"))
    assert natural_pace(session.model) == 1.0
    run_frames(session, 6)
    assert session.view.status.notice.startswith(session.notice)  # before what happens meanwhile


@pytest.mark.parametrize("name", PLAYED)
def test_pulled_at_random_its_account_stays_closed(name: str) -> None:
    assert pulled_at_random(name, 3.0).time >= 3.0


def test_the_columns_knock_one_another_over() -> None:
    session = opened("falling_columns")
    run_frames(session, 30)
    assert place(session, "head 8") == pytest.approx((3.15, 1.0), abs=1e-3)  # they stand by themselves
    drag(session, "head 1", (0.3, 0.0), 8)
    run_frames(session, 300)
    assert all(place(session, f"head {number}")[1] < 0.2 for number in range(1, 9))


def test_the_catapult_shoots() -> None:
    session = opened("catapult")
    run_frames(session, 30)
    resting = place(session, "ball")
    assert resting == pytest.approx((-1.83, 0.98), abs=0.05)
    drag(session, "weight", (-0.2, -1.0), 6, held=24)
    run_frames(session, 60)
    assert place(session, "ball")[0] > resting[0] + 3.0


def test_the_ball_crosses_the_bridge() -> None:
    session = opened("rope_bridge")
    run_frames(session, 60)
    drag(session, "ball", (0.7, 0.0), 9)
    assert "thrown at 4.6" in session.notice
    run_frames(session, 240)
    assert place(session, "ball")[0] > 4.0


def test_ropes_of_the_bridge_yield_where_a_lifted_plank_falls() -> None:
    session = opened("rope_bridge")
    run_frames(session, 30)
    drag(session, "plank 11", (0.0, 2.0), 15, held=40)
    assert session.energy.dissipated_plastic == 0.0
    run_frames(session, 90)
    assert session.energy.dissipated_plastic > 10.0
