"""Toolbar: buttons at the left edge of the window, and how many of them have room there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from pinjoint.components.camera import Viewport

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
        columns, _, _ = self.shown(window, unit)
        width = round((columns * BUTTON[0] + 2 * EDGE) * unit) if columns else 0
        return Viewport(window.left, window.top, width, window.height)

    def folded(self, window: Viewport, unit: float) -> tuple[tuple[Tool, ...], ...]:
        """The groups for which there is no room."""
        _, groups, _ = self.shown(window, unit)
        return tuple(group for group in self.groups[:-1] if group not in groups)

    def shown(self, window: Viewport, unit: float) -> tuple[int, Groups, float]:
        """The number of columns, the groups in them, and the points that a button is high; none where it is hidden."""
        if self.groups and window.width >= LEAST_WIDTH * unit:
            for groups in self._kept():
                for columns in range(1, MOST_COLUMNS + 1):
                    rows = sum(-(-len(group) // columns) for group in groups)
                    room = window.height / unit - (len(groups) - 1) * GAP - 2 * EDGE
                    if rows * LEAST_HEIGHT <= room:
                        return columns, groups, min(BUTTON[1], room / rows)
        return 0, (), 0.0

    def _kept(self) -> Iterator[Groups]:
        """All groups; then without the last ones, but for that at the bottom."""
        yield self.groups
        if self.more is not None:
            for count in range(len(self.groups) - 2, 1, -1):
                yield (*self.groups[:count], (self.more, *self.groups[-1]))
