"""Readouts: panels of names and values, one below the other, with a button that closes each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from pinjoint.components.camera import Rectangle
from pinjoint.components.language import english, tr
from pinjoint.components.view import Readout
from pinjoint.systems.render.model.sheet import Sheet
from pinjoint.systems.render.theme import faded
from pinjoint.systems.render.typography import ALL
from pinjoint.systems.render.ui.buttons import closing
from pinjoint.systems.render.ui.layout import Column, Drawn, Paper, Part, Plate, Row, Text
from pinjoint.systems.render.ui.plots import draw_plot

# Points: to edges, in a panel, name to value, between panels.
_EDGE, _PAD, _GAP, _BETWEEN = 10.0, 9.0, 16.0, 6.0
_SIZE, _CLOSE = 12.0, 20.0  # points: of type, and across the button that closes a panel
_PLOT, _LEAST_PLOT = 150.0, 84.0  # points, height of a plot with its axes, and where there is little room


def put_readouts(paper: Paper, sheet: Sheet, room: tuple[float, float]) -> None:
    """The panels between `room`'s top and bottom; none where they are hidden.

    Where room is short, plots are lower, and the oldest panels are folded into one with a row for each.
    """
    view, u = sheet.view, sheet.unit
    readouts, place = view.readouts if view.legend else (), view.panels
    top, bottom = max(room[0], place.top) + _EDGE * u, min(room[1], place.top + place.height) - _EDGE * u
    width = place.width - 2 * _EDGE * u
    if not any(readout.is_large for readout in readouts):
        natural = (_panel(sheet, readout, float("inf"), 0.0).width(u) for readout in readouts)
        width = min(max(natural, default=0.0), width)
    since = [view.since.get(english(readout.title), 0) for readout in readouts]
    oldest = sorted(range(len(readouts)), key=since.__getitem__)
    for count in range(len(readouts) + 1):
        column = _stack(sheet, readouts, oldest[:count], width, _LEAST_PLOT)
        spare = bottom - top - column.height(u, width)
        if spare >= 0.0:
            break
    plots = sum(readouts[index].plot is not None for index in oldest[count:]) if readouts else 0
    if plots:
        plot = min(_LEAST_PLOT + max(spare, 0.0) / (plots * u), _PLOT)
        column = _stack(sheet, readouts, oldest[:count], width, plot)
    begun = len(paper.hits)
    paper.put(column, Rectangle(place.right - _EDGE * u - width, top, width, column.height(u, width)))
    for hit in paper.hits[begun:]:
        sheet.occupancy.block(*hit.box)


def _stack(
    sheet: Sheet, readouts: Sequence[Readout], folded: Sequence[int], width: float, plot: float
) -> Column:
    """The panels, some of them folded into one."""
    whole = [_panel(sheet, r, width, plot) for index, r in enumerate(readouts) if index not in folded]
    rest = [_folded(sheet, [readouts[index] for index in sorted(folded)])] if folded else []
    return Column([*whole, *rest], _BETWEEN)


def _panel(sheet: Sheet, readout: Readout, width: float, plot: float) -> Plate:
    """A panel with all rows; what is too long for one line goes on below. plot: points of the plot, if it has one."""
    theme, room = sheet.theme, width - 2 * _PAD * sheet.unit
    title = Text(tr(readout.title), _SIZE, theme.text, "semibold", lines=ALL, grow=1.0)
    parts: list[Part] = [_titled(sheet, title, readout)]
    for row in readout.rows:
        name, value = Text(row[0], _SIZE, theme.muted), Text(row[1], _SIZE, theme.text, "semibold", "right")
        there = [
            replace(text, grow=float(text is name or not name.text)) for text in (name, value) if text.text
        ]
        beside = Row(there, _GAP)
        parts += [beside] if beside.width(sheet.unit) <= room else [replace(text, lines=ALL) for text in there]
    if (plotted := readout.plot) is not None:
        parts.append(Drawn(lambda at, u: draw_plot(plotted, at, theme, u, sheet.view.pointer), high=plot))
    return _plate(sheet, Column(parts, around=(_PAD, _PAD, _PAD)), readout)


def _folded(sheet: Sheet, readouts: Sequence[Readout]) -> Plate:
    """A panel with the titles of folded ones only."""
    rows = [_titled(sheet, Text(tr(r.title), _SIZE, sheet.theme.muted, grow=1.0), r) for r in readouts]
    return _plate(sheet, Column(rows, around=(_PAD, _PAD / 2, _PAD / 2)), None)


def _plate(sheet: Sheet, inside: Part, readout: Readout | None) -> Plate:
    paper = faded(sheet.theme.panel, 0.94)
    return Plate(inside, paper, sheet.theme.line, radius=6.0, action="", item=readout or Readout(""))


def _titled(sheet: Sheet, title: Text, readout: Readout) -> Row:
    """A title with the button that closes its panel, if it can be closed."""
    close = [closing(readout.closes, sheet.theme, _CLOSE, readout, 0.75)] if readout.closes else []
    return Row((title, *close))
