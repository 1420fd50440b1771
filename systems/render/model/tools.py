"""Tools: previews of drawings and drags, over the picture of the model."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from pinjoint.components.view import Preview
from pinjoint.systems.render.clip import clip_segments
from pinjoint.systems.render.marks import Fills, Mark, Panel, Points, Stamps, Strokes, Text
from pinjoint.systems.render.model.sheet import DIRECTIONS, Sheet
from pinjoint.systems.render.symbols import SUPPORT_DEPTH
from pinjoint.systems.render.theme import Colour, faded
from pinjoint.systems.render.typography import line_height, text_width, wrapped

_WIDTH = 2.5  # points, of lines
_APART, _MOST_ARROWS = 26.0, 40  # points between arrows along a rod, and how many there are at most
_ARC = 24.0  # points, radius of a moment's


def draw_flashes(sheet: Sheet) -> list[Mark]:
    """Flashes where particles collided just now."""
    at = sheet.view.camera.to_pixels(sheet.view.flashes)
    at = at[np.isfinite(at).all(axis=1)]
    if len(at) == 0:
        return []
    colour = sheet.theme.ink
    return [Stamps("disc", at, 7.0 * sheet.unit, sheet.unit, faded(colour, 0.25), faded(colour, 0.8))]


def draw_trails(sheet: Sheet) -> list[Mark]:
    """Where what is selected was in the run so far."""
    colour, places = faded(sheet.theme.sketch, 0.6), sheet.view.trails.places
    paths = sheet.view.camera.to_pixels(places).transpose(1, 0, 2)
    return [mark for path in paths for mark in _lines(sheet, path, colour, 1.5)]


def draw_preview(sheet: Sheet) -> list[Mark]:
    """The rod, arrow, spring, support or box of a gesture, with its value at the end."""
    preview = sheet.view.preview
    if preview is None:
        return []
    start, end = sheet.view.camera.to_pixels([preview.start, preview.end])
    if not np.isfinite([start, end]).all():
        return []
    drawn = _KINDS[preview.kind](sheet, start, end)
    if preview.before:
        drawn += _lines(
            sheet, sheet.view.camera.to_pixels([*preview.before, preview.start]), sheet.theme.sketch
        )
    for ends in preview.along:
        drawn += _along(sheet, sheet.view.camera.to_pixels(ends), end - start)
    for joint in preview.joints:
        drawn += _hinge(sheet, sheet.view.camera.to_pixels(joint), end)
    if preview.typed:
        end = np.array(sheet.view.pixel)
    return [*drawn, *(_label(sheet, preview, end) if preview.label or preview.typed else [])]


def _rod(sheet: Sheet, start: Points, end: Points) -> list[Mark]:
    colour = sheet.theme.sketch
    dot = Stamps("disc", np.array([start, end]), 4.0 * sheet.unit, sheet.unit, colour, colour)
    return [*_lines(sheet, np.array([start, end]), colour), dot]


def _pull(sheet: Sheet, start: Points, end: Points) -> list[Mark]:
    """A spring to the pointer: straight at both ends, coils between."""
    colour, u = sheet.theme.load, sheet.unit
    along = end - start
    length = float(np.hypot(*along))
    hook = Stamps("disc", end[None], 4.0 * u, u, colour, colour)
    if length < 12.0 * u:
        return [hook]
    share = np.concatenate([[0.0], np.linspace(0.2, 0.8, 18), [1.0]])
    side = np.where(np.arange(len(share)) % 2, 1.0, -1.0) * 5.0 * u
    side[[0, 1, -2, -1]] = 0.0
    normal = np.array([along[1], -along[0]]) / length
    return [*_lines(sheet, start + share[:, None] * along + side[:, None] * normal, colour, 1.5), hook]


def _support(symbol: str, sheet: Sheet, start: Points, end: Points) -> list[Mark]:
    """A support's symbol, turned to the side to which it was dragged."""
    theme, side = sheet.theme, int(np.argmax(DIRECTIONS @ (end - start)))
    return [
        Stamps(symbol, start[None], SUPPORT_DEPTH * sheet.unit, sheet.unit, theme.sketch, theme.hollow, side)
    ]


def _box(sheet: Sheet, start: Points, end: Points) -> list[Mark]:
    low, high = sheet.viewport.corners
    (x0, y0), (x1, y1) = np.clip([start, end], low - 10.0, high + 10.0)
    corners = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]])
    colour = sheet.theme.sketch
    return [Fills(corners[None, :4], faded(colour, 0.1)), *_lines(sheet, corners, faded(colour, 0.8), 1.0)]


