"""Sliders: a panel each with its title and value, a line with a knob, and a button."""

from __future__ import annotations

import numpy as np

from pinjoint.components.language import tr
from pinjoint.components.slider import PAD, Place, under
from pinjoint.systems.render.marks import Mark, Panel, Stamps, Text, boxes
from pinjoint.systems.render.sheet import Sheet
from pinjoint.systems.render.theme import faded
from pinjoint.systems.render.typography import shortened, text_width

_SIZES = (11.0, 10.0, 9.0)  # points of its type, the largest in which the title stands whole beside the value
_KNOB = 5.0  # points, its radius
_GAP = 8.0  # points between title and value


def draw_sliders(sheet: Sheet) -> list[Mark]:
    """The sliders at the lower left, kept free of labels."""
    places, pointer = sheet.view.slider_places, sheet.view.pointer
    hovered = under(places, pointer) if pointer is not None else None
    marks: list[Mark] = []
    for place in places:
        sheet.occupancy.block(*place.box)
        marks += _slider(sheet, place, hovered=place is hovered)
    return marks


def _slider(sheet: Sheet, place: Place, *, hovered: bool) -> list[Mark]:
    u, theme, control, title = sheet.unit, sheet.theme, place.control, tr(place.control.title)
    left, right, middle = place.track
    line = place.top + 0.31 * place.height
    for size in map(sheet.font, _SIZES):
        value = shortened(control.value, right - left, size, "semibold")
        room = right - left - text_width(value, size, "semibold") - _GAP * u
        if text_width(title, size) <= room:
            break
    marks: list[Mark] = [
        Panel(*place.box, 6.0 * u, faded(theme.panel, 0.94), theme.line),
        Text(shortened(title, room, size), left, line, size, theme.muted),
        Text(value, right, line, size, theme.text, "semibold", "right"),
        boxes(theme.muted, (round(left), round(middle - u), round(right - left), max(round(2 * u), 1))),
        *_button(sheet, place),
    ]
    if control.share is not None:
        knob = np.array([[left + control.share * (right - left), middle]])
        radius = (_KNOB + (1.0 if hovered else 0.0)) * u
        marks.append(Stamps("disc", knob, radius, u, theme.focus, theme.focus))
    return marks


def _button(sheet: Sheet, place: Place) -> list[Mark]:
    """What the button says, on a plate while it is pressed or under the pointer."""
    u, theme, size, button = sheet.unit, sheet.theme, sheet.font(10.0), place.button
    pointer, control = sheet.view.pointer, place.control
    text = Text(
        control.button,
        button.left + button.width / 2 - 0.1 * PAD * u,
        button.top + button.height / 2,
        size if len(control.button) > 1 else sheet.font(14.0),
        theme.focus if control.pressed else theme.muted,
        "semibold",
        "centre",
    )
    if not control.pressed and not (pointer is not None and button.contains(pointer)):
        return [text]
    colour = faded(theme.focus, 0.16) if control.pressed else faded(theme.text, 0.09)
    inset = 3.0 * u
    width, height = button.width - 2 * inset, button.height - 2 * inset
    return [Panel(button.left + inset, button.top + inset, width, height, 4.0 * u, colour), text]
