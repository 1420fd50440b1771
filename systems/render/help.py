"""Help: a card with everything that can be pressed in the present mode, by purpose."""

from __future__ import annotations

import math

import numpy as np

from components.camera import Rectangle, Viewport
from components.field import Vector
from components.view import View
from systems.render.marks import Fills, Mark, Panel, Text, boxes, cross
from systems.render.theme import Theme, faded
from systems.render.typography import font_size, line_height, text_width

_PAD, _GAP = 22.0, 26.0  # points: inside the card, between columns
_HEAD = 320.0  # points, least width of the heading
_CLOSE = 22.0  # points, side of the button that closes it
_SIZES = (*((points, 1.1) for points in (13.0, 12.0, 11.0, 10.0, 9.0)), (9.0, 1.0))  # points, and lines apart


Lines = list[tuple[str, str]]  # (key, meaning); ("", purpose) stands above the keys of a purpose


def help_pages(keys: Lines, viewport: Viewport, unit: float) -> list[Lines]:
    """(key, meaning) in lines, on as many pages as a viewport needs."""
    lines = _joined(keys)
    for count in range(1, max(len(lines), 1) + 1):
        pages = _parts(lines, math.ceil(len(lines) / count))
        if all(_card(page, viewport, unit).fits for page in pages):
            break
    return pages


def _parts(lines: Lines, each: int) -> list[Lines]:
    """Lines in parts of at most `each`, or three; none ends with a purpose, and one that goes on is named again."""
    parts, purpose = [list[tuple[str, str]]()], ("", "")
    for number, line in enumerate(lines):
        purpose = purpose if line[0] else line
        needed = 1 if line[0] or number + 1 == len(lines) else 2
        if parts[-1] and len(parts[-1]) + needed > max(each, 3):
            parts.append([purpose] if line[0] and purpose[1] else [])
        parts[-1].append(line)
    return parts


def help_closed_by(lines: Lines, more: bool, viewport: Viewport, unit: float, pixel: Vector) -> bool:
    """True if a click at a pixel puts the list away; in the card, while there is more of it, a click goes on."""
    card = _card(lines, viewport, unit)
    return not more or card.close.contains(pixel) or not card.place.contains(pixel)


def draw_help(view: View, v: Viewport, theme: Theme) -> list[Mark]:
    """Keys and meanings in columns, over everything else in a viewport."""
    if not view.keys:
        return []
    corners = [(v.left, v.top), (v.right, v.top), (v.right, v.bottom), (v.left, v.bottom)]
    veil = Fills(np.array([corners], dtype=np.float64), faded(theme.background, 0.75))
    last = view.help >= view.pages
    says = "F1 or a click closes" if last else "F1, a click or the wheel: more"
    heading = f"Keys, page {min(view.help, view.pages)} of {view.pages}" if view.pages > 1 else "Keys"
    return [veil, *_card(view.keys, v, view.pixel_ratio).marks(theme, heading, says)]


def _card(lines: Lines, viewport: Viewport, unit: float) -> _Card:
    """The card with the largest type that fits."""
    cards = (_Card(lines, viewport, unit, *size) for size in _SIZES)
    return next((card for card in cards if card.fits), _Card(lines, viewport, unit, *_SIZES[-1]))


