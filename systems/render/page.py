"""Pages: text in place of a model, such as the working of the force method."""

from __future__ import annotations

import numpy as np

from systems.render.marks import Mark, Rectangles, Text
from systems.render.overlays import draw_overlays
from systems.render.sheet import Sheet
from systems.render.typography import line_height, shortened, text_width

_EDGE, _GAP = 14.0, 22.0  # points: to the edges of the viewport, between columns
_SIZES = (13.0, 12.0, 11.0, 10.0, 9.0)  # points, the first at which all lines fit


def draw_page(sheet: Sheet) -> list[Mark]:
    """Lines, a table with aligned columns, and the status line below them."""
    overlays, (_, bottom) = draw_overlays(sheet)
    page, v, u = sheet.view.page, sheet.viewport, sheet.unit
    if page is None or not (page.lines or page.table):
        return overlays
    lines = len(page.lines) + len(page.table)
    room = bottom - v.top - 8.0 * u
    sizes = [sheet.font(points) for points in _SIZES]
    size = next((s for s in sizes if lines * line_height(s) <= room and _width(sheet, s) <= v.width), sizes[-1])
    step, left = line_height(size), v.left + _EDGE * u
    line = np.array([[v.left, v.top, v.width, max(round(u), 1)]], dtype=np.int64)
    marks: list[Mark] = [Rectangles(line, sheet.theme.line)]
    y = v.top + 5.0 * u + step / 2
    for text in page.lines:
        marks.append(
            Text(
                shortened(text, v.width - 2 * _EDGE * u, size, "semibold"),
                left,
                y,
                size,
                sheet.theme.text,
                "semibold",
            )
        )
        y += step
    shown = page.table[: max(int((bottom - y + step / 2) / step), 0)]
    return [*marks, *_table(sheet, shown, left, y, size), *overlays]


def _width(sheet: Sheet, size: int) -> float:
    page = sheet.view.page
    assert page is not None
    return max((text_width(text, size, "semibold") for text in page.lines), default=0) + 2 * _EDGE * sheet.unit


def _table(sheet: Sheet, table: tuple[tuple[str, ...], ...], left: float, y: float, size: int) -> list[Mark]:
    if not table:
        return []
    step, gap = line_height(size), _GAP * sheet.unit
    columns = list(zip(*table, strict=True))
    widths = [max(text_width(cell, size, "semibold") for cell in column) for column in columns]
    marks: list[Mark] = []
    for number, row in enumerate(table):
        colour = sheet.theme.muted if number == 0 else sheet.theme.text
        x = left
        for index, (cell, width) in enumerate(zip(row, widths, strict=True)):
            if index == 0:
                marks.append(Text(cell, x, y + number * step, size, colour))
            else:
                marks.append(Text(cell, x + width, y + number * step, size, colour, anchor="right"))
            x += width + gap
    return marks
