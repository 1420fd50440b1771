"""Typography: width and height of texts, without opening a font."""

from __future__ import annotations

import json
import math
from collections import defaultdict
from collections.abc import Iterable
from functools import cache, lru_cache
from importlib.resources import files
from itertools import accumulate, takewhile
from typing import Any, TypeVar

T = TypeVar("T")

ALL = 1_000  # lines: as many as a text takes

WEIGHTS = {"regular": "Inter-Regular.otf", "semibold": "Inter-SemiBold.otf"}


@cache
def _metrics() -> dict[str, Any]:
    text = (files("pinjoint.assets") / "fonts" / "metrics.json").read_text(encoding="utf-8")
    return json.loads(text)


@lru_cache(maxsize=8192)
def text_width(text: str, size: int, weight: str = "regular") -> int:
    """Width in pixels of a text, of several lines that of the longest, at a font size in pixels.

    Every advance is rounded to whole pixels, as hinted fonts are drawn. A character that the font lacks
    counts 0.7 em.
    """
    wide = _widths(size, weight)
    return max(sum(map(wide.__getitem__, line)) for line in text.split("\n"))


@cache
def _widths(size: int, weight: str) -> defaultdict[str, int]:
    """The width in pixels of each character at a font size."""
    metrics = _metrics()[weight]
    em = float(metrics["units_per_em"])
    known = {one: math.floor(advance * size / em + 0.5) for one, advance in metrics["advance"].items()}
    return defaultdict(lambda: math.floor(0.7 * em * size / em + 0.5), known)


@cache
def font_size(points: float, unit: float) -> int:
    """A font size in whole pixels, of which each point takes `unit`."""
    return max(round(points * unit), 7)


def capital_height(size: int) -> float:
    """Height in pixels of capitals and figures."""
    metrics = _metrics()["regular"]
    return float(size * metrics["cap_height"] / metrics["units_per_em"])


def line_height(size: int) -> float:
    """Distance in pixels between the lines of a paragraph."""
    return 1.4 * size


def shortened(text: str, width: float, size: int, weight: str = "regular") -> str:
    """The text, or as much of its beginning as fits with an ellipsis; "" if not even that."""
    if text_width(text, size, weight) <= width:
        return text
    end = fitting(text, width - text_width("…", size, weight), size, weight)
    return text[:end].rstrip(" ,;:.") + "…" if end else ""


def fitting(characters: Iterable[str], width: float, size: int, weight: str = "regular") -> int:
    """How many characters of a text, from the first one, fit into a width; none into less than none."""
    ends = accumulate(map(_widths(size, weight).__getitem__, characters))
    return sum(1 for _ in takewhile(width.__ge__, ends))


@lru_cache(maxsize=2048)  # a form asks for the heights of all that it could explain, several times a frame
def wrapped(text: str, width: float, size: int, weight: str = "regular", most: int = ALL) -> tuple[str, ...]:
    """The text in at most so many lines of a width, broken at spaces; a longer word, and what is left over, is shortened."""
    lines: list[str] = []
    for paragraph in text.split("\n"):
        line = ""
        for word in paragraph.split():
            longer = f"{line} {word}" if line else word
            if line and text_width(longer, size, weight) > width:
                lines.append(line)
                line = word
            else:
                line = longer
        lines.append(line)
    if len(lines) > most:
        lines[most - 1 :] = [" ".join(lines[most - 1 :])]
    return tuple(shortened(line, width, size, weight) for line in lines)


def in_rows(items: list[T], each: int) -> list[list[T]]:
    """Items in rows of `each`; the last row may be shorter."""
    return [items[first : first + each] for first in range(0, len(items), each)]
