"""Toolbar: its strip, the tip of the button under the pointer, the help and an open menu, over everything else."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pinjoint.components.camera import Rectangle
from pinjoint.components.toolbar import BUTTON, EDGE, GAP, Tool, Toolbar
from pinjoint.components.view import Hit, View
from pinjoint.systems.render.buttons import button, titled, tool_icon, written_key
from pinjoint.systems.render.help import put_help
from pinjoint.systems.render.layout import Column, Gap, Paper, Part, Plate, Row, Text
from pinjoint.systems.render.marks import Mark, Panel, Picture
from pinjoint.systems.render.marks import Text as Written
from pinjoint.systems.render.menu import put_menu
from pinjoint.systems.render.theme import Theme
from pinjoint.systems.render.typography import in_rows, text_width


def compose_toolbar(toolbar: Toolbar, view: View, theme: Theme, below: Sequence[Picture] = ()) -> Picture:
    """The toolbar in its strip of a view; without a background, since it lies over the pictures below."""
    paper = Paper(view.pixel_ratio, view.pointer)
    if view.strip.width:
        _put_strip(paper, toolbar, view, theme)
    pointed = next((hit for hit in paper.hits if hit.item and paper.is_under_pointer(hit)), None)
    put_help(paper, view, view.canvas, theme)
    if pointed is not None and view.menu is None and view.pressed is None:
        _put_tip(paper, pointed, view, theme, below)
    put_menu(paper, view, theme)
    return Picture(view.camera.viewport, None, paper.marks, hits=paper.hits)


def _put_strip(paper: Paper, toolbar: Toolbar, view: View, theme: Theme) -> None:
    """The bar with a hairline at its right edge, and its buttons, the last group at the bottom."""
    s, thin = view.strip, max(round(paper.unit), 1)
    paper.marks.append(Panel(*s.box, 0.0, theme.panel))
    paper.marks.append(Panel(s.right - thin, s.top, thin, s.height, 0.0, theme.line))
    columns, high = toolbar.columns(view.camera.viewport, paper.unit)
    parts: list[Part] = []
    for number, group in enumerate(toolbar.groups):
        if number:
            parts.append(Gap(high=GAP, grow=float(number == len(toolbar.groups) - 1)))
        parts += [
            Row([_button(tool, theme) for tool in row], high=high) for row in in_rows(list(group), columns)
        ]
    paper.put(Plate(Column(parts, around=(EDGE, EDGE, EDGE)), action="", wheel=("", "")), s)


def _button(tool: Tool, theme: Theme) -> Plate:
    sign = tool_icon(tool, theme, BUTTON[0])
    return button(sign, tool.action, theme, enabled=tool.enabled, pressed=tool.pressed, item=tool, again=True)


def _put_tip(paper: Paper, place: Hit, view: View, theme: Theme, below: Sequence[Picture]) -> None:
    """The title and the key of a button, near by where they cover nothing that is said."""
    tool = place.item
    key = [Text(written_key(tool.key), 12.0, theme.muted, "semibold")] if tool.key else []
    row = Row((Text(titled(tool), 12.0, theme.text), *key), 14.0, (10.0, 5.0, 5.0))
    size = row.width(paper.unit), row.height(paper.unit, np.inf)
    at = _free_place(place.middle[1] - size[1] / 2, *size, view, below)
    paper.put(Plate(row, theme.background, theme.line, radius=6.0), Rectangle(*at, *size))


def _free_place(
    top: float, width: float, height: float, view: View, below: Sequence[Picture]
) -> tuple[float, float]:
    """Left and top of the place nearest to the strip's edge at `top` where a box covers no text and no panel."""
    u, window, gap = view.pixel_ratio, view.camera.viewport, 2.0 * view.pixel_ratio
    lefts = np.arange(view.strip.right + 6.0 * u, window.right - width - gap, 12.0 * u)
    tops = np.arange(window.top + gap, window.bottom - height - gap, 4.0 * u)
    nearest = view.strip.right + 6.0 * u, min(max(top, window.top + gap), window.bottom - height - gap)
    places = np.array([nearest, *((x, y) for x in lefts for y in tops)])
    places = places[np.argsort(np.hypot(*(places - nearest).T), kind="stable")]
    size = np.array([width, height])
    for box in np.array([box for picture in below for mark in picture.marks if (box := _box(mark))]):
        apart = (places <= box[:2] - size - gap) | (places >= box[2:] + gap)
        if len(places := places[apart.any(axis=1)]) == 0:
            return nearest
    left, upper = places[0].tolist()
    return left, upper


def _box(mark: Mark) -> tuple[float, float, float, float] | None:
    """Left, top, right and bottom of a text, or of a panel on which something stands."""
    if isinstance(mark, Panel) and mark.outline is not None:
        return mark.left, mark.top, mark.left + mark.width, mark.top + mark.height
    if not isinstance(mark, Written):
        return None
    width = text_width(mark.text, mark.size, mark.weight)
    left = mark.x - {"left": 0.0, "centre": 0.5, "right": 1.0}[mark.anchor] * width
    return left, mark.y - 0.6 * mark.size, left + width, mark.y + 0.6 * mark.size
