"""Stability: whether forces of rods hold a structure in its present shape, found quickly enough for every frame."""

from __future__ import annotations

import numpy as np

from components.model import Model
from components.rod import nodes

LARGEST = 100  # rods up to which it is found: a fraction of a millisecond


def is_held(model: Model, *, at_first: bool = False) -> bool:
    """True if every small displacement of the nodes is resisted: the tangent stiffness is positive definite.

    at_first: as if no rod bore any force yet, so that mechanisms are not held, whatever tension keeps them in shape.

    K = Σ EA/L₀ d dᵀ + N/L (1 − d dᵀ) over the rods, d being their directions; yielding rods and slack cables have no EA.
    """
    particles, rods = model.particles, model.rods
    ends = rods.between.astype(np.intp)
    along = rods.difference + particles.displacement[ends[:, 1]] - particles.displacement[ends[:, 0]]
    length = np.maximum(np.hypot(*along.T), 1e-300)
    axial, across = rods.stiffness / rods.rest_length, np.zeros(rods.count)
    if not at_first:
        force = rods.axial_force
        axial = axial * ~(rods.yielding | (rods.tension_only & (force <= 0.0)))
        across = force / length
    directions = along / length[:, None]
    dyads = directions[:, :, None] * directions[:, None, :]
    block = axial[:, None, None] * dyads + across[:, None, None] * (np.eye(2) - dyads)
    size = 2 * particles.count
    full, of = np.zeros(size * size), 2 * ends[:, :, None] + np.arange(2)  # (m, 2 ends, 2 axes)
    for first, second, sign in ((0, 0, 1.0), (1, 1, 1.0), (0, 1, -1.0), (1, 0, -1.0)):
        places = of[:, first, :, None] * size + of[:, second, None, :]
        full += np.bincount(places.ravel(), sign * block.ravel(), size * size)
    joined = np.repeat(nodes(model), 2)
    free = np.flatnonzero(joined & ~particles.fixed.ravel())
    tangent = full.reshape(size, size)[np.ix_(free, free)]
    try:
        np.linalg.cholesky(tangent - 1e-9 * np.eye(len(tangent)) * np.abs(tangent).max(initial=0.0))
    except np.linalg.LinAlgError:
        return False
    return bool(len(tangent))
