"""The card of an empty model: the tools with which one begins, as buttons with their names."""

from __future__ import annotations

import numpy as np

from pinjoint.components.camera import Rectangle
from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.components.view import View
from pinjoint.systems.render.marks import Mark, Stamps, Strokes
from pinjoint.systems.render.theme import Theme
from pinjoint.systems.render.ui.buttons import button, tool_icon, tool_row
from pinjoint.systems.render.ui.layout import Column, Drawn, Gap, Paper, Plate, Row, Text
from pinjoint.systems.render.ui.overlays import BAR

_FIRST = (
    "place",
    "rod",
    "rigid",
    "support",
    "force",
    "load",
    "toggle help",
)  # the tools, if the toolbar has them
_ROOMY = 420.0  # points: a canvas high enough for an emblem


def put_card(paper: Paper, model: Model, view: View, theme: Theme) -> None:
    """The card in the middle of the canvas, where a model is empty, nothing is drawn, and its picture has all the room."""
    drawing = bool(view.tool) or view.preview is not None
    if model.particles.count or drawing or view.page is not None or view.aside is not None:
        return
    v, u = view.canvas, view.pixel_ratio
    known = {tool.action: tool for group in view.toolbar.groups for tool in group}
    there = view.strip.left, view.strip.top  # as by the toolbar
    rows = []
    for tool in (known[action] for action in _FIRST if action in known):
        sign = Row((tool_icon(tool, theme, 20.0), Gap(14.0)))
        row = Row(
            (tool_row(tool, theme, sign, (13.0, 12.0, 11.0, 10.0), 26.0),), around=(12.0, 0.0, 0.0), high=27.0
        )
        rows.append(button(row, tool.action, theme, enabled=tool.enabled, item=tool, at=there))
    emblem = [Drawn(lambda at, u: _emblem(at, u, theme), high=66.0)] if v.height >= _ROOMY * u else []
    title = Text(tr("An empty model"), 20.0, theme.text, "semibold", "centre")
    card = Column(
        (*emblem, Column((title,), around=(0.0, 14.0, 10.0)), *rows), around=(12.0, 2.0, 14.0), wide=280.0
    )
    width = min(card.width(u), v.width - 28.0 * u)
    height = card.height(u, width)
    top = v.top + (v.height - BAR * u - height) / 2
    place = Rectangle(v.left + (v.width - width) / 2, top, width, height)
    paper.put(Plate(card, theme.background, theme.line, radius=12.0), place)


def _emblem(at: Rectangle, u: float, theme: Theme) -> list[Mark]:
    """Two small triangles of rods."""
    nodes = np.array([[-36.0, 18.0], [0.0, 18.0], [36.0, 18.0], [-18.0, -18.0], [18.0, -18.0]]) * u
    nodes += [at.middle[0], at.middle[1] + 14.0 * u]
    rods = np.array([[0, 1], [1, 2], [0, 3], [3, 1], [1, 4], [4, 2], [3, 4]])
    return [
        Strokes(nodes[rods[:, 0]], nodes[rods[:, 1]], 2.0 * u, theme.ghost),
        Stamps("ring", nodes, 5.0 * u, u, theme.ghost, theme.background),
    ]
