"""Toolbar: buttons at the left edge of the window, how they are arranged in the room there is; and menus of the same."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

from pinjoint.components.camera import Viewport
from pinjoint.components.field import Vector

BUTTON = 30.0, 26.0  # points, width and height
LEAST_HEIGHT = 23.5  # points of a button in a low window, before another column begins
EDGE = 4.0  # points around all buttons
GAP = 6.0  # points between groups
NAME = 13.0  # points that the name of a group is high
LEAST_WIDTH = 420.0  # points: a window less wide does without
# Points: of a window in which buttons have words, in two columns; of such a button.
WORDS_FROM, WORDED = 1200.0, 114.0


class Arrangement(NamedTuple):
    """How the buttons of a toolbar stand. columns: 0 where no number of them has room. high, wide: points of a button.

    named: groups have their names above them.
    """

    columns: int = 0
    high: float = 0.0
    wide: float = 0.0
    named: bool = False


@dataclass(frozen=True)
class Tool:
    """The contents of a button.

    action: its name, and that of its icon. title, key: what it does, and what can be pressed instead.
    pressed: it is in use, or what it shows is on. enabled: it would do something now. word: what stands beside its icon
    where there is room.
    """

    action: str
    title: str
    key: str = ""
    icon: str = ""
    pressed: bool = False
    enabled: bool = True
    word: str = ""


@dataclass(frozen=True)
class Toolbar:
    """Tools in groups, from the top; the last group stands at the bottom. names: of the groups.

    With words in wide windows, else in as few columns of icons as the height allows.
    """

    groups: tuple[tuple[Tool, ...], ...] = ()
    names: tuple[str, ...] = ()

    def strip(self, window: Viewport, unit: float) -> Viewport:
        """The part of a window that the toolbar takes, with `unit` pixels per point; of no width where it is hidden."""
        columns, _, wide, _ = self.arranged(window, unit)
        width = round((columns * wide + 2 * EDGE) * unit) if columns else 0
        return Viewport(window.left, window.top, width, window.height)

    def arranged(self, window: Viewport, unit: float) -> Arrangement:
        """How the buttons stand in a window, with `unit` pixels per point."""
        return _arranged(tuple(map(len, self.groups)), window.width, window.height, unit)


@lru_cache(maxsize=64)  # a picture asks thirty times where its canvas begins
def _arranged(groups: tuple[int, ...], width: int, height: int, unit: float) -> Arrangement:
    """Of groups of so many tools."""
    room, names = height / unit - (len(groups) - 1) * GAP - 2 * EDGE, len(groups) * NAME
    ways = [(columns, BUTTON[0]) for columns in range(1, max(groups, default=0) + 1)]
    if width >= WORDS_FROM * unit:
        ways.insert(0, (2, WORDED))
    for columns, wide in ways if groups and width >= LEAST_WIDTH * unit else ():
        rows = sum(-(-group // columns) for group in groups)
        named = columns > 1 and rows * LEAST_HEIGHT <= room - names
        if named or (wide < WORDED and rows * LEAST_HEIGHT <= room):
            return Arrangement(columns, min(BUTTON[1], (room - named * names) / rows), wide, named)
    return Arrangement()


@dataclass(frozen=True)
class Menu:
    """Entries in groups under a title, opened at a pixel, where they act.

    chosen: the number of the entry that keys have come to; -1: none yet. pointed: where the pointer was then; once it
    is elsewhere, the entry under it counts.
    """

    title: str
    groups: tuple[tuple[Tool, ...], ...]
    at: Vector
    chosen: int = -1
    pointed: Vector | None = None

    @property
    def entries(self) -> tuple[Tool, ...]:
        """The entries of all groups, from the top."""
        return tuple(tool for group in self.groups for tool in group)
