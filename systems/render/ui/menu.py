"""The menu that is open: its entries in columns beside the place where it opened."""

from __future__ import annotations

import numpy as np

from pinjoint.components.camera import Rectangle
from pinjoint.components.field import Vector
from pinjoint.components.language import tr
from pinjoint.components.toolbar import Tool
from pinjoint.components.view import Hit, View
from pinjoint.systems.render.marks import Mark, Panel, Strokes
from pinjoint.systems.render.theme import Colour, Theme, faded
from pinjoint.systems.render.ui.buttons import ink_of, tool_row
from pinjoint.systems.render.ui.layout import (
    Column,
    Drawn,
    Gap,
    Paper,
    Part,
    Plate,
    Row,
    Text,
    in_columns,
    rule,
)

_SIZES = (12.5, 21.0), (11.5, 19.0), (10.0, 14.5)  # points: type, and from entry to entry
_EDGE = 4.0  # points above, below, and to the edges of the window


def put_menu(paper: Paper, view: View, theme: Theme) -> None:
    """The menu that is open in a view; a press beside it closes it.

    Where not all columns have room, those are shown that end with the one that keys or the wheel have come to, and it says
    so below them.
    """
    menu, window, u = view.menu, view.camera.viewport, view.pixel_ratio
    if menu is None:
        return
    parts, (points, row) = _columns(view, theme)
    widths = [Column(column).width(u) for column in parts]
    fits = sum(widths) <= window.width - 2 * _EDGE * u
    wheel = None if fits else ("menu left", "menu right")
    most = len(parts) if fits else max(int(window.width / max(widths)), 1)
    last = next((n for n, column in enumerate(parts) if menu.chosen in _numbers_in(column)), 0)
    first = max(min(last, len(parts) - 1) - most + 1, 0)
    columns = Row([Column(column, grow=1.0) for column in parts[first : first + most]])
    head, foot = (
        [Row((Text(text, points, theme.muted, weight),), around=(10.0, 0.0, 0.0), high=row)] * bool(text)
        for text, weight in ((menu.title, "semibold"), ("" if fits else tr("Wheel shows more"), "regular"))
    )
    whole = Plate(
        Column((*head, columns, *foot), around=(0.0, _EDGE, _EDGE)),
        theme.background,
        theme.line,
        radius=6.0,
        action="",
        wheel=wheel,
    )
    edge, (x, y) = _EDGE * u, menu.at
    wide = min(whole.width(u), window.width - 2 * edge)
    high = whole.height(u, wide)
    beside = x + max(round(u), 1)  # to the left or above only where all of it has room there
    left = beside if beside + wide <= window.right - edge or x - wide < window.left + edge else x - wide
    top = y if y + high <= window.bottom - edge or y - high < window.top + edge else y - high
    left = min(max(left, window.left + edge), max(window.right - edge - wide, window.left))
    top = min(max(top, window.top + edge), max(window.bottom - edge - high, window.top))
    placed = Paper(u)
    placed.put(whole, Rectangle(left, top, wide, high))
    paper.hits += [Hit(*window.box, "close menu", wheel=wheel, again=True), *placed.hits]
    now = _pointed_at(view, placed.hits, paper.pointer)
    lit = [
        Panel(hit.left + 3 * u, hit.top, hit.width - 6 * u, hit.height, 4.0 * u, faded(theme.text, opacity))
        for hit in placed.hits
        if hit.item == now and (opacity := 0.09 if hit.enabled else 0.04)
    ]
    paper.marks += [*placed.marks[:1], *lit, *placed.marks[1:]]


def pointed_at(view: View, theme: Theme, pointer: Vector) -> int:
    """The number of the entry that the pointer, once it has moved, else the keys, have come to; -1: none."""
    paper = Paper(view.pixel_ratio)
    put_menu(paper, view, theme)
    return _pointed_at(view, paper.hits, pointer)


def _pointed_at(view: View, hits: list[Hit], pointer: Vector | None) -> int:
    assert view.menu is not None
    if pointer is None or pointer == view.menu.pointed:
        return view.menu.chosen
    under = (hit.item for hit in hits if hit.item is not None and hit.contains(pointer))
    return next(under, view.menu.chosen)


def entry_beside(view: View, theme: Theme, number: int, by: int) -> int:
    """The entry at the same height in the column to the right (1) or left (-1) of that of an entry, or the same."""
    columns = [_numbers_in(column) for column in _columns(view, theme)[0]]
    here = next((n for n, column in enumerate(columns) if number in column), 0)
    if not 0 <= here + by < len(columns):
        return number
    there = columns[here + by]
    return there[min(columns[here].index(max(number, 0)), len(there) - 1)]


def _numbers_in(column: list[Part]) -> list[int]:
    """The numbers of the entries in a column."""
    return [part.item for part in column if isinstance(part, Plate)]


def _columns(view: View, theme: Theme) -> tuple[list[list[Part]], tuple[float, float]]:
    """The entries in columns, in the largest type in which all have room beside each other, and its size and rows."""
    assert view.menu is not None
    menu, u, window = view.menu, view.pixel_ratio, view.camera.viewport
    between = Row((Gap(10.0), rule(theme.line, 7.0), Gap(10.0)))
    for points, row, told in (*((*size, 0) for size in _SIZES), (*_SIZES[-1], 1)):  # below: that there is more
        number = iter(range(len(menu.entries)))
        room = window.height - (4 * _EDGE + row * (bool(menu.title) + told)) * u
        groups = [
            [_entry(tool, next(number), menu.at, theme, points, row) for tool in group] for group in menu.groups
        ]
        columns = in_columns(groups, between, u, room, np.inf)
        if sum(Column(column).width(u) for column in columns) <= window.width - 2 * _EDGE * u:
            break
    return columns, (points, row)


def _entry(tool: Tool, number: int, at: Vector, theme: Theme, points: float, row: float) -> Plate:
    """A check mark if it is on, its title and its key."""
    ink = ink_of(theme, enabled=tool.enabled)
    sign = Drawn(lambda at, u: _tick(at, u, ink) if tool.pressed else [], 16.0)
    inside = Row((tool_row(tool, theme, sign, points, 20.0),), around=(10.0, 0.0, 0.0), high=row)
    return Plate(inside, action=tool.action, enabled=tool.enabled, item=number, at=at)


def _tick(at: Rectangle, u: float, ink: Colour) -> list[Mark]:
    x, y = at.left, at.middle[1]
    corners = np.array([[x, y], [x + 3.5 * u, y + 3.5 * u], [x + 9.5 * u, y - 4.0 * u]])
    return [Strokes(corners[:-1], corners[1:], 1.6 * u, ink)]
