"""A box of a form: its title, its frame with what is typed, its unit and its caret, and why it is refused."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from pinjoint.components.camera import Rectangle
from pinjoint.components.form import NAME, NUMBER, WORD, Box
from pinjoint.components.language import tr, tr_in
from pinjoint.components.units import number_and_unit
from pinjoint.systems.render.marks import Fills, Mark, Panel
from pinjoint.systems.render.marks import Text as Written
from pinjoint.systems.render.theme import Theme, faded
from pinjoint.systems.render.typography import ALL, fitting, font_size, text_width
from pinjoint.systems.render.ui.layout import Column, Drawn, Gap, Plate, Row, Text

TITLE = 11.5  # points, size of type above and below a box
_TEXT, _SMALL, _HIGH = 13.0, 11.0, 26.0  # points: type in a box, of its unit and note; its height
_PAD, _GAP = 8.0, 4.0  # points between a box's edge and its text, and between a number and its unit
_STEP = 40.0  # points that widths of boxes are multiples of, so that one grows seldom while somebody types


def titled_box(box: Box, width: float, theme: Theme, u: float, *, selected: bool) -> Column:
    """A box in so many pixels, with its title and what has no room in it above, and why it is refused below."""
    unit = "" if box.text in box.words else box.unit
    if _has_room_for_unit(box, width, u):
        unit = "" if box.changed or _has_room_for_note(box, width, u) else box.note
        if text_width(f"{box.said_title} {unit}", font_size(TITLE, u)) + 8.0 * u > width:
            unit = _short(unit)
    title = Text(box.said_title, TITLE, theme.muted, grow=1.0)
    above = Row([title, *([Text(unit, TITLE, theme.muted)] if unit else [])], 8.0, high=18.0)
    problem = [Text(box.problem, TITLE, theme.problem, lines=ALL, apart=14.0)] if box.problem else []
    wide = _needed(box, width, u)
    frame = Column((bare_box(box, wide, theme, u, selected=selected),), wide=wide / u)
    return Column((above, Row((frame, Gap(grow=1.0))), *problem, Gap(high=10.0)))


def bare_box(box: Box, width: float, theme: Theme, u: float, *, selected: bool, grow: float = 0.0) -> Plate:
    """A box alone, with a ring around it when it is typed into."""
    contents = Drawn(partial(_contents, box, theme, selected, _has_room_for_unit(box, width, u)), high=_HIGH)
    line, hovered = (None, None) if selected else (theme.line, theme.muted)
    frame = Plate(contents, theme.background, line, theme.background, hovered, 4.0)
    ring = theme.focus if selected else None
    return Plate(frame, ring, radius=6.0, inset=-2.0, item=box, grow=grow)


def is_short(box: Box, width: float, u: float) -> bool:
    """True if the title of a box stands whole above it in so many pixels, with what is noted of its value."""
    unit = "" if box.text else box.unit
    beside = max(_short(box.note), unit, key=len)
    said = f"{box.said_title} {beside}".rstrip()
    return text_width(said, font_size(TITLE, u)) + 8.0 * u * bool(beside) <= width


def caret_at(place: Rectangle, box: Box, x: float, u: float) -> int:
    """The place of the caret nearest to the pixel column `x` in a box's text."""
    size, left = font_size(_TEXT, u), place.left + _PAD * u
    start, visible = window_of(_written(box), box.caret, place.width - 2 * _PAD * u, size)
    ends = [left + text_width(visible[:end], size) for end in range(len(visible) + 1)]
    return start + min(range(len(ends)), key=lambda end: abs(ends[end] - x))


def window_of(text: str, caret: int, room: float, size: int) -> tuple[int, str]:
    """The number of characters hidden before the part of a text around the caret that fits, and that part."""
    start = caret - fitting(reversed(text[:caret]), room, size)
    return start, text[start : start + fitting(text[start:], room, size)]


def _contents(
    box: Box, theme: Theme, selected: bool, with_unit: bool, place: Rectangle, u: float
) -> list[Mark]:
    """Text with its unit, caret or mark, and the note at the right while nothing was typed."""
    size, small, middle = font_size(_TEXT, u), font_size(_SMALL, u), place.middle[1]
    left, room, text = place.left + _PAD * u, _room(box, place.width, u), _written(box)
    start, visible = window_of(text, box.caret if selected else 0, room, size)
    width, marks = text_width(visible, size), list[Mark]()
    if selected:
        before, all_of_it = text_width(text[start : box.caret], size), bool(box.marked and text)
        x, w = (left, width) if all_of_it else (left + before, max(1.5 * u, 1.0))
        colour = faded(theme.focus, 0.3) if all_of_it else theme.text
        marks.append(Panel(round(x), place.top + 5.0 * u, max(round(w), 1), place.height - 10.0 * u, u, colour))
    marks.append(Written(visible, left, middle, size, theme.text))
    if with_unit:
        marks.append(Written(box.unit, left + width + _GAP * u, middle, small, theme.muted))
    if box.note and not box.changed and _has_room_for_note(box, place.width, u):
        x, anchor = (left + room, "right") if text else (left + 2.0 * u, "left")
        marks.append(Written(box.note, x, middle, small, theme.muted, anchor=anchor))
    if box.accepts in (WORD, NAME):  # a click turns to the next word
        up, at = np.array([[-3.5, -2.0], [3.5, -2.0], [0.0, -6.0]]) * u, [place.right - 14.0 * u, middle]
        marks.append(Fills(np.array([at + up, at - up]), theme.muted))
    return marks


def _room(box: Box, width: float, u: float) -> float:
    """Pixels for what stands in a box."""
    return width - (2 * _PAD + 12.0 * (box.accepts in (WORD, NAME))) * u


def _needed(box: Box, width: float, u: float) -> float:
    """Pixels of at most so many that a box is wide: for its text, unit and note, and a little more to type."""
    unit = box.unit if _has_room_for_unit(box, width, u) else ""
    note = box.note if not box.changed else ""
    inside = width - _room(box, width, u) + _taken(box, u, unit, note) + 8.0 * u
    return min(max(math.ceil(inside / (_STEP * u)), 2) * _STEP * u, width)


def _has_room_for_unit(box: Box, width: float, u: float) -> bool:
    """True if the unit stands behind the number, not above the box."""
    if not box.text or not box.unit or box.text in box.words or number_and_unit(box.text)[1]:
        return False
    return _taken(box, u, box.unit) <= _room(box, width, u)


def _has_room_for_note(box: Box, width: float, u: float) -> bool:
    """True if the note stands in the box, behind the number and its unit."""
    unit = box.unit if _has_room_for_unit(box, width, u) else ""
    return _taken(box, u, unit, box.note) + 6.0 * u <= _room(box, width, u)


def _taken(box: Box, u: float, *behind: str) -> float:
    """Pixels that the text of a box takes with what stands behind it."""
    small = sum(text_width(text, font_size(_SMALL, u)) + (_GAP + 2.0) * u for text in behind if text)
    return text_width(_written(box), font_size(_TEXT, u)) + small


def _short(note: str) -> str:
    """What is noted of the value of a box, where there is little room."""
    return note.replace(tr("automatic"), tr_in("note of a box", "auto"))


def _written(box: Box) -> str:
    """The text of a box as it is shown: numbers with a real minus sign."""
    text = box.said_text
    return text.replace("-", "−") if box.accepts == NUMBER else text
