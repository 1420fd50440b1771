"""Shapes: the marks of a picture one by one, each with its element, as drawings made of lines and areas need them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

from pinjoint.systems.render.marks import (
    Bars,
    Discs,
    Fills,
    Mark,
    Owner,
    Owners,
    Panel,
    Picture,
    Points,
    Stamps,
    Strokes,
    Text,
)
from pinjoint.systems.render.symbols import RIM, turned_parts
from pinjoint.systems.render.theme import Colour


class Line(NamedTuple):
    """A straight line with flat ends, between two points in pixels."""

    start: tuple[float, float]
    end: tuple[float, float]
    width: float
    colour: Colour


class Polygon(NamedTuple):
    """A filled polygon."""

    corners: list[list[float]]
    colour: Colour


class Circle(NamedTuple):
    """A circle whose rim, of that width in pixels, lies within the radius; 0: all of it has the colour of ink."""

    middle: tuple[float, float]
    radius: float
    ink: Colour
    hollow: Colour
    rim: float


Shape = Line | Polygon | Circle | Panel | Text


def shapes(mark: Mark) -> Iterator[tuple[Owner | None, Shape]]:
    """The shapes of a mark, and whose they are."""
    match mark:
        case Text() | Panel():
            yield mark.of, mark
        case Strokes():
            ends = zip(mark.start.tolist(), mark.end.tolist(), strict=True)
            lines = (Line((x, y), (far_x, far_y), mark.width, mark.colour) for (x, y), (far_x, far_y) in ends)
            yield from zip(_whose(mark.of, len(mark.start)), lines, strict=True)
        case Fills() | Bars():
            corners = mark.corners.tolist()
            yield from zip(
                _whose(mark.of, len(corners)), (Polygon(c, mark.colour) for c in corners), strict=True
            )
        case Discs():
            discs = zip(mark.at.tolist(), mark.radius.tolist(), strict=True)
            circles = (Circle((x, y), radius, mark.ink, mark.hollow, mark.rim) for (x, y), radius in discs)
            yield from zip(_whose(mark.of, len(mark.at)), circles, strict=True)
        case Stamps():
            for of, at in zip(_whose(mark.of, len(mark.at)), mark.at, strict=True):
                yield from ((of, part) for part in _stamped(mark, at))


def grouped(picture: Picture) -> list[tuple[Owner | None, list[Shape]]]:
    """All shapes of each element together, and those between of no element, in an order to paint them in.

    An element stands where the last of its lines and areas is painted: rods below particles, and both above the
    diagrams of all. Its texts move there with it.
    """
    groups: dict[Owner | int, list[Shape]] = {}
    painted: dict[Owner | int, int] = {}
    for order, mark in enumerate(picture.marks):
        label = isinstance(mark, Text | Panel)
        for of, shape in shapes(mark):
            key = of or order
            groups.setdefault(key, []).append(shape)
            painted[key] = painted.get(key, order) if label else order
    owners = {key: key if isinstance(key, tuple) else None for key in groups}
    return [
        (owners[key], groups[key])
        for key in sorted(groups, key=lambda key: (painted[key], owners[key] or ("", 0)))
    ]


def _whose(of: Owners | None, count: int) -> list[Owner | None]:
    return [None] * count if of is None else [(of[0], row) for row in of[1].tolist()]


def _stamped(mark: Stamps, at: Points) -> Iterator[Shape]:
    """A symbol at one place."""
    x, y = at.tolist()
    if mark.symbol in ("ring", "disc"):
        yield Circle(
            (x, y), mark.size, mark.ink, mark.hollow, RIM * mark.unit if mark.symbol == "ring" else 0.0
        )
        return
    for role, corners in turned_parts(mark):
        yield Polygon((at + corners).tolist(), mark.ink if role == "ink" else mark.hollow)


Name = Callable[[Owner], str]  # the path of an element, such as "rods.AB"
