"""Sliders: a panel each with its title and value, a line with a knob, and a button."""

from __future__ import annotations

from functools import partial

import numpy as np

from pinjoint.components.camera import Rectangle
from pinjoint.components.language import tr
from pinjoint.components.slider import BUTTON, PAD, Place
from pinjoint.components.view import View
from pinjoint.systems.render.marks import Mark, Panel, Stamps
from pinjoint.systems.render.theme import Theme, faded
from pinjoint.systems.render.ui.buttons import button
from pinjoint.systems.render.ui.layout import Column, Drawn, Paper, Plate, Row, Text

SLIDER = "slider"  # the last word of the actions of what hits one
_SIZES = 11.0, 10.0, 9.0  # points of its type, the largest in which the title stands whole beside the value
_KNOB = 5.0  # points, its radius


def put_sliders(paper: Paper, view: View, theme: Theme) -> None:
    """The sliders at the lower left."""
    for place in view.slider_places:
        control = place.control
        title = Text(tr(control.title), _SIZES, theme.muted, grow=1.0)
        line = Row(
            (title, Text(control.value, _SIZES, theme.text, "semibold")),
            8.0,
            high=0.62 * place.height / paper.unit,
        )
        knob = partial(_knob, place, theme, paper.is_under_pointer(place))
        said = Column((line, Drawn(knob, grow=1.0)), around=(PAD, 0.0, 0.0), grow=1.0)
        ink = theme.focus if control.pressed else theme.muted
        sizes = (10.0, 9.0, 8.0, 7.0) if len(control.button) > 1 else 14.0
        sign = Text(control.button, sizes, ink, "semibold", "centre", wide=BUTTON)
        pressed = button(sign, SLIDER, theme, pressed=control.pressed, inset=3.0)
        paper.put(Plate(Row((said, pressed)), faded(theme.panel, 0.94), theme.line, radius=6.0), place)


def _knob(place: Place, theme: Theme, hovered: bool, at: Rectangle, u: float) -> list[Mark]:
    """The line and the knob on it, if it is somewhere."""
    left, right, middle = place.track
    thick = max(round(2 * u), 1)
    track = Panel(round(left), round(middle - u), round(right - left), thick, 0.0, theme.muted)
    if place.control.share is None:
        return [track]
    knob = np.array([[left + place.control.share * (right - left), middle]])
    return [track, Stamps("disc", knob, (_KNOB + float(hovered)) * u, u, theme.focus, theme.focus)]
