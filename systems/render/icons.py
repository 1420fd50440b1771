"""Icons of the toolbar by the names of their actions, read from assets/icons, in a square of 20 by 20, y down.

Every part is a kind and its numbers: "line" x, y, x, y, …; "area" x, y, x, y, …; "arc" x, y, radius, from, to
(degrees, clockwise from the right); "disc" x, y, radius.
"""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files

Part = tuple[str, tuple[float, ...]]

STROKE = 1.8  # the width of lines


ADDED: dict[str, tuple[Part, ...]] = {}  # icons of mods


def icon(name: str) -> tuple[Part, ...]:
    """The parts of an icon. Raises KeyError."""
    return ADDED[name] if name in ADDED else icons()[name]


@cache
def icons() -> dict[str, tuple[Part, ...]]:
    """The parts of the icons that the program brings, by name."""
    drawn = json.loads((files("assets") / "icons" / "toolbar.json").read_text(encoding="utf-8"))
    return {name: tuple((kind, tuple(at)) for kind, *at in parts) for name, parts in drawn.items()}
