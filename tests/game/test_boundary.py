"""The boundary of a window: whatever raises inside is told of once, the model is kept, and a person goes on."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pygame
import pytest

from pinjoint import boundary
from pinjoint.app import App
from pinjoint.boundary import FAULTS
from pinjoint.documents import models
from pinjoint.documents.autosave import Autosave
from pinjoint.documents.open_documents import ModelFile
from pinjoint.systems.input.actions import ACTIONS, FILES
from pinjoint.systems.render.backends.pygame_canvas import Canvas
from tests.reference.models import triangle

ERRORS = (np.linalg.LinAlgError("singular"), MemoryError(), RecursionError("too deep"), OSError(28, "no room"))


@pytest.fixture
def app(data: Path) -> App:
    """A window with a model that nobody saved."""
    app = App(models.parse(triangle()), ModelFile(None, "work"), Autosave(interval=0.0))
    app.session.rods[0].stiffness = 5.0
    return app


def shown_to(
    app: App, monkeypatch: pytest.MonkeyPatch, *keys: str, look: Callable[[], Any] | None = None
) -> list[Any]:
    """Run the window for somebody who presses a key in each frame ("": none) and closes it.

    Returns what each frame said, or what a look at it returned.
    """
    pending, said = iter(keys), list[Any]()

    def process(frame: Any) -> None:
        said.append(app.session.notice if look is None else look())
        key = next(pending, None)
        if key:
            frame.pressed.append((key, frame.session.view.pixel))
        elif key is None:
            app.input.close()

    monkeypatch.setattr(app.input, "process", process)
    app.run()
    return said


def failing(error: Exception) -> Callable[..., Any]:
    """A function that always raises; `calls` counts."""

    def fail(*given: Any) -> None:
        fail.calls += 1  # type: ignore[attr-defined]
        raise error

    fail.calls = 0  # type: ignore[attr-defined]
    return fail


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
def test_an_action_that_raises_is_told_of_and_the_next_ones_act(
    app: App, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, data: Path, error: Exception
) -> None:
    monkeypatch.setitem(ACTIONS, "next shape", replace(ACTIONS["next shape"], perform=failing(error)))
    said = shown_to(app, monkeypatch, "b", "b", "ctrl+z", "b", "ctrl+y")
    assert type(error).__name__ in said[1]
    assert str(data / FAULTS) in said[1]
    assert said[1] == said[2] == said[4] != said[3], "undo says something else"
    assert [record.exc_info is not None for record in caplog.records if record.name == "pinjoint.window"] == [
        True
    ]
    assert (data / FAULTS).read_text(encoding="utf-8").count("Traceback") == 1
    assert app.session.rods[0].stiffness == 5.0
    (left,) = Autosave().left()
    recovered = models.load(left)
    assert recovered.rods[0].stiffness == 5.0


@pytest.mark.parametrize(
    "name", ["edit.hover", "edit.actions", "run.time", "files.autosave", "render.view", "render.pygame"]
)
def test_a_system_that_always_raises_is_left_alone_and_the_rest_goes_on(
    app: App, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, name: str
) -> None:
    """It is called again when something was pressed, and now and then; a run is paused."""
    fail, session = failing(np.linalg.LinAlgError("singular")), app.session
    system = next(s for some in session.schedule._ordered.values() for s in some if s.name == name)
    monkeypatch.setattr(system, "process", fail)
    monkeypatch.setattr(boundary, "REST", 3600.0)
    said = shown_to(app, monkeypatch, *(["space"] if name == "run.time" else []), *[""] * 20, "ctrl+z")
    assert name in said[2]
    assert 1 <= fail.calls <= 3  # type: ignore[attr-defined]
    assert session.scene == "pause"
    assert len([record for record in caplog.records if record.name == "pinjoint.window"]) == 1
    assert (session.rods[0].stiffness == 5.0) == (name == "edit.actions"), "undone where actions act"


def test_a_picture_that_cannot_be_drawn_is_replaced_by_words_until_it_can(
    app: App, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = Canvas.draw

    def draw(canvas: Canvas, surface: Any, picture: Any) -> None:
        if app.session.rods[0].stiffness == 5.0:
            surface.fill("red")
            raise MemoryError
        drawn(canvas, surface, picture)

    def look() -> tuple[bool, bool, bool]:
        """Whether white letters on black are shown, half a picture, or the view as the session has it."""
        pixels = pygame.surfarray.array3d(app.render.surface).reshape(-1, 3).tolist()
        shown = {tuple(pixel) for pixel in pixels[::7]}
        return (0, 0, 0) in shown and len(shown) > 1, (255, 0, 0) in shown, app.render.shown is not None

    monkeypatch.setattr(Canvas, "draw", draw)
    looks = shown_to(app, monkeypatch, *[""] * 4, "ctrl+z", "", "ctrl+y", "", look=look)
    assert looks[1:5] == [(True, False, False)] * 4
    assert looks[5:7] == [(False, False, True)] * 2, "once it can be drawn"
    assert looks[7:] == [(True, False, False)] * 2


def test_a_script_that_was_dropped_on_the_window_says_what_is_wrong_with_it(
    app: App, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    header = '{"format": "pinjoint session", "version": 1, "model": "isostatic"}'
    (tmp_path / "wrong.jsonl").write_text(f'{header}\n{{"action": "no such"}}\n', encoding="utf-8")
    said = shown_to(app, monkeypatch, f"{FILES}{tmp_path / 'wrong.jsonl'}", "", "")
    assert "no such" in said[-1]
    assert not caplog.records
