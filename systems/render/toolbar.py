"""Toolbar: its marks, the tip of the button under the pointer, the help and an open menu, over everything else."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pinjoint.components.toolbar import Button, Toolbar
from pinjoint.components.view import View
from pinjoint.systems.render.help import draw_help, written_key
from pinjoint.systems.render.marks import Mark, Panel, Picture, Stamps, Text, boxes
from pinjoint.systems.render.menu import draw_menu, titled
from pinjoint.systems.render.theme import Theme, faded
from pinjoint.systems.render.typography import font_size, line_height, text_width

_ICON = 0.85  # points for each of the 20 units of an icon's square
_RADIUS = 5.0  # points, of a button's corners


def compose_toolbar(toolbar: Toolbar, view: View, theme: Theme, below: Sequence[Picture] = ()) -> Picture:
    """The toolbar in its strip of a view; without a background, since it lies over the pictures below."""
    writer = _Writer(toolbar, view, theme)
    marks = [*writer.strip(), *draw_help(view, view.canvas, theme), *writer.tip(below), *draw_menu(view, theme)]
    return Picture(view.camera.viewport, None, marks)


class _Writer:
    """Makes the marks of one toolbar."""

    def __init__(self, toolbar: Toolbar, view: View, theme: Theme) -> None:
        self.view, self.theme, self.unit = view, theme, view.pixel_ratio
        shown = view.strip.width > 0
        self.buttons = toolbar.buttons(view.camera.viewport, self.unit) if shown else []
        self.hovered = view.button_at(view.pointer)

    def strip(self) -> list[Mark]:
        """The bar with a hairline at its right edge, and its buttons."""
        if not self.buttons:
            return []
        s, thin = self.view.strip, max(round(self.unit), 1)
        marks: list[Mark] = [boxes(self.theme.panel, s.box)]
        marks.append(boxes(self.theme.line, (s.right - thin, s.top, thin, s.height)))
        for button in self.buttons:
            marks += self._button(button)
        return marks

    def _button(self, button: Button) -> list[Mark]:
        """The icon, on a plate if it is pressed or would be by a click."""
        u, tool, theme = self.unit, button.tool, self.theme
        middle = np.array([button.middle])
        ink = faded(theme.muted, 0.4) if not tool.enabled else theme.focus if tool.pressed else theme.text
        icon = Stamps(tool.icon, middle, _ICON * u, u, ink, ink)
        if not tool.pressed and not (button == self.hovered and tool.enabled):
            return [icon]
        colour = faded(theme.focus, 0.16) if tool.pressed else faded(theme.text, 0.09)
        width, height = button.width - 2 * u, button.height - 2 * u
        return [Panel(button.left + u, button.top + u, width, height, _RADIUS * u, colour), icon]

    def tip(self, below: Sequence[Picture]) -> list[Mark]:
        """The title and the key of the button under the pointer, near by where they cover nothing that is said."""
        button = self.hovered
        if button is None or self.view.menu is not None or self.view.pressed is not None:
            return []
        u, theme, size = self.unit, self.theme, font_size(12.0, self.unit)
        title = titled(button.tool)
        key = written_key(button.tool.key) if button.tool.key else ""
        title_width, key_width = text_width(title, size), text_width(key, size, "semibold")
        pad, gap, height = 10.0 * u, 14.0 * u if key else 0.0, line_height(size) + 10.0 * u
        width, middle = title_width + gap + key_width + 2 * pad, button.middle[1]
        left, top = self._free_place(middle - height / 2, width, height, below)
        y = top + height / 2
        return [
            Panel(left, top, width, height, 6.0 * u, theme.background, theme.line),
            Text(title, left + pad, y, size, theme.text),
            *([Text(key, left + pad + title_width + gap, y, size, theme.muted, "semibold")] if key else []),
        ]

    def _free_place(
        self, top: float, width: float, height: float, below: Sequence[Picture]
    ) -> tuple[float, float]:
        """Left and top of the place nearest to the strip's edge at `top` where a box covers no text and no panel."""
        u, window, gap = self.unit, self.view.camera.viewport, 2.0 * self.unit
        lefts = np.arange(self.view.strip.right + 6.0 * u, window.right - width - gap, 12.0 * u)
        tops = np.arange(window.top + gap, window.bottom - height - gap, 4.0 * u)
        first = window.left + self.view.strip.width + 6.0 * u
        nearest = first, min(max(top, window.top + gap), window.bottom - height - gap)
        places = np.array([nearest, *((x, y) for x in lefts for y in tops)])
        places = places[np.argsort(np.hypot(*(places - nearest).T), kind="stable")]
        size = np.array([width, height])
        said = np.array([_box(mark) for picture in below for mark in picture.marks if _says(mark)])
        if not len(said):
            return nearest
        for box in said:
            apart = (places <= box[:2] - size - gap) | (places >= box[2:] + gap)
            if len(places := places[apart.any(axis=1)]) == 0:
                return nearest
        left, upper = places[0].tolist()
        return left, upper


def _says(mark: Mark) -> bool:
    """Whether a mark is a text, or a panel on which something stands."""
    return isinstance(mark, Text) or (isinstance(mark, Panel) and mark.outline is not None)


def _box(mark: Mark) -> tuple[float, float, float, float]:
    """Left, top, right and bottom of a text or panel."""
    if isinstance(mark, Panel):
        return mark.left, mark.top, mark.left + mark.width, mark.top + mark.height
    assert isinstance(mark, Text)
    width = text_width(mark.text, mark.size, mark.weight)
    left = mark.x - {"left": 0.0, "centre": 0.5, "right": 1.0}[mark.anchor] * width
    return left, mark.y - 0.6 * mark.size, left + width, mark.y + 0.6 * mark.size
