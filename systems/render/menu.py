"""Menu: where its entries are, for drawing and for clicking, and its marks."""

from __future__ import annotations

import numpy as np

from pinjoint.components.camera import Rectangle, Viewport
from pinjoint.components.field import Vector
from pinjoint.components.language import begun, tr
from pinjoint.components.menu import Menu
from pinjoint.components.toolbar import Tool
from pinjoint.components.view import View
from pinjoint.systems.render.help import written_key
from pinjoint.systems.render.marks import Mark, Panel, Strokes, Text, boxes
from pinjoint.systems.render.theme import Theme, faded
from pinjoint.systems.render.typography import font_size, shortened, text_width

_SIZES = ((12.5, 22.0), (11.5, 19.0), (10.0, 16.0), (9.0, 13.0))  # points: type, and from entry to entry
_PAD, _CHECK, _GAP = 10.0, 16.0, 20.0  # points: at the sides, for the check mark, between title and key
_BETWEEN, _EDGE = 7.0, 4.0  # points between groups; above, below, and to the edges of the window
_RADIUS = 6.0  # points


def menu_of(view: View) -> MenuLayout | None:
    """The menu that is open in a view: beside the place where it opened, with the largest type that fits."""
    if view.menu is None:
        return None
    for size in _SIZES:
        layout = MenuLayout(view.menu, view.camera.viewport, view.pixel_ratio, *size)
        if layout.fits:
            break
    return layout


class MenuLayout:
    """Places in pixels. frame: the whole menu. entries: a rectangle of each. rules: lines between groups."""

    def __init__(self, menu: Menu, window: Viewport, unit: float, points: float, row: float) -> None:
        self.menu, self.unit, self.size, self.row = menu, unit, font_size(points, unit), row * unit
        edge = _EDGE * unit
        self.head = self.row if menu.title else 0.0
        columns = self._even_columns(window.height - 4 * edge - self.head)
        width = max(
            [self._width(tool) for tool in menu.entries] + [text_width(menu.title, self.size, "semibold") / 2]
        )
        self.column = min(width + (2 * _PAD + _CHECK) * unit, (window.width - 2 * edge) / len(columns))
        high = max(rows[-1][1] + self.row for rows in columns) + self.head + 2 * edge
        wide = self.column * len(columns)
        self.fits = high <= window.height - 2 * edge and width + (2 * _PAD + _CHECK) * unit <= self.column + 0.5
        x, y = menu.at
        beside = x + max(round(unit), 1)
        left = beside if beside + wide <= window.right - edge else x - wide
        top = y if y + high <= window.bottom - edge else y - high
        left = min(max(left, window.left + edge), max(window.right - edge - wide, window.left))
        top = min(max(top, window.top + edge), max(window.bottom - edge - high, window.top))
        self.frame = Rectangle(left, top, wide, high)
        self.entries: list[Rectangle] = []
        self.rules: list[Rectangle] = []
        for column, rows in enumerate(columns):
            for is_rule, y in rows:
                at = Rectangle(left + column * self.column, top + edge + self.head + y, self.column, self.row)
                (self.rules if is_rule else self.entries).append(at)

    def _width(self, tool: Tool) -> float:
        key = text_width(written_key(tool.key), self.size) + _GAP * self.unit if tool.key else 0.0
        return text_width(titled(tool), self.size) + key

    def _even_columns(self, room: float) -> list[list[tuple[bool, float]]]:
        """As few columns as the room above each other needs, about equally high."""
        columns, high = self._columns(room), len(self.menu.entries) * self.row
        least = high / len(columns)
        lower = (
            self._columns(least + number * self.row) for number in range(int((room - least) / self.row) + 1)
        )
        return next((even for even in lower if len(even) == len(columns)), columns)

    def _columns(self, room: float) -> list[list[tuple[bool, float]]]:
        """(is a rule, its top) of every line, in as many columns as the room above each other needs."""
        columns, y, between = [list[tuple[bool, float]]()], 0.0, _BETWEEN * self.unit
        for number, group in enumerate(self.menu.groups):
            high = len(group) * self.row
            if columns[-1] and y + between + min(high, room) > room:
                columns.append([])
                y = 0.0
            elif number:
                columns[-1].append((True, y + between / 2))
                y += between
            for _ in group:
                if columns[-1] and y + self.row > room:
                    columns.append([])
                    y = 0.0
                columns[-1].append((False, y))
                y += self.row
        return columns

    def entry_at(self, pixel: Vector) -> int:
        """The number of the entry at a pixel; -1: none."""
        return next((number for number, place in enumerate(self.entries) if place.contains(pixel)), -1)

    def pointed_at(self, pointer: Vector | None) -> int:
        """The number of the entry that the pointer, else the keys, have come to; -1: none."""
        if pointer is not None and pointer != self.menu.pointed and (under := self.entry_at(pointer)) >= 0:
            return under
        return self.menu.chosen

    def beside(self, number: int, by: int) -> int:
        """The entry nearest to this one in the column to the right (1) or left (-1) of it; the same without any."""
        here = self.entries[max(number, 0)]
        there = [
            (abs(place.top - here.top), other)
            for other, place in enumerate(self.entries)
            if round((place.left - here.left) / self.column) == by
        ]
        return min(there)[1] if there else number


