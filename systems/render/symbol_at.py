"""Symbol at: whose arrow, moment or support a pixel shows, by the same functions that draw them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pinjoint.components.field import Vector
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.view import View
from pinjoint.systems.broad_phase import distance_to_segments
from pinjoint.systems.render.arrows import draw_loads, draw_particle_diagrams, draw_velocities
from pinjoint.systems.render.free_bodies import draw_free_bodies
from pinjoint.systems.render.marks import Fills, Mark, Owners, Points, Stamps, Strokes
from pinjoint.systems.render.members import draw_distributed_forces, draw_moments
from pinjoint.systems.render.sheet import DIRECTIONS, MANY, Sheet, measure
from pinjoint.systems.render.supports import draw_supports, support_sides
from pinjoint.systems.render.theme import load_theme

REACH = 6.0  # points from the lines of an arrow

_Lines = tuple[Points, Points, float, Owners]  # from, to, reach in pixels beside them, and whose each is


def symbol_at(model: Model, view: View, pixel: Vector) -> Particle | Rod | None:
    """The particle or rod whose arrow or support lies under a pixel, of a load the particle that bears it.

    None in large models, and while something is drawn, when a click means a place.
    """
    elsewhere = view.covers(pixel) or not view.camera.viewport.contains(pixel)
    if elsewhere or view.tool or view.preview is not None or model.particles.count > MANY:
        return None
    sheet = measure(model, view, load_theme(view.theme))
    best, found = np.inf, None
    for start, end, reach, of in (lines for mark in _symbols(sheet) for lines in _lines_of(mark, sheet.unit)):
        away = distance_to_segments(np.array(pixel), start, end)
        if len(away) and (nearest := int(np.argmin(away))) >= 0 and away[nearest] <= min(reach, best):
            best, found = float(away[nearest]), (of[0], int(of[1][nearest]))
    if found is None:
        return None
    table, row = found if found[0] != "loads" else ("particles", int(model.loads.on[found[1]]))
    return model.rods[row] if table == "rods" else model.particles[row]


def _symbols(sheet: Sheet) -> list[Mark]:
    """The marks of supports and arrows as the picture has them."""
    if sheet.view.free_bodies and sheet.view.forces_known:
        draw_free_bodies(sheet)
        draw_distributed_forces(sheet)
        return sheet.marks
    sides = support_sides(sheet)
    draw_supports(sheet, sides)
    draw_distributed_forces(sheet)
    draw_loads(sheet)
    draw_velocities(sheet)
    draw_moments(sheet)
    draw_particle_diagrams(sheet, sides)
    return sheet.marks


def _lines_of(mark: Mark, unit: float) -> Iterator[_Lines]:
    """The lines along which a mark of elements lies."""
    match mark:
        case Strokes(start, end, _, _, (str(), _) as of):
            yield start, end, REACH * unit, of
        case Fills(corners, _, (str(), _) as of):
            for k in range(corners.shape[1]):
                yield corners[:, k - 1], corners[:, k], REACH * unit, of
        case Stamps(_, at, size, turns=turns, of=(str(), _) as of):
            yield at, at + size * DIRECTIONS[turns], size / 2, of
