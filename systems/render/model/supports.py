"""Supports: their symbols, on the sides of particles with most room."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pinjoint.components import written
from pinjoint.components.arrays import Rows
from pinjoint.components.model import Model
from pinjoint.components.particle import is_sprung, turned, turned_supports
from pinjoint.components.rod import rigid_joints
from pinjoint.systems.render.marks import Points, Stamps, Truths, Values
from pinjoint.systems.render.model.sheet import DIRECTIONS, MANY, Sheet
from pinjoint.systems.render.model.values import write_beside, write_spring
from pinjoint.systems.render.symbols import SUPPORT_DEPTH

RIGHT, DOWN, LEFT, UP = range(4)
NO_SUPPORT = -1
_RELUCTANCE = np.array([0.45, 0.0, 0.45, 0.8])  # by side, to have a support there
_SPIRAL = 11.0  # points, radius of a rotation spring
MOST = 200  # springs of a kind whose stiffness is told
_ALIKE = 1e-6  # differences of crowding that are rounding


def crowding(sheet: Sheet, rows: Rows) -> Values:
    """How much the rods crowd each side of the particles in `rows`, shape (n, 4), sides as in DIRECTIONS.

    Of other particles it is 0. Σ cos² of the angle between the side and the attached rods, in the original
    geometry, so that it does not change while a structure moves.
    """
    rods = sheet.model.rods
    wanted = np.zeros(len(sheet.centres), dtype=bool)
    wanted[rows] = True
    crowd = np.zeros(4 * len(sheet.centres))
    for end, outward in ((0, [1.0, -1.0]), (1, [-1.0, 1.0])):
        attached = np.flatnonzero(wanted[sheet.ends[:, end]])
        length = np.maximum(rods.original_length[attached], 1e-300)[:, None]
        cosine = (rods.difference[attached] / length * outward) @ DIRECTIONS.T
        places = 4 * sheet.ends[attached, end, None] + np.arange(4)
        crowd += np.bincount(places.ravel(), (np.maximum(cosine, 0.0) ** 2).ravel(), len(crowd))
    return crowd.reshape(-1, 4)


def support_sides(sheet: Sheet) -> NDArray[np.int64]:
    """The side of each particle on which its support stands, shape (n,); NO_SUPPORT where it has none."""
    fixed = sheet.model.particles.fixed
    crowd = crowding(sheet, np.flatnonzero(fixed[:, 0] | fixed[:, 1]))
    x = sheet.model.particles.position[:, 0]
    middle = 0.5 * (x.min() + x.max()) if len(x) else 0.0
    sides = freest_sides(fixed, crowd, x > middle)
    clamped = np.flatnonzero(fixed[:, 0] & fixed[:, 1] & clamps(sheet.model))
    opposite = np.roll(crowd[clamped], 2, axis=1)
    sides[clamped] = np.argmin(crowd[clamped] - opposite + _RELUCTANCE / 10.0, axis=1)
    if is_sprung(sheet.model):
        for other in _sides_of_springs(sheet):
            sides = np.where(sides == NO_SUPPORT, other, sides)
    return sides


def _sides_of_springs(sheet: Sheet) -> list[NDArray[np.int64]]:
    """The sides on which springs along y, then along x, stand."""
    sprung, x = sheet.model.particles.support_springs > 0.0, sheet.model.particles.position[:, 0]
    crowd, right = crowding(sheet, np.flatnonzero(sprung.any(axis=1))), x > 0.5 * (x.min() + x.max())
    return [freest_sides(sprung & along, crowd, right) for along in ([False, True], [True, False])]


def clamps(model: Model) -> Truths:
    """Which particles hold rigid rod ends so that these cannot turn, (particles,)."""
    held: Truths = model.particles.fixed_rotation
    return held & rigid_joints(model) if held.any() else held


def freest_sides(fixed: Truths, crowd: Values, right: Truths) -> NDArray[np.int64]:
    """The side for the supports of particles fixed in x, y (n, 2) that are crowded so (n, 4).

    Below or outwards, or the opposite side where that is clearly freer; for both directions below rather than at a side,
    and above only where all else is crowded, or left and right are alike. right: which stand in the right half of the
    structure. So what is symmetrical stays so.
    """
    sides, held = np.full(len(fixed), NO_SUPPORT), np.flatnonzero(fixed[:, 0] | fixed[:, 1])
    (x, y), crowd, right = fixed[held].T, crowd[held], right[held]
    vertical = np.where(crowd[:, UP] < crowd[:, DOWN] - 0.3, UP, DOWN)
    freer = crowd[:, LEFT] - crowd[:, RIGHT]
    horizontal = np.where(np.where(right, freer > -0.3, freer > 0.3), RIGHT, LEFT)
    cost = crowd + _RELUCTANCE
    cost[np.abs(freer) <= _ALIKE, RIGHT::2] = np.inf
    sides[held] = np.where(x & y, np.argmin(cost, axis=1), np.where(x, horizontal, vertical))
    return sides


def draw_supports(sheet: Sheet, sides: NDArray[np.int64]) -> None:
    """Triangles on a line (one direction) or on a plate (both), touching the particles from outside; springs on the ground.

    What cannot turn either stands on hatched ground (clamped) or on a plate that rolls (guided).
    """
    rows = sheet.particles
    rigid, held = sheet.model.particles.fixed[rows].any(axis=1), clamps(sheet.model)
    supported = rows[rigid & (sides[rows] != NO_SUPPORT)]
    kinds = 2 * held[supported] + sheet.model.particles.fixed[supported].all(axis=1)
    codes, symbols = 4 * sides[supported] + kinds, ("roller", "pinned", "guided", "clamped")
    for code in np.unique(codes).tolist():
        _stand(sheet, symbols[code % 4], code // 4, supported[codes == code])
    if is_sprung(sheet.model):
        _draw_springs(sheet, rows)
    if len(turning := rows[held[rows] & ~rigid]):
        _stamp(sheet, "unturned", sheet.centres[turning], 0, turning)
        half = np.full(len(turning), 10.0 * sheet.unit)
        sheet.occupancy.parts.add(("particles", turning), sheet.centres[turning], sheet.centres[turning], half)
        sheet.occupancy.block_squares(sheet.centres[turning], half)


def _draw_springs(sheet: Sheet, rows: Rows) -> None:
    """Springs on the ground along y and x, spirals around what they hold from turning, and their stiffness."""
    particles, u = sheet.model.particles, sheet.unit
    for axis, sides in zip((1, 0), _sides_of_springs(sheet), strict=True):
        for side in range(4):
            if len(of := rows[sides[rows] == side]):
                middle = _stand(sheet, "spring", side, of)
                springs = particles.support_springs[of, axis].tolist()
                for at, row, stiffness in zip(middle[:MOST], of.tolist(), springs, strict=False):
                    key, owner = ("particles.support_springs", 2 * row + axis), ("particles", row)
                    write_spring(sheet, at, 0.5 * SUPPORT_DEPTH * u, stiffness, "kN/m", key, owner)
    if len(of := rows[(particles.rotation_spring[rows] > 0.0) & rigid_joints(sheet.model)[rows]]):
        at, size = sheet.centres[of], _SPIRAL * u
        ink, hollow = sheet.theme.ink, sheet.theme.hollow
        sheet.marks.append(Stamps("spiral", at, size, u, ink, hollow, of=("particles", of)))
        sheet.occupancy.block_squares(at[:MANY], np.full(len(at[:MANY]), size))
        sheet.explain("spring", at, at)
        for place, row in zip(at[:MOST], of.tolist(), strict=False):
            key, stiffness = ("particles.rotation_spring", row), float(particles.rotation_spring[row])
            write_spring(sheet, place, size, stiffness, "kN·m/rad", key, ("particles", row))


def _stand(sheet: Sheet, symbol: str, side: int, of: Rows) -> Points:
    """A symbol at a side of some particles, turned as their supports are; returns the middles of the symbols."""
    size, particles = SUPPORT_DEPTH * sheet.unit, sheet.model.particles
    coiled = particles.rotation_spring[of] > 0.0
    coiled = coiled & rigid_joints(sheet.model)[of] if coiled.any() else coiled
    rim = np.where(coiled, _SPIRAL * sheet.unit, sheet.radii[of] - sheet.unit)
    angle = np.where(turned_supports(sheet.model)[of], particles.support_angle[of], 0.0)
    outward = turned(np.broadcast_to(DIRECTIONS[side], (len(of), 2)), angle)  # y is down
    apex = sheet.centres[of] + outward * rim[:, None]
    for one in np.unique(angle):
        alike = angle == one
        _stamp(sheet, symbol, apex[alike], side - float(one) / (0.5 * np.pi), of[alike])
    middle: Points = apex + outward * size / 2
    sheet.occupancy.parts.add(("particles", of), middle, middle, size / 2)
    sheet.occupancy.block_squares(middle[:MANY], np.full(len(middle[:MANY]), size / 2))
    for at, row in zip(middle[angle != 0.0][:MOST], of[angle != 0.0].tolist(), strict=False):
        key, owner = ("particles.support_angle", row), ("particles", row)
        degrees = written.given(float(np.degrees(particles.support_angle[row])), written.DIGITS)
        write_beside(sheet, at, size / 2, f"{degrees}°", key, owner)
    return middle


def _stamp(sheet: Sheet, symbol: str, at: Points, side: float, rows: Rows) -> None:
    """The symbol of supports."""
    size, theme = SUPPORT_DEPTH * sheet.unit, sheet.theme
    sheet.marks.append(Stamps(symbol, at, size, sheet.unit, theme.ink, theme.hollow, side, ("particles", rows)))
