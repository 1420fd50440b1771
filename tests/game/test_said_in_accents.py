"""In a language whose letters all have accents: all is said, and scripts, order and colours stay as they are."""

from __future__ import annotations

import re
from contextlib import nullcontext

import pytest

from pinjoint.components.language import english
from pinjoint.session import Session
from pinjoint.systems.render.picture import compose_all
from pinjoint.systems.render.theme import load_theme
from tests.pseudo import pseudo

WORD = re.compile(r"\b[A-Za-z]{3,}\b(?! \d)")  # not translated, in plain letters, and no name such as "wall 1"


@pytest.mark.parametrize("key", ["l", "ctrl+j", "c", "f", "ctrl+m", "v", "w", "p"])
@pseudo()
def test_hints_and_notices_of_every_tool_are_said(key: str) -> None:
    session = Session.open("portal")
    session.press(key, (session.view.strip.left + 1, session.view.strip.top + 1))
    for name in ("", "B", "C"):
        if name:
            session.click(*session.particles[name].position)
        session.update_view()
        for said in (session.view.status.hint, session.notice):
            assert not WORD.search(said), said


@pseudo()
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
        assert not WORD.search(said), said


def test_scripts_panels_and_colours_are_as_in_english() -> None:
    told = []
    for speaking in (nullcontext, pseudo):
        with speaking():
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