def titled(tool: Tool) -> str:
    """The title of an entry or a button in the present language, as a sentence begins."""
    return begun(tr(tool.title))


def draw_menu(view: View, theme: Theme) -> list[Mark]:
    """The menu that is open, over everything else."""
    layout = menu_of(view)
    if layout is None:
        return []
    u, size, frame, menu = layout.unit, layout.size, layout.frame, layout.menu
    marks: list[Mark] = [Panel(*frame.box, _RADIUS * u, theme.background, theme.line)]
    if menu.title:
        title = shortened(menu.title, frame.width - 2 * _PAD * u, size, "semibold")
        y = frame.top + _EDGE * u + layout.head / 2
        marks.append(Text(title, frame.left + _PAD * u, y, size, theme.muted, "semibold"))
    for rule in layout.rules:
        thin = max(round(u), 1)
        left, width = round(rule.left + _PAD * u), round(rule.width - 2 * _PAD * u)
        marks.append(boxes(theme.line, (left, round(rule.top), width, thin)))
    now = layout.pointed_at(view.pointer)
    for number, (tool, place) in enumerate(zip(menu.entries, layout.entries, strict=True)):
        if number == now:
            inner = place.left + 3 * u, place.top, place.width - 6 * u, place.height
            marks.append(Panel(*inner, 4.0 * u, faded(theme.text, 0.09 if tool.enabled else 0.04)))
        marks += _entry(layout, tool, place, theme)
    return marks


def _entry(layout: MenuLayout, tool: Tool, place: Rectangle, theme: Theme) -> list[Mark]:
    """A check mark if it is on, its title, and its key at the right if there is room."""
    u, size, y = layout.unit, layout.size, place.middle[1]
    ink = theme.text if tool.enabled else faded(theme.muted, 0.5)
    left = place.left + (_PAD + _CHECK) * u
    room = place.right - _PAD * u - left
    title, key = titled(tool), written_key(tool.key) if tool.key else ""
    marks: list[Mark] = [Text(shortened(title, room, size), left, y, size, ink)]
    if key and text_width(title, size) + text_width(key, size) + 0.5 * _GAP * u <= room:
        paler = faded(theme.muted, 1.0 if tool.enabled else 0.5)
        marks.append(Text(key, place.right - _PAD * u, y, size, paler, anchor="right"))
    if tool.pressed:
        x = place.left + _PAD * u
        corners = np.array([[x, y], [x + 3.5 * u, y + 3.5 * u], [x + 9.5 * u, y - 4.0 * u]])
        marks.append(Strokes(corners[:-1], corners[1:], 1.6 * u, ink))
    return marks
