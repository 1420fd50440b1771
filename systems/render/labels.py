"""Labels: texts placed where they are free, the important ones first."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from components.camera import Viewport
from systems.render.clip import bounds
from systems.render.marks import Mark, Owner, Panel, Points, Text
from systems.render.theme import Colour
from systems.render.typography import line_height, text_width

FAINT, STRONG = 1, 2  # lines that names never cover; lines that values cover only in need
_COVERED = {"cover": (STRONG,), "spare": (FAINT, STRONG), "avoid": (0,)}  # by each attempt, at most
_FAR = 1e6  # pixels
_MANY_LINES = 4000
_CELL = 3.0  # points: how finely the picture is divided into free and taken


Key = tuple[str, int]  # such as ("rods.axial_force", its row)
Placed = dict[Key, int]  # which of its places each label has taken


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
        cells = self.cells_of(centres - half[:, None], 2.0 * half[:, None])
        for left, top, right, bottom in cells.tolist():
            self.taken[top:bottom, left:right] = True

    def line(self, start: Points, end: Points, strength: int) -> None:
        """Note lines, FAINT or STRONG, from `start` to `end`, each (n, 2), inside or near the viewport.

        Of very many lines only a sample is noted: they leave no room between them in any case. Those that begin or end
        very far away are left out.
        """
        near = ((np.abs(start) < _FAR) & (np.abs(end) < _FAR)).all(axis=1)
        start, end = start[near], end[near]
        some = slice(None, None, len(start) // _MANY_LINES + 1)
        start, end = start[some], end[some]
        left, top = self.viewport.left, self.viewport.top
        x, y = (start[:, 0] - left) / self.cell, (start[:, 1] - top) / self.cell
        dx, dy = (end[:, 0] - start[:, 0]) / self.cell, (end[:, 1] - start[:, 1]) / self.cell
        count = np.maximum(np.abs(dx), np.abs(dy)).astype(np.intp) + 2
        of = np.repeat(np.arange(len(start)), count)
        step = np.arange(len(of)) - (np.cumsum(count) - count)[of]
        scale = 1.0 / (count - 1)
        columns = (x[of] + step * (dx * scale)[of]).astype(np.intp)
        rows = (y[of] + step * (dy * scale)[of]).astype(np.intp)
        height, width = self.lined.shape
        ok = (rows >= 0) & (columns >= 0) & (rows < height) & (columns < width)
        self.lined.ravel()[(rows * width + columns)[ok]] = strength

    def crossed(self, left: float, top: float, width: float, height: float) -> int:
        """How much of a rectangle is taken or crossed by lines, in cells."""
        cells = self._cells(left, top, width, height)
        return int((self.taken[cells] | (self.lined[cells] > 0)).sum())

    def are_free(self, cells: NDArray[np.intp], covering: int) -> NDArray[np.bool_]:
        """For each box of `cells` (n, 4), whether nothing takes any and no line in it is stronger than `covering`.

        The sum over a box is the difference of four sums over boxes that begin at the first cell.
        """
        height, width = self.taken.shape
        sums = np.zeros((height + 1, width + 1), dtype=np.int32)
        sums[1:, 1:] = self.taken | (self.lined > covering)
        np.cumsum(sums, axis=1, out=sums)
        sums = np.ascontiguousarray(sums.T)  # sums along contiguous memory are several times faster
        np.cumsum(sums, axis=1, out=sums)
        left, top, right, bottom = cells.T
        nothing: NDArray[np.bool_] = (
            sums[right, bottom] - sums[right, top] == sums[left, bottom] - sums[left, top]
        )
        return nothing

    def cells_of(self, corners: Points, sizes: Points) -> NDArray[np.intp]:
        """First column and row, and those after the last, that boxes touch, shape (n, 4), within the picture."""
        height, width = self.taken.shape
        corners = corners - [self.viewport.left, self.viewport.top]
        most = [width, height]
        low = np.clip(corners / self.cell, 0, most).astype(np.intp)
        high = np.clip(np.clip((corners + sizes) / self.cell, -1, most).astype(np.intp) + 1, low, most)
        return np.concatenate([low, high], axis=1)

    def _cells(self, left: float, top: float, width: float, height: float) -> tuple[slice, slice]:
        """Rows and columns of the cells that a rectangle touches; they may end beyond the last ones."""
        x, y = left - self.viewport.left, top - self.viewport.top
        columns = slice(max(int(x / self.cell), 0), max(int((x + width) / self.cell) + 1, 0))
        return slice(max(int(y / self.cell), 0), max(int((y + height) / self.cell) + 1, 0)), columns


class Label(NamedTuple):
    """A text that is to be placed with its middle at one of `places` (k, 2), the best first.

    rank: labels of lower rank come first. backing: colour behind the text, or None. lines: whether it may
    cover rods ("cover"), only if there is no other place ("spare"), or no line ever ("avoid"). key: the
    quantity and row, if the label is to stay where it was in the last picture. of: whose it is.
    """

    text: str
    places: Points | Sequence[tuple[float, float]]
    size: int
    colour: Colour
    rank: float
    weight: str = "regular"
    backing: Colour | None = None
    lines: Literal["cover", "spare", "avoid"] = "spare"
    key: Key | None = None
    of: Owner | None = None


@lru_cache(maxsize=8192)
def half_size(text: str, size: int, weight: str, unit: float) -> tuple[float, float]:
    """Half the width and height in pixels of a label, its margins included."""
    return text_width(text, size, weight) / 2 + 3.5 * unit, line_height(size) / 2 + 0.5 * unit


def place_labels(labels: Iterable[Label], occupancy: Occupancy, unit: float, placed: Placed) -> list[Mark]:
    """Marks of the labels that found a free place, in order of rank; the others are left out.

    placed: the places of labels in the last picture, updated; a label moves only where it then covers less.
    """
    ranked = sorted(labels, key=lambda label: label.rank)
    former = [placed.get(label.key, -1) if label.key else -1 for label in ranked]
    placed.clear()
    if not ranked:
        return []
    count = np.array([len(label.places) for label in ranked])
    of, first = np.repeat(np.arange(len(ranked)), count), np.cumsum(count) - count
    half = np.array([half_size(label.text, label.size, label.weight, unit) for label in ranked])[of]
    low, high = bounds(occupancy.viewport)
    middle = np.concatenate([label.places for label in ranked])
    middle = np.minimum(np.maximum(middle, low + half), high - half)  # into the viewport where it sticks out
    cells = occupancy.cells_of(middle - half, 2.0 * half)
    held = np.arange(len(of)) - first[of] == np.array(former)[of]
    free = _free_places(ranked, of, held, cells, occupancy)
    marks: list[Mark] = []
    for index, place, (x, y), (wide, tall) in zip(
        of[free].tolist(),
        (free - first[of[free]]).tolist(),
        middle[free].tolist(),
        half[free].tolist(),
        strict=True,
    ):
        label = ranked[index]
        if label.key:
            placed[label.key] = place
        if label.backing is not None:
            box = x - wide, y - tall, 2.0 * wide, 2.0 * tall
            marks.append(Panel(*box, 4.0 * unit, label.backing, None, label.of))
        marks.append(Text(label.text, x, y, label.size, label.colour, label.weight, "centre", label.of))
    return marks


def _free_places(
    labels: Sequence[Label],
    of: NDArray[np.intp],
    held: NDArray[np.bool_],
    cells: NDArray[np.intp],
    occupancy: Occupancy,
) -> NDArray[np.intp]:
    """Of each label for which any of its places is free, the first such place, which is taken.

    of: the label of each place. held: whether the label was there in the last picture. cells: (k, 4) of each place.
    Thousands of places are tested against panels and lines at once; only what labels take is tested one by one.
    """
    kinds = [label.lines for label in labels]
    strengths = sorted({strength for lines in set(kinds) for strength in _COVERED[lines]})
    free = {strength: occupancy.are_free(cells, strength) for strength in strengths}
    attempts = []
    for lines, coverings in _COVERED.items():
        theirs = np.flatnonzero(np.array([kind == lines for kind in kinds])[of])
        for covering in coverings if len(theirs) else ():
            possible = theirs[free[covering][theirs]]
            attempts += [possible[held[possible]], possible]
    tried = np.concatenate(attempts)
    tried = tried[np.argsort(of[tried], kind="stable")]  # all attempts of one label, then those of the next
    taken = [0] * len(occupancy.taken)  # by labels so far: the columns of each row as bits of one number
    found, placed = [], -1
    for index, place, (left, top, right, bottom) in zip(
        of[tried].tolist(), tried.tolist(), cells[tried].tolist(), strict=True
    ):
        bits = (1 << right) - (1 << left)
        if index == placed or any(row & bits for row in taken[top:bottom]):
            continue
        taken[top:bottom] = [row | bits for row in taken[top:bottom]]
        occupancy.taken[top:bottom, left:right] = True
        found.append(place)
        placed = index
    return np.array(found, dtype=np.intp)
