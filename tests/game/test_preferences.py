"""What is kept of a person's choices, and the cycle of themes."""

import json
from pathlib import Path

import pygame
import pytest

from pinjoint import Session
from pinjoint.app import FRAME, App, place_on
from pinjoint.components.view import magnified
from pinjoint.documents import models, preferences
from pinjoint.editor.actions.view import THEMES
from pinjoint.systems.render.theme import theme_names

pytestmark = pytest.mark.usefixtures("config")


def test_t_goes_through_all_themes_and_back() -> None:
    session = Session.open("isostatic")
    seen = [session.view.theme]
    for _ in THEMES:
        session.press("t")
        seen.append(session.view.theme)
    assert seen == ["light", "dark", "colour-blind", "colour-blind-dark", "light"]
    assert sorted(THEMES) == theme_names()


def test_a_theme_is_remembered_and_other_entries_stay(config: Path) -> None:
    assert preferences.preferred("theme") == "light"
    preferences.remember("theme", "dark")
    assert preferences.preferred("theme") == "dark"
    path = config / "settings.json"
    path.write_text('{"theme": "dark", "other": 1}', encoding="utf-8")
    preferences.remember("theme", "colour-blind")
    assert json.loads(path.read_text(encoding="utf-8")) == {"theme": "colour-blind", "other": 1}
    assert [entry.name for entry in config.iterdir()] == ["settings.json"]


def test_the_convention_of_the_force_method_is_remembered(config: Path) -> None:
    assert preferences.preferred("convention") == "textbook"
    preferences.remember("convention", "thesis")
    assert preferences.preferred("convention") == "thesis"
    preferences.remember("convention", "another")
    assert preferences.preferred("convention") == "textbook"


@pytest.mark.parametrize(
    "text",
    [
        *("", "{", "[]", '{"theme": 3}', '{"theme": "gone"}', "\x00\xff", "[" * 100_000, '{"keys": ' * 100_000),
        *('{"magnification": "large"}', '{"magnification": 1e9}', '{"magnification": [2]}'),
    ],
)
def test_a_damaged_file_is_no_choice_and_can_be_written_again(config: Path, text: str) -> None:
    config.mkdir()
    (config / "settings.json").write_bytes(text.encode("latin-1"))
    assert (preferences.preferred("theme"), preferences.preferred("magnification")) == ("light", 1.0)
    preferences.remember("theme", "dark")
    assert preferences.preferred("theme") == "dark"


def test_what_cannot_be_read_is_put_aside(config: Path) -> None:
    """A comma too many in keys that somebody chose would cost them all."""
    slip = b'{"keys": {"pause": {"w": "undo"},}}'
    config.mkdir()
    (config / "settings.json").write_bytes(slip)
    preferences.remember("theme", "dark")
    assert preferences.preferred("theme") == "dark"
    assert (config / "settings-unreadable.json").read_bytes() == slip


def test_where_nothing_can_be_written_nothing_is_kept(config: Path) -> None:
    config.write_text("a file where the folder should be", encoding="utf-8")
    preferences.remember("theme", "dark")
    assert preferences.preferred("theme") == "light"


def test_a_session_without_a_window_writes_no_settings(config: Path) -> None:
    Session.open("isostatic").press("t")
    assert not config.exists()


def test_the_magnification_is_kept_beside_the_theme(config: Path) -> None:
    preferences.remember("theme", "dark")
    preferences.remember("magnification", 1.5)
    assert preferences.preferred("magnification") == 1.5
    assert preferences.preferred("theme") == "dark"


@pytest.mark.parametrize(
    ("height", "display", "chosen", "magnification"),
    [
        (480.0, 1080.0, 1.0, 1.0),
        (1440.0, 1440.0, 1.0, 1.25),
        (2160.0, 768.0, 1.0, 2.0),
        (1440.0, 2160.0, 1.0, 2.0),
        (600.0, 2160.0, 1.0, 1.25),
        (2160.0, 2160.0, 0.5, 1.0),
        (480.0, 1080.0, 4.0, 2.0),
    ],
)
def test_type_grows_with_display_and_window_and_leaves_room(
    height: float, display: float, chosen: float, magnification: float
) -> None:
    assert magnified(height, display, chosen) == magnification


# --- the window ----------------------------------------------------------------------------------------

DISPLAYS = [(1024, 640), (1280, 800), (1366, 768), (1920, 1080), (3840, 2160)]


@pytest.mark.parametrize("display", DISPLAYS)
def test_a_window_opens_inside_the_display_with_room_for_its_frame(display: tuple[int, int]) -> None:
    (width, height), position = place_on([display], None)
    assert position is None, "the desktop places it"
    assert width <= display[0] - FRAME[0]
    assert height <= display[1] - FRAME[1]
    assert width >= 0.5 * min(display[0], 1000)


@pytest.mark.parametrize("display", DISPLAYS)
@pytest.mark.parametrize("place", [(-50, -50, 900, 500), (3000, 2000, 900, 500), (0, 0, 9000, 9000)])
def test_a_remembered_place_is_moved_into_the_display(
    display: tuple[int, int], place: tuple[int, int, int, int]
) -> None:
    (width, height), position = place_on([display], place)
    assert position is not None
    assert 0 <= position[0] <= display[0] - width
    assert 0 <= position[1] <= display[1] - height


def test_a_place_is_remembered_as_it_was_and_nonsense_is_not() -> None:
    assert preferences.preferred_place() is None
    preferences.remember("window", [30, 40, 800, 600])
    assert preferences.preferred_place() == (30, 40, 800, 600)
    assert place_on([(1920, 1080)], (30, 40, 800, 600)) == ((800, 600), (30, 40))
    assert place_on([(1920, 1080), (1920, 1080)], (-1800, 40, 800, 600)) == ((800, 600), (-1800, 40))
    for wrong in ("x", [1, 2], [1, 2, 3, None], [1.5, 2, 3, 4], [10**9, 2, 3, 4]):
        preferences.remember("window", wrong)  # type: ignore[arg-type]
        assert preferences.preferred_place() is None


def test_a_window_remembers_that_it_was_maximised(config: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pinjoint.app.UNSEEN", ())
    preferences.remember("window", [30, 40, 800, 600])
    for event, maximised in ((pygame.WINDOWMAXIMIZED, True), (pygame.WINDOWRESTORED, False)):
        app = App(models.load("isostatic"))
        for kind in (event, pygame.QUIT):
            pygame.event.post(pygame.event.Event(kind))
        app.run()
        assert preferences.preferred("maximised") is maximised
        assert (preferences.preferred_place() == (30, 40, 800, 600)) is maximised
