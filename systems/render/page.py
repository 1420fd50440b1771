"""Pages: text in place of a model, such as the working of the force method."""

from __future__ import annotations

import math

from pinjoint.components.view import Page
from pinjoint.systems.render.marks import Mark, Text, boxes
from pinjoint.systems.render.overlays import BAR, draw_notice, draw_overlays
from pinjoint.systems.render.sheet import Sheet
from pinjoint.systems.render.typography import font_size, line_height, text_width, wrapped

_EDGE, _BLOCKS = 14.0, 34.0  # points: to the edges, between blocks of a table
_SIZE = 12.0  # points
_FITTING = (
    (_SIZE, 16.0),
    (_SIZE, 9.0),
    (11.0, 9.0),
    (10.0, 8.0),
    (9.0, 7.0),
)  # points of type, and between columns
_ABOVE, _BELOW = 6.0, 6.0  # points


def draw_page(sheet: Sheet) -> list[Mark]:
    """Lines, a table with aligned columns, and the status line below them."""
    overlays, room = draw_overlays(sheet)
    overlays += draw_notice(sheet, room)
    _, bottom = room
    page, v = sheet.view.page, sheet.viewport
    if page is None or not (page.lines or page.table):
        return overlays
    layout = _Layout(page, v.width, sheet.unit)
    y = v.top + _ABOVE * sheet.unit + layout.step / 2
    marks: list[Mark] = [boxes(sheet.theme.line, (v.left, v.top, v.width, max(round(sheet.unit), 1)))]
    for text in layout.lines:
        left = v.left + _EDGE * sheet.unit
        marks.append(Text(text, left, y, layout.size, sheet.theme.text, "semibold"))
        y += layout.step
    return [*marks, *_table(sheet, layout, y, bottom), *overlays]


def page_height(page: Page, width: float, unit: float) -> int:
    """Pixels that a page takes, its status line included."""
    if not (page.lines or page.table):
        return round(BAR * unit)
    layout = _Layout(page, width, unit)
    rows = len(layout.lines) + (layout.rows + 1 if page.table else 0)
    return math.ceil(rows * layout.step + (_ABOVE + _BELOW + BAR) * unit)


class _Layout:
    """A page in lines of a width; its table in blocks side by side, each under the head.

    A table that is too wide is set closer and smaller, then without the columns that follow the names.
    """

    def __init__(self, page: Page, width: float, unit: float) -> None:
        self.page = page
        self.size = font_size(_SIZE, unit)
        self.step = line_height(self.size)
        room = width - 2 * _EDGE * unit
        self.lines = [line for text in page.lines for line in wrapped(text, room, self.size, "semibold")]
        sample = page.table[:200]  # enough to know how wide columns are
        for size, gap in _FITTING:
            self.type, self.gap = font_size(size, unit), gap * unit
            widths = [
                max(text_width(cell, self.type, "semibold") for cell in column)
                for column in zip(*sample, strict=True)
            ]
            if sum(widths) + self.gap * (len(widths) - 1) <= room:
                break
        kept = list(range(len(widths)))
        while len(kept) > 2 and sum(widths[at] + self.gap for at in kept) - self.gap > room:
            kept.pop(1)  # the last columns are the results
        self.columns, self.widths = kept, [widths[at] for at in kept]
        self.block = sum(self.widths) + self.gap * (len(self.widths) - 1) + _BLOCKS * unit
        self.blocks = max(int((room + _BLOCKS * unit) / self.block), 1) if self.widths else 1
        self.rows = -(-max(len(page.table) - 1, 0) // self.blocks)


def _table(sheet: Sheet, layout: _Layout, y: float, bottom: float) -> list[Mark]:
    """As many rows as there is room for, from the one that was scrolled to."""
    if not layout.page.table:
        return []
    table = layout.page.table
    room = max(int((bottom - _BELOW * sheet.unit - y - 0.5 * layout.step) / layout.step + 0.01), 1)
    high = min(layout.rows, room)
    first = min(layout.page.first, max(layout.rows - high, 0))
    marks: list[Mark] = []
    for block in range(layout.blocks):
        begin = block * layout.rows
        shown = table[1 + begin + first : 1 + min(begin + first + high, begin + layout.rows)]
        left = sheet.viewport.left + _EDGE * sheet.unit + block * layout.block
        for number, row in enumerate([table[0], *shown] if shown else []):
            colour = sheet.theme.muted if number == 0 else sheet.theme.text
            marks += _row(layout, row, left, y + number * layout.step, colour)
    return marks


def _row(layout: _Layout, row: tuple[str, ...], left: float, y: float, colour: tuple[int, ...]) -> list[Mark]:
    marks: list[Mark] = []
    shown = [row[at] for at in layout.columns]
    for index, (cell, width) in enumerate(zip(shown, layout.widths, strict=True)):
        at, anchor = (left, "left") if index == 0 else (left + width, "right")
        marks.append(Text(cell, at, y, layout.type, colour, anchor=anchor))  # type: ignore[arg-type]
        left += width + layout.gap
    return marks
