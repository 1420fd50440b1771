"""F2 changes the language of all that a window shows, in every scene."""

from __future__ import annotations

import pytest

from components.language import language
from game.documents.preferences import CONFIG_VARIABLE, preferred_language
from game.session import Session


def test_f2_goes_from_language_to_language_and_begins_again():
    session = Session.open("isostatic")
    session.press("f2")
    assert language() == "pt"
    assert session.message.endswith("Português")
    session.press("f2")
    assert language() == "en"
    assert session.message == "Language: English"


@pytest.mark.parametrize("scene", ["properties", "load", "save"])
def test_what_was_typed_into_a_form_stays(scene):
    session = Session.open("isostatic")
    session.click(1.0, 1.0)
    session.act(scene)
    session.click_box("load x" if scene == "properties" else "name")
    session.press("ctrl+a")
    session.type("12.")
    session.press("f2")
    form = session.scenes.active.form
    assert form.selected is not None
    assert form.selected.text == "12."
    session.press("escape")
    assert session.scene == scene
    assert session.scenes.active.boxes["load x" if scene == "properties" else "name"] == (
        "120" if scene == "properties" else "isostatic" if scene == "save" else ""
    )


def test_a_window_remembers_the_choice(monkeypatch, tmp_path):
    from game.app import App
    from game.documents import models

    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    monkeypatch.setenv(CONFIG_VARIABLE, str(tmp_path))
    app = App(models.load("isostatic"))
    app.frame(0.0)
    assert preferred_language() == ""
    app.session.press("f2")
    app.frame(0.0)
    assert app.render.drawn
    assert preferred_language() == "pt"
    app.close()
