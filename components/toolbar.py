"""Toolbar: buttons at the left edge of the window, and where they are: the same for drawing and for clicking."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from pinjoint.components.camera import Rectangle, Viewport

BUTTON = 30.0, 26.0  # points, width and height
LEAST_HEIGHT = 23.5  # points of a button in a low window, before another column begins
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


Groups = tuple[tuple[Tool, ...], ...]


@dataclass(frozen=True)
class Toolbar:
    """Tools in groups, from the top; the last group stands at the bottom.

    more: the tool that leads to the groups for which there is no room.
    """

    groups: tuple[tuple[Tool, ...], ...] = ()
    more: Tool | None = None

    def strip(self, window: Viewport, unit: float) -> Viewport:
        """The part of a window that the toolbar takes, with `unit` pixels per point; of no width where it is hidden.

        The toolbar has as few columns as the height allows; where MOST_COLUMNS are too high, groups are folded into
        `more`, and where that does not help it is hidden.
        """
        columns, _ = self._shown(window, unit)
        width = round((columns * BUTTON[0] + 2 * EDGE) * unit) if columns else 0
        return Viewport(window.left, window.top, width, window.height)

    def buttons(self, window: Viewport, unit: float) -> list[Button]:
        """Where the buttons are; none where it is hidden."""
        columns, groups = self._shown(window, unit)
        buttons, top = [], EDGE
        width, height = BUTTON
        if columns:
            height = min(height, (window.height / unit - _gaps(groups)) / _rows_of(groups, columns))
        for number, group in enumerate(groups):
            if number == len(groups) - 1:
                top = window.height / unit - EDGE - _rows(group, columns) * height
            for index, tool in enumerate(group):
                row, column = divmod(index, columns)
                left, right = (round((EDGE + at * width) * unit) for at in (column, column + 1))
                upper, lower = (round((top + at * height) * unit) for at in (row, row + 1))
                place = window.left + left, window.top + upper, right - left, lower - upper
                buttons.append(Button(*place, tool))
            top += _rows(group, columns) * height + GAP
        return buttons

    def folded(self, window: Viewport, unit: float) -> tuple[tuple[Tool, ...], ...]:
        """The groups for which there is no room."""
        _, groups = self._shown(window, unit)
        return tuple(group for group in self.groups[:-1] if group not in groups)

    def _shown(self, window: Viewport, unit: float) -> tuple[int, Groups]:
        """The number of columns and the groups in them; none where it is hidden."""
        if not self.groups or window.width < LEAST_WIDTH * unit:
            return 0, ()
        for groups in self._kept():
            for columns in range(1, MOST_COLUMNS + 1):
                least = _rows_of(groups, columns) * LEAST_HEIGHT + _gaps(groups)
                if least * unit <= window.height:
                    return columns, groups
        return 0, ()

    def _kept(self) -> Iterator[Groups]:
        """All groups; then without the last ones, but for that at the bottom."""
        yield self.groups
        if self.more is not None:
            for count in range(len(self.groups) - 2, 1, -1):
                yield (*self.groups[:count], (self.more, *self.groups[-1]))


def _gaps(groups: Groups) -> float:
    """Points above, between and below groups."""
    return (len(groups) - 1) * GAP + 2 * EDGE


def _rows_of(groups: Groups, columns: int) -> int:
    return sum(_rows(group, columns) for group in groups)


def _rows(group: tuple[Tool, ...], columns: int) -> int:
    return -(-len(group) // columns)
