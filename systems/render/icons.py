"""Icons of the toolbar as lines and areas, by the names of their actions, in a square of 20 by 20, y down.

Every part is a kind and its numbers: "line" x, y, x, y, …; "area" x, y, x, y, …; "arc" x, y, radius, from, to
(degrees, clockwise from the right); "disc" x, y, radius.
"""

from __future__ import annotations

Part = tuple[str, tuple[float, ...]]

STROKE = 1.8  # the width of lines


def _ring(x: float, y: float, radius: float) -> Part:
    return "arc", (x, y, radius, 0, 360)


def _grid(right: float, top: float) -> tuple[Part, ...]:
    """Lines both ways, from the lower left corner."""
    return (
        ("line", (-5, top, -5, 8.5)),
        ("line", (1.5, top, 1.5, 8.5)),
        ("line", (-9, -1, right, -1)),
        ("line", (-9, 5, right, 5)),
    )


def _mirrored(parts: tuple[Part, ...]) -> tuple[Part, ...]:
    """Left and right exchanged, of lines, areas and discs."""
    return tuple((kind, tuple(-n if i % 2 == 0 else n for i, n in enumerate(at))) for kind, at in parts)


_STEP: tuple[Part, ...] = (("area", (-6, -6.5, 3.5, 0, -6, 6.5)), ("line", (6, -5.6, 6, 5.6)))
_TURN: tuple[Part, ...] = (
    ("line", (-3, -8, -7, -4, -3, 0)),
    ("line", (-7, -4, 2.5, -4, 4.9, -3.3, 6.8, -1.4, 7.5, 1.2, 6.8, 3.9, 4.9, 5.8, 2.5, 6.5, -3, 6.5)),
)
_GAUGE: tuple[Part, ...] = (("arc", (0, 3, 8, 165, 375)), ("disc", (0, 3, 2)))
_DIAGRAM: tuple[Part, ...] = (
    ("line", (-9, 6.5, 9, 6.5)),
    ("line", (-7, 6.5, -7, -5.5, 7, -5.5, 7, 6.5)),
    ("line", (-2.3, -5.5, -2.3, 6.5)),
    ("line", (2.3, -5.5, 2.3, 6.5)),
)

_RELEASE: tuple[Part, ...] = (("line", (-4, -8, -0.5, -1.5, -7.5, -1.5, -4, -8)), ("line", (-9, 1.5, 1, 1.5)))

