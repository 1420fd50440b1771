"""Help: a card with everything that can be pressed in the present mode."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from components.camera import Viewport
from components.view import View
from systems.render.marks import Fills, Mark, Panel, Text
from systems.render.theme import Theme, faded
from systems.render.typography import line_height, text_width

_PAD, _GAP = 22.0, 26.0  # points: inside the card, between columns
_HEAD = 160.0  # points, least width of the heading
_SIZES = (*((points, 1.1) for points in (13.0, 12.0, 11.0, 10.0, 9.0)), (9.0, 1.0))  # points, and lines apart


class Drawn(Protocol):
    """What is drawn in one viewport: a model's sheet, or a form."""

    view: View
    theme: Theme
    unit: float

    @property
    def viewport(self) -> Viewport: ...


def help_pages(keys: list[tuple[str, str]], viewport: Viewport, unit: float) -> list[list[tuple[str, str]]]:
    """(key, meaning) in lines, on as many pages as a viewport needs."""
    lines = _joined(keys)
    for count in range(1, max(len(lines), 1) + 1):
        each = math.ceil(len(lines) / count)
        pages = [lines[first : first + each] for first in range(0, len(lines), each)]
        if all(_card(page, viewport, unit).fits for page in pages):
            break
    return pages


def draw_help(sheet: Drawn) -> list[Mark]:
    """Draw keys and meanings in columns, over everything else."""
    if not sheet.view.keys:
        return []
    v = sheet.viewport
    right, bottom = v.left + v.width, v.top + v.height
    corners = np.array([[(v.left, v.top), (right, v.top), (right, bottom), (v.left, bottom)]], dtype=np.float64)
    veil = Fills(corners, faded(sheet.theme.background, 0.75))
    says = "F1 shows more" if sheet.view.more_keys else "F1 closes"
    return [veil, *_card(sheet.view.keys, v, sheet.unit).marks(sheet.theme, says)]


def _card(lines: list[tuple[str, str]], viewport: Viewport, unit: float) -> _Card:
    """The card with the largest type that fits."""
    cards = (_Card(lines, viewport, unit, *size) for size in _SIZES)
    return next((card for card in cards if card.fits), _Card(lines, viewport, unit, *_SIZES[-1]))


class _Card:
    """The help at one size of type: columns that are as wide as what stands in them."""

    def __init__(
        self, lines: list[tuple[str, str]], viewport: Viewport, unit: float, points: float, spacing: float
    ) -> None:
        self.v, self.u = v, u = viewport, unit
        self.size = max(round(points * u), 7)
        self.step = spacing * line_height(self.size)
        self.pad, self.gap = min(_PAD * u, 0.03 * v.width), min(_GAP * u, 0.03 * v.width)
        self.head = 16.0 * u + 0.8 * self.step
        room = v.height - 2 * self.pad - self.head - 8.0 * u
        columns = math.ceil(len(lines) / max(int(room / self.step), 1))
        self.rows = math.ceil(len(lines) / max(columns, 1))
        self.columns = [lines[first : first + self.rows] for first in range(0, len(lines), self.rows)]
        self.key_widths = [
            max(text_width(key, self.size, "semibold") for key, _ in column) + 12.0 * u
            for column in self.columns
        ]
        self.widths = [
            keys_wide + max(text_width(title, self.size) for _, title in column)
            for keys_wide, column in zip(self.key_widths, self.columns, strict=True)
        ]
        self.width = max(sum(self.widths) + (columns - 1) * self.gap, _HEAD * u) + 2 * self.pad
        self.height = self.rows * self.step + self.head + 2 * self.pad
        self.fits = self.width <= v.width - 4.0 * u and self.height <= v.height

    def marks(self, theme: Theme, says: str) -> list[Mark]:
        """The card, its heading, how to go on, and its lines."""
        v, u, pad, large = self.v, self.u, self.pad, max(round(16.0 * self.u), 7)
        left, top = v.left + (v.width - self.width) / 2, v.top + max((v.height - self.height) / 2, 2.0 * u)
        marks: list[Mark] = [
            Panel(left, top, self.width, self.height, 10.0 * u, theme.panel, theme.line),
            Text("Keys", left + pad, top + pad + 6.0 * u, large, theme.text, "semibold"),
            Text(says, left + self.width - pad, top + pad + 6.0 * u, self.size, theme.muted, anchor="right"),
        ]
        x = left + pad
        for column, keys_wide, wide in zip(self.columns, self.key_widths, self.widths, strict=True):
            for row, (key, title) in enumerate(column):
                y = top + pad + self.head + (row + 0.5) * self.step
                marks.append(Text(key, x, y, self.size, theme.text, "semibold"))
                marks.append(Text(title, x + keys_wide, y, self.size, theme.muted))
            x += wide + self.gap
        return marks


def _joined(keys: list[tuple[str, str]]) -> list[tuple[str, str]]:
    """Keys that do the same, in one line: ("Ctrl+Y, Ctrl+Shift+Z", "redo")."""
    by_title: dict[str, list[str]] = {}
    for key, title in keys:
        by_title.setdefault(title, []).append(written_key(key))
    return [(", ".join(names), title) for title, names in by_title.items()]


def written_key(key: str) -> str:
    """A key's name as a keyboard shows it: "ctrl+shift+z" → "Ctrl+Shift+Z"; a speck of ink by its name."""
    key = {".": "period", ",": "comma"}.get(key, key)
    *modifiers, last = key[:-1].split("+")  # the last character may be a plus itself
    parts = [*modifiers, last + key[-1]]
    return "+".join(part[:1].upper() + part[1:] for part in parts).replace("-", "−")
