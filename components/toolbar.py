"""Toolbar: buttons at the left edge of the window, and where they are: the same for drawing and for clicking."""

from __future__ import annotations

from dataclasses import dataclass

from components.camera import Rectangle, Viewport

BUTTON = 30.0, 26.0  # points, width and height
EDGE = 4.0  # points around all buttons
GAP = 6.0  # points between groups
LEAST_WIDTH = 420.0  # points: a window less wide does without
MOST_COLUMNS = 3


@dataclass(frozen=True)
class Tool:
    """The contents of a button.

    action: its name, and that of its icon. title, key: what it does, and what can be pressed instead.
    pressed: it is in use, or what it shows is on. enabled: it would do something now.
    """

    action: str
    title: str
    key: str
    icon: str
    pressed: bool = False
    enabled: bool = True


@dataclass(frozen=True)
class Button(Rectangle):
    """A tool and the rectangle of its button in pixels."""

    tool: Tool


@dataclass(frozen=True)
class Toolbar:
    """Tools in groups, from the top; the last group stands at the bottom."""

    groups: tuple[tuple[Tool, ...], ...] = ()

    def strip(self, window: Viewport, unit: float) -> Viewport:
        """The part of a window that the toolbar takes, with `unit` pixels per point; of no width where it is hidden.

        The toolbar has as few columns as the height allows, and is hidden where MOST_COLUMNS are too high.
        """
        columns = self._columns(window, unit)
        width = round((columns * BUTTON[0] + 2 * EDGE) * unit) if columns else 0
        return Viewport(window.left, window.top, width, window.height)

    def buttons(self, window: Viewport, unit: float) -> list[Button]:
        """Where the buttons are; none where it is hidden."""
        columns = self._columns(window, unit)
        if not columns:
            return []
        (width, height), buttons = BUTTON, []
        top = EDGE
        for group in self.groups:
            if group is self.groups[-1]:
                top = window.height / unit - EDGE - _rows(group, columns) * height
            for index, tool in enumerate(group):
                row, column = divmod(index, columns)
                place = EDGE + column * width, top + row * height, width, height
                left, upper, wide, high = (round(points * unit) for points in place)
                buttons.append(Button(window.left + left, window.top + upper, wide, high, tool))
            top += _rows(group, columns) * height + GAP
        return buttons

    def _columns(self, window: Viewport, unit: float) -> int:
        if not self.groups or window.width < LEAST_WIDTH * unit:
            return 0
        fitting = (n for n in range(1, MOST_COLUMNS + 1) if self._height(n) * unit <= window.height)
        return next(fitting, 0)

    def _height(self, columns: int) -> float:
        """Points that it takes in that many columns."""
        rows = sum(_rows(group, columns) for group in self.groups)
        return rows * BUTTON[1] + (len(self.groups) - 1) * GAP + 2 * EDGE


def _rows(group: tuple[Tool, ...], columns: int) -> int:
    return -(-len(group) // columns)
