"""Occupancy: which parts of a picture are taken, crossed by lines, and whose they are."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Rows
from pinjoint.components.camera import Viewport
from pinjoint.systems.render.labels.nearness import NOBODY, Codes, Parts, ranges, within
from pinjoint.systems.render.marks import Mark, Owners, Panel, Points, Text, Truths, Values, owners
from pinjoint.systems.render.typography import text_width

FAINT, STRONG = 1, 2  # lines that names never cover; lines that values cover only in need
_FAR = 1e6  # pixels
_MANY_LINES, _FEW = 4000, 50  # lines of which a sample is noted; boxes, looked into one by one
_SHARES = np.linspace(0.0, 1.0, 12)[:, None]  # of a diagonal, where cells are looked at


class Occupancy:
    """Which parts of a viewport are taken (by labels, panels), which are crossed by lines, and what is whose there."""

    def __init__(self, viewport: Viewport, unit: float) -> None:
        self.viewport = viewport
        self.cell = 3.0 * unit  # points: how finely the picture is divided into free and taken
        shape = (int(viewport.height / self.cell) + 1, int(viewport.width / self.cell) + 1)
        self.taken: Truths = np.zeros(shape, dtype=bool)
        self._lined = np.zeros(shape, dtype=np.uint8)
        self._owner: NDArray[np.int64] = np.full(shape, NOBODY)
        self._lines: list[tuple[Points, Points, int, Owners | None]] = []  # that are in neither yet
        self._owned: list[tuple[Rows, Rows, Codes]] = []  # cells, the line through each, whose lines
        self.parts = Parts(viewport, unit)

    def block(self, left: float, top: float, width: float, height: float) -> None:
        """Take a rectangle."""
        self.taken[self._cells(left, top, width, height)] = True

    def block_marks(self, marks: Iterable[Mark]) -> None:
        """Take the texts among some marks, and the plates on which they stand."""
        for mark in marks:
            if isinstance(mark, Panel) and mark.radius:
                self.block(*mark[:4])
            elif isinstance(mark, Text):
                width = text_width(mark.text, mark.size, mark.weight)
                left = mark.x - {"left": 0.0, "centre": 0.5, "right": 1.0}[mark.anchor] * width
                self.block(left, mark.y - mark.size / 2, width, mark.size)

    def block_squares(self, centres: Points, half: Values) -> None:
        """Take many squares of half width `half` (n,) about `centres` (n, 2)."""
        cells = self.cells_of(centres - half[:, None], 2.0 * half[:, None])
        for left, top, right, bottom in cells.tolist():
            self.taken[top:bottom, left:right] = True

    def line(self, start: Points, end: Points, strength: int, of: Owners | None = None) -> None:
        """Note lines, FAINT or STRONG, from `start` to `end`, each (n, 2), inside or near the viewport; of: their keys.

        Of very many lines only a sample is noted: they leave no room between them in any case. Those that begin or end
        very far away are left out.
        """
        if len(start) > _MANY_LINES:
            near = np.flatnonzero(_are_near(start, end))
            some = near[:: len(near) // _MANY_LINES + 1]
            start, end, of = start[some], end[some], owners(of, some)
        self._lines.append((start, end, strength, of))

    @property
    def lined(self) -> NDArray[np.uint8]:
        """How strong the last line through each cell is; 0: none."""
        self._draw_lines()
        return self._lined

    @property
    def owner(self) -> NDArray[np.int64]:
        """Whose the last line through each cell is: asked only where labels look for a place."""
        self._draw_lines()
        for cells, line, code in self._owned:
            whose = code.take(line)
            self._owner.ravel()[cells[whose != NOBODY]] = whose[whose != NOBODY]
        self._owned.clear()
        return self._owner

    def _draw_lines(self) -> None:
        """Put all lines that were noted since into the cells, at once."""
        if not self._lines:
            return
        added, self._lines = self._lines, []
        start, end = (np.concatenate([line[side] for line in added]) for side in (0, 1))
        strength = np.repeat([line[2] for line in added], [len(line[0]) for line in added])
        codes = [
            np.full(len(first), NOBODY) if of is None else self.parts.code((of[0], 0)) + of[1]
            for first, _, _, of in added
        ]
        near, (left, top), code = _are_near(start, end), self.viewport.corners[0], np.concatenate(codes)
        if not near.all():
            start, end, strength, code = start[near], end[near], strength[near], code[near]
        dx, dy = (end - start).T / self.cell
        count = np.maximum(np.abs(dx), np.abs(dy)).astype(np.intp) + 2
        line, step = np.repeat(np.arange(len(count)), count), ranges(np.zeros_like(count), count)
        columns, rows = (
            ((first / self.cell).take(line) + step * (way / (count - 1)).take(line)).astype(np.intp)
            for first, way in ((start[:, 0] - left, dx), (start[:, 1] - top, dy))
        )
        height, width = self._lined.shape
        cells, ok = rows * width + columns, (rows >= 0) & (columns >= 0) & (rows < height) & (columns < width)
        if not ok.all():
            cells, line = cells[ok], line[ok]
        self._lined.ravel()[cells] = strength.take(line)
        self._owned.append((cells, line, code))

    def crossed(self, left: float, top: float, width: float, height: float) -> int:
        """How much of a rectangle is taken or crossed by lines, in cells."""
        cells = self._cells(left, top, width, height)
        return int(np.count_nonzero(self.taken[cells] | (self.lined[cells] > 0)))

    def is_taken(self, left: float, top: float, width: float, height: float) -> bool:
        """Whether a label, a panel or a symbol takes any of a rectangle."""
        return bool(np.count_nonzero(self.taken[self._cells(left, top, width, height)]))

    def are_free(self, cells: Rows, covering: int) -> Truths:
        """For each box of `cells` (n, 4), whether nothing takes any and no line in it is stronger than `covering`."""
        blocked, (height, width) = self.taken | (self.lined > covering), self.taken.shape
        if len(cells) < _FEW:
            return np.array(
                [not blocked[top:low, left:right].any() for left, top, right, low in cells.tolist()], bool
            )
        left, top, right, bottom = cells.T
        # How many are above and to the left of each corner.
        before = np.zeros((height + 1, width + 1), dtype=np.int32)
        blocked.cumsum(axis=1, dtype=np.int32, out=before[1:, 1:])
        for above, row in pairwise(before):  # in half the time of a sum along columns
            row += above
        high, low = ([before.take(y * (width + 1) + x) for x in (left, right)] for y in (top, bottom))
        return low[1] - high[1] == low[0] - high[0]

    def may_be_of(self, cells: Rows, *owners: Codes) -> Truths:
        """For each box of `cells` (n, 4), False where lines through it are seen to be of others than `owners`, each (n,).

        It is tested along the diagonals, which every line that parts the corners crosses. Values beside 1000 diagrams are
        placed in 16.6 ms instead of 21.0 by it.
        """
        left, top, right, bottom = cells.T
        width, height = right - left - 3, bottom - top - 3
        rows, columns = self.taken.shape
        down = within((top + 1 + _SHARES * height).astype(np.intp), 0, rows - 1)
        across = within((left + 1 + _SHARES * width).astype(np.intp), 0, columns - 1)
        possible = np.ones(len(cells), dtype=bool)
        for row in (down, down[::-1]):
            found = self.owner[row, across]
            strange = found != NOBODY
            for owner in owners:
                strange &= found != owner
            possible &= ~strange.any(axis=0)
        return possible

    def cell_of(self, points: Points) -> Rows:
        """Rows and columns of the cells that hold points (n, 2)."""
        height, width = self.taken.shape
        cells = (points - [self.viewport.left, self.viewport.top]) / self.cell
        return within(cells, 0.0, [width - 1, height - 1]).astype(np.intp)[:, ::-1]

    def cells_of(self, corners: Points, sizes: Points) -> Rows:
        """First column and row, and those after the last, that boxes touch, shape (n, 4), within the picture."""
        height, width = self.taken.shape
        corners = corners - [self.viewport.left, self.viewport.top]
        most = [width, height]
        low = within(corners / self.cell, 0.0, most).astype(np.intp)
        high = within(within((corners + sizes) / self.cell, -1.0, most).astype(np.intp) + 1, low, most)
        return np.concatenate([low, high], axis=1)

    def cells_along(self, start: Points, end: Points, apart: float) -> list[Rows]:
        """The cells, counted row by row, at points so far apart from the `end` of each line to its `start`, (n, 2)."""
        count = (np.hypot(*(end - start).T) / apart).astype(np.intp) + 2
        which = np.repeat(np.arange(len(count)), count)
        share = ranges(np.zeros_like(count), count) / count[which]
        rows, columns = self.cell_of(end[which] + share[:, None] * (start - end)[which]).T
        cells = rows * self.taken.shape[1] + columns
        return [cells[first:last] for first, last in pairwise([0, *np.cumsum(count).tolist()])]

    def _cells(self, left: float, top: float, width: float, height: float) -> tuple[slice, slice]:
        """Rows and columns of the cells that a rectangle touches; they may end beyond the last ones."""
        x, y = left - self.viewport.left, top - self.viewport.top
        columns = slice(max(int(x / self.cell), 0), max(int((x + width) / self.cell) + 1, 0))
        return slice(max(int(y / self.cell), 0), max(int((y + height) / self.cell) + 1, 0)), columns


def _are_near(start: Points, end: Points) -> Truths:
    """Which lines begin and end not very far away."""
    near: Truths = (np.abs(start) < _FAR) & (np.abs(end) < _FAR)
    return near[:, 0] & near[:, 1]
