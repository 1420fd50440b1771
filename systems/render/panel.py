"""Panel: boxes of properties, save and load, results beside them, and tiles to choose from, as marks."""

from __future__ import annotations

import numpy as np

from pinjoint.components.box import NAME, NUMBER, WORD, Box, number_and_unit
from pinjoint.components.camera import Rectangle, Viewport
from pinjoint.components.form import Form, Reading, Tile
from pinjoint.components.language import begun, tr
from pinjoint.components.view import BETWEEN, View
from pinjoint.systems.render.form_layout import (
    BOX_TITLE,
    CAPTION,
    HINT,
    MESSAGE,
    MESSAGE_LINE,
    PILL,
    PROBLEM,
    FormLayout,
    Place,
    explanation_type,
    lay_out,
    message_lines,
    problem_lines,
    short_note,
)
from pinjoint.systems.render.help import put_help
from pinjoint.systems.render.layout import Paper
from pinjoint.systems.render.marks import Fills, Mark, Panel, Picture, Stamps, Text, boxes, cross
from pinjoint.systems.render.theme import Colour, Theme, faded
from pinjoint.systems.render.thumbnails import thumbnail
from pinjoint.systems.render.typography import at_most, fitting, font_size, shortened, text_width, wrapped

_TEXT = 13.0  # points, size of type in a box
_HEADING = (19.0, 16.0, 14.0)  # points, the largest that fits
_SMALL, _GAP = 11.0, 4.0  # points: size of type of units and notes, between a number and its unit
_PAD = 8.0  # points between a box's edge and its text


def compose_form(form: Form, view: View, theme: Theme) -> Picture:
    """A form as marks in the pixels of the view's viewport. Reads the form, changes nothing."""
    layout = lay_out(form, view.aside or view.camera.viewport, view.pixel_ratio)
    writer = _Writer(form, view, theme, layout)
    marks = [
        *writer.edges(),
        *writer.header(),
        *writer.rows(),
        *writer.footer(),
        *writer.scroll_bar(),
    ]
    paper = Paper(view.pixel_ratio, view.pointer, marks)
    put_help(paper, view, layout.viewport, theme)
    return Picture(layout.viewport, theme.panel, marks, hits=paper.hits)


