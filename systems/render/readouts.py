"""Readouts: panels of names and values, one below the other where the view has them stand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from components.view import Readout
from systems.render.marks import Mark, Panel, Text
from systems.render.plots import Box, draw_plot
from systems.render.sheet import Sheet
from systems.render.theme import faded
from systems.render.typography import line_height, shortened, text_width

_EDGE, _PAD, _GAP = 10.0, 9.0, 16.0  # points: to the edges, inside a panel, between name and value
_BETWEEN = 6.0  # points between panels
_PLOT, _LEAST_PLOT = 150.0, 96.0  # points, height of a plot with its axes, and where there is little room


def draw_readouts(sheet: Sheet, room: tuple[float, float]) -> list[Mark]:
    """The panels between `room`'s top and bottom; none where they are hidden.

    Where there is not room for all, plots are lower, and those that are there longest keep but their titles.
    """
    readouts = sheet.view.readouts if sheet.view.legend else ()
    place, u = sheet.view.panels, sheet.unit
    top, bottom = max(room[0], place.top) + _EDGE * u, min(room[1], place.top + place.height) - _EDGE * u
    width = place.width - 2 * _EDGE * u
    if not any(readout.is_large for readout in readouts):
        width = min(max((_width(sheet, readout) for readout in readouts), default=0.0), width)
    left = place.left + place.width - _EDGE * u - width
    marks: list[Mark] = []
    for readout, height in zip(readouts, _heights(sheet, readouts, bottom - top), strict=True):
        if height:
            marks += _panel(sheet, readout, (left, top, width, height))
            top += height + _BETWEEN * u
    return marks


def _heights(sheet: Sheet, readouts: Sequence[Readout], room: float) -> list[float]:
    """Pixels that each panel takes of so many; 0: none."""
    u = sheet.unit
    title, gap = _line(sheet) + _PAD * u, _BETWEEN * u
    since = [sheet.view.since.get(readout.title, 0) for readout in readouts]
    newest = sorted(range(len(readouts)), key=since.__getitem__, reverse=True)
    shown = newest[: max(int((room + gap) / (title + gap)), 0)]
    heights = [title if index in shown else 0.0 for index in range(len(readouts))]
    left = room - len(shown) * (title + gap) + gap
    for plot in (_LEAST_PLOT, _PLOT):  # the lowest that all of them may be, then as high as there is room for
        for index in shown:
            wanted = _height(sheet, readouts[index], plot)
            if heights[index] < wanted <= heights[index] + left:
                left -= wanted - heights[index]
                heights[index] = wanted
    return heights


def _line(sheet: Sheet) -> float:
    return line_height(sheet.font(12.0))


def _height(sheet: Sheet, readout: Readout, plot: float) -> float:
    """Pixels of a panel with all its rows, and a plot so many points high if it has one."""
    height = (len(readout.rows) + 1) * _line(sheet) + 2 * _PAD * sheet.unit
    return height + (plot * sheet.unit if readout.plot is not None else 0.0)


def _width(sheet: Sheet, readout: Readout) -> float:
    """Pixels that a panel in a corner needs."""
    u, size = sheet.unit, sheet.font(12.0)
    names = max((text_width(name, size) for name, _ in readout.rows), default=0.0)
    values = max((text_width(value, size, "semibold") for _, value in readout.rows), default=0.0)
    return max(names + _GAP * u + values, text_width(readout.title, size, "semibold")) + 2 * _PAD * u


def _panel(sheet: Sheet, readout: Readout, box: Box) -> list[Mark]:
    """A panel, or only its title where there is no room for more."""
    u, theme, size = sheet.unit, sheet.theme, sheet.font(12.0)
    left, top, width, height = box
    sheet.occupancy.block(*box)
    inner, room = left + _PAD * u, width - 2 * _PAD * u
    folded = height < _height(sheet, readout, _LEAST_PLOT)
    y = top + (height if folded else _line(sheet) + 2 * _PAD * u) / 2
    heading = shortened(readout.title, room, size, "semibold")
    marks: list[Mark] = [
        Panel(*box, 6.0 * u, faded(theme.panel, 0.94), theme.line),
        Text(heading, inner, y, size, theme.muted if folded else theme.text, "semibold"),
    ]
    if folded:
        return marks
    for name, value in readout.rows:
        y += _line(sheet)
        value = shortened(value, room, size, "semibold")
        taken = text_width(value, size, "semibold") + _GAP * u
        marks.append(Text(shortened(name, room - taken, size), inner, y, size, theme.muted))
        marks.append(Text(value, inner + room, y, size, theme.text, "semibold", "right"))
    if readout.plot is not None:
        above = _height(sheet, replace(readout, plot=None), 0.0) - _PAD * u
        marks += draw_plot(
            readout.plot, (inner, top + above, room, height - above - _PAD * u), theme, u, sheet.view.pointer
        )
    return marks
