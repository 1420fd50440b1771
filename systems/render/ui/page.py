"""Pages: text in place of a model, such as the working of the force method."""

from __future__ import annotations

import math

from pinjoint.components.camera import Rectangle, Viewport
from pinjoint.components.field import Vector
from pinjoint.components.view import Page
from pinjoint.systems.render.marks import Mark, Panel
from pinjoint.systems.render.model.sheet import Sheet
from pinjoint.systems.render.typography import font_size, line_height, text_width, wrapped
from pinjoint.systems.render.ui.layout import Column, Paper, Row, Text
from pinjoint.systems.render.ui.overlays import BAR, EDGE, draw_overlays, put_notice

_BLOCKS, _AROUND = 34.0, 6.0  # points: between blocks of a table, above and below all
_SIZE = 12.0  # points


def draw_page(sheet: Sheet) -> list[Mark]:
    """Lines, a table with as many rows as there is room for from the one scrolled to, and the status line below them."""
    overlays, room = draw_overlays(sheet)
    put_notice(Paper(sheet.unit, None, overlays), sheet, room)
    page, v, u, theme = sheet.view.page, sheet.viewport, sheet.unit, sheet.theme
    if page is None or not (page.lines or page.table):
        return overlays
    layout = _Layout(page, v.width, u)
    step, table, blocks = layout.step / u, page.table, []
    first, high = layout.in_sight(page, room[1] - v.top)
    for begin in range(0, layout.blocks * layout.rows, max(layout.rows, 1)):
        rows = table[1 + begin + first : 1 + begin + min(first + high, layout.rows)]
        columns = []
        for at, width in layout.columns:
            anchor = "right" if at else "left"
            cells = [Text(row[at], layout.type, theme.text, anchor=anchor, apart=step) for row in rows]
            head = Text(table[0][at], layout.type, theme.muted, anchor=anchor, apart=step)
            columns.append(Column((head, *cells), wide=width / u))
        blocks += [Row(columns, layout.gap / u)] if rows else []
    lines = (Text(line, _SIZE, theme.text, "semibold", apart=step) for line in layout.lines)
    tree = Column((*lines, Row(blocks, _BLOCKS, top=True)), around=(EDGE, _AROUND, _AROUND))
    paper = Paper(u, marks=[Panel(v.left, v.top, v.width, max(round(u), 1), 0.0, theme.line)])
    paper.put(tree, Rectangle(v.left, v.top, v.width, tree.height(u, v.width)))
    return [*paper.marks, *overlays]


def page_height(page: Page, width: float, unit: float) -> int:
    """Pixels that a page takes, its status line included."""
    if not (page.lines or page.table):
        return round(BAR * unit)
    layout = _Layout(page, width, unit)
    rows = len(layout.lines) + (layout.rows + 1 if page.table else 0)
    return math.ceil(rows * layout.step + (2 * _AROUND + BAR) * unit)


def cell_at(page: Page, place: Viewport, unit: float, pixel: Vector | None) -> tuple[int, int] | None:
    """Row and column of the cell of a page's table at a pixel, rows from 0, its head; None elsewhere."""
    if pixel is None or not page.table or not place.contains(pixel):
        return None
    layout = _Layout(page, place.width, unit)
    x, y = pixel[0] - place.left - EDGE * unit, pixel[1] - place.top - _AROUND * unit
    line = int(y // layout.step) - len(layout.lines)
    block, x = divmod(x, layout.across)
    first, _ = layout.in_sight(page, place.height - BAR * unit)
    row = line and line + first + int(block) * layout.rows
    for column, wide in layout.columns:
        if line >= 0 and 0.0 <= x <= wide + layout.gap and row < len(page.table):
            return row, column
        x -= wide + layout.gap
    return None


class _Layout:
    """A page in lines of a width; its table in blocks side by side, each under the head.

    A table that is too wide is set closer and smaller, then without the columns that follow the names. columns: the number
    and the pixels of those that are left. across: pixels from block to block.
    """

    def __init__(self, page: Page, width: float, unit: float) -> None:
        size, room = font_size(_SIZE, unit), width - 2 * EDGE * unit
        self.step = line_height(size)
        self.lines = [line for text in page.lines for line in wrapped(text, room, size, "semibold")]
        for self.type, gap in (_SIZE, 16.0), (_SIZE, 9.0), (10.0, 8.0):  # points of type, and between columns
            self.gap, font = gap * unit, font_size(self.type, unit)
            columns = zip(*page.table[:200], strict=True)  # enough to know how wide columns are
            widths = [max(text_width(cell, font, "semibold") for cell in column) for column in columns]
            if sum(widths) + self.gap * (len(widths) - 1) <= room:
                break
        self.columns = list(enumerate(widths))
        while len(self.columns) > 2 and sum(wide + self.gap for _, wide in self.columns) - self.gap > room:
            self.columns.pop(1)  # the last columns are the results
        self.across = sum(wide + self.gap for _, wide in self.columns) - self.gap + _BLOCKS * unit
        self.blocks = max(int((room + _BLOCKS * unit) / self.across), 1) if widths and not page.whole else 1
        self.rows = -(-max(len(page.table) - 1, 0) // self.blocks)
        self.around = 2 * _AROUND * unit

    def in_sight(self, page: Page, height: float) -> tuple[int, int]:
        """The first row of each block that is shown in a height, and how many are at most."""
        high = max(int((height - self.around) / self.step - len(self.lines) - 1 + 0.01), 1)
        return min(page.first, max(self.rows - high, 0)), high
