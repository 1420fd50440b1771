"""Texts stand in the window and clear of one another, in every scene and at sizes that no golden picture shows."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import pytest

from systems.render.marks import Panel, Picture, Text
from systems.render.typography import capital_height, text_width
from tests.golden.scenes import SCENES, WINDOWS, Window, pictures

SIZES = {
    **WINDOWS,
    "narrow": Window(480, 800),
    "flat": Window(1200, 420),
    "full HD": Window(1920, 1080),
    "dense": Window(1600, 1200, 2.0),
    "large type": Window(1600, 1200, 1.5),
}
Box = tuple[float, float, float, float]


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", SCENES)
def test_texts_are_in_the_window_and_clear_of_one_another(name: str, size: str) -> None:
    window = SIZES[size]
    seen = list(texts(pictures(name, window)))
    for text, (left, top, right, bottom) in seen:
        assert left >= -1.0, text
        assert top >= -1.0, text
        assert right <= window.width + 1.0, text
        assert bottom <= window.height + 1.0, text
    for (one, box), (other, beside) in combinations(seen, 2):
        assert not overlap(box, beside), f"{one!r} {box} and {other!r} {beside}"


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", SCENES)
def test_nothing_is_shortened(name: str, size: str) -> None:
    """But the keys' help in a window that is narrower than 640 points, and what is drawn there."""
    if SIZES[size].width >= 640:
        assert [text for text, _ in texts(pictures(name, SIZES[size])) if text.endswith("…")] == []


def texts(shown: list[Picture]) -> Iterator[tuple[str, Box]]:
    """What can be read, and where its capitals are (left, top, right, bottom), without what lies under a panel."""
    marks = [mark for picture in shown for mark in picture.marks]
    for place, mark in enumerate(marks):
        if isinstance(mark, Text) and mark.text.strip():
            box = extent(mark)
            above = [box_of(panel) for panel in marks[place:] if isinstance(panel, Panel)]
            if not any(overlap(box, panel) for panel in above):
                yield mark.text, box


def extent(text: Text) -> Box:
    width, height = text_width(text.text, text.size, text.weight), capital_height(text.size)
    left = text.x - {"left": 0.0, "centre": 0.5, "right": 1.0}[text.anchor] * width
    return left, text.y - height / 2, left + width, text.y + height / 2


def box_of(panel: Panel) -> Box:
    return panel.left, panel.top, panel.left + panel.width, panel.top + panel.height


def overlap(one: Box, other: Box) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]
