"""Picking: which element lies under a pixel."""

from __future__ import annotations

import numpy as np

from components.field import Vector
from components.grid import Grid
from components.model import Model
from components.particle import Particle
from components.rod import Rod
from components.view import View, drawn_positions
from components.world import Handle

PARTICLE_REACH = 8.0  # points from the centre, at least its radius
ROD_REACH = 10.0  # points
GRID_REACH = 5.0  # points


def pick(model: Model, view: View, pixel: Vector) -> Handle | None:
    """The particle, else the rod, else the shown grid under a pixel; None if there is nothing to be seen."""
    if view.strip.contains(pixel):
        return None
    return pick_particle(model, view, pixel) or pick_rod(model, view, pixel) or _grid_at(model, view, pixel)


def pick_particle(model: Model, view: View, pixel: Vector) -> Particle | None:
    """The particle that is nearest to being hit at a pixel, if one is; none under the toolbar."""
    if model.particles.count == 0 or view.strip.contains(pixel):
        return None
    x, y = (view.camera.to_pixels(drawn_positions(model)) - pixel).T
    reach = np.maximum(model.particles.radius * view.camera.scale, PARTICLE_REACH * view.pixel_ratio)
    beyond = np.hypot(x, y) - reach
    nearest = int(np.argmin(beyond))
    return model.particles[nearest] if beyond[nearest] <= 0.0 else None


def pick_rod(model: Model, view: View, pixel: Vector) -> Rod | None:
    """The nearest rod within reach of a pixel."""
    if model.rods.count == 0:
        return None
    x, y = (view.camera.to_pixels(drawn_positions(model)) - pixel).T
    first, last = model.rods.between.astype(np.intp).T
    start_x, start_y = x[first], y[first]
    along_x, along_y = x[last] - start_x, y[last] - start_y
    squared = along_x**2 + along_y**2
    share = -(start_x * along_x + start_y * along_y) / np.where(squared > 0.0, squared, 1.0)
    share = np.minimum(np.maximum(share, 0.0), 1.0)  # of the rod, up to its point nearest to the pixel
    distance = (start_x + share * along_x) ** 2 + (start_y + share * along_y) ** 2
    nearest = int(np.argmin(distance))
    return model.rods[nearest] if distance[nearest] <= (ROD_REACH * view.pixel_ratio) ** 2 else None


def _grid_at(model: Model, view: View, pixel: Vector) -> Grid | None:
    reach = GRID_REACH * view.pixel_ratio
    for row in np.flatnonzero(model.grids.shown).tolist():
        grid = model.grids[row]
        point = view.camera.to_model(pixel)
        for value, spacing in zip(point, grid.spacing, strict=True):
            offset = abs(value - round(value / spacing) * spacing) * view.camera.scale
            if spacing * view.camera.scale > 2 * reach and offset <= reach:
                return grid
    return None
