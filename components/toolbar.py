"""Toolbar: buttons at the left edge of the window, and in how many columns they have room there; and menus of the same."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from pinjoint.components.camera import Viewport
from pinjoint.components.field import Vector

BUTTON = 30.0, 26.0  # points, width and height
LEAST_HEIGHT = 23.5  # points of a button in a low window, before another column begins
EDGE = 4.0  # points around all buttons
GAP = 6.0  # points between groups
LEAST_WIDTH = 420.0  # points: a window less wide does without


@dataclass(frozen=True)
class Tool:
    """The contents of a button.

    action: its name, and that of its icon. title, key: what it does, and what can be pressed instead.
    pressed: it is in use, or what it shows is on. enabled: it would do something now.
    """

    action: str
    title: str
    key: str = ""
    icon: str = ""
    pressed: bool = False
    enabled: bool = True


@dataclass(frozen=True)
class Toolbar:
    """Tools in groups, from the top, in as few columns as the height allows; the last group stands at the bottom."""

    groups: tuple[tuple[Tool, ...], ...] = ()

    def strip(self, window: Viewport, unit: float) -> Viewport:
        """The part of a window that the toolbar takes, with `unit` pixels per point; of no width where it is hidden."""
        columns, _ = self.columns(window, unit)
        width = round((columns * BUTTON[0] + 2 * EDGE) * unit) if columns else 0
        return Viewport(window.left, window.top, width, window.height)

    def columns(self, window: Viewport, unit: float) -> tuple[int, float]:
        """The number of columns, and the points that a button is high; 0 where no number of them has room."""
        return _columns(tuple(map(len, self.groups)), window.width, window.height, unit)


@lru_cache(maxsize=64)  # a picture asks thirty times where its canvas begins
def _columns(groups: tuple[int, ...], width: int, height: int, unit: float) -> tuple[int, float]:
    """Of groups of so many tools."""
    room = height / unit - (len(groups) - 1) * GAP - 2 * EDGE
    for columns in range(1, max(groups, default=0) + 1):
        rows = sum(-(-group // columns) for group in groups)
        if width >= LEAST_WIDTH * unit and rows * LEAST_HEIGHT <= room:
            return columns, min(BUTTON[1], room / rows)
    return 0, 0.0


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
