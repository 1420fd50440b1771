"""Placing: where new and moved particles lie, on the grid if near it."""

from __future__ import annotations

import math

import numpy as np

from pinjoint.components.field import Vector
from pinjoint.components.handle import Handle
from pinjoint.components.language import begun
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.view import View, drawn_positions
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.picking import PARTICLE_REACH, pick_point

SNAP_REACH = 5.0  # points from a grid line


def snapped(model: Model, view: View, point: Vector) -> Vector:
    """A point (m) moved onto the lines of the shown grid within reach, each axis by itself.

    Other points are rounded to a power of ten of at most a pixel, so that numbers stay short.
    """
    shown = np.flatnonzero(model.grids.shown)
    spacing = model.grids.spacing[shown[-1]].tolist() if len(shown) else (math.inf, math.inf)
    found = []
    for value, step in zip(point, spacing, strict=True):
        # 3 × 0.1 is 0.3
        line = float(f"{round(value / step) * step:.12g}") if math.isfinite(step) else math.inf
        near = abs(line - value) * view.camera.scale <= SNAP_REACH * view.pixel_ratio
        found.append((line if near else round(value, _digits(view))) + 0.0)  # no −0
    return found[0], found[1]


def snapped_to_points(model: Model, view: View, pixel: Vector, besides: Handle | None = None) -> Vector:
    """The point (m) under a pixel: that of another element, within reach, else on the grid if near it."""
    grip = pick_point(model, view, pixel, besides)
    return snapped(model, view, view.camera.to_model(pixel)) if grip is None else grip.place


def resolution(view: View) -> float:
    """The power of ten (m) that is nearest below a pixel."""
    return float(10.0 ** -_digits(view))


def _digits(view: View) -> int:
    return math.ceil(math.log10(view.camera.scale) - 1e-9)


def place(model: Model, view: View, pixel: Vector) -> Particle:
    """A new particle under a pixel, on the grid if near it. Raises Refusal if one is there already."""
    return place_at(model, view, snapped(model, view, view.camera.to_model(pixel)))


def place_at(model: Model, view: View, point: Vector) -> Particle:
    """A new particle at a point (m). Raises Refusal if one is there already."""
    check_free(model, view, point)
    return model.create(Particle, position=[point])[0]


def check_free(model: Model, view: View, point: Vector, besides: list[Particle] | None = None) -> None:
    """Raise Refusal if a particle other than those in `besides` is drawn at a point (m)."""
    if model.particles.count == 0:
        return
    distance = np.hypot(*(drawn_positions(model) - point).T) * view.camera.scale
    distance[model.row_of_entity[[particle.entity for particle in besides or []]]] = math.inf
    nearest = int(np.argmin(distance))
    if distance[nearest] <= PARTICLE_REACH * view.pixel_ratio:
        name = model.describe(model.particles[nearest])
        raise Refusal("{particle} is here already; choose another place, or zoom in.", particle=begun(name))
