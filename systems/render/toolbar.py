"""Toolbar: its marks, the tip of the button under the pointer, and the help, over everything else."""

from __future__ import annotations

import numpy as np

from components.camera import Viewport
from components.toolbar import Button, Toolbar
from components.view import View
from systems.render.help import draw_help, written_key
from systems.render.marks import Mark, Panel, Picture, Rectangles, Stamps, Text
from systems.render.theme import Colour, Theme, faded
from systems.render.typography import line_height, text_width

_ICON = 0.85  # points for each of the 20 units of an icon's square
_RADIUS = 5.0  # points, of a button's corners


def compose_toolbar(toolbar: Toolbar, view: View, theme: Theme) -> Picture:
    """The toolbar in its strip of a view; without a background, since it lies over the picture."""
    writer = _Writer(toolbar, view, theme)
    marks = [*writer.strip(), *draw_help(writer), *writer.tip()]
    return Picture(view.camera.viewport, None, marks)


class _Writer:
    """Makes the marks of one toolbar."""

    def __init__(self, toolbar: Toolbar, view: View, theme: Theme) -> None:
        self.view, self.theme, self.unit = view, theme, view.pixel_ratio
        shown = view.strip.width > 0
        self.buttons = toolbar.buttons(view.camera.viewport, self.unit) if shown else []
        pointer = view.pointer
        under = (button for button in self.buttons if pointer is not None and button.contains(pointer))
        self.hovered = next(under, None)

    @property
    def viewport(self) -> Viewport:
        return self.view.canvas

    def font(self, points: float) -> int:
        """A font size in whole pixels."""
        return max(round(points * self.unit), 7)

    def strip(self) -> list[Mark]:
        """The bar with a hairline at its right edge, and its buttons."""
        if not self.buttons:
            return []
        s, thin = self.view.strip, max(round(self.unit), 1)
        bar = np.array([[s.left, s.top, s.width, s.height]], dtype=np.int64)
        edge = np.array([[s.left + s.width - thin, s.top, thin, s.height]], dtype=np.int64)
        marks: list[Mark] = [Rectangles(bar, self.theme.panel), Rectangles(edge, self.theme.line)]
        for button in self.buttons:
            marks += self._button(button)
        return marks

    def _button(self, button: Button) -> list[Mark]:
        u, tool = self.unit, button.tool
        middle = np.array([[button.left + button.width / 2, button.top + button.height / 2]])
        ink = self._ink(button)
        icon = Stamps(tool.icon, middle, _ICON * u, u, ink, ink)
        if tool.pressed:
            return [self._plate(button, faded(self.theme.hover, 0.16)), icon]
        if button is self.hovered and tool.enabled:
            return [self._plate(button, faded(self.theme.text, 0.09)), icon]
        return [icon]

    def _ink(self, button: Button) -> Colour:
        if not button.tool.enabled:
            return faded(self.theme.muted, 0.4)
        return self.theme.hover if button.tool.pressed else self.theme.text

    def _plate(self, button: Button, colour: Colour) -> Panel:
        gap = self.unit
        width, height = button.width - 2 * gap, button.height - 2 * gap
        return Panel(button.left + gap, button.top + gap, width, height, _RADIUS * self.unit, colour)

    def tip(self) -> list[Mark]:
        """The title and the key of the button under the pointer, beside the button."""
        button = self.hovered
        if button is None:
            return []
        u, theme, size = self.unit, self.theme, self.font(12.0)
        title, key = button.tool.title[:1].upper() + button.tool.title[1:], written_key(button.tool.key)
        title_width, key_width = text_width(title, size), text_width(key, size, "semibold")
        pad, gap, height = 10.0 * u, 14.0 * u, line_height(size) + 10.0 * u
        left, middle = self.viewport.left + 6.0 * u, button.top + button.height / 2
        window = self.view.camera.viewport
        top = min(max(middle - height / 2, window.top + 2.0 * u), window.top + window.height - height - 2.0 * u)
        width, y = title_width + gap + key_width + 2 * pad, top + height / 2
        return [
            Panel(left, top, width, height, 6.0 * u, theme.background, theme.line),
            Text(title, left + pad, y, size, theme.text),
            Text(key, left + pad + title_width + gap, y, size, theme.muted, "semibold"),
        ]
