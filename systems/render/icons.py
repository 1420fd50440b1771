"""Icons of the toolbar by the names of their actions, read from assets/icons, in a square of 20 by 20, y down.

Every part is a kind and its numbers: "line" x, y, x, y, …; "area" x, y, x, y, …; "arc" x, y, radius, from, to
(degrees, clockwise from the right); "disc" x, y, radius.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from functools import cache
from importlib.resources import files

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.mistake import WrongValue

Part = tuple[str, tuple[float, ...]]

STROKE = 1.8  # the width of lines


_NUMBERS = {"disc": 3, "arc": 5}  # of one part; lines and areas have two for each of their points


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
