"""Leaders: thin lines to what a value belongs to, from free space near it, where there is no room beside it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from systems.render.clip import bounds
from systems.render.marks import Points
from systems.render.nearness import NOBODY, Boxes, Codes
from systems.render.occupancy import FAINT, Occupancy

TRIED = 48  # values of a picture
_MOST = 16  # lines, since more would confuse
_TURNS = np.array([0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6, -6, 7, -7, 8]) * (
    np.pi / 8.0
)  # from the best direction
_LENGTHS = (14.0, 26.0, 40.0, 58.0, 80.0)  # points
_STEP, _HALF = (
    4.0,
    1.5,
)  # points between the places where a line is tested, and half the room that it needs there
_CLEAR, _OFF_DIAGRAMS = 3.0, 1.0  # points between a value and all else


class Leader(NamedTuple):
    """A value about `middle` with a line from `start` at its rim to `end`; place: which of the tried ones it is."""

    place: int
    middle: tuple[float, float]
    start: tuple[float, float]
    end: tuple[float, float]


def lead(
    anchors: Points,
    outward: Points,
    half: Points,
    own: Codes,
    kin: Codes,
    former: list[int],
    occupancy: Occupancy,
) -> list[Leader | None]:
    """For values of `half` the size (n, 2), the first of which come first, places from which a line leads to `anchors`.

    outward: unit vectors (n, 2) in which lines go preferably. own, kin: as for Parts.own_is_nearest; lines may cross
    these, and diagrams. former: the place of each in the last picture, or -1. What is found is taken.
    """
    found: list[Leader | None] = [None] * len(anchors)
    if not len(anchors):
        return found
    unit, count = occupancy.parts.unit, len(_TURNS) * len(_LENGTHS)
    angle = np.arctan2(outward[:, 1], outward[:, 0])[:, None] + np.tile(_TURNS, len(_LENGTHS))
    direction = np.stack([np.cos(angle), np.sin(angle)], axis=2)
    reach = np.repeat(_LENGTHS, len(_TURNS)) * unit + (np.abs(direction) * half[:, None]).sum(axis=2)
    middle = (anchors[:, None] + direction * reach[:, :, None]).reshape(-1, 2)
    of = np.repeat(np.arange(len(anchors)), count)
    boxes, cells = _clear_boxes(middle, of, half, occupancy)
    at, samples, line_cells = _clear_lines(middle, boxes, anchors[of], half[of], own[of], kin[of], occupancy)
    lines = 0
    for label in range(len(anchors)):
        if lines == _MOST:
            break
        mine = at[of[at] == label]
        places = mine - label * count
        for box in [*mine[places == former[label]].tolist(), *mine.tolist()]:
            left, top, right, bottom = cells[box]
            row, column = line_cells[slice(*np.searchsorted(samples, [box, box + 1]))].T
            if occupancy.taken[top:bottom, left:right].any() or occupancy.taken[row, column].any():
                continue
            occupancy.taken[top:bottom, left:right] = True
            occupancy.taken[row, column] = True
            x, y = middle[box].tolist()
            start = np.clip(anchors[label], middle[box] - half[label], middle[box] + half[label]).tolist()
            end_x, end_y = anchors[label].tolist()
            lines += 1
            found[label] = Leader(box - label * count, (x, y), (start[0], start[1]), (end_x, end_y))
            break
    return found


def _clear_boxes(
    middle: Points, of: NDArray[np.intp], half: Points, occupancy: Occupancy
) -> tuple[NDArray[np.bool_], NDArray[np.intp]]:
    """Which boxes lie in the picture, on nothing and near nothing; and the cells of all, (n, 4)."""
    boxes = Boxes(middle, half[of], of)
    nobody, unit = np.full(len(half), NOBODY), occupancy.parts.unit
    limits = np.array([_CLEAR, _OFF_DIAGRAMS, _CLEAR])[:, None] * unit * np.ones(len(of))
    low, high = bounds(occupancy.viewport)
    inside = ((middle - half[of] >= low) & (middle + half[of] <= high)).all(axis=1)
    cells = occupancy.cells_of(middle - half[of], 2.0 * half[of])
    possible = inside & occupancy.are_free(cells, FAINT)
    return possible & occupancy.parts.are_clear(boxes, nobody, nobody, limits, possible), cells


def _clear_lines(
    middle: Points,
    possible: NDArray[np.bool_],
    anchors: Points,
    half: Points,
    own: Codes,
    kin: Codes,
    occupancy: Occupancy,
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """Those of the possible boxes whose lines meet nothing; of places along lines their boxes, and rows and columns."""
    at, unit = np.flatnonzero(possible), occupancy.parts.unit
    middle, anchors, half, own, kin = middle[at], anchors[at], half[at], own[at], kin[at]
    start = np.clip(anchors, middle - half, middle + half)
    step = start - anchors
    length = np.hypot(step[:, 0], step[:, 1])
    count = np.ceil(length / (_STEP * unit)).astype(np.intp) + 1
    of, first = np.repeat(np.arange(len(at)), count), np.cumsum(count) - count
    share = (np.arange(len(of)) - first[of]) / count[of]
    points = anchors[of] + share[:, None] * step[of]
    room = np.full(points.shape, _HALF * unit)
    limits = np.array([_HALF, -1.0, _HALF])[:, None] * unit * np.ones(len(of))
    rows, columns = occupancy.cell_of(points).T
    owner = occupancy.owner[rows, columns]
    strange = (owner != NOBODY) & (owner != own[of]) & (owner != kin[of])
    stopped = np.bincount(of[strange | occupancy.taken[rows, columns]], minlength=len(at)) > 0
    clear = occupancy.parts.are_clear(Boxes(points, room, of), own, kin, limits, ~stopped[of])
    stopped |= np.bincount(of[~clear], minlength=len(at)) > 0
    return at[~stopped], at[of], np.stack([rows, columns], axis=1)