def _arrow(sheet: Sheet, start: Points, end: Points, colour: Colour) -> list[Mark]:
    along = end - start
    length = float(np.hypot(*along))
    if length < 1.0:
        return []
    forward = along / length
    across = np.array([forward[1], -forward[0]])
    head = min(12.0 * sheet.unit, length)
    neck = end - head * forward
    point = np.array([end, neck + 0.5 * head * across, neck - 0.5 * head * across])
    return [*_lines(sheet, np.array([start, neck + 0.2 * head * forward]), colour), Fills(point[None], colour)]


def _along(sheet: Sheet, ends: Points, force: Points) -> list[Mark]:
    """Arrows of one force all along a rod, which point to it, and the line from which they come."""
    colour, length = sheet.theme.load, float(np.hypot(*(ends[1] - ends[0])))
    size = float(np.hypot(*force))
    if not np.isfinite(ends).all() or size < 1.0:
        return []
    back = force * min(1.0, 60.0 * sheet.unit / size)
    count = int(np.clip(length / (_APART * sheet.unit), 1, _MOST_ARROWS))
    feet = ends[0] + np.linspace(0.0, 1.0, count + 1)[:, None] * (ends[1] - ends[0])
    arrows = [mark for foot in feet for mark in _arrow(sheet, foot - back, foot, colour)]
    return [*_lines(sheet, ends - back, colour, 1.5), *arrows]


def _moment(sheet: Sheet, start: Points, end: Points) -> list[Mark]:
    """An arc around the particle, from above it to the side of the pointer; to the left counter-clockwise."""
    away = float(end[0] - start[0])
    if away == 0.0:
        return []
    sweep = np.linspace(0.0, np.clip(abs(away) / (100.0 * sheet.unit), 0.25, 1.0) * 1.5 * np.pi, 25)
    side = np.copysign(1.0, away)
    points = start + _ARC * sheet.unit * np.column_stack([side * np.sin(sweep), -np.cos(sweep)])
    return [
        *_lines(sheet, points[:-2], sheet.theme.load),
        *_arrow(sheet, points[-4], points[-1], sheet.theme.load),
    ]


def _hinge(sheet: Sheet, start: Points, end: Points) -> list[Mark]:
    """A ring where a click acts."""
    colour = sheet.theme.sketch
    return [Stamps("disc", start[None], 7.0 * sheet.unit, 2.0 * sheet.unit, faded(colour, 0.25), colour)]


def _lines(sheet: Sheet, points: Points, colour: Colour, width: float = _WIDTH) -> list[Mark]:
    """Lines through points (n, 2), as far as they can be seen."""
    start, end, _ = clip_segments(points[:-1], points[1:], *sheet.viewport.corners)
    return [Strokes(start, end, width * sheet.unit, colour)] if len(start) else []


def _label(sheet: Sheet, preview: Preview, at: Points) -> list[Mark]:
    """The value beside the end, inside the viewport; below what is typed at the pointer, and why that is refused instead."""
    u, v, theme, size = sheet.unit, sheet.viewport, sheet.theme, sheet.font(13.0)
    lines = [(preview.label, theme.muted if preview.typed else theme.text)] * bool(preview.label)
    if preview.problem:
        refused = wrapped(preview.problem, 240.0 * u, size, "semibold")
        lines = [(line, theme.problem) for line in refused]
    lines = [(text.replace("-", "−"), ink) for text, ink in ((preview.typed, theme.text), *lines) if text]
    width = max(text_width(text, size, "semibold") for text, _ in lines) + 14.0 * u
    apart = line_height(size)
    height = len(lines) * apart + 6.0 * u
    left = float(np.clip(at[0] + 14.0 * u, v.left, max(v.right - width, v.left)))
    top = float(np.clip(at[1] - 14.0 * u - height, v.top, max(v.bottom - height, v.top)))
    sheet.occupancy.block(left, top, width, height)
    middles = (top + 3.0 * u + (number + 0.5) * apart for number in range(len(lines)))
    return [
        Panel(left, top, width, height, 5.0 * u, faded(theme.panel, 0.94), theme.line),
        *(
            Text(text, left + 7.0 * u, middle, size, ink, "semibold")
            for (text, ink), middle in zip(lines, middles, strict=True)
        ),
    ]


_KINDS: dict[str, Callable[[Sheet, Points, Points], list[Mark]]] = {
    "": lambda sheet, start, end: [],
    "rod": _rod,
    "force": lambda sheet, start, end: _arrow(sheet, start, end, sheet.theme.load),
    "distributed force": lambda sheet, start, end: [],
    "moment": _moment,
    "hinge": _hinge,
    "velocity": lambda sheet, start, end: _arrow(sheet, start, end, sheet.theme.ink),
    "roller": partial(_support, "roller"),
    "pinned": partial(_support, "pinned"),
    "guided": partial(_support, "guided"),
    "clamped": partial(_support, "clamped"),
    "pull": _pull,
    "box": _box,
}
