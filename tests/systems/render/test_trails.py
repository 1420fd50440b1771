"""Trails of what is selected, and a view that follows a particle."""

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.view import drawn_positions
from pinjoint.systems.render.marks import Strokes
from pinjoint.systems.render.model.sheet import measure
from pinjoint.systems.render.model.tools import draw_trails
from pinjoint.systems.render.theme import load_theme
from tests.systems.edit.hand import FRAME, run_frames


@pytest.fixture
def swinging() -> Session:
    session = Session.open("pendulum")
    session.press("space")
    run_frames(session, 10)
    return session


def test_what_is_selected_leaves_a_trail_that_ends_where_time_is_taken_back(swinging: Session) -> None:
    assert not swinging.view.trails.places.size
    swinging.select(swinging.particles["bob"])
    run_frames(swinging, 20)
    places = swinging.view.trails.places
    assert places.shape == (20, 1, 2)
    assert np.hypot(*places[:, 0].T) == pytest.approx(1.0, rel=1e-3)  # on the circle of the arm
    assert places[-1, 0] == pytest.approx(drawn_positions(swinging.model)[1])
    sheet = measure(swinging.model, swinging.view, load_theme("light"))
    (path,) = draw_trails(sheet)
    assert isinstance(path, Strokes)
    assert len(path.start) == 19
    swinging.press("r")
    swinging.frame(FRAME)
    assert len(swinging.view.trails.places) == 1
    swinging.select()
    swinging.frame(FRAME)
    assert not swinging.view.trails.places.size


def test_the_view_goes_with_the_particle_that_it_follows(swinging: Session) -> None:
    bob, view = swinging.particles["bob"], swinging.view
    x, y = drawn_positions(swinging.model)[bob.row].tolist()
    swinging.click(x, y, "right click")
    assert "follow" in [entry.action for group in view.menu.groups for entry in group]
    swinging.act("follow")
    (pixel,) = view.camera.to_pixels(drawn_positions(swinging.model)[[bob.row]])
    run_frames(swinging, 30)
    assert view.camera.to_pixels(drawn_positions(swinging.model)[bob.row]) == pytest.approx(pixel, abs=1e-6)
    swinging.press("drag middle", (30.0, 0.0))  # pans, and goes on following
    run_frames(swinging, 5)
    moved = view.camera.to_pixels(drawn_positions(swinging.model)[bob.row])
    assert moved == pytest.approx(np.add(pixel, (30.0, 0.0)), abs=1e-6)
    swinging.act("follow")
    assert view.followed is None
    swinging.act("follow")
    swinging.model.delete([bob])
    swinging.frame(FRAME)
    assert view.followed is None
