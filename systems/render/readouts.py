"""Readouts: panels of names and values, one below the other, with a button that closes each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pinjoint.components.camera import Rectangle
from pinjoint.components.field import Vector
from pinjoint.components.language import english, tr
from pinjoint.components.view import Readout
from pinjoint.systems.render.marks import Mark, Panel, Text, cross
from pinjoint.systems.render.plots import Box, draw_plot
from pinjoint.systems.render.sheet import Sheet
from pinjoint.systems.render.theme import faded
from pinjoint.systems.render.typography import line_height, shortened, text_width, wrapped

_EDGE, _PAD, _GAP = 10.0, 9.0, 16.0  # points: to the edges, inside a panel, between name and value
_BETWEEN, _CLOSE = 6.0, 20.0  # points between panels, and the side of the button that closes one
_PLOT, _LEAST_PLOT = 150.0, 84.0  # points, height of a plot with its axes, and where there is little room


@dataclass(frozen=True)
class ShownPanel:
    """Where a panel is, or the row of a folded one, and its button that closes it, if it has one."""

    place: Rectangle
    readout: Readout
    close: Rectangle | None = None

    def action_at(self, pixel: Vector) -> str | None:
        """The action of a click at a pixel, if it has one."""
        return self.readout.closes if self.close is not None and self.close.contains(pixel) else None


def draw_readouts(sheet: Sheet, room: tuple[float, float]) -> tuple[list[Mark], list[ShownPanel]]:
    """The panels between `room`'s top and bottom, and where they are; none where they are hidden.

    Where room is short, plots are lower, and the oldest panels are folded into one with a row for each.
    """
    readouts = sheet.view.readouts if sheet.view.legend else ()
    place, u = sheet.view.panels, sheet.unit
    top, bottom = max(room[0], place.top) + _EDGE * u, min(room[1], place.top + place.height) - _EDGE * u
    width = place.width - 2 * _EDGE * u
    if not any(readout.is_large for readout in readouts):
        width = min(max((_width(sheet, readout) for readout in readouts), default=0.0), width)
    left = place.left + place.width - _EDGE * u - width
    marks, shown = list[Mark](), list[ShownPanel]()
    heights = _heights(sheet, readouts, width, bottom - top)
    for index, height in sorted(heights.items()):
        middle = top + _PAD * u + _line(sheet) / 2  # of the title's line
        panel = _with_button(sheet, readouts[index], Rectangle(left, top, width, height), middle)
        marks += _panel(sheet, readouts[index], panel)
        shown.append(panel)
        top += height + _BETWEEN * u
    folded = [readout for index, readout in enumerate(readouts) if index not in heights]
    if folded:
        box = left, top, width, _folded_height(sheet, len(folded))
        rows = _rows(sheet, folded, box)
        marks += _titles(sheet, rows, box)
        shown += rows
    return marks, shown


def _heights(sheet: Sheet, readouts: Sequence[Readout], width: float, room: float) -> dict[int, float]:
    """Heights in pixels of the panels for which there is room, by index; the newest panels come first."""
    since = [sheet.view.since.get(english(readout.title), 0) for readout in readouts]
    newest = sorted(range(len(readouts)), key=since.__getitem__, reverse=True)
    gap, shown = _BETWEEN * sheet.unit, dict[int, float]()
    left = room
    for index in newest:
        height = _height(sheet, readouts[index], width, _LEAST_PLOT)
        others = len(readouts) - len(shown) - 1
        folded = _folded_height(sheet, others) + gap if others else 0.0
        if height + folded <= left:
            shown[index] = height
            left -= height + gap
            spare = left - folded
    for index in shown:
        grown = min(_height(sheet, readouts[index], width, _PLOT), shown[index] + spare)
        spare -= grown - shown[index]
        shown[index] = grown
    return shown


def _folded_height(sheet: Sheet, count: int) -> float:
    """Height in pixels of a panel with the titles of those for which there is no room."""
    return count * _line(sheet) + _PAD * sheet.unit


def _rows(sheet: Sheet, folded: Sequence[Readout], box: Box) -> list[ShownPanel]:
    """A row for each, from edge to edge, with its button."""
    left, top, width, _ = box
    rows, line = list[ShownPanel](), _line(sheet)
    for number, readout in enumerate(folded):
        y = top + _PAD * sheet.unit / 2 + number * line
        rows.append(_with_button(sheet, readout, Rectangle(left, y, width, line), y + line / 2))
    return rows


def _titles(sheet: Sheet, rows: Sequence[ShownPanel], box: Box) -> list[Mark]:
    """A panel with the titles of folded ones only."""
    u, theme, size = sheet.unit, sheet.theme, sheet.font(12.0)
    sheet.occupancy.block(*box)
    marks: list[Mark] = [Panel(*box, 6.0 * u, faded(theme.panel, 0.94), theme.line)]
    for row in rows:
        left, right = row.place.left + _PAD * u, row.close.left if row.close else row.place.right
        room = right - 4.0 * u - left
        title = shortened(tr(row.readout.title), room, size)
        marks.append(Text(title, left, row.place.middle[1], size, theme.muted))
        marks += _closing(sheet, row.close) if row.close else []
    return marks


def _line(sheet: Sheet) -> float:
    return line_height(sheet.font(12.0))


def _height(sheet: Sheet, readout: Readout, width: float, plot: float) -> float:
    """Height in pixels of a panel with all rows; plot: points of the plot, if the readout has one."""
    lines = len(_heading(sheet, readout, width)) + len(_lines(sheet, readout, width))
    height = lines * _line(sheet) + 2 * _PAD * sheet.unit
    return height + (plot * sheet.unit if readout.plot is not None else 0.0)


def _heading(sheet: Sheet, readout: Readout, width: float) -> list[str]:
    """The title of a panel that is so wide, in lines beside its button."""
    room = width - (_PAD + (_CLOSE + 7.0 if readout.closes else _PAD)) * sheet.unit
    return wrapped(tr(readout.title), room, sheet.font(12.0), "semibold")


def _lines(sheet: Sheet, readout: Readout, width: float) -> list[tuple[str, str]]:
    """The rows of a panel that is so wide; what is too long for one line goes on below."""
    size, room, lines = sheet.font(12.0), width - 2 * _PAD * sheet.unit, list[tuple[str, str]]()
    for name, value in readout.rows:
        taken = text_width(name, size) + _GAP * sheet.unit * bool(name and value)
        if taken + text_width(value, size, "semibold") <= room:
            lines.append((name, value))
            continue
        lines += [(part, "") for part in wrapped(name, room, size)] if name else []
        lines += [("", part) for part in wrapped(value, room, size, "semibold")] if value else []
    return lines


def _width(sheet: Sheet, readout: Readout) -> float:
    """Width in pixels of a panel in a corner."""
    u, size = sheet.unit, sheet.font(12.0)
    names = max((text_width(name, size) for name, _ in readout.rows), default=0.0)
    values = max((text_width(value, size, "semibold") for _, value in readout.rows), default=0.0)
    title = text_width(tr(readout.title), size, "semibold") + (_CLOSE * u if readout.closes else 0.0)
    return max(names + _GAP * u + values, title) + 2 * _PAD * u


def _with_button(sheet: Sheet, readout: Readout, place: Rectangle, middle: float) -> ShownPanel:
    """A panel with its button at the right end of the line about `middle`, if it can be closed."""
    if not readout.closes:
        return ShownPanel(place, readout)
    side = min(_CLOSE * sheet.unit, place.height)
    close = Rectangle(place.right - side - 3.0 * sheet.unit, middle - side / 2, side, side)
    return ShownPanel(place, readout, close)


def _closing(sheet: Sheet, close: Rectangle) -> list[Mark]:
    """The button that closes a panel, which shows that it is one under the pointer."""
    u, theme, pointer = sheet.unit, sheet.theme, sheet.view.pointer
    under = pointer is not None and close.contains(pointer)
    paper = [Panel(*close.box, 4.0 * u, faded(theme.text, 0.12))]
    return [*(paper if under else []), cross(close, 0.75 * u, theme.muted)]


def _panel(sheet: Sheet, readout: Readout, panel: ShownPanel) -> list[Mark]:
    u, theme, size = sheet.unit, sheet.theme, sheet.font(12.0)
    place, close = panel.place, panel.close
    left, top, width, height = box = place.box
    sheet.occupancy.block(*box)
    inner, room = left + _PAD * u, width - 2 * _PAD * u
    y = top + _PAD * u + _line(sheet) / 2
    heading = _heading(sheet, readout, width)
    marks: list[Mark] = [
        Panel(*box, 6.0 * u, faded(theme.panel, 0.94), theme.line),
        *(
            Text(line, inner, y + n * _line(sheet), size, theme.text, "semibold")
            for n, line in enumerate(heading)
        ),
        *([] if close is None else _closing(sheet, close)),
    ]
    y += (len(heading) - 1) * _line(sheet)
    for name, value in _lines(sheet, readout, width):
        y += _line(sheet)
        value = shortened(value, room, size, "semibold")
        taken = text_width(value, size, "semibold") + _GAP * u * bool(value)
        if name:
            marks.append(Text(shortened(name, room - taken, size), inner, y, size, theme.muted))
        if value:
            marks.append(Text(value, inner + room, y, size, theme.text, "semibold", "right"))
    if readout.plot is not None:
        above = _height(sheet, replace(readout, plot=None), width, 0.0) - _PAD * u
        marks += draw_plot(
            readout.plot, (inner, top + above, room, height - above - _PAD * u), theme, u, sheet.view.pointer
        )
    return marks
