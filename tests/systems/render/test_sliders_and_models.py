"""What stands about a fitted model is not covered by the sliders."""

import pytest

from pinjoint import Session
from pinjoint.components.slider import ARROW, SUPPORT
from pinjoint.components.view import drawn_places
from pinjoint.documents import models
from tests.golden.scenes import Window, opened

WINDOWS = [Window(640, 480), Window(1024, 640)]
REACH = SUPPORT + ARROW  # points below a particle that a support and an arrow take


def clear(session: Session) -> bool:
    """Whether no particle stands so near to the sliders that its support or an arrow may lie under them."""
    session.update_view()
    x, y = session.view.camera.to_pixels(drawn_places(session.model)).T
    return not any(
        ((x - ARROW < place.right) & (y + REACH > place.top + 1.0) & (y < place.bottom)).any()
        for place in session.view.slider_places
    )


@pytest.mark.parametrize("window", WINDOWS, ids=str)
def test_a_fitted_model_stands_beside_or_above_the_sliders(window: Window) -> None:
    for name in models.bundled():
        session = opened(window, name)
        assert clear(session), name
        session.press("e") if session.model.rods.count and session.model.rods.count < 100 else None
        assert clear(session), f"{name}, settled"


def test_a_new_slider_lets_the_model_make_room() -> None:
    session = opened(Window(1000, 720), "hyperstatic")
    for rod in list(session.rods)[:4]:
        session.select(rod)
        session.press("ctrl+l")
    assert len(session.view.slider_places) == 5
    assert clear(session)
    scale = session.view.camera.scale
    session.press("wheel up", (500.0, 300.0))
    session.select(session.rods[4])
    session.press("ctrl+l")
    assert session.view.camera.scale > scale, "who looks closer is left alone"


def test_in_a_low_window_a_load_above_is_whole() -> None:
    session = opened(Window(640, 280))
    session.update_view()
    assert session.view.camera.to_pixels(drawn_places(session.model))[:, 1].min() > ARROW
