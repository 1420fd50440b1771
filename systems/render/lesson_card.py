"""The card of a lesson: its task, answers and buttons, in a column or strip of its own; for drawing and clicking."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pinjoint.components.camera import Rectangle
from pinjoint.components.card import CardButton
from pinjoint.components.field import Vector
from pinjoint.components.view import View
from pinjoint.systems.render.marks import Fills, Mark, Panel, Points, Stamps, Strokes, Text, boxes
from pinjoint.systems.render.theme import Colour, Theme, faded
from pinjoint.systems.render.typography import font_size, line_height, shortened, text_width, wrapped

_EDGE, _GAP, _PAD = 14.0, 8.0, 8.0  # points: around all, between parts, inside a box
_TITLE, _TEXT, _SMALL, _LEAST = 15.0, 14.0, 12.0, 12.0  # points, sizes of type
_BUTTON, _ROW = 30.0, 28.0  # points, heights of buttons and of an answer
_BESIDE = 224.0  # points that buttons take at the right end of a strip
_DOT = 3.5  # points, radius of a task's dot
_SIGNED = ("right", "wrong", "hint")  # moods with a sign


@dataclass(frozen=True)
class _Line:
    """A line of text or an answer of the part that is scrolled."""

    text: str
    height: float
    size: int
    mood: str = ""
    answer: int = -1
    chosen: bool = False
    entry: bool = False


class CardLayout:
    """Where the parts of a card are, in pixels. buttons: at the bottom, or at the right in a strip; answers: as many."""

    def __init__(self, view: View) -> None:
        assert view.card is not None
        self.card, self.unit = view.card, view.pixel_ratio
        v, u = view.camera.viewport, view.pixel_ratio
        self.place = v
        self.strip = v.width > 2 * v.height
        self.left, top = v.left + _EDGE * u, v.top + _EDGE * u * (0.5 if self.strip else 1.0)
        self.right = v.right - (_EDGE + (_BESIDE if self.strip else 0.0)) * u
        self.heading = top + line_height(font_size(_TITLE, u)) / 2
        self.dots = self.heading + (0.0 if self.strip else 24.0 * u)
        self.top = self.dots + 16.0 * u
        self.buttons = self._buttons(view)
        self.bottom = (v.bottom if self.strip else self.buttons[0][0].top) - _GAP * u
        self.lines = self._lines(font_size(_TEXT, u))
        if sum(line.height for line in self.lines) > self.bottom - self.top:
            self.lines = self._lines(font_size(_LEAST, u), 0.5)
        most = self._most_scrolled()
        self.first = min(max((most if self.card.said else 0) + self.card.first, 0), most)
        self.shown = self._shown()

    def _buttons(self, view: View) -> list[tuple[Rectangle, CardButton]]:
        """The main button alone in its row, the others in rows of two."""
        v, u, gap = self.place, self.unit, 6.0 * self.unit
        height = _BUTTON * u
        left, right = self.left, v.right - _EDGE * u
        if self.strip:
            left = right - (_BESIDE - _EDGE) * u
            height = min(height, (v.height - 4 * gap) / 3)
        rows = [self.card.buttons[:1], self.card.buttons[1:3], self.card.buttons[3:]]
        upper = v.bottom - len(rows) * (height + gap) - (0.0 if self.strip else gap)
        placed = []
        for number, row in enumerate(rows):
            width = (right - left - (len(row) - 1) * gap) / max(len(row), 1)
            for column, button in enumerate(row):
                x, y = left + column * (width + gap), upper + number * (height + gap)
                placed.append((Rectangle(x, y, width, height), button))
        return placed

    def _lines(self, size: int, loose: float = 1.0) -> list[_Line]:
        """All that is said and asked, in lines; loose: the share of the usual space between parts."""
        card, u, width, high = self.card, self.unit, self.right - self.left, line_height(size)
        row_height, gap = high + (_ROW - 20.0) * loose * u, _GAP * loose * u
        lines: list[_Line] = []
        for text in card.paragraphs:
            lines += [_Line(part, high, size) for part in wrapped(text, width, size)]
            lines.append(_Line("", gap, size))
        for number, (text, chosen) in enumerate(card.choices):
            parts = wrapped(text, width - 40.0 * u, size)
            row = row_height + high * (len(parts) - 1)
            lines.append(_Line("\n".join(parts), row, size, answer=number, chosen=chosen))
        if card.entry is not None:
            lines.append(_Line(card.entry, row_height, size, entry=True))
        if card.said:
            lines.append(_Line("", gap, size))
        for number, text in enumerate(card.said):
            for index, part in enumerate(wrapped(text, width - 22.0 * u, size)):
                lines.append(_Line(part, high, size, card.mood if index + number == 0 else "more"))
        return lines

    def _most_scrolled(self) -> int:
        """How many lines may be scrolled away, so that the last one is seen."""
        room, count = self.bottom - self.top, 0
        for line in reversed(self.lines):
            room -= line.height
            if room < 0:
                break
            count += 1
        return len(self.lines) - count

    def _shown(self) -> list[tuple[float, _Line]]:
        """The lines in sight, and their upper edges: the last ones if something is said, unless somebody scrolled."""
        y, shown = self.top, []
        for line in self.lines[self.first :]:
            if y + line.height > self.bottom + 1.0:
                break
            shown.append((y, line))
            y += line.height
        return shown

    @property
    def hidden(self) -> bool:
        """True if lines follow below those in sight."""
        return self.first + len(self.shown) < len(self.lines)

    def at(self, pixel: Vector) -> str:
        """The action of a click at a pixel; "" if it has none."""
        for place, button in self.buttons:
            if place.contains(pixel):
                return button.action if button.enabled else ""
        for top, line in self.shown:
            if line.answer >= 0 and self._row(top, line).contains(pixel):
                return f"answer {line.answer + 1}"
        return ""

    def _row(self, top: float, line: _Line) -> Rectangle:
        return Rectangle(self.left, top + self.unit, self.right - self.left, line.height - 2 * self.unit)

    # --- drawing -----------------------------------------------------------------------------------

    def marks(self, theme: Theme, pointer: Vector | None) -> list[Mark]:
        """All marks of the card."""
        v, u = self.place, self.unit
        thin = max(round(u), 1)
        edge = (v.left, v.top, v.width, thin) if v.left == 0 else (v.left, v.top, thin, v.height)
        marks: list[Mark] = [boxes(theme.line, edge), *self._heading(theme)]
        for top, line in self.shown:
            marks += self._line(top, line, theme, pointer)
        for more, y, way in ((self.first > 0, self.top - 6.0 * u, -1.0), (self.hidden, self.bottom, 1.0)):
            if more:
                tip = np.array([[[-5.0, 0.0], [5.0, 0.0], [0.0, 5.0 * way]]]) * u + [self.right - 6.0 * u, y]
                marks.append(Fills(tip, theme.muted))
        for place, button in self.buttons:
            marks += _button(place, button, theme, u, pointer)
        return marks

    def _heading(self, theme: Theme) -> list[Mark]:
        """The title, which task it is, and a dot for each."""
        card, u = self.card, self.unit
        size, small = font_size(_TITLE, u), font_size(_SMALL, u)
        dots = 3 * _DOT * u * card.count + 10.0 * u
        taken = text_width(card.progress, small) + dots
        room = self.right - self.left - (taken + 16.0 * u if self.strip else 0.0)
        title = shortened(card.title, room, size, "semibold")
        marks: list[Mark] = [Text(title, self.left, self.heading, size, theme.text, "semibold")]
        start = self.right - taken if self.strip else self.left
        marks.append(Text(card.progress, start, self.dots, small, theme.muted))
        x = start + text_width(card.progress, small) + 12.0 * u
        for number in range(card.count):
            at = np.array([[x + 3 * _DOT * u * number, self.dots]])
            full = theme.text if number == card.at else theme.running if number in card.done else theme.line
            radius = (1.25 if number == card.at else 1.0) * _DOT * u
            marks.append(Stamps("disc", at, radius, u, full, full))
        return marks

    def _line(self, top: float, line: _Line, theme: Theme, pointer: Vector | None) -> list[Mark]:
        u, middle = self.unit, top + line.height / 2
        if line.answer >= 0 or line.entry:
            return self._answer(top, line, theme, pointer)
        ink = {"right": theme.running, "wrong": theme.problem, "hint": theme.sketch}.get(line.mood, theme.text)
        if not line.mood:
            return [Text(line.text, self.left, middle, line.size, theme.text)] if line.text else []
        marks: list[Mark] = [Text(line.text, self.left + 22.0 * u, middle, line.size, theme.text)]
        if line.mood in _SIGNED:
            at = np.array([[self.left + 7.0 * u, middle]])
            marks.append(Stamps("disc", at, 7.5 * u, u, ink, ink))
            marks += _sign(line.mood, at, u, theme.panel, line.size)
        return marks

    def _answer(self, top: float, line: _Line, theme: Theme, pointer: Vector | None) -> list[Mark]:
        """A choice with its key, or what is typed."""
        u, place = self.unit, self._row(top, line)
        under = pointer is not None and place.contains(pointer) and not line.entry
        fill = faded(theme.text, 0.14 if line.chosen else 0.09 if under else 0.04)
        outline = theme.focus if line.chosen or line.entry else theme.line
        marks: list[Mark] = [Panel(*place.box, 5.0 * u, fill, outline)]
        x, high = place.left + _PAD * u, line_height(line.size)
        parts = line.text.split("\n")
        y = place.middle[1] - (len(parts) - 1) * high / 2
        if not line.entry:
            marks.append(Text(str(line.answer + 1), x, y, line.size, theme.muted, "semibold"))
            x += 18.0 * u
        return marks + [
            Text(part, x, y + number * high, line.size, theme.text) for number, part in enumerate(parts)
        ]


def _sign(mood: str, at: Points, u: float, paper: Colour, size: int) -> list[Mark]:
    """The sign in the disc: a tick, a cross or a question mark."""
    x, y = at[0].tolist()
    if mood == "hint":
        return [Text("?", x, y, size, paper, "semibold", "centre")]
    points = (
        [(-3.5, 0.2), (-1.0, 2.8), (3.6, -2.6)]
        if mood == "right"
        else [(-2.8, -2.8), (2.8, 2.8), (0.0, 0.0), (-2.8, 2.8), (2.8, -2.8)]
    )
    corners = np.array(points) * u + [x, y]
    return [Strokes(corners[:-1], corners[1:], 1.7 * u, paper)]


def _button(place: Rectangle, button: CardButton, theme: Theme, u: float, pointer: Vector | None) -> list[Mark]:
    """A button with its title and its key."""
    under = pointer is not None and place.contains(pointer) and button.enabled
    fill = theme.text if button.main else faded(theme.text, 0.06)
    if under:
        fill = faded(theme.text, 0.85) if button.main else faded(theme.text, 0.14)
    ink = theme.panel if button.main else theme.text if button.enabled else faded(theme.muted, 0.5)
    size, small = font_size(13.0, u), font_size(11.0, u)
    key = text_width(button.key, small)
    title = shortened(button.title, place.width - key - 24.0 * u, size, "semibold")
    whole = text_width(title, size, "semibold") + key + 8.0 * u
    x, y = place.middle[0] - whole / 2, place.middle[1]
    key_ink = faded(ink, 0.6)
    return [
        Panel(*place.box, 5.0 * u, fill, None if button.main else theme.line),
        Text(title, x, y, size, ink, "semibold"),
        Text(button.key, x + whole, y, small, key_ink, "regular", "right"),
    ]


def draw_lesson(view: View, theme: Theme) -> list[Mark]:
    """The card that a view shows."""
    return CardLayout(view).marks(theme, view.pointer)


def lesson_button_at(view: View, pixel: Vector) -> str:
    """The action of a click on the card of a view; "" if it has none there."""
    return CardLayout(view).at(pixel) if view.card is not None else ""
