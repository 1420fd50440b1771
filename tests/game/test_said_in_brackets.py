"""In a language in which every sentence stands in brackets: all is said, and scripts, order and colours stay as they are."""

from __future__ import annotations

import gettext
import re

import pytest

from pinjoint.components import language
from pinjoint.components.language import english
from pinjoint.session import Session
from pinjoint.systems.render.picture import compose_all
from pinjoint.systems.render.theme import load_theme

WORD = re.compile("[A-Za-z]{3,}")


class _Brackets(gettext.NullTranslations):
    def gettext(self, message: str) -> str:
        return f"⟦{message}⟧"

    def pgettext(self, context: str, message: str) -> str:
        return f"⟦{message}⟧"

    def ngettext(self, one: str, many: str, count: int) -> str:
        return f"⟦{one if count == 1 else many}⟧"


@pytest.fixture
def brackets(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(language._SPOKEN, "code", "brackets")
    monkeypatch.setattr(language._SPOKEN, "catalogue", _Brackets())


def without_brackets(text: str) -> str:
    return re.sub("⟦.*⟧", "", text, flags=re.DOTALL)


@pytest.mark.usefixtures("brackets")
@pytest.mark.parametrize("key", ["l", "ctrl+j", "c", "f", "ctrl+m", "v", "w", "p"])
def test_hints_and_notices_of_every_tool_are_said(key: str) -> None:
    session = Session.open("portal")
    session.press(key, (session.view.strip.left + 1, session.view.strip.top + 1))
    for name in ("", "B", "C"):
        if name:
            session.click(*session.particles[name].position)
        session.update_view()
        for said in (session.view.status.hint, session.notice):
            assert not WORD.search(without_brackets(said)), said


@pytest.mark.usefixtures("brackets")
def test_menus_toolbar_and_panels_are_said() -> None:
    session = Session.open("hyperstatic_yield")
    session.run(until="rest")
    session.press("right click", session.point(*session.particles["B"].position))
    menu = session.view.menu
    assert menu is not None
    session.press("escape")
    for key in ("m", "j", "x", "ctrl+l"):
        session.press(key)
    session.update_view()
    tools = [tool.title for group in session.view.toolbar.groups for tool in group]
    entries = [menu.title, *(entry.title for entry in menu.entries)]
    rows = [text for panel in session.view.readouts for text in (panel.title, *(row[0] for row in panel.rows))]
    controls = [control.title for control in session.view.sliders.controls]
    for said in (*tools, *entries, *rows, *controls):
        assert not WORD.search(without_brackets(said)), said


def test_scripts_panels_and_colours_are_as_in_english(monkeypatch: pytest.MonkeyPatch) -> None:
    told = []
    for code, catalogue in (("en", gettext.NullTranslations()), ("brackets", _Brackets())):
        monkeypatch.setattr(language._SPOKEN, "code", code)
        monkeypatch.setattr(language._SPOKEN, "catalogue", catalogue)
        session = Session.open("isostatic")
        session.select(session.particles["B"])
        said = []
        for key in ("c", "ctrl+d", "ctrl+z", "ctrl+y", "delete", "ctrl+z", "ctrl+l", "m", "j", ".", "r"):
            session.press(key)
            said.append(str(english(session.notice)))
        session.press("return")
        session.click_box("load x")
        boxes = sorted(session.boxes)
        session.press("escape")
        session.press("escape")
        session.press("space")
        session.frame(0.01)
        [picture, *_] = compose_all(session.stages, load_theme("light"))
        dots = [mark.ink for mark in picture.marks if getattr(mark, "symbol", "") == "disc"]
        told.append((said, boxes, list(session.view.since), dots[-1]))
    assert told[0] == told[1]