class _Writer:
    """Makes the marks of one form."""

    def __init__(self, form: Form, view: View, theme: Theme, layout: FormLayout) -> None:
        self.form, self.view, self.theme, self.layout, self.unit = form, view, theme, layout, layout.unit
        self.selected, self.chosen = form.selected, form.chosen
        self.hovered = layout.at(view.pointer) if view.pointer is not None else None

    def font(self, points: float) -> int:
        """A font size in whole pixels."""
        return font_size(points, self.unit)

    # --- what stands in fixed places -------------------------------------------------------------

    def edges(self) -> list[Mark]:
        """Hairlines towards a model beside it."""
        v, window, thin = self.layout.viewport, self.view.camera.viewport, max(round(self.unit), 1)
        sides = [v.left] * (v.left > window.left) + [v.left + v.width - thin] * (v.right < window.right)
        return [boxes(self.theme.line, *((x, v.top, thin, v.height) for x in sides))] if sides else []

    def header(self) -> list[Mark]:
        """The heading, and the message below the boxes that stay."""
        layout, heading = self.layout, self.form.heading
        small, u, said = self.font(MESSAGE), self.unit, begun(tr(heading.text))
        sizes = [self.font(points) for points in _HEADING]
        fitting_sizes = (s for s in sizes if text_width(said, s, "semibold") <= layout.heading_width)
        size = next(fitting_sizes, sizes[-1])
        text = shortened(said, layout.heading_width, size, "semibold")
        marks: list[Mark] = [Text(text, layout.left, layout.header, size, self.theme.text, "semibold")]
        for number, line in enumerate(message_lines(self.form, layout.right - layout.left, u)):
            y = layout.message + number * MESSAGE_LINE * u
            marks.append(Text(line, layout.left, y, small, self.theme.problem))
        return [*marks, *self._buttons()]

    def _buttons(self) -> list[Mark]:
        """The one that leaves the form, and the one that does what Return does."""
        layout, theme, u = self.layout, self.theme, self.unit
        marks: list[Mark] = []
        for place, title in ((layout.close, ""), (layout.accept, tr(self.form.accept))):
            if place is None or not (title or place is layout.close):
                continue
            under = self.view.pointer is not None and place.contains(self.view.pointer)
            if under or title:
                marks.append(_grown(place, 0.0, 4.0 * u, faded(theme.text, 0.22 if under else 0.12)))
            if title:
                marks.append(Text(title, *place.middle, self.font(_TEXT), theme.text, "semibold", "centre"))
            else:
                marks.append(cross(place, u, theme.muted))
        return marks

    def footer(self) -> list[Mark]:
        """The explanation of the selected box or tile, and the next possible step."""
        layout, size, v = self.layout, self.font(12.0), self.layout.viewport
        width, bottom = layout.right - layout.left, v.bottom
        hint = _steps(self.view.status.hint, width, size)
        marks: list[Mark] = [Text(hint, layout.left, bottom - 13.0 * self.unit, size, self.theme.muted)]
        if layout.explained:
            told, colour = self._explanation()
            points, apart = explanation_type(v, self.unit)
            size = self.font(points)
            for number, line in enumerate(at_most(wrapped(told, width, size), layout.explained, width, size)):
                y = bottom - (HINT - 8.0 + apart * (layout.explained - number)) * self.unit
                marks.append(Text(line, layout.left, y, size, colour))
        return marks

    def _explanation(self) -> tuple[str, Colour]:
        """What is said about the item under the pointer, else about the chosen or selected one; and its colour."""
        name = next((box for box in self.form.boxes if box.target == "name"), None)
        for item in (self.hovered, self.chosen, self.selected, name):
            if isinstance(item, Box) and item.problem:
                return f"{item.said_title}: {item.problem}", self.theme.problem
            if item is not None and item.explanation:
                return tr(item.explanation), self.theme.text
        return "", self.theme.text

    def scroll_bar(self) -> list[Mark]:
        """The scroll bar, if some rows are not visible."""
        layout = self.layout
        if layout.shown >= layout.count:
            return []
        v, width = layout.viewport, max(round(3.0 * self.unit), 2)
        track = layout.bottom - layout.top
        length = max(track * layout.shown / layout.count, 16.0 * self.unit)
        last = layout.count - layout.shown
        top = layout.top + (track - length) * min(layout.first / last, 1.0)
        return [boxes(self.theme.muted, (v.right - 2 * width, round(top), width, round(length)))]

    # --- rows ------------------------------------------------------------------------------------

    def rows(self) -> list[Mark]:
        """Sections, boxes, readings and tiles."""
        marks: list[Mark] = []
        for place in self.layout.places:
            if isinstance(place.item, str):
                y = place.top + 0.5 * place.height
                marks.append(Text(tr(place.item), place.left, y, self.font(13.0), self.theme.text, "semibold"))
            elif isinstance(place.item, Box):
                marks += self._box(place, place.item)
            elif isinstance(place.item, Reading):
                marks += self._reading(place, place.item)
            else:
                marks += self._tile(place, place.item)
        return marks

    def _reading(self, place: Place, reading: Reading) -> list[Mark]:
        """What it is at the left, its value at the right."""
        theme, size, y = self.theme, self.font(12.0), place.middle[1]
        value = shortened(reading.text, 0.65 * place.width, size, "semibold")
        room = place.width - text_width(value, size, "semibold") - 8.0 * self.unit
        return [
            Text(shortened(tr(reading.title), room, size), place.left, y, size, theme.muted),
            Text(value, place.right, y, size, theme.text, "semibold", "right"),
        ]

    def _box(self, place: Place, box: Box) -> list[Mark]:
        u, theme, size = self.unit, self.theme, self.font(BOX_TITLE)
        above, below = place.top - 9.0 * u, place.bottom + 9.0 * u
        marks = [*self._frame(place, box is self.selected, box is self.hovered), *self._contents(place, box)]
        if box.target != "name":
            unit = box.unit
            if self._has_room_for_unit(place, box):
                unit = "" if box.changed or self._has_room_for_note(place, box) else box.note
                if text_width(f"{box.said_title} {unit}", size) + 8.0 * u > place.width:
                    unit = short_note(unit)
            taken = text_width(unit, size) + 8.0 * u if unit else 0.0
            title = shortened(box.said_title, place.width - taken, size)
            marks.append(Text(title, place.left, above, size, theme.muted))
            if unit:
                marks.append(Text(unit, place.right, above, size, theme.muted, anchor="right"))
        for number, line in enumerate(problem_lines(box, place.width, u)):
            marks.append(Text(line, place.left, below + number * PROBLEM * u, size, theme.problem))
        return marks

    def _frame(self, place: Place, selected: bool, hovered: bool) -> list[Mark]:
        """The box, with a ring around it when it is typed into."""
        theme, u, radius = self.theme, self.unit, 4.0 * self.unit
        if selected:
            ring = _grown(place, 2.0 * u, radius + 2.0 * u, theme.focus)
            return [ring, _grown(place, 0.0, radius, theme.background)]
        line = theme.muted if hovered else theme.line
        return [_grown(place, 0.0, radius, theme.background)._replace(outline=line)]

    def _contents(self, place: Place, box: Box) -> list[Mark]:
        """Text with its unit, caret or mark, and the note at the right while nothing was typed."""
        u, theme, size = self.unit, self.theme, self.font(_TEXT)
        left, middle = place.left + _PAD * u, place.middle[1]
        room, small = self._room(place, box), self.font(_SMALL)
        marks: list[Mark] = []
        text = written(box)
        start, visible = _window(text, box.caret if box is self.selected else 0, room, size)
        width = text_width(visible, size)
        if box is self.selected:
            before = text_width(text[start : box.caret], size)
            x, w = (left, width) if box.marked and text else (left + before, max(1.5 * u, 1.0))
            mark = Rectangle(round(x), place.top + 5.0 * u, max(round(w), 1), place.height - 10.0 * u)
            colour = faded(theme.focus, 0.3) if box.marked and text else theme.text
            marks.append(_grown(mark, 0.0, 1.0 * u, colour))
        marks.append(Text(visible, left, middle, size, theme.text))
        if self._has_room_for_unit(place, box):
            marks.append(Text(box.unit, left + width + _GAP * u, middle, small, theme.muted))
        if box.note and not box.changed and self._has_room_for_note(place, box):
            x, anchor = (left + room, "right") if text else (left + 2.0 * u, "left")
            marks.append(Text(box.note, x, middle, small, theme.muted, anchor=anchor))
        if box.accepts in (WORD, NAME):
            marks.append(_turning(place.right - 14.0 * u, middle, u, theme.muted))
        return marks

    def _room(self, place: Place, box: Box) -> float:
        """Pixels for what stands in a box."""
        return place.width - 2 * _PAD * self.unit - (12.0 * self.unit if box.accepts in (WORD, NAME) else 0.0)

    def _has_room_for_unit(self, place: Place, box: Box) -> bool:
        """True if the unit stands behind the number, not above the box."""
        if not box.text or not box.unit or box.text in (box.words or ()) or number_and_unit(box.text)[1]:
            return False
        return self._taken(box, box.unit) <= self._room(place, box)

    def _has_room_for_note(self, place: Place, box: Box) -> bool:
        """True if the note stands in the box, behind the number and its unit."""
        unit = box.unit if self._has_room_for_unit(place, box) else ""
        return self._taken(box, unit, box.note) + 6.0 * self.unit <= self._room(place, box)

    def _taken(self, box: Box, *behind: str) -> float:
        """Pixels that the text of a box takes with what stands behind it."""
        small = sum(text_width(text, self.font(_SMALL)) + (_GAP + 2.0) * self.unit for text in behind if text)
        return text_width(written(box), self.font(_TEXT)) + small

    def _pill(self, place: Place, tile: Tile) -> list[Mark]:
        """A tile without a picture: its symbol, and beside it its title and its caption."""
        u, theme = self.unit, self.theme
        middle, left = place.middle[1], place.left + 40.0 * u
        at = np.array([[place.left + 21.0 * u, middle]])
        return [
            *self._card(place, tile, 8.0 * u),
            Stamps("disc", at, 12.0 * u, u, faded(theme.focus, 0.14), theme.background),
            Text(tile.symbol, at[0, 0], middle, self.font(15.0), theme.focus, anchor="centre"),
            *self._legend(tile, left, middle - 20.5 * u, place.right - left - 6.0 * u),
        ]

    def _card(self, place: Rectangle, tile: Tile, radius: float) -> list[Mark]:
        """The paper of a tile, with a ring around it when Return or a click opens it."""
        theme, u = self.theme, self.unit
        marks: list[Mark] = []
        if tile is self.chosen:
            marks.append(_grown(place, 2.5 * u, radius + 2.0 * u, theme.focus))
        line = theme.focus if tile is self.hovered else theme.line
        return [*marks, _grown(place, 0.0, radius, theme.background)._replace(outline=line)]

    def _tile(self, place: Place, tile: Tile) -> list[Mark]:
        """A picture of the model, its title and its caption."""
        if place.height <= PILL * self.unit:
            return self._pill(place, tile)
        u, theme = self.unit, self.theme
        height = place.height - CAPTION * u
        card = Rectangle(place.left, place.top, place.width, height)
        marks = self._card(card, tile, 6.0 * u)
        if tile.picture is not None:
            viewport = Viewport(round(card.left), round(card.top), round(card.width), round(card.height))
            marks += thumbnail(tile.picture, viewport, u, theme)
        elif tile.symbol:
            marks.append(Text(tile.symbol, *card.middle, self.font(32.0), theme.muted, anchor="centre"))
        return [*marks, *self._legend(tile, place.left, card.bottom, place.width)]

    def _legend(self, tile: Tile, left: float, top: float, width: float) -> list[Mark]:
        """The title in at most two lines, and the caption if one is enough."""
        u, theme, size, small = self.unit, self.theme, self.font(12.5), self.font(11.0)
        lines = at_most(wrapped(tile.title, width, size, "semibold"), 2, width, size, "semibold")
        marks: list[Mark] = [
            Text(line, left, top + (13.0 + 15.5 * number) * u, size, theme.text, "semibold")
            for number, line in enumerate(lines)
        ]
        if len(lines) == 1:
            caption = shortened(tile.caption, width, small)
            marks.append(Text(caption, left, top + 28.0 * u, small, theme.muted))
        return marks


