"""Pulling a running particle by a spring."""

import math

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.snapshot import Snapshot
from pinjoint.systems.run import real_time
from tests.systems.edit.hand import EMPTY, FRAME, assert_same_state, preview, run_frames


def test_dragging_a_running_particle_pulls_it_with_a_spring_whose_work_is_accounted_for() -> None:
    session = Session.open(EMPTY | {"particles": [{"name": "A", "position": [0, 0]}]})
    session.press("space")
    session.frame(FRAME)
    session.press("drag", session.point(0.0, 0.0))
    session.press("drag to", session.point(1.0, 0.0))
    session.frame(FRAME)
    shown = preview(session)
    assert shown.kind == "pull"
    assert shown.end == pytest.approx((1.0, 0.0), abs=1e-12)
    run_frames(session, 120)
    # Two seconds of a critically damped spring with ω = 4π/s: 25 periods of decay, e⁻²⁵ is left.
    assert session.particles["A"].displacement == pytest.approx((1.0, 0.0), abs=1e-6)
    session.press("drag to", session.point(1.0, 1.0))
    run_frames(session, 6)
    energy = session.energy
    assert energy.kinetic > 0.0
    # The work of the hand, by the trapezoidal rule, is the particle's kinetic energy.
    assert energy.work == pytest.approx(energy.kinetic, rel=1e-4)
    velocity = session.particles["A"].velocity
    session.press("drop")
    session.frame(FRAME)
    assert session.particles["A"].velocity == velocity
    assert session.view.preview is None


@pytest.mark.filterwarnings("error")
def test_what_could_not_begin_to_move_can_be_taken_hold_of() -> None:
    """A speed that is too large to compute with leaves the run without a step size."""
    particles = [{"name": "A", "position": [0, 0], "velocity": [1e300, 0]}, {"name": "B", "position": [1, 0]}]
    session = Session.open({"format": "pinjoint model", "version": 1, "particles": particles})
    session.press("space")
    session.frame(1 / 60)
    session.drag((1.0, 0.0), (1.2, 0.3))
    assert session.particles["B"].position == (1.0, 0.0)


def test_pulling_a_structure_bends_it_by_the_force_that_is_shown(triangle: Session) -> None:
    triangle.particles["B"].force = (0.0, 0.0)
    triangle.press("space")
    triangle.frame(FRAME)
    triangle.press("drag", triangle.point(1.0, 1.0))
    triangle.press("drag to", triangle.point(1.5, 1.0))
    run_frames(triangle, 600)
    x, y = triangle.document.pull.force
    # 164.64 kN for 100 px, at 50 px or so (the truss gives way by less than a millimetre).
    assert x == pytest.approx(0.5 * 164.64, rel=0.01)
    # Statics of the triangle under a horizontal force H at B: AB = H/√2, BC = −H/√2.
    assert triangle.rods["AB"].axial_force == pytest.approx(x / math.sqrt(2.0), rel=2e-3)
    assert triangle.rods["BC"].axial_force == pytest.approx(-x / math.sqrt(2.0), rel=2e-3)
    assert float(preview(triangle).label.removesuffix(" kN")) == pytest.approx(math.hypot(x, y), rel=1e-3)
    triangle.press("space")
    assert (triangle.scene, triangle.gesture, triangle.document.pull.hand) == ("pause", None, None)


def test_a_second_pull_compiles_nothing(triangle: Session) -> None:
    triangle.press("space")
    run_frames(triangle, 3)
    seconds = []
    for x, y in ((1.0, 1.0), (0.0, 0.0), (1.0, 1.0)):
        triangle.press("drag", triangle.point(x, y))
        triangle.press("drag to", triangle.point(x + 0.2, y))
        run_frames(triangle, 3)
        triangle.press("drop")
        run_frames(triangle, 3)
        seconds.append(triangle.simulation.programs.compile_seconds)
    assert seconds[0] == seconds[1] == seconds[2] > 0.0


def test_a_pull_is_undone_with_its_run(triangle: Session) -> None:
    before = Snapshot.take(triangle.model)
    triangle.press("space")
    run_frames(triangle, 2)
    triangle.press("drag", triangle.point(1.0, 1.0))
    triangle.press("drag to", triangle.point(1.4, 1.4))
    run_frames(triangle, 10)
    triangle.press("space")
    assert triangle.particles["B"].displacement != (0.0, 0.0)
    triangle.press("ctrl+z")
    assert_same_state(triangle, before)


