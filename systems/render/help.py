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
_SIZES = (13.0, 12.0, 11.0, 10.0, 9.0)  # points, the first that fits


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
    for points in _SIZES:
        card = _Card(sheet, keys, points)
        if card.fits or points == _SIZES[-1]:
            break
    return [veil, *card.marks()]


class _Card:
    """The help at one size of type."""

    def __init__(self, sheet: Drawn, keys: list[tuple[str, str]], points: float) -> None:
        self.sheet, self.keys, self.u = sheet, [(written_key(key), title) for key, title in keys], sheet.unit
        self.size = sheet.font(points)
        self.step = 1.15 * line_height(self.size)
        self.key_width = max(text_width(key, self.size, "semibold") for key, _ in self.keys) + 14.0 * self.u
        self.title_width = max(text_width(title, self.size) for _, title in self.keys)
        v, pad, gap = sheet.viewport, _PAD * self.u, _GAP * self.u
        self.room = v.height - 2 * pad - 2.2 * self.step - 20.0 * self.u
        self.rows = max(int(self.room / self.step), 1)
        self.columns = math.ceil(len(self.keys) / self.rows)
        self.rows = math.ceil(len(self.keys) / self.columns)
        column = self.key_width + self.title_width
        self.width = self.columns * column + (self.columns - 1) * gap + 2 * pad
        self.height = self.rows * self.step + 1.9 * self.step + 2 * pad - 0.5 * self.step
        self.fits = self.width <= v.width - 16.0 * self.u and self.height <= v.height

    def marks(self) -> list[Mark]:
        """The card, its heading and its lines."""
        v, u, theme, pad = self.sheet.viewport, self.u, self.sheet.theme, _PAD * self.u
        width = min(self.width, v.width - 4.0 * u)
        left, top = v.left + (v.width - width) / 2, v.top + max((v.height - self.height) / 2, 2.0 * u)
        marks: list[Mark] = [
            Panel(left, top, width, self.height, 10.0 * u, theme.panel, theme.line),
            Text("Keys", left + pad, top + pad + 4.0 * u, self.sheet.font(16.0), theme.text, "semibold"),
            Text("F1 closes", left + width - pad, top + pad + 4.0 * u, self.size, theme.muted, anchor="right"),
        ]
        pitch = (width - 2 * pad + _GAP * u) / self.columns
        for index, (key, title) in enumerate(self.keys):
            column, row = divmod(index, self.rows)
            x = left + pad + column * pitch
            y = top + pad + (row + 2.0) * self.step
            title = shortened(title, pitch - _GAP * u - self.key_width, self.size)
            marks.append(Text(key, x, y, self.size, theme.text, "semibold"))
            marks.append(Text(title, x + self.key_width, y, self.size, theme.muted))
        return marks


def written_key(key: str) -> str:
    """A key's name as a keyboard shows it: "ctrl+shift+z" → "Ctrl+Shift+Z"; a speck of ink by its name."""
    key = {".": "period", ",": "comma"}.get(key, key)
    parts = key.split("+") if key != "+" else [key]
    return "+".join(part[:1].upper() + part[1:] for part in parts if part).replace("-", "−")
