"""Marks: the parts of a picture, in pixels, y down, as plain data in painter's order.

Marks of which a picture holds hundreds are tuples, which are faster to make. `of` says whose a mark is: a table, such as
"rods", and the row there of each of its items (n,), or of a text or panel its row; None: no element's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.camera import Viewport
from pinjoint.components.view import Hit
from pinjoint.systems.render.theme import Colour

Points = NDArray[np.float64]  # (…, 2)
Values = NDArray[np.float64]
Truths = NDArray[np.bool_]
Owner = tuple[str, int]  # the table and row of an element
Owners = tuple[str, NDArray[np.intp]]


def owners(of: Owners | None, which: NDArray[np.bool_] | NDArray[np.intp] | slice) -> Owners | None:
    """Whose some items of a mark are."""
    return None if of is None else (of[0], of[1][which])


@dataclass(frozen=True)
class Strokes:
    """Straight lines from `start` to `end`, each (n, 2), of one width and colour."""

    start: Points
    end: Points
    width: float
    colour: Colour
    of: Owners | None = None


@dataclass(frozen=True)
class Fills:
    """Filled convex polygons with `corners` (n, k, 2)."""

    corners: Points
    colour: Colour
    of: Owners | None = None


@dataclass(frozen=True)
class Bars:
    """Filled rectangles on lines from `start` to `end`, each (n, 2); `rise` (n, 2), at right angles, is how high."""

    start: Points
    end: Points
    rise: Points
    colour: Colour
    of: Owners | None = None

    @property
    def corners(self) -> NDArray[np.float64]:
        """Shape (n, 4, 2), from start round to end."""
        return np.stack([self.start, self.start + self.rise, self.end + self.rise, self.end], axis=1)


@dataclass(frozen=True)
class Stamps:
    """One symbol at many places `at` (n, 2).

    symbol: a name in symbols.py. size: its own measure in pixels (a radius, a length). turns: quarter
    turns clockwise. unit: pixels per point. ink, hollow: its two colours.
    """

    symbol: str
    at: Points
    size: float
    unit: float
    ink: Colour
    hollow: Colour
    turns: float = 0
    of: Owners | None = None


@dataclass(frozen=True)
class Discs:
    """Circles about `at` (n, 2) with `radius` (n,) in pixels.

    ink: their colour. rim: pixels within the radius that are ink, the rest being `hollow`; 0: all is ink.
    """

    at: Points
    radius: NDArray[np.float64]
    ink: Colour
    hollow: Colour
    rim: float = 0.0
    of: Owners | None = None


class Panel(NamedTuple):
    """An upright box, perhaps with rounded corners and a hairline around it."""

    left: float
    top: float
    width: float
    height: float
    radius: float
    fill: Colour
    outline: Colour | None = None
    of: Owner | None = None


class Text(NamedTuple):
    """One line of text.

    x, y: the point at `anchor` ("left", "centre" or "right") and half the height of capitals.
    size: font size in whole pixels. weight: "regular" or "semibold".
    """

    text: str
    x: float
    y: float
    size: int
    colour: Colour
    weight: str = "regular"
    anchor: str = "left"
    of: Owner | None = None


Mark = Strokes | Fills | Bars | Stamps | Discs | Panel | Text


@dataclass
class Picture:
    """Everything to be drawn in one viewport; without a background, over what is there already.

    meanings: names of the colours that occur in it and mean something. hits: where a press does something, the topmost
    last. untold: how many values found no room, and of how many only a number stands in it.
    """

    viewport: Viewport
    background: Colour | None
    marks: list[Mark] = field(default_factory=list)
    meanings: tuple[str, ...] = ()
    hits: Sequence[Hit] = ()
    untold: tuple[int, int] = (0, 0)

    @property
    def texts(self) -> list[str]:
        """All texts, in order."""
        return [mark.text for mark in self.marks if isinstance(mark, Text)]
