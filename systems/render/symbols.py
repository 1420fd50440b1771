"""Symbols: the shapes that are stamped on a picture, as polygons about their own origin.

Every symbol points to the right, y down; supports and arrows are turned by quarter turns. Icons of the toolbar are read
from assets/icons, by the names of their actions, in a square of 20 by 20. Every part is a kind and its numbers: "line" x, y,
x, y, …; "area" x, y, x, y, …; "arc" x, y, radius, from, to (degrees, clockwise from the right); "disc" x, y, radius.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from functools import cache
from importlib.resources import files

import numpy as np

from pinjoint.components.arrays import Rows
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.mistake import WrongValue
from pinjoint.systems.render.marks import Points, Stamps

Part = tuple[str, tuple[float, ...]]
Parts = list[tuple[str, Points]]  # ("ink" or "hollow", corners (k, 2)), in painter's order

_STROKE = 1.8  # the width of lines of icons
_NUMBERS = {"disc": 3, "arc": 5}  # of one part; lines and areas have two for each of their points
SUPPORT_DEPTH = 25.0  # points from the particle's rim to the far side of the ground
RIM = 1.75  # points
_HALF_WIDTH, _HEIGHT = 9.5, 16.0  # points, of a support's triangle
_GROUND = 13.0  # points, half the length of the ground under it
_COILED = 9.0  # units of _STROKE, the radius of a coiled spring
_SQUARE = 9.5  # points, half the side of a square around a joint that cannot turn


def turned_parts(stamp: Stamps) -> Parts:
    """The polygons of a stamp about its place in pixels, by its turns clockwise.

    The size of an icon is how many pixels the unit of its square takes.
    """
    if stamp.turns % 1.0:
        across, down = math.cos(0.5 * math.pi * stamp.turns), math.sin(0.5 * math.pi * stamp.turns)
    else:
        across, down = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(stamp.turns) % 4]
    turn = np.array([[across, down], [-down, across]], dtype=np.float64)
    if stamp.symbol in SYMBOLS:
        parts = SYMBOLS[stamp.symbol](stamp.size, stamp.unit)
    else:
        parts = [("ink", polygon * stamp.size) for polygon in _icon(stamp.symbol)]
    return [(role, corners @ turn) for role, corners in parts]


def check_icon(parts: Sequence[Part]) -> None:
    """Raise ValueError if a part of an icon is none that can be drawn."""
    for kind, numbers in parts:
        few = {"line": 4, "area": 6}.get(kind, 0)
        fits = (
            len(numbers) == _NUMBERS[kind]
            if kind in _NUMBERS
            else few <= len(numbers) and len(numbers) % 2 == 0
        )
        if kind not in (*_NUMBERS, "line", "area") or not fits or not all(map(math.isfinite, numbers)):
            raise WrongValue(
                "{part!r} is not a part of an icon; write ('line', (-5, 0, 5, 0)), 'area' with three points or"
                " more, ('arc', (x, y, radius, from, to)) or ('disc', (x, y, radius)).",
                part=(kind, numbers),
            )


def icon(name: str) -> tuple[Part, ...]:
    """The parts of an icon. Raises KeyError."""
    return EXTENSIONS.icons[name] if name in EXTENSIONS.icons else icons()[name]


@cache
def icons() -> dict[str, tuple[Part, ...]]:
    """The parts of the icons that the program brings, by name."""
    drawn = json.loads((files("pinjoint.assets") / "icons" / "toolbar.json").read_text(encoding="utf-8"))
    return {name: tuple((kind, tuple(at)) for kind, *at in parts) for name, parts in drawn.items()}


@cache
def _icon(symbol: str) -> list[Points]:
    """The polygons of an icon in the units of its square; every colour of it needs them."""
    return [polygon for part in icon(symbol) for polygon in _icon_part(*part)]


def _icon_part(kind: str, numbers: tuple[float, ...]) -> list[Points]:
    """A line with round ends and corners, an area, an arc or a disc of an icon as polygons."""
    if kind == "disc":
        return [circle(numbers[2]) + numbers[:2]]
    if kind == "arc":
        x, y, radius, first, last = numbers
        angle = np.radians(np.linspace(first, last, 33))
        return _thick(np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=1))
    points = np.array(numbers).reshape(-1, 2)
    return [points] if kind == "area" else _thick(points)


def _thick(points: Points) -> list[Points]:
    """The polygons of a line through points (n, 2)."""
    along = points[1:] - points[:-1]
    across = along[:, ::-1] * [-1.0, 1.0] / np.hypot(*along.T)[:, None] * (_STROKE / 2)
    sides = [points[:-1] + across, points[1:] + across, points[1:] - across, points[:-1] - across]
    return [*np.stack(sides, axis=1), *(circle(_STROKE / 2) + point for point in points)]


def circle(radius: float) -> Points:
    """A circle about the origin as a polygon with enough corners to look round."""
    corners = max(12, math.ceil(4.0 * math.sqrt(16.0 * radius)))
    angle = np.linspace(0.0, 2.0 * np.pi, corners, endpoint=False)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def arc(centre: Points, radius: float, middle: Points, reach: float) -> Points:
    """The part of a large circle that is within `reach` of the point `middle`, both (2,), as a line (k, 2); else (0, 2).

    It is built from that point, so that no digits cancel however large the circle is.
    """
    away = middle - centre
    distance = float(np.hypot(*away))
    if abs(distance - radius) > reach:
        return np.empty((0, 2))
    out = away / distance if distance > 0.0 else np.array([1.0, 0.0])
    half = math.pi if 2.0 * reach >= radius else 1.1 * math.asin(2.0 * reach / radius)
    angle = np.linspace(-half, half, max(12, math.ceil(half / math.pi * 16.0 * math.sqrt(radius))))[:, None]
    along, down = radius * np.sin(angle), 2.0 * radius * np.sin(0.5 * angle) ** 2
    return middle - (distance - radius + down) * out + along * [-out[1], out[0]]


def _bar(left: float, top: float, right: float, bottom: float) -> Points:
    return np.array([[left, top], [right, top], [right, bottom], [left, bottom]])


def _arrow(length: float, unit: float) -> Parts:
    """An arrow of that length from the origin to the right."""
    head, half = 8.0 * unit, 4.0 * unit
    shaft = _bar(0.0, -unit, length - 0.8 * head, unit)
    point = np.array([[length - head, -half], [length, 0.0], [length - head, half]])
    return [("ink", shaft), ("ink", point)]


def _triangle(unit: float) -> Parts:
    """An open triangle that touches the origin with its apex."""
    outer = np.array([[0.0, 0.0], [_HEIGHT, _HALF_WIDTH], [_HEIGHT, -_HALF_WIDTH]])
    slant = math.hypot(_HEIGHT, _HALF_WIDTH)
    apex = RIM * slant / _HALF_WIDTH  # where the inner edges meet, a rim's width inside the outer ones
    base = _HEIGHT - RIM
    inner_half = (base - apex) * _HALF_WIDTH / _HEIGHT
    inner = np.array([[apex, 0.0], [base, inner_half], [base, -inner_half]])
    return [("ink", outer * unit), ("hollow", inner * unit)]


def _roller(size: float, unit: float) -> Parts:
    """Support in one direction: a triangle, a gap and the line that it slides along."""
    line = _bar(_HEIGHT + 3.0, -_GROUND, _HEIGHT + 4.75, _GROUND)
    return [*_triangle(unit), ("ink", line * unit)]


def _ground(at: float, unit: float) -> Parts:
    """A filled plate with hatched ground behind it, so many points from the origin."""
    plate = _bar(at, -_GROUND, at + 3.5, _GROUND)
    top, bottom, slant, thick = at + 3.0, at + 9.5, 5.0, 1.4
    hatch = [
        np.array([[top, y], [top, y + thick], [bottom, y + thick - slant], [bottom, y - slant]])
        for y in np.arange(-_GROUND + slant, _GROUND - thick + 0.1, 5.15)
    ]
    return [("ink", part * unit) for part in [plate, *hatch]]


def _guided(size: float, unit: float) -> Parts:
    """Support in one direction and in rotation: a plate that rolls along hatched ground without turning."""
    plate, radius = _bar(0.0, -_GROUND, 2.5, _GROUND), 3.2
    rolls = [circle(radius * unit) + np.array([2.5 + radius, y]) * unit for y in (-7.0, 7.0)]
    inner = [circle((radius - RIM) * unit) + np.array([2.5 + radius, y]) * unit for y in (-7.0, 7.0)]
    between = [("ink", roll) for roll in rolls] + [("hollow", roll) for roll in inner]
    return [("ink", plate * unit), *between, *_ground(2.5 + 2.0 * radius, unit)]


def _unturned(size: float, unit: float) -> Parts:
    """Support in rotation only: an open square around a joint that slides in both directions."""
    outer, inner = (_bar(-half, -half, half, half) * unit for half in (_SQUARE, _SQUARE - RIM))
    return [("ink", outer), ("hollow", inner)]


def _spiral(size: float, unit: float) -> Parts:
    """A spring that resists turning: two and a half turns from the middle out."""
    angle = np.linspace(0.0, 5.0 * np.pi, 41)
    points = np.stack([np.cos(angle), np.sin(angle)], axis=1) * (_COILED * angle / angle[-1])[:, None]
    ink = [("ink", part * size / _COILED) for part in _thick(points)]
    return [("hollow", circle(size)), *ink]


def _spring(size: float, unit: float) -> Parts:
    """Elastic support in one direction: a spring on hatched ground."""
    turns = [(3.0 + 2.0 * k, 5.0 * (-1) ** k) for k in range(6)]
    points = np.array([(0.0, 0.0), (2.0, 0.0), *turns, (14.0, 0.0), (_HEIGHT, 0.0)])
    return [*(("ink", part * unit) for part in _thick(points)), *_ground(_HEIGHT - 0.5, unit)]


SYMBOLS: dict[str, Callable[[float, float], Parts]] = {
    "ring": lambda radius, unit: [("ink", circle(radius)), ("hollow", circle(max(radius - RIM * unit, 0.0)))],
    "disc": lambda radius, unit: [("ink", circle(radius))],
    "arrow": _arrow,
    "roller": _roller,
    "pinned": lambda size, unit: [*_triangle(unit), *_ground(_HEIGHT - 0.5, unit)],
    "clamped": lambda size, unit: _ground(0.0, unit),
    "guided": _guided,
    "unturned": _unturned,
    "spiral": _spiral,
    "spring": _spring,
}


def dashed(start: Points, end: Points, dash: float) -> tuple[Points, Points, Rows]:
    """Segments cut into dashes and gaps of about that length, a dash at both ends; and of which segment each dash is."""
    step = end - start
    count = np.maximum(np.round((np.hypot(*step.T) / dash - 1.0) / 2.0), 0.0).astype(np.int64) + 1
    of = np.repeat(np.arange(len(start)), count)
    index = np.arange(len(of)) - np.repeat(np.cumsum(count) - count, count)
    share = (1.0 / (2 * count - 1))[of]
    first, last = (2 * index * share)[:, None], ((2 * index + 1) * share)[:, None]
    return start[of] + first * step[of], start[of] + last * step[of], of
