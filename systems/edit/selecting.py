"""Selecting: which elements lie in a box."""

from __future__ import annotations

import numpy as np

from components.field import Vector
from components.handle import Handle
from components.kind import outlines
from components.model import Model
from components.view import drawn_positions


def inside(model: Model, corner: Vector, opposite: Vector) -> list[Handle]:
    """Particles drawn inside the box between two points (m), and elements with all ends or points inside."""
    low, high = np.minimum(corner, opposite), np.maximum(corner, opposite)
    drawn = drawn_positions(model)
    within = np.asarray(((drawn >= low) & (drawn <= high)).all(axis=1))
    rods = within[model.rods.between].all(axis=1)
    return [
        *(model.particles[row] for row in np.flatnonzero(within).tolist()),
        *(model.rods[row] for row in np.flatnonzero(rods).tolist()),
        *(
            table[row]
            for table, points in outlines(model)
            for row in np.flatnonzero(((points >= low) & (points <= high)).all(axis=(1, 2))).tolist()
        ),
    ]


def everything(model: Model) -> list[Handle]:
    """All particles and rods, and the elements of mods that have a place."""
    return [*model.particles, *model.rods, *(handle for table, _ in outlines(model) for handle in table)]
