"""Picking: which element lies under a pixel."""

from __future__ import annotations

import numpy as np

from components.camera import Camera
from components.field import Vector
from components.grid import Grid
from components.model import Model
from components.particle import Particle
from components.rod import Rod
from components.view import drawn_positions
from components.world import Handle

PARTICLE_REACH = 8.0  # px from the centre, at least its radius
ROD_REACH = 10.0  # px
GRID_REACH = 5.0  # px


def pick(model: Model, camera: Camera, pixel: Vector) -> Handle | None:
    """The particle, else the rod, else the shown grid under a pixel; None if there is nothing."""
    return _particle_at(model, camera, pixel) or _rod_at(model, camera, pixel) or _grid_at(model, camera, pixel)


def _particle_at(model: Model, camera: Camera, pixel: Vector) -> Particle | None:
    if model.particles.count == 0:
        return None
    distance = np.hypot(*(camera.to_pixels(drawn_positions(model)) - pixel).T)
    reach = np.maximum(model.particles.radius * camera.scale, PARTICLE_REACH)
    nearest = int(np.argmin(distance - reach))
    return model.particles[nearest] if distance[nearest] <= reach[nearest] else None


def _rod_at(model: Model, camera: Camera, pixel: Vector) -> Rod | None:
    if model.rods.count == 0:
        return None
    ends = camera.to_pixels(drawn_positions(model))[model.rods.between.astype(np.intp)]
    start, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    squared = (along**2).sum(axis=1)
    share = ((pixel - start) * along).sum(axis=1) / np.where(squared > 0.0, squared, 1.0)
    foot = start + np.clip(share, 0.0, 1.0)[:, None] * along
    distance = np.hypot(*(foot - pixel).T)
    nearest = int(np.argmin(distance))
    return model.rods[nearest] if distance[nearest] <= ROD_REACH else None


def _grid_at(model: Model, camera: Camera, pixel: Vector) -> Grid | None:
    for grid in model.grids:
        if not grid.shown:
            continue
        point = camera.to_model(pixel)
        for value, spacing in zip(point, grid.spacing, strict=True):
            offset = abs(value - round(value / spacing) * spacing) * camera.scale
            if spacing * camera.scale > 2 * GRID_REACH and offset <= GRID_REACH:
                return grid
    return None
