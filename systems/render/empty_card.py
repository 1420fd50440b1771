"""The card of an empty model: the tools with which one begins, as buttons with their names; for drawing and clicking."""

from __future__ import annotations

import numpy as np

from pinjoint.components.camera import Rectangle
from pinjoint.components.field import Vector
from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.components.toolbar import Button, Tool
from pinjoint.components.view import View
from pinjoint.systems.render.help import written_key
from pinjoint.systems.render.marks import Mark, Panel, Stamps, Strokes, Text
from pinjoint.systems.render.menu import titled
from pinjoint.systems.render.overlays import BAR
from pinjoint.systems.render.theme import Theme, faded
from pinjoint.systems.render.typography import font_size, shortened, text_width

_FIRST = (
    "place",
    "rod",
    "rigid",
    "support",
    "force",
    "load",
    "toggle help",
)  # the tools, if the toolbar has them
_ROW, _ICON, _PAD, _GAP = 27.0, 34.0, 24.0, 26.0  # points: a row, its icon, around rows, between title and key
_HEAD, _EMBLEM, _ROOMY = 52.0, 68.0, 420.0  # points: the title, the emblem, and a canvas high enough for that
_SIZE = 13.0  # points, of type


class Card:
    """Where the card of a view is, and its buttons."""

    def __init__(self, view: View) -> None:
        self.unit, v = view.pixel_ratio, view.canvas
        u, self.size = self.unit, font_size(_SIZE, self.unit)
        known = {tool.action: tool for group in view.toolbar.groups for tool in group}
        tools = [known[action] for action in _FIRST if action in known]
        self.emblem = _EMBLEM * u if v.height >= _ROOMY * u else 0.0
        widest = max((self._width(tool) for tool in tools), default=0.0)
        width = min(max(widest + 2 * _PAD * u, 280.0 * u), v.width - 28.0 * u)
        height = self.emblem + (_HEAD + 14.0) * u + len(tools) * _ROW * u
        bottom = v.bottom - BAR * u  # that of the status
        left, top = v.left + (v.width - width) / 2, v.top + (bottom - v.top - height) / 2
        self.place, first = Rectangle(left, top, width, height), top + self.emblem + _HEAD * u
        inner = left + (_PAD - 12.0) * u, width - 2 * (_PAD - 12.0) * u
        self.buttons = [
            Button(inner[0], first + number * _ROW * u, inner[1], _ROW * u, tool)
            for number, tool in enumerate(tools)
        ]

    def _width(self, tool: Tool) -> float:
        """Pixels of the icon, title and key of a tool."""
        key = text_width(written_key(tool.key), self.size, "semibold") if tool.key else 0.0
        return (_ICON + _GAP) * self.unit + text_width(titled(tool), self.size) + key


def card_button_at(model: Model, view: View, pixel: Vector) -> Tool | None:
    """The tool whose button on the card of an empty model is at a pixel."""
    if not shows_card(model, view):
        return None
    return next((button.tool for button in Card(view).buttons if button.contains(pixel)), None)


def shows_card(model: Model, view: View) -> bool:
    """True where a model is empty, nothing is being drawn, and its picture has the room of the window."""
    drawing = bool(view.tool) or view.preview is not None
    return model.particles.count == 0 and view.page is None and view.aside is None and not drawing


def draw_card(view: View, theme: Theme) -> list[Mark]:
    """The card in the middle, the button under the pointer on a plate."""
    card, u = Card(view), view.pixel_ratio
    left, top, width, height = card.place.box
    middle = left + width / 2
    y, size = top + card.emblem + 28.0 * u, font_size(20.0, u)
    marks: list[Mark] = [
        Panel(left, top, width, height, 12.0 * u, theme.background, theme.line),
        *(_emblem(middle, top + 24.0 * u, u, theme) if card.emblem else []),
        Text(tr("An empty model"), middle, y, size, theme.text, "semibold", "centre"),
    ]
    for button in card.buttons:
        marks += _row(button, card.size, view, theme)
    return marks


def _row(button: Button, size: int, view: View, theme: Theme) -> list[Mark]:
    """Icon, title and key of a tool."""
    u, tool, y = view.pixel_ratio, button.tool, button.middle[1]
    left, right = button.left + 12.0 * u, button.right - 12.0 * u
    at = np.array([[left + 10.0 * u, y]])
    key = written_key(tool.key) if tool.key else ""
    room = right - left - _ICON * u - text_width(key, size, "semibold")
    under = tool.enabled and view.pointer is not None and button.contains(view.pointer)
    ink = theme.text if tool.enabled else faded(theme.muted, 0.6)
    plate = Panel(
        button.left, button.top + u, button.width, button.height - 2 * u, 5.0 * u, faded(theme.text, 0.09)
    )
    return [
        *([plate] if under else []),
        Stamps(tool.icon, at, 0.85 * u, u, ink, ink),
        Text(shortened(titled(tool), room, size), left + _ICON * u, y, size, ink),
        *([Text(key, right, y, size, theme.muted, "semibold", "right")] if key else []),
    ]


def _emblem(middle: float, top: float, u: float, theme: Theme) -> list[Mark]:
    """Two small triangles of rods."""
    nodes = np.array([[-36.0, 42.0], [0.0, 42.0], [36.0, 42.0], [-18.0, 6.0], [18.0, 6.0]]) * u + [middle, top]
    rods = np.array([[0, 1], [1, 2], [0, 3], [3, 1], [1, 4], [4, 2], [3, 4]])
    return [
        Strokes(nodes[rods[:, 0]], nodes[rods[:, 1]], 2.0 * u, theme.ghost),
        Stamps("ring", nodes, 5.0 * u, u, theme.ghost, theme.background),
    ]
