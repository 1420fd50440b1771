"""Shape: a mechanism or mode of vibration, as a second, thin structure over the model."""

from __future__ import annotations

import numpy as np

from systems.render.clip import bounds, clip_segments
from systems.render.labels import FAINT
from systems.render.marks import Discs, Strokes
from systems.render.sheet import Sheet
from systems.render.theme import faded

_WIDTH, _RADIUS, _OPACITY = 1.5, 2.5, 0.75  # points, points
_MOVES_FROM = 0.5  # points


def draw_shape(sheet: Sheet) -> None:
    """The moving part of the structure, displaced by the shape from the state that the shape is about."""
    shape, position = sheet.view.shape, sheet.model.particles.position
    if shape is None or shape.displacement.shape != position.shape:
        return
    if shape.about is not None:
        position = position + shape.about * sheet.model.settings.displacement_scale
    places = sheet.view.camera.to_pixels(position + shape.displacement)
    colour = faded(sheet.theme.hover, _OPACITY)
    pixels = np.hypot(*shape.displacement.T) * sheet.view.camera.scale
    moving = pixels > _MOVES_FROM * sheet.unit
    ends = sheet.ends[moving[sheet.ends].any(axis=1)]
    start, end, _ = clip_segments(places[ends[:, 0]], places[ends[:, 1]], *bounds(sheet.viewport))
    if len(start):
        sheet.occupancy.line(start, end, FAINT)
        sheet.marks.append(Strokes(start, end, _WIDTH * sheet.unit, colour))
    dots = places[moving & sheet.sees(places)]
    if len(dots):
        sheet.marks.append(Discs(dots, np.full(len(dots), _RADIUS * sheet.unit), colour, colour))
