"""Leaders: thin lines to what a value belongs to, from free space near it, where there is no room beside it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pinjoint.systems.render.clip import bounds
from pinjoint.systems.render.marks import Points
from pinjoint.systems.render.nearness import NOBODY, Boxes, Codes, ranges
from pinjoint.systems.render.occupancy import FAINT, Occupancy

ANCHORS = np.array([0.5, 0.35, 0.65, 0.2, 0.8])  # shares of a line where one that leads to it may end
TRIED = 32  # values of a picture
_MOST = 16  # lines, since more would confuse
_TURNS = np.array([0, *(way * k for k in range(1, 8) for way in (1, -1)), 8]) * np.pi / 8.0  # from the best way
_LENGTHS = (14.0, 26.0, 40.0, 58.0, 80.0)  # points
_STEP, _HALF = 4.0, 1.5  # points between the places where a line is tested; half the room it needs there
_CLEAR, _OFF_DIAGRAMS = 3.0, 1.0  # points between a value and all else


class Leader(NamedTuple):
    """A value about `middle` with a line from `start` at its rim to `end`; place: which of the tried ones it is."""

    place: int
    middle: tuple[float, float]
    start: tuple[float, float]
    end: tuple[float, float]


def lead(
    anchors: Sequence[Points],
    outward: Points,
    half: Points,
    own: Codes,
    kin: Codes,
    former: list[int],
    occupancy: Occupancy,
) -> list[Leader | None]:
    """For values of `half` the size (n, 2), the first of which come first, places from which a line leads to an anchor.

    anchors: of each value points (k, 2), of which the first is taken that nothing else is near. outward: unit vectors
    (n, 2) in which lines go preferably. own, kin: as for Parts.own_is_nearest; lines may cross these, and diagrams.
    former: the place of each in the last picture, or -1. What is found is taken.
    """
    found: list[Leader | None] = [None] * len(anchors)
    if not len(anchors):
        return found
    which, ends = _clear_ends(anchors, own, kin, occupancy)
    unit, count = occupancy.parts.unit, len(_TURNS) * len(_LENGTHS)
    angle = np.arctan2(outward[which, 1], outward[which, 0])[:, None] + np.tile(_TURNS, len(_LENGTHS))
    direction = np.stack([np.cos(angle), np.sin(angle)], axis=2)
    reach = np.repeat(_LENGTHS, len(_TURNS)) * unit + (np.abs(direction) * half[which, None]).sum(axis=2)
    middle = (ends[:, None] + direction * reach[:, :, None]).reshape(-1, 2)
    of, end = np.repeat(which, count), np.repeat(ends, count, axis=0)
    place = np.tile(np.arange(count), len(which))
    at = _clear_boxes(Boxes(middle, half[of], of), len(anchors), occupancy)
    middle, of, end, place = middle[at], of[at], end[at], place[at]
    start = np.clip(end, middle - half[of], middle + half[of])
    order = np.lexsort((place != np.array(former)[of], of))  # stable
    lines = 0
    clear = _are_clear(start[order], end[order], own[of[order]], kin[of[order]], occupancy)
    for index in order[clear].tolist():
        line = start[index], end[index]
        if found[of[index]] is None and _take(middle[index], half[of[index]], *line, occupancy):
            (x, y), (from_x, from_y), (to_x, to_y) = (p[index].tolist() for p in (middle, start, end))
            found[of[index]] = Leader(int(place[index]), (x, y), (from_x, from_y), (to_x, to_y))
            lines += 1
            if lines == _MOST:
                break
    return found


def _clear_ends(
    anchors: Sequence[Points], own: Codes, kin: Codes, occupancy: Occupancy
) -> tuple[NDArray[np.intp], Points]:
    """Which values have an anchor that nothing else is near, but for diagrams in need, and the first of each, (n, 2)."""
    of, points = np.repeat(np.arange(len(anchors)), [len(each) for each in anchors]), np.concatenate(anchors)
    boxes, unit, possible = Boxes(points, np.zeros_like(points), of), occupancy.parts.unit, []
    for near in ((_CLEAR, 0.0, _CLEAR), (_HALF, -1.0, _HALF)):
        limits = np.array(near)[:, None] * unit * np.ones(len(of))
        possible.append(np.flatnonzero(occupancy.parts.are_clear(boxes, own, kin, limits)))
    clear = np.concatenate(possible)
    which, first = np.unique(of[clear], return_index=True)
    return which, points[clear[first]]


def _clear_boxes(boxes: Boxes, labels: int, occupancy: Occupancy) -> NDArray[np.intp]:
    """Those boxes of so many labels that lie in the picture, on nothing and near nothing."""
    nobody, unit = np.full(labels, NOBODY), occupancy.parts.unit
    low, high = bounds(occupancy.viewport)
    inside = (boxes.middle - boxes.half >= low) & (boxes.middle + boxes.half <= high)
    at = np.flatnonzero(inside[:, 0] & inside[:, 1])
    corner = boxes.middle[at] - boxes.half[at]
    at = at[occupancy.are_free(occupancy.cells_of(corner, 2.0 * boxes.half[at]), FAINT)]
    limits = np.array([_CLEAR, _OFF_DIAGRAMS, _CLEAR])[:, None] * unit * np.ones(len(at))
    return at[occupancy.parts.are_clear(boxes.some(at), nobody, nobody, limits)]


def _are_clear(start: Points, end: Points, own: Codes, kin: Codes, occupancy: Occupancy) -> NDArray[np.intp]:
    """Those of the lines from `start` to `end` that meet nothing."""
    unit = occupancy.parts.unit
    count = np.ceil(np.hypot(*(end - start).T) / (_STEP * unit)).astype(np.intp) + 1
    line = np.repeat(np.arange(len(start)), count)
    share = (ranges(np.zeros_like(count), count) / np.repeat(count, count))[:, None]
    points = end[line] + share * (start[line] - end[line])
    rows, columns = occupancy.cell_of(points).T
    limits = np.array([_HALF, -1.0, _HALF])[:, None] * unit * np.ones(len(line))
    boxes = Boxes(points, np.full(points.shape, _HALF * unit), line)
    clear = ~occupancy.taken[rows, columns] & occupancy.parts.are_clear(boxes, own, kin, limits)
    return np.setdiff1d(np.arange(len(start)), line[~clear])


def _take(middle: Points, half: Points, start: Points, end: Points, occupancy: Occupancy) -> bool:
    """Take a box and a line to it, if both are free."""
    ((left, top, right, bottom),) = occupancy.cells_of((middle - half)[None], 2.0 * half[None]).tolist()
    count = int(np.hypot(*(end - start)) / (_STEP * occupancy.parts.unit)) + 2
    row, column = occupancy.cell_of(end + np.arange(count)[:, None] / count * (start - end)).T
    if occupancy.taken[top:bottom, left:right].any() or occupancy.taken[row, column].any():
        return False
    occupancy.taken[top:bottom, left:right] = True
    occupancy.taken[row, column] = True
    return True
