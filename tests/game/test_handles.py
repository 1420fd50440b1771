"""Whatever has a cross or a knob works in every scene in which it is drawn."""

from collections.abc import Iterator

import pytest

from pinjoint import Session
from pinjoint.components.field import Vector
from pinjoint.components.model import Model
from pinjoint.components.view import Readout
from pinjoint.documents.library import data_in
from pinjoint.editor.scenes.form import FormScene
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.golden.scenes import SCENES, Scene, Window, opened, pressed
from tests.golden.states import STATES

WIDE = Window(1280, 800)
LOW = Window(640, 480)


def _beside_properties(window: Window) -> Session:
    session = pressed(window, "m", "j", source="hyperstatic_yield")
    session.select(session.rods["CD"])
    for key in ("o", "ctrl+l", "return"):
        session.press(key)
    return session


def _all_folded(window: Window) -> Session:
    session = opened(window, "hyperstatic_yield")
    session.select(session.rods["CD"])
    for key in ("m", "j", "ctrl+h", "o", "x"):
        session.press(key)
    return session


def _opened_from_a_run(window: Window) -> Session:
    session = pressed(window, "m", "j", "space", source="hyperstatic")
    session.click(0.0, 0.75)
    session.press("return")
    return session


EVERYWHERE: dict[str, Scene] = SCENES | STATES
MORE: dict[str, Scene] = {
    "panels beside properties": _beside_properties,
    "all folded": _all_folded,
    "properties opened from a run": _opened_from_a_run,
}


def handles(session: Session) -> Iterator[tuple[str, Vector]]:
    """What can be closed or moved in the picture: what it is called, and a pixel to press."""
    session.update_view()
    for shown, view in session.stages:
        if not isinstance(shown, Model) or view.page is not None:
            continue
        for hit in compose(shown, view, load_theme(view.theme)).hits:
            if isinstance(hit.item, Readout) and hit.action:
                yield f"panel {hit.item.title} {hit.item.plot}", hit.middle
        for place in view.slider_places:
            left, right, y = place.track
            elsewhere = 0.75 if place.control.share < 0.5 else 0.25
            yield f"slider {place.control.title}", (left + elsewhere * (right - left), y)
            yield f"button {place.control.title} {place.control.button}", place.button.middle


def state_of(session: Session) -> tuple[object, ...]:
    """What a handle may change."""
    panels = [name for name, _ in handles(session) if name.startswith("panel")]
    sliders = [repr(view.sliders) for _, view in session.stages]
    return panels, sliders


@pytest.mark.parametrize("window", [WIDE, LOW], ids=["wide", "low"])
@pytest.mark.parametrize("name", [*EVERYWHERE, *MORE])
def test_every_cross_and_knob_that_is_drawn_works(name: str, window: Window) -> None:
    with data_in():
        session = (EVERYWHERE | MORE)[name](window)
        if session.view.menu is not None or session.view.help:
            session.press("escape")  # which take clicks first
        session.footer = None  # while a lesson is played, clicks are its own
        done: set[str] = set()
        while left := [(what, at) for what, at in handles(session) if what not in done]:
            what, at = left[0]
            done.add(what)
            before, scene = state_of(session), session.scene
            session.press("click", at)
            session.update_view()
            assert state_of(session) != before, what
            assert session.scene == scene, what
        close_form(session)


def close_form(session: Session) -> None:
    scene = session.scenes.active
    if isinstance(scene, FormScene):
        close = scene.layout(session).place_of("close")
        assert close is not None
        session.press("click", close.middle)
        assert session.scenes.active is not scene
