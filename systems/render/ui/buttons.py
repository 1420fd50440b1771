"""Buttons: the one button of the program, with its plate, its ink and its key; and the names of keys on it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from pinjoint.components.field import Vector
from pinjoint.components.language import begun, language, tr, tr_in
from pinjoint.components.toolbar import Tool
from pinjoint.systems.render.marks import Strokes
from pinjoint.systems.render.theme import Colour, Theme, faded
from pinjoint.systems.render.ui.layout import Drawn, Part, Plate, Row, Text, icon

ICON = 0.85  # points for each of the 20 units of an icon's square
_HOVER, _PRESSED, _IDLE, _MAIN, _DISABLED = 0.09, 0.16, 0.06, 0.85, 0.45  # opacities, of plates and of ink


def button(
    inside: Part,
    action: str | None,
    theme: Theme,
    *,
    enabled: bool = True,
    pressed: bool = False,
    stands_out: bool = False,
    main: bool = False,
    item: Any = None,
    at: Vector | None = None,
    inset: float = 1.0,
    again: bool = False,
) -> Plate:
    """A button: a plate under the pointer, while it is pressed, or always if it stands out; main: the next thing to do."""
    quiet, outline = (faded(theme.text, _IDLE), theme.line) if stands_out else (None, None)
    hover = faded(theme.text, _HOVER + _IDLE if stands_out else _HOVER)
    if main:
        quiet, hover, outline = theme.text, faded(theme.text, _MAIN), None
    if pressed:
        quiet = hover = faded(theme.focus, _PRESSED)
    looks = Plate(inside, quiet, outline, hover, inset=inset)
    return replace(looks, action=action, enabled=enabled, item=item, at=at, again=again)


def ink_of(theme: Theme, *, enabled: bool, pressed: bool = False) -> Colour:
    """The colour of what stands on a button."""
    return faded(theme.muted, _DISABLED) if not enabled else theme.focus if pressed else theme.text


def tool_row(tool: Tool, theme: Theme, sign: Part, points: float | tuple[float, ...], apart: float) -> Row:
    """A sign, the title and the key of a tool, with points between those."""
    ink, title = ink_of(theme, enabled=tool.enabled), begun(tr(tool.title))
    key = Text(written_key(tool.key) if tool.key else "", points, theme.muted if tool.enabled else ink)
    return Row((sign, Row((Text(title, points, ink, grow=1.0), key), apart, grow=1.0)), grow=1.0)


def tool_icon(tool: Tool, theme: Theme, wide: float) -> Drawn:
    """The icon of a tool in the middle of so many points."""
    return icon(tool.icon, ICON, ink_of(theme, enabled=tool.enabled, pressed=tool.pressed), wide)


def closing(action: str | None, theme: Theme, side: float, item: Any = None, size: float = 1.0) -> Plate:
    """The button with a cross that closes something."""
    ends = np.array([[-4.5, -4.5], [-4.5, 4.5]]) * size
    sign = Drawn(
        lambda at, u: [Strokes(at.middle + u * ends, at.middle - u * ends, 1.6 * size * u, theme.muted)], side
    )
    return button(sign, action, theme, item=item, inset=0.0)


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
