"""Help: a card with everything that can be pressed in the present mode."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from components.camera import Viewport
from components.view import View
from systems.render.marks import Fills, Mark, Panel, Text
from systems.render.theme import Theme, faded
from systems.render.typography import line_height, shortened, text_width

_PAD, _GAP = 22.0, 26.0  # points: inside the card, between columns
_SIZES = (*((points, 1.1) for points in (13.0, 12.0, 11.0, 10.0, 9.0)), (9.0, 1.0))  # points, and lines apart


class Drawn(Protocol):
    """What is drawn in one viewport: a model's sheet, or a form."""

    view: View
    theme: Theme
    unit: float

    @property
    def viewport(self) -> Viewport: ...

    def font(self, points: float) -> int: ...


def draw_help(sheet: Drawn) -> list[Mark]:
    """Keys and what they do, in as many columns as it takes; over everything else."""
    keys = sheet.view.keys
    if not keys:
        return []
    v = sheet.viewport
    right, bottom = v.left + v.width, v.top + v.height
    corners = np.array([[(v.left, v.top), (right, v.top), (right, bottom), (v.left, bottom)]], dtype=np.float64)
    veil = Fills(corners, faded(sheet.theme.background, 0.75))
    cards = (_Card(sheet, keys, *size) for size in _SIZES)
    card = next((card for card in cards if card.fits), _Card(sheet, keys, *_SIZES[-1]))
    return [veil, *card.marks()]


class _Card:
    """The help at one size of type: columns that are as wide as what stands in them."""

    def __init__(self, sheet: Drawn, keys: list[tuple[str, str]], points: float, spacing: float) -> None:
        self.sheet, self.u, v = sheet, sheet.unit, sheet.viewport
        self.size = sheet.font(points)
        self.step = spacing * line_height(self.size)
        self.pad = min(_PAD * self.u, 0.03 * v.width)
        self.gap = min(_GAP * self.u, 0.03 * v.width)
        self.head = 16.0 * self.u + 0.8 * self.step
        lines = _joined(keys)
        room = v.height - 2 * self.pad - self.head - 8.0 * self.u
        columns = math.ceil(len(lines) / max(int(room / self.step), 1))
        self.rows = math.ceil(len(lines) / columns)
        self.columns = [lines[first : first + self.rows] for first in range(0, len(lines), self.rows)]
        self.key_widths = [
            max(text_width(key, self.size, "semibold") for key, _ in column) + 12.0 * self.u
            for column in self.columns
        ]
        self.widths = [
            keys_wide + max(text_width(title, self.size) for _, title in column)
            for keys_wide, column in zip(self.key_widths, self.columns, strict=True)
        ]
        self.width = sum(self.widths) + (columns - 1) * self.gap + 2 * self.pad
        self.height = self.rows * self.step + self.head + 2 * self.pad
        self.fits = self.width <= v.width - 4.0 * self.u and self.height <= v.height

    def marks(self) -> list[Mark]:
        """The card, its heading and its lines."""
        v, u, theme, pad = self.sheet.viewport, self.u, self.sheet.theme, self.pad
        width = min(self.width, v.width - 4.0 * u)
        left, top = v.left + (v.width - width) / 2, v.top + max((v.height - self.height) / 2, 2.0 * u)
        marks: list[Mark] = [
            Panel(left, top, width, self.height, 10.0 * u, theme.panel, theme.line),
            Text("Keys", left + pad, top + pad + 6.0 * u, self.sheet.font(16.0), theme.text, "semibold"),
            Text("F1 closes", left + width - pad, top + pad + 6.0 * u, self.size, theme.muted, anchor="right"),
        ]
        missing = (self.width - width) / len(self.columns)  # of room in every column, if it does not fit
        x = left + pad
        for column, keys_wide, wide in zip(self.columns, self.key_widths, self.widths, strict=True):
            for row, (key, title) in enumerate(column):
                y = top + pad + self.head + (row + 0.5) * self.step
                shown = shortened(title, wide - keys_wide - missing, self.size)
                marks.append(Text(key, x, y, self.size, theme.text, "semibold"))
                marks.append(Text(shown, x + keys_wide, y, self.size, theme.muted))
            x += wide - missing + self.gap
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
