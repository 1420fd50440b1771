"""Labels: texts that look for a free place of their own, the important ones first."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from components.camera import Viewport
from systems.render.marks import Mark, Panel, Points, Text
from systems.render.theme import Colour
from systems.render.typography import line_height, text_width

FAINT, STRONG = 1, 2  # lines that a name does not cover; lines that a value covers only if it must
_COVERED = {"cover": (STRONG,), "spare": (FAINT, STRONG), "avoid": (0,)}  # by each attempt, at most
_CELL = 3.0  # points: how finely the picture is divided into free and taken


class Occupancy:
    """Which parts of a viewport are taken (by labels, panels), and which are crossed by lines."""

    def __init__(self, viewport: Viewport, unit: float) -> None:
        self.viewport = viewport
        self.cell = _CELL * unit
        shape = (int(viewport.height / self.cell) + 1, int(viewport.width / self.cell) + 1)
        self.taken: NDArray[np.bool_] = np.zeros(shape, dtype=bool)
        self.lined: NDArray[np.uint8] = np.zeros(shape, dtype=np.uint8)

    def block(self, left: float, top: float, width: float, height: float) -> None:
        """Take a rectangle."""
        self.taken[self._cells(left, top, width, height)] = True

    def block_squares(self, centres: Points, half: NDArray[np.float64]) -> None:
        """Take many squares of half width `half` (n,) about `centres` (n, 2)."""
        for (x, y), h in zip(centres.tolist(), half.tolist(), strict=True):
            self.block(x - h, y - h, 2.0 * h, 2.0 * h)

    def line(self, start: Points, end: Points, strength: int) -> None:
        """Note lines, FAINT or STRONG, from `start` to `end`, each (n, 2), inside or near the viewport."""
        count = (np.abs(end - start).max(axis=1, initial=0.0) / self.cell).astype(np.int64) + 2
        of = np.repeat(np.arange(len(start)), count)
        step = np.arange(len(of)) - np.repeat(np.cumsum(count) - count, count)
        share = (step / (count - 1)[of])[:, None]
        samples = start[of] + share * (end - start)[of]
        cells = ((samples - [self.viewport.left, self.viewport.top]) / self.cell).astype(np.int64)
        rows, columns = cells[:, 1], cells[:, 0]
        ok = (rows >= 0) & (columns >= 0) & (rows < self.lined.shape[0]) & (columns < self.lined.shape[1])
        self.lined[rows[ok], columns[ok]] = strength

    def is_free(self, left: float, top: float, width: float, height: float, *, covering: int) -> bool:
        """True if nothing takes any of a rectangle and no line in it is stronger than `covering`."""
        cells = self._cells(left, top, width, height)
        return not (self.taken[cells].any() or (covering < STRONG and (self.lined[cells] > covering).any()))

    def crossed(self, left: float, top: float, width: float, height: float) -> int:
        """How much of a rectangle is taken or crossed by lines, in cells."""
        cells = self._cells(left, top, width, height)
        return int((self.taken[cells] | (self.lined[cells] > 0)).sum())

    def _cells(self, left: float, top: float, width: float, height: float) -> tuple[slice, slice]:
        x, y = left - self.viewport.left, top - self.viewport.top
        columns = slice(max(int(x / self.cell), 0), max(int((x + width) / self.cell) + 1, 0))
        return slice(max(int(y / self.cell), 0), max(int((y + height) / self.cell) + 1, 0)), columns


@dataclass(frozen=True)
class Label:
    """A text that is to be placed with its middle at one of `places`, the best first.

    rank: labels of lower rank come first. backing: colour behind the text, or None. lines: whether it may
    cover rods ("cover"), only if there is no other place ("spare"), or no line ever ("avoid").
    """

    text: str
    places: Sequence[tuple[float, float]]
    size: int
    colour: Colour
    rank: float
    weight: str = "regular"
    backing: Colour | None = None
    lines: Literal["cover", "spare", "avoid"] = "spare"


def half_size(text: str, size: int, weight: str, unit: float) -> tuple[float, float]:
    """Half the width and height in pixels of a label, its margins included."""
    return text_width(text, size, weight) / 2 + 3.5 * unit, line_height(size) / 2 + 0.5 * unit


def place_labels(labels: Iterable[Label], occupancy: Occupancy, unit: float) -> list[Mark]:
    """Marks of the labels that found a free place, in order of rank; the others are left out."""
    marks: list[Mark] = []
    for label in sorted(labels, key=lambda label: label.rank):
        half = half_size(label.text, label.size, label.weight, unit)
        place = _free_place(label, *half, occupancy)
        if place is None:
            continue
        x, y = place
        box = x - half[0], y - half[1], 2 * half[0], 2 * half[1]
        occupancy.block(*box)
        if label.backing is not None:
            marks.append(Panel(*box, 4.0 * unit, label.backing))
        marks.append(Text(label.text, x, y, label.size, label.colour, label.weight, "centre"))
    return marks


def _free_place(
    label: Label, half_width: float, half_height: float, occupancy: Occupancy
) -> tuple[float, float] | None:
    """The first free one of a label's places, each moved into the viewport where it sticks out."""
    v = occupancy.viewport
    for covering in _COVERED[label.lines]:
        for x, y in label.places:
            x = min(max(x, v.left + half_width), v.left + v.width - half_width)
            y = min(max(y, v.top + half_height), v.top + v.height - half_height)
            box = x - half_width, y - half_height, 2 * half_width, 2 * half_height
            if occupancy.is_free(*box, covering=covering):
                return x, y
    return None
