"""Arrows of loads between the ends of rods, and moments, dragged by a hand."""

from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.load import Load
from pinjoint.systems.edit.arrows import arrow_scale
from tests.game.test_frames_by_mouse import opened
from tests.verification.test_span_loads import simple


def beam(**load: Any) -> Session:
    """A beam of 4 m in 400 pixels, so stiff that it looks straight, with one load between its ends."""
    session = opened(simple(load, bending_stiffness=1e7))
    session.view.camera.scale = 100.0
    session.frame(0.0)
    return session


def drag(session: Session, at: tuple[float, float], *ways: tuple[float, float]) -> tuple[float, float]:
    """From a point of the beam (m) and so many pixels off it (down), by ways in pixels, to the last pixel."""
    x, y = session.view.camera.to_pixels((at[0], 0.0)).tolist()
    begun = x, y + at[1]
    session.press("drag", begun)
    for across, down in ways:
        x, y = begun[0] + across, begun[1] + down
        session.press("drag to", (x, y))
    return x, y


def test_a_force_is_dragged_at_its_tail_in_steps_and_back_by_one_undo() -> None:
    session = beam(start=1.0, force=[0.0, -10.0])
    scale = arrow_scale(session.model, session.view, "force")
    x, y = drag(session, (1.0, -30.0), (2.0, -12.0), (4.0, -18.0))
    [load] = session.span_loads
    assert load.force == (0.0, pytest.approx(-10.0 - 20.0 * scale))
    session.frame(0.0)
    assert session.view.preview.label in session.notice  # it is told at the pointer
    session.press("shift+drag to", (x - 4.0, y - 5.0))
    assert load.force == (0.0, pytest.approx(-10.0 - 23.0 * scale))
    session.press("drop", (x - 4.0, y - 5.0))
    session.undo()
    assert load.force == (0.0, -10.0)


def test_at_the_rod_it_is_dragged_along_it_in_round_steps() -> None:
    session = beam(start=1.0, force=[0.0, -10.0])
    x, y = drag(session, (1.0, -2.0), (83.0, 30.0))
    [load] = session.span_loads
    assert (load.start, load.force) == (pytest.approx(1.8), (0.0, -10.0))
    assert "180 cm" in session.notice
    session.press("shift+drag to", (x, y))
    assert load.start == pytest.approx(1.83)
    session.press("drag to", (x + 900.0, y))
    assert load.start == 4.0
    session.press("escape")
    assert load.start == 1.0
    drag(session, (2.0, -2.0), (83.0, 30.0))  # elsewhere on the rod, that is what moves
    assert load.start == 1.0
    assert session.rods["AB"].ends[0].position != (0.0, 0.0)


def test_a_distributed_load_is_dragged_at_either_end_and_as_a_whole() -> None:
    session = beam(start=1.0, end=3.0, start_intensity=[0.0, -4.0], end_intensity=[0.0, -8.0])
    [load] = session.span_loads
    scale = arrow_scale(session.model, session.view, "end_intensity")
    assert scale == arrow_scale(session.model, session.view, "start_intensity")
    for x, start, end in ((1.2, 1, 0), (2.8, 0, 1), (2.0, 1, 1)):
        drag(session, (x, -13.0), (0.0, -20.0))
        assert load.start_intensity == (0.0, pytest.approx(-4.0 - start * 20.0 * scale))
        assert load.end_intensity == (0.0, pytest.approx(-8.0 - end * 20.0 * scale))
        session.press("escape")
    drag(session, (3.0, -2.0), (-52.0, 0.0))
    assert (load.start, load.end) == (1.0, pytest.approx(2.5))
    drag(session, (1.0, -2.0), (250.0, 0.0))
    assert "is before its start" in session.notice
    assert load.start == 1.0


def test_local_forces_turn_with_their_rod() -> None:
    model = simple({"start": 2.0, "force": [0.0, -10.0], "direction": "local"}, bending_stiffness=1e7)
    model["particles"][1]["position"] = [0.0, 4.0]  # upright: its left is at the left
    session = opened(model)
    scale = arrow_scale(session.model, session.view, "force")
    x, y = session.view.camera.to_pixels((0.0, 2.0)).tolist()
    session.press("drag", (x - 30.0, y))
    session.press("drag to", (x - 50.0, y + 10.0))
    assert session.span_loads[0].force == pytest.approx((10.0 * scale, -10.0 - 20.0 * scale))


@pytest.mark.parametrize("of", ["rod", "particle", "load"])
def test_moments_are_dragged_to_the_left_counter_clockwise(of: str) -> None:
    session = beam(**{"start": 2.0, "moment": 6.0} if of == "rod" else {"start": 2.0, "force": [0.0, -1e-3]})
    element: Any = session.span_loads[0]
    middle = 2.0
    if of != "rod":
        element, middle = session.particles["A"], 0.0
        if of == "load":
            element = session.model.create(Load, on=[0])[0]
        element.moment = 6.0
    scale = arrow_scale(session.model, session.view, "moment")
    session.frame(0.0)
    drag(session, (middle, -17.0), (-20.0, 3.0))
    assert element.moment == pytest.approx(6.0 + 20.0 * scale)
    session.press("escape")
    assert element.moment == 6.0
    assert np.allclose(session.particles["A"].position, 0.0)
