"""The broad phase: pairs of discs, and of discs and obstacles, that are near each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Array
from pinjoint.components.obstacles import NO_OBSTACLES, Obstacles

Rows = NDArray[np.int64]

ALL_PAIRS_DISCS = 64  # discs up to which it is faster to look at all pairs than to import and build trees
SEARCH_MARGIN = 1.0 + 1e-9  # factor of the radius of a search, so that round-off loses no pair


def nearest(line: Array, span: Array) -> Array:
    """The vectors to the nearest points of straight pieces, shape (k, 2).

    line: vectors to the first ends, shape (k, 2). span: from the first end to the other; zero for discs.
    """
    squared = (span * span).sum(axis=1)
    along, long = -(line * span).sum(axis=1), np.where(squared > 0.0, squared, 1.0)
    across = (line[:, 0] * span[:, 1] - line[:, 1] * span[:, 0]) / long
    side = np.column_stack([across * span[:, 1], -across * span[:, 0]])
    end = line + np.where(along >= squared, 1.0, 0.0)[:, None] * span
    return np.where(((along > 0.0) & (along < squared))[:, None], side, end)


def gaps(place: Array, radius: Array, pairs: Rows, obstacles: Obstacles = NO_OBSTACLES) -> tuple[Array, Array]:
    """Distances (m) between the rims of pairs, and unit vectors from the first of each to the nearest point of the second.

    place: centres, shape (n, 2), m. radius: shape (n,), m. The numbers of obstacles follow those of the discs.
    """
    start = np.concatenate([place, obstacles.start])
    span = np.concatenate([np.zeros_like(place), obstacles.span])
    line = nearest(start[pairs[:, 1]] - place[pairs[:, 0]], span[pairs[:, 1]])
    distance = np.hypot(line[:, 0], line[:, 1])
    reach = np.concatenate([radius, obstacles.radius])[pairs].sum(axis=1)
    return distance - reach, line / np.where(distance > 0.0, distance, 1.0)[:, None]


def distance_to_segments(points: Array, start: Array, end: Array) -> Array:
    """How far points are from the segments from `start` to `end`, all (…, 2)."""
    x, y = (start[..., axis] - points[..., axis] for axis in (0, 1))
    along_x, along_y = (end[..., axis] - start[..., axis] for axis in (0, 1))
    squared = along_x * along_x + along_y * along_y
    share = -(x * along_x + y * along_y) / np.where(squared > 0.0, squared, 1.0)
    share = np.minimum(np.maximum(share, 0.0), 1.0)  # np.clip takes a multiple of the time for a few
    x, y = x + share * along_x, y + share * along_y
    return np.sqrt(x * x + y * y)  # np.hypot takes ten times as long for many


def near_pairs(place: Array, reach: Array, obstacles: Obstacles = NO_OBSTACLES) -> Rows:
    """Pairs i < j whose centres are at most reach[i] + reach[j] apart, in ascending order, shape (k, 2).

    place: centres, shape (n, 2), m. reach: shape (n,), m. Discs are searched by size, so that a few large discs
    among many small ones do not widen the search of every small one. The numbers of obstacles follow those of the discs.
    """
    first, second = (
        np.triu_indices(len(place), 1) if len(place) <= ALL_PAIRS_DISCS else _tree_pairs(place, reach)
    )
    apart = place[second] - place[first]
    near = np.hypot(apart[:, 0], apart[:, 1]) <= reach[first] + reach[second]
    total = len(place) + len(obstacles)
    touching = _near_obstacles(place, reach, obstacles)
    keys = np.concatenate([(first * total + second)[near], touching[:, 0] * total + touching[:, 1]])
    return np.column_stack(np.divmod(np.sort(keys), total))


def _tree_pairs(place: Array, reach: Array) -> Rows:
    """Pairs that may be near each other, by trees, shape (2, k), the lower number first."""
    from scipy.spatial import cKDTree

    sizes = np.frexp(reach)[1]
    classes = np.unique(sizes)
    trees = {size: (rows := np.flatnonzero(sizes == size), cKDTree(place[rows])) for size in classes}
    found = [np.zeros((0, 2), dtype=np.int64)]
    for size in classes:
        rows, tree = trees[size]
        found.append(rows[tree.query_pairs(SEARCH_MARGIN * 2.0 * reach[rows].max(), output_type="ndarray")])
        for smaller in classes[classes < size]:
            others, finer = trees[smaller]
            within = SEARCH_MARGIN * (reach[rows].max() + reach[others].max())
            pairs = tree.sparse_distance_matrix(finer, within, output_type="coo_matrix")
            found.append(np.sort(np.column_stack([rows[pairs.row], others[pairs.col]]), axis=1))
    return np.concatenate(found).T


def _near_obstacles(place: Array, reach: Array, obstacles: Obstacles) -> Rows:
    found = [np.zeros((0, 2), dtype=np.int64)]
    for k in range(len(obstacles)):
        span = np.broadcast_to(obstacles.span[k], place.shape)
        away = np.hypot(*nearest(obstacles.start[k] - place, span).T)
        rows = np.flatnonzero(away <= reach + obstacles.radius[k])
        found.append(np.column_stack([rows, np.full(len(rows), len(place) + k)]))
    return np.concatenate(found)
