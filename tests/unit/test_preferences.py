"""What is kept of a person's choices, and the cycle of themes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from game import Session, preferences
from game.actions.view import THEMES
from systems.render.theme import theme_names


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder for the settings, which is made when it is needed."""
    monkeypatch.setenv(preferences.CONFIG_VARIABLE, str(tmp_path / "config"))
    return tmp_path / "config"


def test_t_goes_through_all_themes_and_back() -> None:
    session = Session.open("isostatic")
    seen = [session.view.theme]
    for _ in THEMES:
        session.press("t")
        seen.append(session.view.theme)
    assert seen == ["light", "dark", "colour-blind", "colour-blind-dark", "light"]
    assert sorted(THEMES) == theme_names()


def test_a_theme_is_remembered_and_other_entries_stay(folder: Path) -> None:
    assert preferences.preferred_theme() == "light"
    preferences.remember_theme("dark")
    assert preferences.preferred_theme() == "dark"
    path = folder / "settings.json"
    path.write_text('{"theme": "dark", "other": 1}', encoding="utf-8")
    preferences.remember_theme("colour-blind")
    assert json.loads(path.read_text(encoding="utf-8")) == {"theme": "colour-blind", "other": 1}
    assert [entry.name for entry in folder.iterdir()] == ["settings.json"]


@pytest.mark.parametrize("text", ["", "{", "[]", '{"theme": 3}', '{"theme": "gone"}', "\x00\xff"])
def test_a_damaged_file_is_no_choice_and_can_be_written_again(folder: Path, text: str) -> None:
    folder.mkdir()
    (folder / "settings.json").write_bytes(text.encode("latin-1"))
    assert preferences.preferred_theme() == "light"
    preferences.remember_theme("dark")
    assert preferences.preferred_theme() == "dark"


def test_where_nothing_can_be_written_nothing_is_kept(folder: Path) -> None:
    folder.write_text("a file where the folder should be", encoding="utf-8")
    preferences.remember_theme("dark")
    assert preferences.preferred_theme() == "light"


def test_a_session_without_a_window_writes_no_settings(folder: Path) -> None:
    Session.open("isostatic").press("t")
    assert not folder.exists()
