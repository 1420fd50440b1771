"""Overlaps where a run begins: discs that would have to be in the same place are moved apart.

Importing this module imports numba; do so only where there are overlaps.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from components.obstacles import NO_OBSTACLES, Obstacles
from systems.broad_phase import Floats, Rows, near_pairs, nearest

SLACK = 1e-13  # of the reach of two discs; less is round-off
AROUND = 1.5  # times its radius, within which a disc's neighbours are looked after at a time
MOST_ROUNDS = 100  # of finding neighbours anew


def overlaps(place: Floats, radius: Floats, obstacles: Obstacles | None = None) -> Rows:
    """Pairs of discs, and of discs and obstacles, that overlap, shape (k, 2)."""
    pairs = near_pairs(place, radius, obstacles)
    first, span = place, np.zeros_like(place)
    if obstacles is not None:
        first, span = np.concatenate([place, obstacles.start]), np.concatenate([span, obstacles.span])
        radius = np.concatenate([radius, obstacles.radius])
    line = nearest(first[pairs[:, 1]] - place[pairs[:, 0]], span[pairs[:, 1]])
    reach = radius[pairs].sum(axis=1)
    overlapping: Rows = pairs[np.hypot(line[:, 0], line[:, 1]) < reach * (1.0 - SLACK)]
    return overlapping


def part(
    position: Floats,
    displacement: Floats,
    radius: Floats,
    inverse_mass: Floats,
    among: Callable[[Rows], NDArray[np.bool_]],
    kernel: Callable[..., Any],
    obstacles: Obstacles = NO_OBSTACLES,
) -> int:
    """Move discs apart that overlap, changing `displacement`; returns how many pairs still do in the end.

    among: which of the pairs it is given are to be parted. kernel: `separate` of kernels/overlap.py, compiled.
    """
    count, still = len(position), np.zeros((len(obstacles), 2))
    places, moved = np.concatenate([position, obstacles.start]), np.concatenate([displacement, still])
    span = np.concatenate([np.zeros_like(position), obstacles.span])
    radii, inverse = np.concatenate([radius, obstacles.radius]), np.concatenate([inverse_mass, still])
    for _ in range(MOST_ROUNDS):
        near = near_pairs(position + moved[:count], AROUND * radius, obstacles)
        near = near[among(near)]
        first, second = np.ascontiguousarray(near[:, 0]), np.ascontiguousarray(near[:, 1])
        if kernel(first, second, places, moved, radii, inverse, span, SLACK) == 0:
            break
    displacement[...] = moved[:count]
    left = overlaps(position + displacement, radius, obstacles)
    return int(among(left).sum())
