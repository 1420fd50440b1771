"""Icons of the toolbar by the names of their actions, read from assets/icons, in a square of 20 by 20, y down.

Every part is a kind and its numbers: "line" x, y, x, y, …; "area" x, y, x, y, …; "arc" x, y, radius, from, to
(degrees, clockwise from the right); "disc" x, y, radius.
"""

from __future__ import annotations

import json
from importlib.resources import files

Part = tuple[str, tuple[float, ...]]

STROKE = 1.8  # the width of lines
_DRAWN = json.loads((files("assets") / "icons" / "toolbar.json").read_text(encoding="utf-8"))

ICONS: dict[str, tuple[Part, ...]] = {
    name: tuple((kind, tuple(at)) for kind, *at in parts) for name, parts in _DRAWN.items()
}