ICONS: dict[str, tuple[Part, ...]] = {
    "toggle run": (("area", (-5.5, -8, 8, 0, -5.5, 8)),),
    "pause": (("area", (-6, -7, -2, -7, -2, 7, -6, 7)), ("area", (2, -7, 6, -7, 6, 7, 2, 7))),
    "step": _STEP,
    "step back": _mirrored(_STEP),
    "restart": (
        ("line", (-8, -5.6, -8, 5.6)),
        ("area", (0.5, -6.5, -6.5, 0, 0.5, 6.5)),
        ("area", (8, -6.5, 1, 0, 8, 6.5)),
    ),
    "settle": (("arc", (0, -4.5, 9, 12, 168)), ("disc", (0, 0.2, 3.4))),
    "slower": (*_GAUGE, ("line", (0, 3, -4.6, -0.4))),
    "faster": (*_GAUGE, ("line", (0, 3, 4.6, -0.4))),
    "next part": (("line", (-8, 0, 8, 0)), ("line", (2, -6, 8, 0, 2, 6))),
    "release x": (*_RELEASE, ("line", (-2, 8, 8, 8)), ("line", (4.5, 4.8, 8, 8, 4.5, 11.2))),
    "release y": (*_RELEASE, ("line", (6, 9.5, 6, -0.5)), ("line", (2.8, 3, 6, -0.5, 9.2, 3))),
    "release another": (
        _ring(-6.5, 2, 2.2),
        ("line", (-4, 1, -0.5, -0.5)),
        ("line", (2, 4, 6, 5.5)),
        ("line", (5, -9, 5, -3)),
        ("line", (2, -6, 8, -6)),
    ),
    "back": (("line", (-6, -6, 6, 6)), ("line", (-6, 6, 6, -6))),
    "undo": _TURN,
    "redo": _mirrored(_TURN),
    "copy": (
        ("line", (-8, -8, 3.5, -8, 3.5, -4.5)),
        ("line", (-8, -8, -8, 3.5, -4.5, 3.5)),
        ("line", (-3, -3, 8, -3, 8, 8, -3, 8, -3, -3)),
    ),
    "paste": (
        ("line", (-3, -7, -7, -7, -7, 8.5, 7, 8.5, 7, -7, 3, -7)),
        ("area", (-3, -9, 3, -9, 3, -4.5, -3, -4.5)),
        ("line", (-3.5, 0, 3.5, 0)),
        ("line", (-3.5, 4.2, 3.5, 4.2)),
    ),
    "duplicate": (
        ("line", (-7.5, -6, 0.5, -6)),
        _ring(-7.5, -6, 2),
        _ring(1.5, -6, 2),
        ("line", (-1.5, 5.5, 6.5, 5.5)),
        _ring(-1.5, 5.5, 2),
        _ring(7.5, 5.5, 2),
    ),
    "delete": (
        ("line", (-7.5, -5.5, 7.5, -5.5)),
        ("line", (-2.5, -8, 2.5, -8)),
        ("line", (-5.5, -5.5, -4.5, 8.5, 4.5, 8.5, 5.5, -5.5)),
        ("line", (-1.6, -1.5, -1.6, 5)),
        ("line", (1.6, -1.5, 1.6, 5)),
    ),
    "place": (_ring(-2, 2, 5.5), ("line", (6, -9, 6, -3)), ("line", (3, -6, 9, -6))),
    "rod": (("line", (-4.4, 4.4, 4.4, -4.4)), _ring(-6.2, 6.2, 2.5), _ring(6.2, -6.2, 2.5)),
    "support": (
        ("line", (0, -7.5, 5.5, 2.5, -5.5, 2.5, 0, -7.5)),
        ("line", (-8, 2.5, 8, 2.5)),
        ("line", (-4, 3, -7, 7)),
        ("line", (1, 3, -2, 7)),
        ("line", (6, 3, 3, 7)),
    ),
    "force": (("line", (0, -9, 0, 0)), ("area", (-4.2, -2.5, 4.2, -2.5, 0, 3)), _ring(0, 6.3, 2.5)),
    "velocity": (
        _ring(-1, 0, 3.2),
        ("line", (2.5, 0, 5, 0)),
        ("area", (4.5, -4.2, 9.5, 0, 4.5, 4.2)),
        ("line", (-9, -4.5, -5, -4.5)),
        ("line", (-9, 0, -6.5, 0)),
        ("line", (-9, 4.5, -5, 4.5)),
    ),
    "toggle diagrams": _DIAGRAM,
    "toggle diagrams of sets": _DIAGRAM,
    "new grid": (*_grid(9, -4), ("line", (6, -9.5, 6, -3.5)), ("line", (3, -6.5, 9, -6.5))),
    "next grid": (*_grid(9, -4), ("line", (4.5, -9.7, 7.7, -6.5, 4.5, -3.3))),
    "fit": (
        ("line", (-8, -3.5, -8, -8, -3.5, -8)),
        ("line", (3.5, -8, 8, -8, 8, -3.5)),
        ("line", (8, 3.5, 8, 8, 3.5, 8)),
        ("line", (-3.5, 8, -8, 8, -8, 3.5)),
        ("line", (0, -3.6, 4, 3, -4, 3, 0, -3.6)),
    ),
    "properties": (
        *(("line", (-8.5, y, 8.5, y)) for y in (-6, 0, 6)),
        *(("disc", at) for at in ((-3, -6, 2.6), (4, 0, 2.6), (-1.5, 6, 2.6))),
    ),
    "toggle theory": (
        ("line", (-8, -7, -3, -7)),
        ("line", (-8, -3, -3, -3)),
        ("line", (2, -7, 8, -7)),
        ("line", (2, -3, 8, -3)),
        ("line", (-0.5, -9, -0.5, 1)),
        ("line", (-8, 7, -4, 3.5, 0, 7, 4, 3.5, 8, 7)),
    ),
    "toggle energy": (
        ("line", (-8, -8.5, -8, 8, 8.5, 8)),
        ("area", (-5.5, 6, -5.5, -1, -2.5, -1, -2.5, 6)),
        ("area", (-1, 6, -1, -6, 2, -6, 2, 6)),
        ("area", (3.5, 6, 3.5, 2, 6.5, 2, 6.5, 6)),
    ),
    "new": (
        ("line", (-6, -8.5, 2, -8.5, 6, -4.5, 6, 8.5, -6, 8.5, -6, -8.5)),
        ("line", (1.5, -8.5, 1.5, -4, 6, -4)),
    ),
    "load": (
        ("line", (-8.5, 7, -8.5, -6, -3, -6, -1, -3.5, 6.5, -3.5, 6.5, -0.5)),
        ("line", (-8.5, 7, -5.5, -0.5, 9.5, -0.5, 6.5, 7, -8.5, 7)),
    ),
    "save again": (
        ("line", (-7.5, -7.5, 4.5, -7.5, 7.5, -4.5, 7.5, 7.5, -7.5, 7.5, -7.5, -7.5)),
        ("line", (-3.8, -7.5, -3.8, -3, 2.8, -3, 2.8, -7.5)),
        ("line", (-4.3, 7.5, -4.3, 1.5, 4.3, 1.5, 4.3, 7.5)),
    ),
    "force method": (
        _ring(-7.2, 0, 2.2),
        _ring(7.2, 0, 2.2),
        ("area", (-4.7, -3.6, -0.6, 0, -4.7, 3.6)),
        ("area", (4.7, -3.6, 0.6, 0, 4.7, 3.6)),
        ("line", (0, -8, 0, -5)),
        ("line", (0, 5, 0, 8)),
    ),
    "next theme": (
        _ring(0, 0, 7.5),
        ("area", (0, -7.5, 3.8, -6.5, 6.5, -3.8, 7.5, 0, 6.5, 3.8, 3.8, 6.5, 0, 7.5)),
    ),
    "toggle help": (
        ("line", (-4, -4.2, -3.4, -6.6, -1.5, -8, 1.5, -8, 3.5, -6.5, 4, -4.3, 3.1, -2.2, 0.8, -0.6, 0, 2.6)),
        ("disc", (0, 7.2, 1.5)),
    ),
}