class _Card:
    """The help at one size of type: columns that are as wide as what stands in them."""

    def __init__(self, lines: Lines, viewport: Viewport, unit: float, points: float, spacing: float) -> None:
        self.v, self.u = v, u = viewport, unit
        self.size = font_size(points, u)
        self.step = spacing * line_height(self.size)
        self.pad, self.gap = min(_PAD * u, 0.03 * v.width), min(_GAP * u, 0.03 * v.width)
        self.head = 16.0 * u + 0.8 * self.step
        room = v.height - 2 * self.pad - self.head - 8.0 * u
        most = max(int(room / self.step), 1)
        self.columns = _parts(lines, most)
        for rows in range(math.ceil(len(lines) / len(self.columns)), most):  # columns about equally long
            if len(even := _parts(lines, rows)) == len(self.columns):
                self.columns = even
                break
        columns, self.rows = len(self.columns), max(map(len, self.columns))
        self.key_widths = [
            max(text_width(key, self.size, "semibold") for key, _ in column) + 12.0 * u
            for column in self.columns
        ]
        self.widths = [
            max(
                text_width(title, self.size, weight_of(key)) + (keys_wide if key else 0)
                for key, title in column
            )
            for keys_wide, column in zip(self.key_widths, self.columns, strict=True)
        ]
        self.width = max(sum(self.widths) + (columns - 1) * self.gap, _HEAD * u) + 2 * self.pad
        self.height = self.rows * self.step + self.head + 2 * self.pad
        self.fits = self.width <= v.width - 4.0 * u and self.height <= v.height
        left, top = v.left + (v.width - self.width) / 2, v.top + max((v.height - self.height) / 2, 2.0 * u)
        self.place = Rectangle(left, top, self.width, self.height)
        side = _CLOSE * u
        self.close = Rectangle(left + self.width - side - 6.0 * u, top + 6.0 * u, side, side)

    def marks(self, theme: Theme, heading: str, says: str) -> list[Mark]:
        """The card, its heading, how to go on, and its lines."""
        u, pad, large = self.u, self.pad, font_size(16.0, self.u)
        left, top, y = self.place.left, self.place.top, self.close.middle[1]
        marks: list[Mark] = [
            Panel(left, top, self.width, self.height, 10.0 * u, theme.panel, theme.line),
            Text(heading, left + pad, y, large, theme.text, "semibold"),
            Text(says, self.close.left - 6.0 * u, y, self.size, theme.muted, anchor="right"),
            cross(self.close, u, theme.muted),
        ]
        x = left + pad
        for column, keys_wide, wide in zip(self.columns, self.key_widths, self.widths, strict=True):
            for row, (key, title) in enumerate(column):
                y = top + pad + self.head + (row + 0.5) * self.step
                if key:
                    marks.append(Text(key, x, y, self.size, theme.text, "semibold"))
                    marks.append(Text(title, x + keys_wide, y, self.size, theme.muted))
                else:
                    line = (round(x), round(y + 0.5 * self.step), round(wide), max(round(u), 1))
                    marks += [Text(title, x, y, self.size, theme.text, "semibold"), boxes(theme.line, line)]
            x += wide + self.gap
        return marks


def weight_of(key: str) -> str:
    """The weight of a title: that of a purpose, which has no key, is heavier."""
    return "regular" if key else "semibold"


def _joined(keys: Lines) -> Lines:
    """Keys that do the same for one purpose, in one line: ("Ctrl+Y, Ctrl+Shift+Z", "redo")."""
    by_title: dict[tuple[str, str], list[str]] = {}
    purpose = ""
    for key, title in keys:
        purpose = purpose if key else title
        by_title.setdefault((purpose, title), []).append(key)
    return [(_written_keys(names), title) for (_, title), names in by_title.items()]


def _written_keys(keys: list[str]) -> str:
    """Some keys; all four arrows are called so."""
    stem = keys[0].removesuffix("left")
    if keys == [f"{stem}{way}" for way in ("left", "right", "up", "down")]:
        return f"{written_key(stem + 'arrow')}s"
    return ", ".join(map(written_key, keys)) if keys != [""] else ""


def written_key(key: str) -> str:
    """The name of a key as a keyboard shows it: "ctrl+shift+z" → "Ctrl+Shift+Z"; full stop and comma by name."""
    key = {".": "period", ",": "comma"}.get(key, key)
    *modifiers, last = key[:-1].split("+")  # the last character may be a plus itself
    parts = [*modifiers, last + key[-1]]
    return "+".join(part[:1].upper() + part[1:] for part in parts).replace("-", "−")
