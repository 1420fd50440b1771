"""Islands: the particles of a model that forces of rods can move together, and nothing else does."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from components.model import Model

Rows = NDArray[np.intp]

HELD = 0  # the island of particles that nothing can move


def islands(model: Model) -> Rows:
    """The island of each particle, shape (n,): 1, 2, … in the order of their first particles, or HELD.

    Particles are on one island if a chain of rods joins them; no chain goes through a particle that is held in
    both directions, for nothing that happens on one side of it is felt on the other.
    """
    moves = np.asarray((model.particles.mobility > 0.0).any(axis=1))
    between = model.rods.between.astype(np.intp)
    root = _lowest_joined(len(moves), between[moves[between].all(axis=1)])
    found = np.full(len(moves), HELD, dtype=np.intp)
    found[moves] = np.unique(root[moves], return_inverse=True)[1] + 1
    return found


def _lowest_joined(count: int, pairs: Rows) -> Rows:
    """The lowest row that a chain of pairs joins each row to, shape (count,)."""
    root = np.arange(count)
    while True:
        ends = root[pairs]
        low, high = ends.min(axis=1), ends.max(axis=1)
        if (low == high).all():
            return root
        np.minimum.at(root, high, low)
        while (root[root] != root).any():
            root = root[root]
