"""Near pairs: the list of pairs of particles that step programs with laws of pairs keep, made by the grid of collisions.

pair_reach    squares of the distance that particles may travel before the list is renewed and, from the third
              entry on, of the cutoff of each law (m²); second entry: distance up to which pairs are listed (m)
pair_listed   displacements at which the list was made, shape (particles, 2)
pair_count    how many pairs the list has; -1: none was made yet; more than there is room for: it has none
pair_list     the pairs, ascending, at the end of shape (room, 2)
pair_grid     of kernels/grid.py
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from pinjoint.components.model import Model
from pinjoint.systems.broad_phase import ALL_PAIRS_DISCS, Rows, near_pairs
from pinjoint.systems.collision.columns import Grid

MARGIN = 0.3  # of the largest cutoff, within which pairs are listed beyond it; wider: longer lists, renewed less often
ROOM = 1.5  # times the pairs that are near, for those that come near later
PER_PARTICLE = 4  # entries at least
LAYERS = 4  # of the grid; more are needed only where the farthest particles are 10¹³ cutoffs away

ARRAYS = ("pair_reach", "pair_listed", "pair_count", "pair_list", "pair_grid")


class NearPairs:
    """The arrays by which a step program of one model lists its near pairs, by name.

    cutoffs: of the laws (m), in order; infinite: all pairs.
    """

    def __init__(self, model: Model, cutoffs: Sequence[float]) -> None:
        count, largest = model.particles.count, max(cutoffs)
        within = largest * (1.0 + MARGIN) if count > ALL_PAIRS_DISCS else math.inf  # so few need no list
        travel = 0.5 * MARGIN * largest * (1.0 - 1e-9)
        self._count = count
        self.arrays: dict[str, Any] = {
            "pair_reach": np.array([travel * travel, within, *(cutoff * cutoff for cutoff in cutoffs)]),
            "pair_listed": np.zeros((count, 2)),
            "pair_count": np.full(1, -1, dtype=np.int64),
            "pair_grid": Grid.empty(count, LAYERS),
        }
        self._make_room(len(pairs_within(model, within)) if within < math.inf else 0)

    def grow(self) -> bool:
        """Make room for the pairs that there are now; False if there is room, so that not all pairs were looked at."""
        pairs = int(self.arrays["pair_count"][0])
        if outgrown := pairs > len(self.arrays["pair_list"]):
            self._make_room(pairs)
            self.arrays["pair_count"][0] = -1
        return outgrown

    def _make_room(self, pairs: int) -> None:
        self.arrays["pair_list"] = np.zeros((int(ROOM * pairs) + PER_PARTICLE * self._count, 2), dtype=np.int64)


def pairs_within(model: Model, distance: float) -> Rows:
    """Rows i < j of the particles at most so far from each other (m) now, in ascending order, shape (k, 2)."""
    if distance == math.inf:
        return np.column_stack(np.triu_indices(model.particles.count, 1))
    place = model.particles.position + model.particles.displacement
    return near_pairs(place, np.full(len(place), 0.5 * distance))
