"""Envelopes: what is most and least of N, V, M and reactions in several combinations, and in which."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Envelope:
    """Numbers of c combinations side by side.

    names: theirs. shares: stations along the rods, extremes of all among them, (rods, k). values: by quantity "N", "V", "M",
    (c, rods, k) kN, kN·m. reactions: along x and y, and of clamps, (c, particles, 3). unsolved: combinations without an
    equilibrium, which are left out.
    """

    names: tuple[str, ...]
    shares: Array = field(repr=False, compare=False)
    values: Mapping[str, Array] = field(repr=False, compare=False)
    reactions: Array = field(repr=False, compare=False)
    unsolved: tuple[str, ...] = ()

    def along(self, quantity: str) -> tuple[Array, Array]:
        """The least and the most of a quantity along rods, (rods, k) each."""
        values = self.values[quantity]
        return values.min(axis=0), values.max(axis=0)

    def extremes(self, quantity: str) -> tuple[Array, NDArray[np.intp], NDArray[np.intp]]:
        """The least and the most of a quantity in each rod, at which station and in which combination, (rods, 2)."""
        values = np.moveaxis(self.values[quantity], 0, 1)  # rod, combination, station
        flat = values.reshape(len(values), -1)
        at = np.stack([flat.argmin(axis=1), flat.argmax(axis=1)], axis=1)
        combination, station = np.unravel_index(at, values.shape[1:])
        return np.take_along_axis(flat, at, axis=1), station, combination

    @property
    def of_reactions(self) -> tuple[Array, NDArray[np.intp]]:
        """The least and the most of reactions, and in which combination, (2, particles, 3) each."""
        which = np.stack([self.reactions.argmin(axis=0), self.reactions.argmax(axis=0)])
        return np.take_along_axis(self.reactions, which, axis=0), which
