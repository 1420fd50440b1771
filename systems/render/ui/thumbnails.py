"""Thumbnails: small pictures of models that do not change, with what happens in them, inside their cards."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from pinjoint.components.bent import MOMENT
from pinjoint.components.camera import Camera, Viewport
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.model import Model
from pinjoint.components.view import View, drawn_places
from pinjoint.systems.render.marks import Bars, Discs, Fills, Mark, Points, Stamps, Strokes
from pinjoint.systems.render.model.arrows import draw_loads, draw_velocities
from pinjoint.systems.render.model.diagrams import draw_diagrams
from pinjoint.systems.render.model.members import draw_hinges, draw_inextensible, draw_moments, draw_span_loads
from pinjoint.systems.render.model.sheet import measure
from pinjoint.systems.render.model.structure import draw_particles, draw_rods
from pinjoint.systems.render.model.supports import draw_supports, support_sides
from pinjoint.systems.render.symbols import turned_parts
from pinjoint.systems.render.theme import Theme, faded
from pinjoint.systems.render.ui.overlays import taken_by_heading

_SMALLER, _USUAL = 0.6, 84.0  # symbols, compared with those in a model; in less high ones (points) smaller yet
_EDGE = 4.0  # points that stay free within the card
_MARGIN = 12.0  # points around a model to begin with
_SAFE, _ENOUGH = 0.99, 1.12  # of the scale that seems to fit, the one to try; how much larger it could be
_TINT = 0.16  # share of the colour of loads in the paper of discs


@lru_cache(maxsize=128)
def thumbnail(model: Model, viewport: Viewport, unit: float, theme: Theme) -> tuple[Mark, ...]:
    """A small picture of a fixed model: walls, rods with their forces, supports, particles and arrows."""
    camera, places = Camera(viewport=viewport), _finite(drawn_places(model))
    camera.fit(places, _MARGIN, unit=unit)
    room = np.array([viewport.width, viewport.height]) - 2 * _EDGE * unit
    for _ in range(4):  # arrows and symbols keep their size
        marks = _marks(model, camera, unit, theme)
        low, high = extent(marks)
        span = camera.scale * np.ptp(places, axis=0) if len(places) else np.zeros(2)
        around = high - low - span  # what arrows and symbols add, whatever the scale
        wide = span > 1e-9
        ratio = float(((room - around)[wide] / span[wide]).min()) if wide.any() else 1.0
        middle = np.array(viewport.middle)
        if (
            1.0 <= ratio < _ENOUGH
            and (np.abs((low + high) / 2 - middle) <= (room - (high - low)) / 2 + 1.0).all()
        ):
            break
        camera.pan(tuple((middle - (low + high) / 2).tolist()))
        camera.scale *= min(max(_SAFE * ratio, 0.2), 1.5)
    return marks


def extent(marks: Iterable[Mark]) -> tuple[Points, Points]:
    """The corners (2,) of the smallest upright box around what some marks draw, texts and panels left out."""
    corners = np.concatenate([np.zeros((0, 2)), *(_corners(mark) for mark in marks)])
    corners = _finite(corners)
    if not len(corners):
        return np.zeros(2), np.zeros(2)
    return corners.min(axis=0), corners.max(axis=0)


def _corners(mark: Mark) -> Points:
    match mark:
        case Strokes():
            half = mark.width / 2
            ends = np.concatenate([mark.start, mark.end])
            return np.concatenate([ends - half, ends + half])
        case Fills() | Bars():
            return mark.corners.reshape(-1, 2)
        case Discs():
            reach = mark.radius[:, None]
            return np.concatenate([mark.at - reach, mark.at + reach])
        case Stamps():
            shape = np.concatenate([polygon for _, polygon in turned_parts(mark)])
            return (mark.at[:, None] + shape).reshape(-1, 2)
        case _:
            return np.zeros((0, 2))


def _finite(points: Points) -> Points:
    return points[np.isfinite(points).all(axis=1)]


def _marks(model: Model, camera: Camera, unit: float, theme: Theme) -> tuple[Mark, ...]:
    red, green, blue = (
        round((1.0 - _TINT) * paper + _TINT * ink)
        for paper, ink in zip(theme.hollow[:3], theme.focus[:3], strict=True)
    )
    shown = replace(theme, hollow=(red, green, blue, 255))  # so that discs are seen as bodies
    smaller = _SMALLER * min(camera.viewport.height / (_USUAL * unit), 1.0)
    view = View(camera=replace(camera), pixel_ratio=smaller * unit, all_diagrams=True, quantity=MOMENT)
    sheet = measure(model, view, shown)
    for layer in EXTENSIONS.below:
        sheet.marks += layer(sheet)
    below = len(sheet.marks)
    draw_diagrams(sheet, taken_by_heading(sheet))
    sheet.marks[below:] = [
        replace(mark, colour=faded(mark.colour, 0.4)) if isinstance(mark, Bars) else mark
        for mark in sheet.marks[below:]
    ]
    draw_supports(sheet, support_sides(sheet))
    draw_rods(sheet)
    draw_particles(sheet)
    draw_hinges(sheet)
    draw_inextensible(sheet)
    draw_span_loads(sheet)
    sheet.view.all_diagrams = False  # arrows of one length; the values of diagrams are left out
    draw_moments(sheet)
    draw_loads(sheet)
    draw_velocities(sheet)
    return tuple(sheet.marks)
