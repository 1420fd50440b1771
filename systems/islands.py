"""Islands: groups of particles that rods connect, so that no force of a rod acts between two islands."""

from __future__ import annotations

import numpy as np

from pinjoint.components.arrays import Rows
from pinjoint.components.model import Model

IMMOVABLE = 0  # the island of particles that are held in both directions


def islands(model: Model) -> Rows:
    """The island of each particle, shape (n,): 1, 2, … in the order of their first particles, or IMMOVABLE.

    Particles are on one island if a chain of rods joins them; no chain goes through a particle that is held in
    both directions, since it passes no motion on.
    """
    moves = np.asarray((model.particles.mobility > 0.0).any(axis=1) | (model.particles.turning > 0.0))
    between = model.rods.between.astype(np.intp)
    root = lowest_joined(len(moves), between[moves[between].all(axis=1)])
    found = np.full(len(moves), IMMOVABLE, dtype=np.intp)
    found[moves] = np.unique(root[moves], return_inverse=True)[1] + 1
    return found


def lowest_joined(count: int, pairs: Rows) -> Rows:
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
