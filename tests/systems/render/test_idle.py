"""Nothing is drawn, and nothing looked for under the pointer, while nothing changes."""

import gc
from collections.abc import Iterator
from typing import Any

import numpy as np
import pygame
import pytest

import pinjoint.systems.edit.hover
from pinjoint import Session
from pinjoint.app import SELDOM, App
from pinjoint.documents import models
from pinjoint.editor.frame import Frame
from pinjoint.systems.edit.picking import pick
from pinjoint.systems.input import pygame_input
from pinjoint.systems.render import picture
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.pygame_render import PygameRender
from pinjoint.systems.render.ui import toolbar


@pytest.fixture
def app(monkeypatch: pytest.MonkeyPatch) -> Iterator[App]:
    """A window with a triangle in it that has come to rest, which does not sleep between frames."""
    monkeypatch.setattr(pygame_input, "IDLE_PAUSE", 0.0)
    window = App(models.load("isostatic"))
    frames(window, 3)
    yield window
    window.close()


def frames(app: App, count: int) -> int:
    """How many of so many frames drew a picture."""
    drawn = 0
    for _ in range(count):
        app.frame(1 / 60)
        drawn += app.render.drawn
    return drawn


def test_a_paused_window_draws_nothing(app: App) -> None:
    assert frames(app, 20) == 0


def test_what_changes_is_drawn_once(app: App) -> None:
    app.session.press("i")
    assert frames(app, 20) == 1
    app.session.particles["B"].force = (1.0, 2.0)
    assert frames(app, 20) == 1
    app.session.view.camera.pan((3.0, 0.0))
    assert frames(app, 20) == 1


def test_a_running_window_draws_every_frame_and_one_at_rest_none(app: App) -> None:
    app.session.press("space")
    assert frames(app, 5) == 5
    app.session.run(until="rest")
    frames(app, 2)
    assert frames(app, 20) == 0


def test_a_toolbar_is_drawn_again_where_it_changed_or_was_covered(
    app: App, monkeypatch: pytest.MonkeyPatch
) -> None:
    composed: list[object] = []

    def compose_toolbar(*stage: Any) -> Any:
        composed.append(stage)
        return toolbar.compose_toolbar(*stage)

    monkeypatch.setattr(picture, "compose_toolbar", compose_toolbar)
    session, strip, (x, y) = app.session, app.session.view.strip, app.session.point(1.0, 0.5)
    deeds = ["i", "space", ".", "space", "ctrl+z", "f1", "escape", "n", "d", "escape", "return", "escape", "q"]
    deeds += ["right click", "escape", "l", "escape", "k", "escape", "f8", "f8", "p", "escape"]
    for number, deed in enumerate(deeds):
        at = (x, y) if number % 5 else (strip.middle[0], 30.0 + number)
        session.view.pointer = at
        session.press(deed, at)
        for _ in range(2):
            app.frame(1 / 60)
            seen = pygame.surfarray.array3d(app.render.surface)[: session.view.strip.width]
            render = PygameRender(pygame.Surface(app.render.surface.get_size(), depth=32))
            render.process(Frame(session, 0.0))
            anew = pygame.surfarray.array3d(render.surface)[: session.view.strip.width]
            assert (seen == anew).all(), deed
    session.view.pointer = (x, y)
    session.press("space")
    frames(app, 2)
    composed.clear()
    assert frames(app, 5) == 5
    assert not composed


def test_one_of_a_thousand_flashes_is_drawn_anew(app: App) -> None:
    view = app.session.view
    before = view.looks
    view.flashes = np.zeros((1200, 2))
    assert view.looks != before
    before = view.looks
    view.flashes[600, 1] = 1e-9
    assert view.looks != before
    assert view.looks == view.looks


def test_tables_of_the_force_method_are_drawn_once() -> None:
    session = Session.open("hyperstatic")
    for key in ("k", "k", "k", "k", "k"):
        session.press(key)
    session.update_view()
    looks = [view.looks for _, view in session.stages]
    session.update_view()
    assert [view.looks for _, view in session.stages] == looks


def test_what_lies_under_a_resting_pointer_is_looked_up_once(app: App, monkeypatch: pytest.MonkeyPatch) -> None:
    looked: list[object] = []

    def looked_up(*where: Any) -> Any:
        looked.append(where)
        return pick(*where)

    monkeypatch.setattr(pinjoint.systems.edit.hover, "pick", looked_up)
    app.session.view.pointer = tuple(app.session.view.camera.to_pixels(app.session.particles["B"].position))
    assert frames(app, 20) == 1  # it is marked
    assert len(looked) <= 2  # and once more, now that its mark has changed the model
    app.session.view.pointer = (1.0, 1.0)
    assert frames(app, 20) == 1
    assert len(looked) <= 4


def test_garbage_is_looked_for_while_nothing_happens(app: App, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not in mid edit: looking through what is new of 10 000 elements takes longer than a frame."""
    seen: list[int] = []

    def only_frame() -> None:
        seen.append(gc.get_threshold()[0])
        app.input.closed = True

    monkeypatch.setattr(app, "next_frame", only_frame)
    before = gc.get_threshold()
    app.run()
    assert seen == [SELDOM]
    assert gc.get_threshold() == before


def test_labels_are_told_where_they_stood_until_one_looks_from_elsewhere(
    app: App, monkeypatch: pytest.MonkeyPatch
) -> None:
    known: list[bool] = []

    def composed(shown: Any, view: Any, theme: Any, placed: Any, others: Any) -> Any:
        if shown is app.session.model:
            known.append(bool(placed))
        return compose(shown, view, theme, placed, others)

    monkeypatch.setattr(picture, "compose", composed)
    app.session.view.camera.pan((3.0, 0.0))
    frames(app, 1)
    app.session.particles["B"].force = (1.0, 2.0)
    frames(app, 1)
    app.session.view.camera.pan((3.0, 0.0))
    frames(app, 1)
    assert known == [False, True, False]
