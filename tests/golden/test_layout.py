"""Texts stand in the window and clear of one another, in every scene and at sizes that no golden picture shows."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import pytest

from pinjoint import Session
from pinjoint.systems.input.actions import help_lines
from pinjoint.systems.render.marks import Panel, Picture, Text
from pinjoint.systems.render.typography import capital_height
from tests.golden.scenes import SCENES, WINDOWS, Window, composed
from tests.golden.states import STATES, seen
from tests.reference.boxes import Box, overlap, text_box

SIZES = {
    **WINDOWS,
    "narrow": Window(480, 800),
    "flat": Window(1200, 420),
    "full HD": Window(1920, 1080),
    "dense": Window(1600, 1200, 2.0),
    "large type": Window(1600, 1200, 1.5),
}


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", [*SCENES, *STATES])
def test_texts_are_whole_in_the_window_and_clear_of_one_another(name: str, size: str) -> None:
    """Whole but in a window that is narrower than 640 points."""
    assert not "\n".join(problems(seen(name, SIZES[size]), SIZES[size]))


def problems(shown: list[Picture], window: Window) -> Iterator[str]:
    """What is cut, outside the window, or over something else."""
    read = list(texts(shown))
    for text, (left, top, right, bottom) in read:
        if window.width >= 640 and text.endswith("…"):
            yield f"cut: {text!r}"
        if left < -1.0 or top < -1.0 or right > window.width + 1.0 or bottom > window.height + 1.0:
            yield f"outside: {text!r} {left:.0f} {top:.0f} {right:.0f} {bottom:.0f}"
    for (one, box), (other, beside) in combinations(read, 2):
        if overlap(box, beside):
            yield f"over one another: {one!r} {box} and {other!r} {beside}"


def texts(shown: list[Picture]) -> Iterator[tuple[str, Box]]:
    """What can be read, and where its capitals are (left, top, right, bottom), without what lies under a panel."""
    marks = [mark for picture in shown for mark in picture.marks]
    for place, mark in enumerate(marks):
        if isinstance(mark, Text) and mark.text.strip():
            box = text_box(mark, capital_height(mark.size))
            above = [box_of(panel) for panel in marks[place:] if isinstance(panel, Panel)]
            if not any(overlap(box, panel) for panel in above):
                yield mark.text, box


def box_of(panel: Panel) -> Box:
    return panel.left, panel.top, panel.left + panel.width, panel.top + panel.height


@pytest.mark.parametrize("size", [(320, 240), (480, 800), (640, 480), (1000, 720), (1920, 1080)])
@pytest.mark.parametrize("key", ["", "space", "return", "s", "d", "k"])
def test_every_key_is_explained_in_a_window_of_any_size(key: str, size: tuple[int, int]) -> None:
    """On as many pages as that takes; F1 goes through them and closes the last."""
    session = Session.open("hyperstatic")
    session.resize(*size)
    session.press("i")
    if key:
        session.press(key)
    told: set[str] = set()
    for _ in range(100):
        session.press("f1")
        shown = list(texts(composed(session))) if session.view.help else []
        if not shown:
            break
        told |= {text for text, _ in shown}
        card = [(text, box) for text, box in shown if text in told and not text.endswith("…")]
        assert all(
            left >= 0.0 and right <= size[0] and bottom <= size[1] for _, (left, _, right, bottom) in card
        )
    assert session.view.help == 0
    assert {title for _, title in help_lines(session.scene)} <= told
