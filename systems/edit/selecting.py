"""Selecting: which elements lie in a box."""

from __future__ import annotations

import numpy as np

from components.field import Vector
from components.model import Model
from components.view import drawn_positions
from components.world import Handle


def inside(model: Model, corner: Vector, opposite: Vector) -> list[Handle]:
    """Particles drawn inside the box between two points (m), and rods with both ends inside."""
    low, high = np.minimum(corner, opposite), np.maximum(corner, opposite)
    drawn = drawn_positions(model)
    within = np.asarray(((drawn >= low) & (drawn <= high)).all(axis=1))
    rods = within[model.rods.between].all(axis=1)
    return [
        *(model.particles[row] for row in np.flatnonzero(within).tolist()),
        *(model.rods[row] for row in np.flatnonzero(rods).tolist()),
    ]


def everything(model: Model) -> list[Handle]:
    """All particles and rods."""
    return [*model.particles, *model.rods]
