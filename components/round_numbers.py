"""Round numbers: 1, 2 and 5 times powers of ten, for scales that people read."""

from __future__ import annotations

import math

_SMALLEST, _LARGEST = 1e-300, 1e300  # beyond them powers of ten are no exact steps, or none


def round_down(number: float) -> float:
    """The largest of …, 1, 2, 5, 10, 20, … that is at most a number."""
    number, power = _decade(number)
    return next(step * power for step in (5.0, 2.0, 1.0, 0.5) if step * power <= number * (1.0 + 1e-9))


def round_up(number: float) -> float:
    """The smallest of …, 1, 2, 5, 10, 20, … that is at least a number."""
    number, power = _decade(number)
    return next(step * power for step in (0.5, 1.0, 2.0, 5.0, 10.0) if step * power >= number * (1.0 - 1e-9))


def round_near(number: float) -> float:
    """The one of …, 1, 2, 5, 10, 20, … whose ratio to a number is nearest to 1."""
    number, power = _decade(number)
    return min((1.0, 2.0, 5.0, 10.0), key=lambda step: abs(math.log(step * power / number))) * power


def _decade(number: float) -> tuple[float, float]:
    """A number within the range of powers of ten, in which whatever is no number above 0 is the least; and its own."""
    number = min(max(_SMALLEST, number), _LARGEST)
    return number, 10.0 ** math.floor(math.log10(number))
