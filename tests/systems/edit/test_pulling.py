"""Pulling a running particle by a spring."""

import math

import pytest

from pinjoint import Session
from pinjoint.components.snapshot import Snapshot
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
