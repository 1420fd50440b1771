"""The card of a lesson: its task, answers and buttons, in a column or strip of its own."""

from __future__ import annotations

from functools import partial

import numpy as np

from pinjoint.components.camera import Rectangle
from pinjoint.components.toolbar import Tool
from pinjoint.components.view import Card, View
from pinjoint.systems.render.marks import Mark, Panel, Picture, Stamps, Strokes
from pinjoint.systems.render.marks import Text as Written
from pinjoint.systems.render.theme import Theme, faded
from pinjoint.systems.render.typography import ALL, font_size, wrapped
from pinjoint.systems.render.ui.buttons import button, ink_of
from pinjoint.systems.render.ui.layout import Column, Drawn, Gap, Paper, Part, Plate, Row, Scroll, Text

_EDGE, _GAP = 14.0, 8.0  # points: around all, between parts
# Points of type, and the share of usual gaps; the first in which all is in sight.
_BESIDE, _SIGN = 210.0, 22.0  # points that buttons take at the right end of a strip, and a sign before a text
_DOT = 3.5  # points, radius of a task's dot
_SIGNS = {
    "right": [(-3.5, 0.2), (-1.0, 2.8), (3.6, -2.6)],
    "wrong": [(-2.8, -2.8), (2.8, 2.8), (0.0, 0.0), (-2.8, 2.8), (2.8, -2.8)],
}


def compose_lesson(card: Card, view: View, theme: Theme) -> Picture:
    """The card that a view shows."""
    v, paper = view.camera.viewport, Paper(view.pixel_ratio, view.pointer)
    u, strip = paper.unit, v.width > 2 * v.height
    thin = max(round(u), 1)
    size = (v.width, thin) if v.left == 0 else (thin, v.height)
    paper.marks.append(Panel(v.left, v.top, *size, 0.0, theme.line))
    in_rows = card.buttons[:2], card.buttons[2:4], card.buttons[4:]
    main = next((one for one in card.buttons if one.enabled), None)
    rows = [
        Row([_button(one, theme, main=one is main) for one in row], 6.0, even=True, high=24.0, grow=1.0)
        for row in in_rows
        if row
    ]
    buttons = Column(rows, 6.0, wide=_BESIDE if strip else 0.0, high=30.0 * len(rows) + 12.0)
    title = Text(card.title, 15.0, theme.text, "semibold", grow=1.0)
    progress = Row((Text(card.progress, 12.0, theme.muted), Row(_dots(card, theme))), 12.0)
    head: Part = Row((title, progress), 16.0) if strip else Column((title, progress), 4.0)
    for points, loose in ((14.0, 1.0), (12.0, 0.5)):
        width = v.width - (2 * _EDGE + (_BESIDE + _EDGE if strip else 0.0)) * u
        lines = _lines(card, theme, width, u, points, loose)
        text = Scroll(lines, first=card.first, from_end=bool(card.said), bar=theme.muted, beside=6.0, grow=1.0)
        around = (_EDGE, 0.5 * _EDGE if strip else _EDGE, 0.5 * _EDGE if strip else _EDGE)
        said = Column((head, text) if strip else (head, text, buttons), _GAP, grow=1.0)
        whole = Row((said, buttons) if strip else (said,), _EDGE, around)
        if whole.height(u, v.width) <= v.height:
            break
    paper.put(Plate(whole, action="", wheel=("lesson up", "lesson down")), v)
    return Picture(v, theme.panel, paper.marks, hits=paper.hits)


def _button(one: Tool, theme: Theme, *, main: bool) -> Plate:
    ink = theme.panel if main else ink_of(theme, enabled=one.enabled)
    title = Text(one.title, (13.0, 12.0, 11.0), ink, "semibold", "centre", grow=1.0)
    inside = Row((title, Text(one.key, 11.0, faded(ink, 0.6))), 8.0, (8.0, 0.0, 0.0))
    again = one.action == "hint"  # there is another one
    return button(
        inside, one.action, theme, enabled=one.enabled, stands_out=True, main=main, inset=0.0, again=again
    )


def _lines(card: Card, theme: Theme, width: float, u: float, points: float, loose: float) -> list[Part]:
    """All that is said and asked, in lines, so that it can be scrolled by them."""
    gap, size = Gap(high=_GAP * loose), font_size(points, u)
    parts: list[Part] = []
    for text in card.paragraphs:
        parts += [*(Text(line, points, theme.text) for line in wrapped(text, width, size)), gap]
    for number, (text, chosen) in enumerate(card.choices, start=1):
        said = Text(text, points, theme.text, lines=ALL, grow=1.0)
        row = Row((Text(str(number), points, theme.muted, "semibold", wide=18.0), said), 0.0, (8.0, 5.0, 5.0))
        parts += [button(row, f"answer {number}", theme, pressed=chosen, stands_out=True, item=text)]
    if card.entry is not None:
        row = Row((Text(card.entry, points, theme.text),), around=(8.0, 5.0, 5.0))
        parts.append(Plate(row, faded(theme.text, 0.04), theme.focus, inset=1.0))
    parts += [gap] if card.said else []
    for number, text in enumerate(card.said):
        for index, line in enumerate(wrapped(text, width - _SIGN * u, size)):
            mood = card.mood if index + number == 0 else ""
            sign = Drawn(partial(_sign, mood, theme, size), _SIGN) if mood else Gap(_SIGN)
            parts.append(Row((sign, Text(line, points, theme.text))))
    return parts


def _dots(card: Card, theme: Theme) -> list[Part]:
    """A dot for each task, which leads there."""

    def dot(number: int) -> Plate:
        full = theme.text if number == card.at else theme.running if number in card.done else theme.line
        radius = (1.25 if number == card.at else 1.0) * _DOT

        def draw(at: Rectangle, u: float) -> list[Mark]:
            return [Stamps("disc", np.array([at.middle]), radius * u, u, full, full)]

        sign = Drawn(draw, 4 * _DOT, 5 * _DOT)
        return button(sign, "task of dot", theme, item=number, inset=0.0)

    return [dot(number) for number in range(card.count)]


def _sign(mood: str, theme: Theme, size: int, at: Rectangle, u: float) -> list[Mark]:
    """A disc with a tick, a cross or a question mark."""
    ink = {"right": theme.running, "wrong": theme.problem, "hint": theme.sketch}.get(mood)
    if ink is None:
        return []
    middle = np.array([[at.left + 7.5 * u, at.middle[1]]])
    x, y = middle[0].tolist()
    disc = Stamps("disc", middle, 7.5 * u, u, ink, ink)
    if mood not in _SIGNS:
        return [disc, Written("?", x, y, size, theme.panel, "semibold", "centre")]
    corners = np.array(_SIGNS[mood]) * u + [x, y]
    return [disc, Strokes(corners[:-1], corners[1:], 1.7 * u, theme.panel)]
