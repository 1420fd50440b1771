"""Supports: their symbols, on the sides of particles with most room."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from systems.render.marks import Stamps
from systems.render.sheet import DIRECTIONS, MANY, Rows, Sheet
from systems.render.symbols import SUPPORT_DEPTH

RIGHT, DOWN, LEFT, UP = range(4)
NO_SUPPORT = -1


def crowding(sheet: Sheet, rows: Rows) -> NDArray[np.float64]:
    """How much the rods crowd each side of the particles in `rows`, shape (n, 4), sides as in DIRECTIONS.

    Of other particles it is 0. Σ cos² of the angle between the side and the attached rods, in the original
    geometry, so that it does not change while a structure moves.
    """
    rods = sheet.model.rods
    wanted = np.zeros(len(sheet.centres), dtype=bool)
    wanted[rows] = True
    crowd = np.zeros((len(sheet.centres), 4))
    for end, outward in ((0, [1.0, -1.0]), (1, [-1.0, 1.0])):
        attached = np.flatnonzero(wanted[sheet.ends[:, end]])
        length = np.maximum(rods.original_length[attached], 1e-300)[:, None]
        cosine = (rods.difference[attached] / length * outward) @ DIRECTIONS.T
        for side in range(4):
            share = np.maximum(cosine[:, side], 0.0) ** 2
            crowd[:, side] += np.bincount(sheet.ends[attached, end], share, len(crowd))
    return crowd


def support_sides(sheet: Sheet) -> NDArray[np.int64]:
    """The side of each particle on which its support stands, shape (n,); NO_SUPPORT where it has none."""
    fixed = sheet.model.particles.fixed
    return freest_sides(fixed, crowding(sheet, np.flatnonzero(fixed[:, 0] | fixed[:, 1])))


def freest_sides(fixed: NDArray[np.bool_], crowd: NDArray[np.float64]) -> NDArray[np.int64]:
    """The side for the supports of particles fixed in x, y (n, 2) that are crowded so (n, 4).

    Below or to the left, or the opposite side where that is clearly freer; for both directions below
    rather than at a side, and above only where all else is crowded.
    """
    sides = np.full(len(fixed), NO_SUPPORT)
    x, y = fixed[:, 0], fixed[:, 1]
    vertical = np.where(crowd[:, UP] < crowd[:, DOWN] - 0.3, UP, DOWN)
    horizontal = np.where(crowd[:, RIGHT] < crowd[:, LEFT] - 0.3, RIGHT, LEFT)
    reluctance = np.zeros(4)
    reluctance[[RIGHT, DOWN, LEFT, UP]] = 0.5, 0.0, 0.45, 0.8
    sides[y & ~x] = vertical[y & ~x]
    sides[x & ~y] = horizontal[x & ~y]
    sides[x & y] = np.argmin(crowd[x & y] + reluctance, axis=1)
    return sides


def draw_supports(sheet: Sheet, sides: NDArray[np.int64]) -> None:
    """Triangles on a line (one direction) or on a plate (both), touching the particles from outside."""
    supported = sheet.particles[sides[sheet.particles] != NO_SUPPORT]
    fixed = sheet.model.particles.fixed[supported].all(axis=1)
    for side in range(4):
        for symbol, both in (("roller", False), ("pinned", True)):
            rows = supported[(sides[supported] == side) & (fixed == both)]
            if not len(rows):
                continue
            apex = sheet.centres[rows] + DIRECTIONS[side] * (sheet.radii[rows] - sheet.unit)[:, None]
            size = SUPPORT_DEPTH * sheet.unit
            colours, of = (sheet.theme.ink, sheet.theme.hollow), ("particles", rows)
            sheet.marks.append(Stamps(symbol, apex, size, sheet.unit, *colours, side, of))
            middle = apex + DIRECTIONS[side] * size / 2
            sheet.occupancy.parts.symbols(of, middle, middle, size / 2)
            sheet.occupancy.block_squares(middle[:MANY], np.full(len(middle[:MANY]), size / 2))