def _steps(hint: str, width: float, size: int) -> str:
    """The next possible steps, as many as there is room for; the last says how to leave."""
    steps = hint.split(BETWEEN)
    while len(steps) > 2 and text_width(BETWEEN.join(steps), size) > width:
        del steps[-2]
    return shortened(BETWEEN.join(steps), width, size)


def _grown(place: Rectangle, by: float, radius: float, colour: Colour) -> Panel:
    return Panel(place.left - by, place.top - by, place.width + 2 * by, place.height + 2 * by, radius, colour)


def _turning(x: float, y: float, u: float, colour: Colour) -> Fills:
    """Two small triangles, up and down: a click turns to the next word."""
    half, gap, height = 3.5 * u, 2.0 * u, 4.0 * u
    up = [[x - half, y - gap], [x + half, y - gap], [x, y - gap - height]]
    down = [[x - half, y + gap], [x + half, y + gap], [x, y + gap + height]]
    return Fills(np.array([up, down]), colour)


def _window(text: str, caret: int, room: float, size: int) -> tuple[int, str]:
    """The part of a text around the caret that fits, and the number of characters hidden before it."""
    start = caret - fitting(reversed(text[:caret]), room, size)
    return start, text[start : start + fitting(text[start:], room, size)]


def written(box: Box) -> str:
    """The text of a box as it is shown: numbers with a real minus sign."""
    text = box.said_text
    return text.replace("-", "−") if box.accepts == NUMBER else text


def caret_at(place: Place, box: Box, x: float, unit: float) -> int:
    """The place of the caret nearest to the pixel column `x` in a box's text."""
    size = font_size(_TEXT, unit)
    start, visible = _window(written(box), box.caret, place.width - 2 * _PAD * unit, size)
    left = place.left + _PAD * unit
    ends = [left + text_width(visible[:end], size) for end in range(len(visible) + 1)]
    return start + min(range(len(ends)), key=lambda end: abs(ends[end] - x))
