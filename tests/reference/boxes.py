"""Boxes (left, top, right, bottom) of what is drawn, and which of them overlap."""

import itertools
from collections.abc import Iterable

from pinjoint.systems.render.marks import Text
from pinjoint.systems.render.typography import text_width

Box = tuple[float, float, float, float]
NamedBox = tuple[str, float, float, float, float]


def text_box(text: Text, height: float) -> Box:
    """Where a text stands whose letters are so high."""
    width = text_width(text.text, text.size, text.weight)
    left = text.x - {"left": 0.0, "centre": 0.5, "right": 1.0}[text.anchor] * width
    return left, text.y - height / 2, left + width, text.y + height / 2


def text_boxes(texts: Iterable[Text]) -> list[NamedBox]:
    """Every text with the box of its lines."""
    return [(text.text, *text_box(text, text.size)) for text in texts]


def overlap(one: Box, other: Box) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


def overlapping(boxes: Iterable[NamedBox]) -> list[tuple[str, str]]:
    """The names of the pairs that overlap."""
    return [(a[0], b[0]) for a, b in itertools.combinations(boxes, 2) if overlap(a[1:], b[1:])]
