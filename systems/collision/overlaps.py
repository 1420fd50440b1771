"""Overlaps where a run begins: discs that would have to be in the same place are moved apart.

Importing this module imports numba; do so only where there are overlaps.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from systems.collision.near import Floats, Rows, near_pairs
from systems.collision.overlap.kernels import separate

SLACK = 1e-13  # of the reach of two discs; less is round-off
AROUND = 1.5  # times its radius, within which a disc's neighbours are looked after at a time
MOST_ROUNDS = 100  # of finding neighbours anew


def overlaps(place: Floats, radius: Floats) -> Rows:
    """Pairs of discs that overlap, shape (k, 2)."""
    pairs = near_pairs(place, radius)
    line = place[pairs[:, 1]] - place[pairs[:, 0]]
    reach = radius[pairs].sum(axis=1)
    overlapping: Rows = pairs[np.hypot(line[:, 0], line[:, 1]) < reach * (1.0 - SLACK)]
    return overlapping


def part(
    position: Floats,
    displacement: Floats,
    radius: Floats,
    inverse_mass: Floats,
    among: Callable[[Rows], NDArray[np.bool_]],
    kernel: Callable[..., Any] = separate,
) -> int:
    """Move discs apart that overlap, changing `displacement`; returns how many pairs still do in the end.

    among: which of the pairs it is given are to be parted.
    """
    for _ in range(MOST_ROUNDS):
        near = near_pairs(position + displacement, AROUND * radius)
        near = near[among(near)]
        first, second = np.ascontiguousarray(near[:, 0]), np.ascontiguousarray(near[:, 1])
        if kernel(first, second, position, displacement, radius, inverse_mass, SLACK) == 0:
            break
    left = overlaps(position + displacement, radius)
    return int(among(left).sum())
