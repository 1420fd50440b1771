"""Arrows: forces and velocities drawn as arrows, to a round scale."""

from __future__ import annotations

import numpy as np

from pinjoint.components.field import Vector
from pinjoint.components.model import Model
from pinjoint.components.round_numbers import round_down
from pinjoint.components.view import View
from pinjoint.systems.edit.placing import SNAP_REACH

COMFORTABLE = 100.0  # points, length of an arrow of usual size
LONGEST = 400.0  # points, of the largest arrow before another scale is taken
USUAL_STRAIN = 1e-3  # of a loaded structure, where no force is known yet
USUAL_SLOPE = 0.1  # force × length² / bending stiffness of members, likewise
LEVER = 0.25  # of a moment, as a share of the extent
USUAL_ACCELERATION = 10.0  # m/s², of a loaded free body
USUAL_SPEED = 5.0  # m/s


def usual(model: Model, field: str) -> float:
    """The usual size of a vector of elements: the largest there is, else one that suits the model."""
    tables = [
        table for table in (model.particles, model.rods, model.loads, model.span_loads) if field in table.fields
    ]
    largest = max(float(np.abs(table.column(field)).max(initial=0.0)) for table in tables)
    if largest > 0.0:
        return largest
    if field == "velocity":
        return USUAL_SPEED
    if field == "moment":
        return LEVER * usual(model, "force") * extent(model)
    if field == "end_intensity":
        return usual(model, "distributed_force")
    rods = model.rods
    span = float(rods.original_length.max(initial=0.0)) or 1.0
    if field == "distributed_force":
        return usual(model, "force") / span
    if rods.count and (bending := rods.bending_stiffness.max()) > 0.0:
        return float(USUAL_SLOPE * bending / span**2)
    if rods.count:
        return float(USUAL_STRAIN * rods.stiffness.max())
    return float(USUAL_ACCELERATION * model.particles.mass.max(initial=1.0) / 1000.0)


def extent(model: Model) -> float:
    """The larger side (m) of the box around the particles' original places."""
    return float(np.ptp(model.particles.position, axis=0).max(initial=0.0)) or 1.0


def arrow_scale(model: Model, view: View, field: str) -> float:
    """How much of a vector one point of its arrow is: a round number, the same while the model is open.

    Only where the largest would be longer than a picture has room for, it is another one.
    """
    size, kept = usual(model, field), view.arrow_scales.get(field, 0.0)
    if size > LONGEST * kept:
        kept = view.arrow_scales[field] = round_down(size / COMFORTABLE)
    return kept


def arrow_value(view: View, start: Vector, pixel: Vector, scale: float) -> Vector:
    """The vector that an arrow from the point `start` (m) of the picture to a pixel stands for, by its scale.

    Whole points count; a component within reach of zero is zero.
    """
    origin = view.camera.to_pixels(start)
    across = (pixel[0] - origin[0]) / view.pixel_ratio
    up = (origin[1] - pixel[1]) / view.pixel_ratio
    x, y = (
        0.0 if abs(points) <= SNAP_REACH else float(f"{round(points) * scale:.12g}") for points in (across, up)
    )
    return x, y


def arrow_end(view: View, start: Vector, value: Vector, scale: float) -> Vector:
    """The point (m) of the picture where the arrow for a value ends."""
    metres = view.pixel_ratio / scale / view.camera.scale
    return start[0] + metres * value[0], start[1] + metres * value[1]
