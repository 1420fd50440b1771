"""Toolbar: its strip, the tip of the button under the pointer, the help and an open menu, over everything else."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pinjoint.components.camera import Rectangle
from pinjoint.components.language import begun, tr
from pinjoint.components.toolbar import BUTTON, EDGE, GAP, NAME, Tool, Toolbar
from pinjoint.components.view import Hit, View
from pinjoint.systems.render.labels.occupancy import STRONG, Occupancy
from pinjoint.systems.render.marks import Panel, Picture
from pinjoint.systems.render.theme import Theme
from pinjoint.systems.render.typography import in_rows
from pinjoint.systems.render.ui.buttons import button, ink_of, tool_icon, written_key
from pinjoint.systems.render.ui.help import put_help
from pinjoint.systems.render.ui.layout import Column, Gap, Paper, Part, Plate, Row, Text
from pinjoint.systems.render.ui.menu import put_menu

_BESIDE = 6.0  # points at the left of the name of a group


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
    columns, high, wide, named = toolbar.arranged(view.camera.viewport, paper.unit)
    parts: list[Part] = []
    for number, (name, group) in enumerate(zip(toolbar.names, toolbar.groups, strict=True)):
        if number:
            parts.append(Gap(high=GAP, grow=float(number == len(toolbar.groups) - 1)))
        if named:
            said = Text(name, (10.5, 9.5, 9.0), theme.muted, "semibold", apart=NAME, grow=1.0)
            parts.append(Row((said,), around=(_BESIDE, 0.0, 0.0), high=NAME))
        parts += [
            Row([_button(tool, theme, wide) for tool in row], high=high)
            for row in in_rows(list(group), columns)
        ]
    paper.put(Plate(Column(parts, around=(EDGE, EDGE, EDGE)), action="", wheel=("", "")), s)


def _button(tool: Tool, theme: Theme, wide: float) -> Plate:
    inside: Part = tool_icon(tool, theme, BUTTON[0])
    if wide > BUTTON[0]:
        ink, said = ink_of(theme, enabled=tool.enabled, pressed=tool.pressed), begun(tool.word or tool.title)
        inside = Row((inside, Text(said, (12.0, 11.0, 10.0, 9.0), ink, wide=wide - BUTTON[0] - 2.0)), wide=wide)
    return button(inside, tool.action, theme, enabled=tool.enabled, pressed=tool.pressed, item=tool, again=True)


def _put_tip(paper: Paper, place: Hit, view: View, theme: Theme, below: Sequence[Picture]) -> None:
    """The title and the key of a button, near by where they cover nothing that is said."""
    tool = place.item
    key = [Text(written_key(tool.key), 12.0, theme.muted, "semibold")] if tool.key else []
    row = Row((Text(begun(tr(tool.title)), 12.0, theme.text), *key), 14.0, (10.0, 5.0, 5.0))
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
    size, taken = np.array([width, height]), Occupancy(window, u)
    for picture in below:
        taken.block_marks(picture.marks)
    free = taken.are_free(taken.cells_of(places - gap, size + 2.0 * gap), STRONG)
    left, upper = places[int(free.argmax())].tolist()
    return left, upper
