"""Readouts: small panels of names and values, one below the other at the right edge."""

from __future__ import annotations

from components.view import Readout
from systems.render.marks import Mark, Panel, Text
from systems.render.plots import draw_plot
from systems.render.sheet import Sheet
from systems.render.theme import faded
from systems.render.typography import line_height, shortened, text_width

_EDGE, _PAD, _GAP = 10.0, 9.0, 16.0  # points: to the edge, inside the panel, between name and value
_WIDEST, _LEAST_ROOM = 320.0, 520.0  # points, of a panel and of the viewport beside which it stands
_PLOT = (280.0, 150.0)  # points, width and height of a plot with its axes


def draw_readouts(sheet: Sheet, room: tuple[float, float]) -> list[Mark]:
    """The panels, as many as there is room for between `room`'s top and bottom; none where they are hidden."""
    if not sheet.view.legend or sheet.viewport.width < _LEAST_ROOM * sheet.unit:
        return []
    marks: list[Mark] = []
    top, bottom = room[0] + _EDGE * sheet.unit, room[1] - _EDGE * sheet.unit
    width = max((_width(sheet, readout) for readout in sheet.view.readouts), default=0.0)
    for readout in sheet.view.readouts:
        height = (len(readout.rows) + 1) * line_height(sheet.font(12.0)) + 2 * _PAD * sheet.unit
        height += _PLOT[1] * sheet.unit if readout.plot is not None else 0.0
        if top + height > bottom:
            break
        marks += _panel(sheet, readout, top, width, height)
        top += height + 6.0 * sheet.unit
    return marks


def _width(sheet: Sheet, readout: Readout) -> float:
    """Pixels that a panel needs; all are as wide as the widest."""
    u, size = sheet.unit, sheet.font(12.0)
    names = max((text_width(name, size) for name, _ in readout.rows), default=0.0)
    values = max((text_width(value, size, "semibold") for _, value in readout.rows), default=0.0)
    title = text_width(readout.title, size, "semibold")
    plot = _PLOT[0] * u if readout.plot is not None else 0.0
    return max(min(max(names + _GAP * u + values, title), _WIDEST * u), plot) + 2 * _PAD * u


def _panel(sheet: Sheet, readout: Readout, top: float, width: float, height: float) -> list[Mark]:
    u, theme, size = sheet.unit, sheet.theme, sheet.font(12.0)
    right = sheet.viewport.left + sheet.viewport.width - _EDGE * u
    left, y = right - width, top + _PAD * u + line_height(size) / 2
    sheet.occupancy.block(left, top, width, height)
    inner = left + _PAD * u, right - _PAD * u
    heading = shortened(readout.title, width - 2 * _PAD * u, size, "semibold")
    marks: list[Mark] = [
        Panel(left, top, width, height, 6.0 * u, faded(theme.panel, 0.94), theme.line),
        Text(heading, inner[0], y, size, theme.text, "semibold"),
    ]
    for name, value in readout.rows:
        y += line_height(size)
        taken = text_width(value, size, "semibold") + _GAP * u
        marks.append(Text(shortened(name, inner[1] - inner[0] - taken, size), inner[0], y, size, theme.muted))
        marks.append(Text(value, inner[1], y, size, theme.text, "semibold", "right"))
    if readout.plot is not None:
        box = (inner[0], top + height - (_PLOT[1] + _PAD) * u, inner[1] - inner[0], _PLOT[1] * u)
        marks += draw_plot(readout.plot, box, theme, u, sheet.view.pointer)
    return marks
