"""Nearness: what a picture shows of each element, and which places of labels are nearer to their own than to all else."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinjoint.components.arrays import Rows
from pinjoint.components.camera import Viewport
from pinjoint.systems.broad_phase import distance_to_segments
from pinjoint.systems.render.marks import Owner, Owners, Points, Truths, Values

LINE, DIAGRAM, SYMBOL = range(3)  # kinds of parts
NOBODY = -1  # code of what is not there
_SIDE = 48.0  # points: of the squares in which parts are searched for, in pieces that are no longer
_CROWD = 64  # pieces of a square that leave no room for labels
_REACH = 160.0  # points around labels within which parts matter
_FARTHEST = 80.0  # points from its own, beyond which no label stands by itself
_MOST_PIECES = 1000  # of one part
_ROWS = 40  # bits of a code that are left for rows
_FACTOR, _MARGIN = 1.25, 2.0  # by how much, in points, all else is further away than the own element
_LEAST_MARGIN = 0.1  # points

Codes = NDArray[np.int64]


@dataclass(frozen=True)
class Boxes:
    """Where labels may stand: `middle` and `half` the size of each box (n, 2), those of one label together.

    of: the label of each box.
    """

    middle: Points
    half: Points
    of: Rows

    def some(self, which: Truths | Rows) -> Boxes:
        return Boxes(self.middle[which], self.half[which], self.of[which])


class Parts:
    """Lines, symbols and diagrams of elements in a picture, and which of them are near labels once these are known.

    What a part belongs to is a key such as ("rods", 3); arrows have keys of their own, such as ("particles.reaction", 7).
    """

    def __init__(self, viewport: Viewport, unit: float) -> None:
        self.viewport, self.unit = viewport, unit
        self._tables: dict[str, int] = {}
        self._kept: list[tuple[Owners, Points, Points, float | Values, Points | float, int]] = []
        self._seen: _Bands
        self._pieces: _Pieces
        self._squares: _Squares

    def add(
        self,
        of: Owners,
        start: Points,
        end: Points,
        half: float | Values = 0.0,
        rise: Points | float = 0.0,
        kind: int = SYMBOL,
    ) -> None:
        """Add what lies within `half` of lines from `start` to `end`, each (n, 2), or up to `rise` to one side of them."""
        self._kept.append((of, start, end, half, rise, kind))

    def _bands(self) -> Iterator[_Bands]:
        for of, start, end, half, rise, kind in self._kept:
            codes = self.code((of[0], 0)) + np.asarray(of[1], dtype=np.int64)
            wide = np.broadcast_to(np.asarray(half, dtype=np.float64), len(start))
            high = np.broadcast_to(np.asarray(rise, dtype=np.float64), start.shape)
            yield _Bands(start, end, high, wide, codes, np.full(len(start), kind))

    def code(self, key: Owner | None) -> int:
        """What stands for a key in the arguments of the others."""
        if key is None:
            return NOBODY
        return (self._tables.setdefault(key[0], len(self._tables)) << _ROWS) + key[1]

    def own_is_nearest(self, boxes: Boxes, own: Codes, kin: Codes, clearly: Truths) -> Truths:
        """For each box whether it is nearer to what its label belongs to than to all else; True where that is nothing.

        own, kin: by label, codes of what it belongs to, and of what it is in no danger to be taken for. clearly: by
        box, whether by a margin that is seen. Lines are compared with the own line, all else with the nearest of the
        own parts, so that a value stands well in its own diagram.
        """
        nearest: Truths = own[boxes.of] == NOBODY
        if nearest.all():
            return nearest
        some = np.flatnonzero(~nearest)
        boxes, clearly = boxes.some(some), clearly[some]
        to_line, to_any = self._own_distances(boxes, own)
        factor, margin = np.where(clearly, _FACTOR, 1.0), np.where(clearly, _MARGIN, _LEAST_MARGIN) * self.unit
        limits = np.stack([away * factor + margin for away in (to_line, to_any, to_any)])
        left = np.flatnonzero(to_line < _FARTHEST * self.unit)
        clear = self.are_clear(boxes.some(left), own, kin, limits[:, left])
        nearest[some[left[clear]]] = True
        return nearest

    def are_clear(self, boxes: Boxes, own: Codes, kin: Codes, limits: Values) -> Truths:
        """For each box whether nothing is as near as `limits` (3, n) in pixels, for lines, diagrams and symbols.

        What may be even on it has a negative limit. own, kin: by label, codes of what does not count.
        """
        clear: Truths = np.ones(len(boxes.of), dtype=bool)
        if not self._kept or not len(boxes.of):
            return clear
        reach = boxes.half + limits.max(axis=0)[:, None]
        box, piece, is_full = self._squares.meeting(boxes.middle - reach, boxes.middle + reach)
        clear[is_full] = False
        pieces = self._pieces
        for axis in (0, 1):  # most of what shares a square is too far away along one of them
            away = np.abs(boxes.middle[:, axis][box] - pieces.middle[:, axis][piece])
            close = away <= reach[:, axis][box] + pieces.extent[:, axis][piece]
            box, piece = box[close], piece[close]
        label = boxes.of[box]
        strange = (pieces.of[piece] != own[label]) & (pieces.of[piece] != kin[label])
        box, piece = box[strange], piece[strange]
        limit = limits[pieces.kind[piece], box]
        clear[box[_are_within(boxes, box, pieces, piece, limit)]] = False
        return clear

    def are_on(self, boxes: Boxes, own: Codes) -> Truths:
        """For each box whether its middle is on the line of its own element, or on any of its parts if it has none."""
        points = Boxes(boxes.middle, np.zeros_like(boxes.half), boxes.of)
        return self._own_distances(points, own)[0] < self.unit

    def gather(self, points: Points) -> None:
        """Find the parts near points (n, 2), about which alone one can ask. To be called when all parts are there."""
        reach = _REACH * self.unit
        low, high = points.min(axis=0) - reach, points.max(axis=0) + reach
        found = []
        for bands in self._bands():
            ends, near = [bands.start, bands.end], np.ones(len(bands.of), dtype=bool)
            if bands.rise.any():
                ends += [bands.start + bands.rise, bands.end + bands.rise]
            for first, last, *places in zip(low, high, *(end.T for end in ends), strict=True):
                least, most = reduce(np.minimum, places), reduce(np.maximum, places)
                near &= (least - bands.half <= last) & (most + bands.half >= first)
            some = bands.some(np.flatnonzero(near))
            found.append(some.some(np.isfinite((some.start + some.end + some.rise).sum(axis=1))))
        self._squares = _Squares(*self.viewport.corners, _SIDE * self.unit)
        if found:
            columns = ([getattr(bands, column.name) for bands in found] for column in fields(_Bands))
            seen = _Bands(*map(np.concatenate, columns))
            self._seen = seen.some(np.argsort(seen.of, kind="stable"))
            self._pieces = _cut(self._seen, _SIDE * self.unit)
            self._squares.fill(self._pieces)

    def _own_distances(self, boxes: Boxes, own: Codes) -> tuple[Values, Values]:
        """From each box to the line of its own element, and to any of its parts, at most; infinite without one."""
        to_any = np.full(len(boxes.of), np.inf)
        if not self._kept or not len(boxes.of):
            return to_any, to_any
        left, right = (np.searchsorted(self._seen.of, own, side) for side in ("left", "right"))
        many = (right - left)[boxes.of]
        box, band = np.repeat(np.arange(len(many)), many), ranges(left[boxes.of], many)
        bands = self._seen.some(band)
        start, end = bands.start + bands.rise, bands.end + bands.rise
        away = _to_segments(boxes.middle[box], boxes.half[box], start, end)
        away = np.where((start == end).all(axis=1), np.maximum(away - bands.half, 0.0), away)
        outlines = _cut(replace(bands, half=np.zeros(len(box))), np.inf)
        away[_are_within(boxes, box, outlines, np.arange(len(box)), np.zeros(len(box)))] = 0.0
        np.minimum.at(to_any, box, away)
        lines, to_line = bands.kind == LINE, to_any.copy()
        to_line[box[lines]] = np.inf
        np.minimum.at(to_line, box[lines], away[lines])
        return to_line, to_any


@dataclass(frozen=True)
class _Bands:
    """Lines from `start` to `end`, widened by `half` all around, or on one side by `rise`."""

    start: Points
    end: Points
    rise: Points
    half: Values
    of: Codes
    kind: Rows

    def some(self, which: Truths | Rows) -> _Bands:
        return _Bands(*(getattr(self, column.name)[which] for column in fields(self)))


@dataclass(frozen=True)
class _Pieces:
    """Rectangles about `middle`, `reach` (n, 2) along and across the unit vectors `along`, widened by `half`.

    extent: half the size of the upright box around each, (n, 2).
    """

    middle: Points
    along: Points
    reach: Points
    half: Values
    of: Codes
    kind: Rows
    extent: Points


def _cut(bands: _Bands, longest: float) -> _Pieces:
    """Rectangles that are no longer than `longest`."""
    step = bands.end - bands.start
    length = np.hypot(step[:, 0], step[:, 1])
    count = within(np.ceil(length / longest), 1.0, _MOST_PIECES).astype(np.intp)
    which, number = np.repeat(np.arange(len(count)), count), ranges(np.zeros_like(count), count)
    height = np.hypot(bands.rise[:, 0], bands.rise[:, 1])
    along = np.where(length[:, None] > 0.0, step / np.maximum(length, 1e-300)[:, None], [1.0, 0.0])[which]
    share = ((number + 0.5) / count[which])[:, None]
    middle = bands.start[which] + step[which] * share + 0.5 * bands.rise[which]
    reach = np.stack([0.5 * length / count, 0.5 * height], axis=1)[which]
    half = bands.half[which]
    extent = np.abs(along) * reach[:, :1] + np.abs(along[:, ::-1]) * reach[:, 1:] + half[:, None]
    return _Pieces(middle, along, reach, half, bands.of[which], bands.kind[which], extent)


def ranges(first: Rows, count: Rows) -> Rows:
    """The numbers first, first + 1, …, `count` of them, for each of several, one after the other."""
    ends = np.cumsum(count)
    return np.arange(ends[-1] if len(ends) else 0) + np.repeat(first - (ends - count), count)


def within(values: NDArray[Any], low: ArrayLike, high: ArrayLike) -> NDArray[Any]:
    """Values between bounds: np.clip for the small arrays of single labels, of which it takes a multiple of the time."""
    return np.minimum(np.maximum(values, low), high)


class _Squares:
    """Squares of a picture, and which pieces are in each; those at the rim hold what lies beyond, too."""

    def __init__(self, low: Points, high: Points, side: float) -> None:
        self.low, self.side = low, side
        self.size = np.maximum(np.ceil((high - low) / side), 1.0).astype(np.intp)
        self.first = np.zeros(int(self.size.prod()) + 1, dtype=np.intp)  # by square, among `pieces`
        self.pieces = np.empty(0, dtype=np.intp)
        self.full = np.zeros(len(self.first) - 1, dtype=bool)

    def _cells(self, points: Points) -> Rows:
        """Column and row of the squares that hold points (n, 2)."""
        return within((points - self.low) / self.side, 0.0, self.size - 1).astype(np.intp)

    def _rows(self, low: Points, high: Points) -> tuple[Rows, Rows, Rows]:
        """Of upright boxes, for each row of squares that they touch: which box, and the first and last square."""
        (left, top), (right, bottom) = self._cells(low).T, self._cells(high).T
        box = np.repeat(np.arange(len(low)), bottom - top + 1)
        row = ranges(top, bottom - top + 1) * self.size[0]
        return box, row + left[box], row + right[box]

    def fill(self, pieces: _Pieces) -> None:
        """Put pieces into the squares that the boxes around them touch, but for squares that are full."""
        piece, first, last = self._rows(pieces.middle - pieces.extent, pieces.middle + pieces.extent)
        piece, square = np.repeat(piece, last - first + 1), ranges(first, last - first + 1)
        self.full = np.bincount(square, minlength=len(self.full)) > _CROWD
        piece, square = piece[~self.full[square]], square[~self.full[square]]
        self.pieces = piece[np.argsort(square, kind="stable")]
        self.first[1:] = np.cumsum(np.bincount(square, minlength=len(self.full)))

    def meeting(self, low: Points, high: Points) -> tuple[Rows, Rows, Truths]:
        """Pairs of upright boxes and pieces that may meet, some more than once; and which boxes touch full squares."""
        box, first, last = self._rows(low, high)
        begin = self.first[first]
        count = self.first[last + 1] - begin
        crowded = np.concatenate([[0], np.cumsum(self.full)])
        full = np.zeros(len(low), dtype=bool)
        full[box[crowded[last + 1] > crowded[first]]] = True
        return np.repeat(box, count), self.pieces[ranges(begin, count)], full


def _are_within(boxes: Boxes, box: Rows, pieces: _Pieces, piece: Rows, limit: Values) -> Truths:
    """For pairs of boxes and pieces, whether they may be no further apart than `limit`.

    Their distance is at least that of the rectangles around them, upright or along the piece, of which one is the box
    or the piece itself: exact but for pairs of corners, where it is a little less.
    """
    away = boxes.middle[box] - pieces.middle[piece]
    half = pieces.half[piece]
    gap = np.maximum(np.abs(away) - boxes.half[box] - pieces.extent[piece] + half[:, None], 0.0)
    limit = limit + half
    within: Truths = gap[:, 0] ** 2 + gap[:, 1] ** 2 <= limit * np.abs(limit)
    pairs = np.flatnonzero(within)
    box, piece, away, limit = box[pairs], piece[pairs], away[pairs], limit[pairs]
    (tx, ty), (wide, tall) = pieces.along[piece].T, boxes.half[box].T
    along = np.abs(away[:, 0] * tx + away[:, 1] * ty) - np.abs(tx) * wide - np.abs(ty) * tall
    across = np.abs(away[:, 0] * ty - away[:, 1] * tx) - np.abs(ty) * wide - np.abs(tx) * tall
    along, across = (np.maximum(d - pieces.reach[piece, axis], 0.0) for axis, d in enumerate((along, across)))
    within[pairs] = along**2 + across**2 <= limit * np.abs(limit)
    return within


def _to_segments(middle: Points, half: Points, start: Points, end: Points) -> Values:
    """Distances of upright boxes that meet no segment from segments, pair by pair, (n,)."""
    start, end = start - middle, end - middle
    ends = (np.hypot(*np.maximum(np.abs(point) - half, 0.0).T) for point in (start, end))
    away = np.minimum(*ends)
    for corner in ((1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)):
        away = np.minimum(away, distance_to_segments(half * corner, start, end))
    return away
