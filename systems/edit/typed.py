"""Typed: where a drawing ends or what an arrow is, as people type it: "2 m", "3@45", "@45", "3; 1.5"."""

from __future__ import annotations

import math
from decimal import DecimalException

from pinjoint.components.field import FieldError, Vector
from pinjoint.components.units import inside

BEGINS = frozenset("0123456789.,;-−+@<")  # what is typed with a tool in hand begins with one of these
MOST = 40  # characters
UP = (0.0, 1.0)

_STEP = math.radians(15.0)  # of the direction to the pointer, where only a length is typed
_MEANS = str.maketrans(",−<", ".-@")
_DIGITS = 14  # significant ones that are kept, so that 3 at 60° is 1.5 across


def number(text: str, unit: str, otherwise: str) -> float:
    """The number that a text means, in a unit of the program; otherwise: the unit of one that has none.

    Raises FieldError if it is no number, or its unit is of another kind.
    """
    try:
        return float(inside(text.translate(_MEANS).strip(), unit, otherwise))
    except DecimalException:
        raise FieldError("must be a number") from None


def vector(text: str, unit: str, otherwise: str, pointed: Vector, along: Vector | None = None) -> Vector:
    """The vector that a text means: both parts, "3; 1.5", or a length, an angle from the x-axis, or both, "3@45".

    What is left out is that of the vector to the pointer, its angle in steps. along: the way of a length without an angle.
    Raises as `number` does.
    """
    text = text.translate(_MEANS)
    if ";" in text:
        first, _, second = text.partition(";")
        x, y = (number(part, unit, otherwise) if part.strip() else 0.0 for part in (first, second))
        return x, y
    length, _, angle = text.partition("@")
    across, up = along or pointed
    turned = math.atan2(up, across) if along else _STEP * round(math.atan2(up, across) / _STEP)
    turned = number(angle, "rad", "°") if angle.strip() else turned
    size = number(length, unit, otherwise) if length.strip() else math.hypot(*pointed)
    x, y = (tidy(size * part if abs(part) > 1e-12 else 0.0) for part in (math.cos(turned), math.sin(turned)))
    return x, y


def tidy(value: float) -> float:
    """A number without what rounding left behind its digits."""
    return float(f"{value:.{_DIGITS}g}") + 0.0
