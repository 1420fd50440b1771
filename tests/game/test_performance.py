"""A script that is played in a window comes to what it comes to without one, and a person can end it."""

from collections.abc import Iterator
from pathlib import Path

import pygame
import pytest

from pinjoint import Session
from pinjoint.app import App
from pinjoint.components.model import Model
from pinjoint.documents import models
from pinjoint.documents.open_documents import ModelFile
from pinjoint.editor.scenes.load import LESSONS
from pinjoint.lessons.course import take_up_lesson
from pinjoint.scripts.performance import FOOTER, Performance
from pinjoint.scripts.playing import play, session_of
from pinjoint.scripts.script import Script, lessons
from tests.reference.bits import columns, different


@pytest.fixture
def app() -> Iterator[App]:
    window = App(Model(), ModelFile(None, "anything"))
    window.frame(0.0)
    yield window
    window.close()


def opened(app: App, script: Script) -> Performance:
    app.session.documents.open(script.source)
    return Performance(app, script, pace=0.0)


@pytest.mark.parametrize("name", lessons())
def test_a_lesson_comes_to_the_same_bits_as_without_a_window(app: App, name: str) -> None:
    script = Script(name)
    assert opened(app, script).play() == []
    headless = session_of(script)
    play(script, headless)
    assert different(columns(app.session.model), columns(headless.model)) == []


@pytest.mark.parametrize("below", [1000, 24])
def test_room_for_what_is_said_is_made_and_taken_away(
    app: App, monkeypatch: pytest.MonkeyPatch, below: int
) -> None:
    monkeypatch.setattr(App, "room_below", below)
    viewport, size = app.session.view.camera.viewport, tuple(app.window.size)
    said: list[str] = []
    heights: set[int] = set()
    frame = app.frame

    def watched(elapsed: float) -> object:
        result = frame(elapsed)
        footer = app.session.footer
        if footer is not None and footer.page is not None:
            said.extend(footer.page.lines)
            heights.add(app.session.view.camera.viewport.height)
            assert footer.camera.viewport.top == app.session.view.camera.viewport.height
            assert app.window.size[1] == size[1] + min(below, round(FOOTER))
        return result

    monkeypatch.setattr(app, "frame", watched)
    opened(app, Script("3_force_method")).play()
    assert any("K begins the force method" in text for text in said)
    (height,) = heights
    assert (height == viewport.height) == (below > FOOTER), "the picture shrinks only if the display is full"
    app.frame(0.0)
    assert app.session.footer is None
    assert app.session.view.camera.viewport == viewport
    assert tuple(app.window.size) == size


def test_escape_ends_a_lesson_and_the_person_goes_on(app: App) -> None:
    pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_ESCAPE, mod=0, unicode=""))
    performance = opened(app, Script("1_draw_a_truss"))
    assert performance.play() == []
    assert app.session.particles.count == 0
    app.session.press("p", (400.0, 300.0))
    assert app.session.particles.count == 1


def test_keys_pressed_meanwhile_do_nothing_to_the_model(app: App) -> None:
    for key in (pygame.K_p, pygame.K_DELETE, pygame.K_SPACE):
        pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=key, mod=0, unicode=""))
    script = Script("1_draw_a_truss")
    assert opened(app, script).play() == []
    assert app.session.particles.count == 3


SAVES = """{"format": "pinjoint session", "version": 1, "model": "isostatic"}
{"press": "s"}
{"type": "mine"}
{"press": "return"}
{"expect": "scene = pause"}
"""


def test_what_a_script_saves_replaces_nothing_of_the_persons(app: App, tmp_path: Path, data: Path) -> None:
    mine = data / "models" / "mine.json"
    mine.parent.mkdir(parents=True)
    mine.write_text("what I made")
    (tmp_path / "saves.jsonl").write_text(SAVES)
    script = Script(tmp_path / "saves.jsonl")
    assert opened(app, script).play() == []
    assert mine.read_text() == "what I made"
    assert (app.session.document.file.path, app.session.document.file.name) == (None, "mine")
    assert app.session.document.unsaved
    app.session.press("ctrl+s")
    assert app.session.scene == "save"
    app.session.act("pause")
    script.has_data = True
    mine.unlink()
    assert opened(app, script).play() == []
    assert app.session.document.file.path == mine
    assert mine.is_file()


def test_a_lesson_is_chosen_from_the_pictures() -> None:
    session = Session(models.load("isostatic"))
    session.act("load")
    tiles = [tile for tile in session.scenes.active.form.tiles if tile.section == LESSONS]  # type: ignore[attr-defined]
    shown = [
        tile.source.title for tile in tiles if isinstance(tile.source, Script) and not tile.source.task_count
    ]
    assert shown == [Script(name).title for name in lessons()]
    session.type("two in")
    session.press("down")
    session.press("return")
    assert session.scene == "pause"
    assert session.lesson is not None
    assert session.lesson.title.startswith("Two in")
    assert session.particles.count == models.load("newtons_cradle").particles.count


@pytest.mark.usefixtures("config")
def test_after_a_task_was_shown_only_its_card_says_what_to_do(app: App) -> None:
    session = app.session
    session.lesson = Script("03_stable_or_mechanism")
    take_up_lesson(session)
    session.course.begin(1)
    session.press("f7")
    script, session.lesson = session.lesson, None
    assert script is not None
    assert Performance(app, script, pace=0.0).play() == []
    app.frame(0.0)
    assert session.course.accepted
    assert session.notice == "Rod 1: 282.8 cm"  # what its last line says
