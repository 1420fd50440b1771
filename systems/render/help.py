"""Help: a card with everything that can be pressed in the present mode, by purpose, and then the glossary."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache, lru_cache
from itertools import zip_longest

import numpy as np

from pinjoint.components.camera import Rectangle, Viewport
from pinjoint.components.field import Vector
from pinjoint.components.language import language, tr, tr_in
from pinjoint.components.view import View
from pinjoint.systems.render.glossary import glossary
from pinjoint.systems.render.marks import Fills, Mark, Panel, Text, boxes, cross
from pinjoint.systems.render.theme import Theme, faded
from pinjoint.systems.render.typography import font_size, line_height, shortened, text_width, wrapped

_PAD, _GAP = 22.0, 26.0  # points: inside the card, between columns
_CLOSE = 22.0  # points, side of the button that closes it
_SIZES = (*((points, 1.1) for points in (13.0, 12.0, 11.0, 10.0, 9.0)), (9.0, 1.0))  # points, and lines apart
_OF_GLOSSARY = _SIZES[:3]  # sentences are read, keys are looked up
_LOW = 330.0  # points: a viewport less high has smaller type
_TERM, _MEANING = 13.0, 27.0  # sizes of type that a term and its meaning are wide at most

Sizes = Sequence[tuple[float, float]]
Lines = list[tuple[str, str]]  # (key, meaning); ("", purpose) stands above the keys of a purpose
_GOES_ON = " "  # before the key of a line that goes on with the meaning of that above


def help_pages(keys: Lines, viewport: Viewport, unit: float) -> list[Lines]:
    """(key, meaning) in lines, on as many pages as a viewport needs; those of the glossary are the last."""
    return [*_paged(_joined(keys), viewport, unit, _SIZES), *_pages_of_glossary(viewport, unit, language())]


@lru_cache(maxsize=4)
def _pages_of_glossary(viewport: Viewport, unit: float, _: str) -> list[Lines]:
    """Terms and meanings in the present language, the long ones in several lines."""
    sizes = _OF_GLOSSARY if viewport.height > _LOW * unit else _SIZES
    size = font_size(sizes[-1][0], unit)
    room = viewport.width - 2 * min(_PAD * unit, 0.03 * viewport.width) - 20.0 * unit
    wide, meant = min(_TERM * size, 0.35 * room), min(_MEANING * size, 0.65 * room)
    lines: Lines = [("", tr("Glossary"))]
    for term, meaning, also in glossary():
        names = [f"{term} ({also})"] if also else [term]
        if also and text_width(names[0], size, "semibold") > wide:
            names = [term, f"({also})"]
        left = [line for name in names for line in wrapped(name, wide, size, "semibold")]
        rows = zip_longest(left, wrapped(meaning, meant, size), fillvalue="")
        lines += [(f"{_GOES_ON * (row > 0)}{name}", text) for row, (name, text) in enumerate(rows)]
    return _paged(lines, viewport, unit, sizes)


def _paged(lines: Lines, viewport: Viewport, unit: float, sizes: Sizes) -> list[Lines]:
    """Lines on as few pages as fit in one of some sizes of type."""
    for count in range(1, max(len(lines), 1) + 1):
        pages = _parts(lines, math.ceil(len(lines) / count))
        if all(any(_Card(page, viewport, unit, *size).fits for size in sizes) for page in pages):
            break
    return pages


def _parts(lines: Lines, each: int) -> list[Lines]:
    """Lines in parts of at most `each`, or three; none ends with a purpose, and one that goes on is named again.

    No part begins within a meaning that takes several lines.
    """
    parts, purpose = [list[tuple[str, str]]()], ("", "")
    for number, line in enumerate(lines):
        purpose = purpose if line[0] else line
        needed = 1
        while number + needed < len(lines) and _stays(lines[number + needed - 1], lines[number + needed]):
            needed += 1
        if line[0].startswith(_GOES_ON):
            needed = 0
        if parts[-1] and len(parts[-1]) + needed > max(each, 3):
            parts.append([purpose] if line[0] and purpose[1] else [])
        parts[-1].append(line)
    return parts


def _stays(line: tuple[str, str], following: tuple[str, str]) -> bool:
    """True if a line stands in the same column as the one above it: a key below its purpose, or more of a meaning."""
    return not line[0] or following[0].startswith(_GOES_ON)


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
    heading = _heading(min(view.help, view.pages), view.pages)
    return [veil, *_card(view.keys, v, view.pixel_ratio).marks(theme, heading, _how_to_go_on(last=last))]


def _heading(page: int, pages: int) -> str:
    return tr("Help, page {page} of {pages}", page=page, pages=pages)


def _how_to_go_on(*, last: bool) -> str:
    return tr("F1 or click: close") if last else tr("F1, click or wheel: next page")


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
        head = text_width(_heading(10, 10), font_size(16.0, u), "semibold") + (_CLOSE + 12.0) * u
        head += max(text_width(_how_to_go_on(last=last), self.size) for last in (False, True))
        head = min(head, v.width - 4.0 * u - 2 * self.pad)
        self.width = max(sum(self.widths) + (columns - 1) * self.gap, head) + 2 * self.pad
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
        room = self.close.left - 12.0 * u - left - pad - text_width(heading, large, "semibold")
        says = shortened(says, room, self.size)
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
        keys = [f"{stem}arrows"]
    return ", ".join(map(written_key, keys)) if keys != [""] else ""


def written_key(key: str) -> str:
    """The name of a key as a keyboard of the present language shows it: "ctrl+shift+z" → "Ctrl+Shift+Z"."""
    *modifiers, last = key[:-1].split("+")  # the last character may be a plus itself
    last += key[-1]
    named = _key_names(language()).get(last) or (last[:1].upper() + last[1:]).replace("-", "−")
    return "+".join([*(modifier.capitalize() for modifier in modifiers), named])


@cache
def _key_names(_: str) -> dict[str, str]:
    """What keys and buttons are called in the present language, where that is not their own character."""
    return {
        ".": tr_in("key", "Period"),
        ",": tr_in("key", "Comma"),
        "space": tr_in("key", "Space"),
        "return": tr_in("key", "Return"),
        "escape": tr_in("key", "Escape"),
        "delete": tr_in("key", "Delete"),
        "backspace": tr_in("key", "Backspace"),
        "tab": tr_in("key", "Tab"),
        "home": tr_in("key", "Home"),
        "end": tr_in("key", "End"),
        "page up": tr_in("key", "Page up"),
        "page down": tr_in("key", "Page down"),
        "menu": tr_in("key", "Menu"),
        "left": tr_in("key", "Left"),
        "right": tr_in("key", "Right"),
        "up": tr_in("key", "Up"),
        "down": tr_in("key", "Down"),
        "arrows": tr_in("key", "Arrows"),
        "click": tr_in("key", "Click"),
        "double click": tr_in("key", "Double click"),
        "right click": tr_in("key", "Right click"),
        "drag": tr_in("key", "Drag"),
        "drag middle": tr_in("key", "Drag middle"),
        "wheel up": tr_in("key", "Wheel up"),
        "wheel down": tr_in("key", "Wheel down"),
    }
