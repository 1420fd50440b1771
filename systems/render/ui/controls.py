"""Controls: what can be pressed over a model wherever that is: the status bar, sliders, and the card of an empty model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from pinjoint.components.camera import Rectangle
from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.components.slider import BUTTON, CHOICES, GAP, PAD, Place
from pinjoint.components.view import Hit, View
from pinjoint.systems.render.marks import Mark, Panel, Stamps, Strokes
from pinjoint.systems.render.theme import Theme, faded
from pinjoint.systems.render.ui.buttons import button, tool_icon, tool_row
from pinjoint.systems.render.ui.layout import Column, Drawn, Gap, Paper, Plate, Row, Text
from pinjoint.systems.render.ui.overlays import BAR

SLIDER = "slider"  # the last word of the actions of what hits one
_SIZES = 11.0, 10.0, 9.0  # points of its type, the largest in which the title stands whole beside the value
# The tools, if the toolbar has them.
_FIRST = ("place", "rod", "rigid", "support", "force", "new grid", "load", "toggle help")


def put_controls(paper: Paper, model: Model, view: View, theme: Theme) -> None:
    """The sliders at the lower left and the card; a press on the status bar, of which one of several models has none, is
    no press on the model."""
    v, high = view.canvas, BAR * view.pixel_ratio
    if view.page is None:
        if not view.caption:
            paper.hits.append(Hit(v.left, v.bottom - high, v.width, high, ""))
        for place in view.slider_places:
            paper.put(_slider(place, theme, paper), place)
        _put_choices(paper, view, theme)
    _put_card(paper, model, view, theme)


def _put_choices(paper: Paper, view: View, theme: Theme) -> None:
    """The choices above the sliders, as many as have room, of the others those beside the one that is pressed."""
    place, tools = view.choices_place, list(enumerate(view.sliders.choices))
    if not tools:
        return
    parts = {}
    for number, tool in tools:
        ink = theme.focus if tool.pressed else theme.text
        text = Text(tool.title, 12.0, ink, "semibold" if tool.pressed else "regular")
        inside = Row((text,), around=(9.0, 0.0, 0.0), high=CHOICES - GAP - 4.0)
        parts[number] = button(inside, tool.action, theme, pressed=tool.pressed, item=number, again=True)
    shown = sorted(parts, key=lambda number: (not tools[number][1].pressed, number < len(parts) - 2, number))
    while len(shown) > 1 and _row_of(parts, shown).width(paper.unit) > place.width:
        shown.pop()
    row = _row_of(parts, sorted(shown))
    plate = Plate(row, faded(theme.panel, 0.94), theme.line, radius=6.0)
    paper.put(plate, replace(place, width=row.width(paper.unit)))


def _row_of(parts: Mapping[int, Plate], shown: Sequence[int]) -> Row:
    return Row([parts[number] for number in shown], 2.0, (2.0, 0.0, 0.0))


def _slider(place: Place, theme: Theme, paper: Paper) -> Plate:
    """A panel with a title and a value, a line with a knob, and a button, which are pressed as one."""
    control = place.control
    title = Text(tr(control.title), _SIZES, theme.muted, grow=1.0)
    value = Text(control.value, _SIZES, theme.text, "semibold")
    line = Row((title, value), 8.0, high=0.62 * place.height / paper.unit)
    knob = partial(_knob, place, theme, paper.is_under_pointer(place))
    said = Column((line, Drawn(knob, grow=1.0)), around=(PAD, 0.0, 0.0), grow=1.0)
    ink = theme.focus if control.pressed else theme.muted
    sizes = (10.0, 9.0, 8.0, 7.0) if len(control.button) > 1 else 14.0
    sign = Text(control.button, sizes, ink, "semibold", "centre", wide=BUTTON)
    inside = Row((said, button(sign, None, theme, pressed=control.pressed, inset=3.0)))
    ground, wheel = faded(theme.panel, 0.94), ("slider up", "slider down")
    return Plate(inside, ground, theme.line, radius=6.0, action=SLIDER, item=place, wheel=wheel, again=True)


def _knob(place: Place, theme: Theme, hovered: bool, at: Rectangle, u: float) -> list[Mark]:
    """The line and the knob on it, if it is somewhere."""
    left, right, middle = place.track
    thick = max(round(2 * u), 1)
    track = Panel(round(left), round(middle - u), round(right - left), thick, 0.0, theme.muted)
    if place.control.share is None:
        return [track]
    knob = np.array([[left + place.control.share * (right - left), middle]])
    return [track, Stamps("disc", knob, (5.0 + float(hovered)) * u, u, theme.focus, theme.focus)]


def _put_card(paper: Paper, model: Model, view: View, theme: Theme) -> None:
    """The card in the middle of the canvas, where a model is empty, nothing is drawn, and its picture has all the room."""
    drawing = bool(view.tool) or view.preview is not None
    if model.particles.count or drawing or view.page is not None or view.aside is not None:
        return
    v, u = view.canvas, view.pixel_ratio
    known = {tool.action: tool for group in view.toolbar.groups for tool in group}
    there = view.strip.left, view.strip.top  # as by the toolbar
    rows = []
    for tool in (known[action] for action in _FIRST if action in known):
        sign = Row((tool_icon(tool, theme, 20.0), Gap(14.0)))
        row = Row(
            (tool_row(tool, theme, sign, (13.0, 12.0, 11.0, 10.0), 26.0),), around=(12.0, 0.0, 0.0), high=27.0
        )
        rows.append(button(row, tool.action, theme, enabled=tool.enabled, item=tool, at=there))
    emblem = Drawn(lambda at, u: _emblem(at, u, theme), high=66.0)
    title = Text(tr("An empty model"), 20.0, theme.text, "semibold", "centre")
    card = Column(
        (emblem, Column((title,), around=(0.0, 14.0, 10.0)), *rows), around=(12.0, 2.0, 14.0), wide=280.0
    )
    width = min(card.width(u), v.width - 28.0 * u)
    height = card.height(u, width)
    top = v.top + (v.height - BAR * u - height) / 2
    place = Rectangle(v.left + (v.width - width) / 2, top, width, height)
    paper.put(Plate(card, theme.background, theme.line, radius=12.0), place)


def _emblem(at: Rectangle, u: float, theme: Theme) -> list[Mark]:
    """Two small triangles of rods."""
    nodes = np.array([[-36.0, 18.0], [0.0, 18.0], [36.0, 18.0], [-18.0, -18.0], [18.0, -18.0]]) * u
    nodes += [at.middle[0], at.middle[1] + 14.0 * u]
    rods = np.array([[0, 1], [1, 2], [0, 3], [3, 1], [1, 4], [4, 2], [3, 4]])
    return [
        Strokes(nodes[rods[:, 0]], nodes[rods[:, 1]], 2.0 * u, theme.ghost),
        Stamps("ring", nodes, 5.0 * u, u, theme.ghost, theme.background),
    ]
