"""Near pairs: the list of pairs of particles that step programs with laws of pairs keep; see templates/pairs.py."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from pinjoint.components.field import Column
from pinjoint.components.model import Model
from pinjoint.systems.broad_phase import ALL_PAIRS_DISCS, Rows, near_pairs

MARGIN = 0.3  # of the largest cutoff, within which pairs are listed beyond it; wider: longer lists, renewed less often
ROOM = 1.5  # times the pairs that are near, for those that come near later
PER_PARTICLE = 4  # entries at least

ARRAYS = ("pair_reach", "pair_listed", "pair_order", "pair_first", "pair_other", "pair_count")


class NearPairs:
    """The arrays by which a step program of one model lists its near pairs, by name.

    cutoffs: of the laws (m), in order; infinite: all pairs.
    """

    def __init__(self, model: Model, cutoffs: Sequence[float]) -> None:
        self._model = model
        count, largest = model.particles.count, max(cutoffs)
        within = largest * (1.0 + MARGIN) if count > ALL_PAIRS_DISCS else math.inf  # so few need no list
        travel = 0.5 * MARGIN * largest * (1.0 - 1e-9)
        self.arrays: dict[str, Column] = {
            "pair_reach": np.array([travel * travel, within, *(cutoff * cutoff for cutoff in cutoffs)]),
            "pair_listed": np.zeros((count, 2)),
            "pair_order": np.arange(count),
            "pair_first": np.zeros(count + 1, dtype=np.int64),
            "pair_other": np.zeros(0, dtype=np.int64),
            "pair_count": np.full(1, -1, dtype=np.int64),
        }
        if within < math.inf:
            self.begin()
            self._make_room(len(pairs_within(model, within)))

    @property
    def is_far(self) -> bool:
        """True if the state is one that no step has led to, in which the order along x may be another."""
        travelled = np.abs(self._model.particles.displacement - self.arrays["pair_listed"])
        return bool(travelled.max(initial=0.0) > self.arrays["pair_reach"][1])

    def begin(self) -> None:
        """Have the list made anew, from the order of the particles along x in the present state."""
        x = self._model.particles.position[:, 0] + self._model.particles.displacement[:, 0]
        self.arrays["pair_order"][:] = np.argsort(x)
        self.arrays["pair_count"][0] = -1

    @property
    def outgrown(self) -> bool:
        """True if there was no room for all pairs, so that all pairs of the model were looked at."""
        return int(self.arrays["pair_count"][0]) > len(self.arrays["pair_other"])

    def grow(self) -> None:
        """Make room for the pairs that there are now."""
        self._make_room(int(self.arrays["pair_count"][0]))
        self.arrays["pair_count"][0] = -1

    def _make_room(self, pairs: int) -> None:
        room = int(ROOM * pairs) + PER_PARTICLE * self._model.particles.count
        self.arrays["pair_other"] = np.zeros(room, dtype=np.int64)


def pairs_within(model: Model, distance: float) -> Rows:
    """Rows i < j of the particles at most so far from each other (m) now, in ascending order, shape (k, 2)."""
    if distance == math.inf:
        return np.column_stack(np.triu_indices(model.particles.count, 1))
    place = model.particles.position + model.particles.displacement
    return near_pairs(place, np.full(len(place), 0.5 * distance))