def flick(session: Session, start: tuple[float, float], by: tuple[float, float], frames: int = 12) -> None:
    """Drag from a point (m) by a vector (m) in so many frames, and let go in the midst of it."""
    session.press("drag", session.point(*start))
    for number in range(1, frames + 1):
        session.press(
            "drag to", session.point(*(s + b * number / frames for s, b in zip(start, by, strict=True)))
        )
        session.frame(FRAME)
    session.press("drop")


def test_a_flick_throws_at_the_velocity_of_the_pointer() -> None:
    session = Session.open(EMPTY | {"particles": [{"name": "A", "position": [0, 0]}]})
    session.press("space")
    session.frame(FRAME)
    flick(session, (0.0, 0.0), (1.2, -0.6))
    assert "thrown at 6.7" in session.notice  # √5 · 0.6 m in 12/60 s
    assert session.notice.endswith(" m/s.")  # events follow it as sentences
    assert session.particles["A"].velocity == pytest.approx((6.0, -3.0), rel=1e-9)
    run_frames(session, 6)
    assert session.particles["A"].velocity == pytest.approx((6.0, -3.0), rel=1e-9)
    assert session.energy.work == pytest.approx(session.energy.kinetic, rel=1e-9)
    assert not session.document.edited


def test_a_pointer_that_rests_before_it_lets_go_throws_nothing() -> None:
    session = Session.open(EMPTY | {"particles": [{"name": "A", "position": [0, 0]}]})
    session.press("space")
    session.frame(FRAME)
    session.press("drag", session.point(0.0, 0.0))
    session.press("drag to", session.point(1.0, 0.0))
    run_frames(session, 6)
    before = session.particles["A"].velocity
    session.press("drop")
    assert (session.particles["A"].velocity, session.notice) == (before, "")


def test_only_what_rods_and_supports_leave_free_is_thrown(
    triangle: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    for limit in ("BUDGET", "LONGEST_STEP", "AT_ONCE"):  # frames keep the pace on any machine
        monkeypatch.setattr(real_time, limit, 10.0)
    session = Session.open("pendulum")
    session.press("space")
    session.frame(FRAME)
    bob = session.particles["bob"]
    session.press("drag", session.point(*bob.position))
    for number in range(1, 13):
        session.press("drag to", session.point(1.0 + 0.025 * number, -0.075 * number))
        session.frame(FRAME)
    held, arm = np.array(bob.velocity), np.add(bob.position, bob.displacement)
    session.press("drop")
    thrown, across = np.array(bob.velocity), np.array([arm[1], -arm[0]]) / np.hypot(*arm)
    assert thrown @ arm == pytest.approx(held @ arm, rel=1e-9)  # as fast along the arm as before
    assert thrown @ across == pytest.approx(
        np.array([1.5, -4.5]) @ across, rel=0.15
    )  # whole steps: one more or less
    assert "thrown at" in session.notice
    triangle.press("space")
    triangle.frame(FRAME)
    flick(triangle, (1.0, 1.0), (0.5, 0.5))
    assert (triangle.notice, triangle.document.pull.hand) == ("", None)


def test_a_throw_is_gone_through_again_and_taken_back_with_its_run() -> None:
    session = Session.open("pendulum")
    before = Snapshot.take(session.model)
    session.press("space")
    session.frame(FRAME)
    flick(session, session.particles["bob"].position, (0.3, -0.9))
    run_frames(session, 6)
    session.press("space")
    assert session.step(1)  # to the end of a step that is under way
    thrown, timeline = Snapshot.take(session.model), session.document.timeline
    steps = session.model.clock.steps
    assert timeline.go_to(timeline.first)
    assert timeline.go_to(steps)
    assert_same_state(session, thrown)
    session.press("ctrl+z")
    session.press("ctrl+z")
    assert_same_state(session, before)


def test_pulling_harder_than_a_rod_bears_makes_it_yield_and_says_so(triangle: Session) -> None:
    triangle.particles["B"].force = (0.0, 0.0)
    triangle.press("space")
    triangle.frame(FRAME)
    triangle.press("drag", triangle.point(1.0, 1.0))
    triangle.press("drag to", triangle.point(1.0, 3.2))
    run_frames(triangle, 400)
    assert {triangle.rods.names[row] for row in triangle.rods.plastic_strain.nonzero()[0]} == {"AB", "BC"}
    assert "yield" in triangle.view.status.notice
    assert preview(triangle).label.endswith(" kN")
