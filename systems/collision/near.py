"""Pairs of discs that are near each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Rows = NDArray[np.int64]


def near_pairs(place: Floats, reach: Floats) -> Rows:
    """Pairs i < j whose centres are at most reach[i] + reach[j] apart, in ascending order, shape (k, 2).

    place: centres, shape (n, 2), m. reach: shape (n,), m. Discs are sought by size, so that a few large ones
    among many small ones do not make every small one look far.
    """
    from scipy.spatial import cKDTree

    sizes = np.frexp(reach)[1]
    classes = np.unique(sizes)
    trees = {size: (rows := np.flatnonzero(sizes == size), cKDTree(place[rows])) for size in classes}
    found = []
    for size in classes:
        rows, tree = trees[size]
        for other in classes[classes <= size]:
            others, finer = trees[other]
            within = reach[rows].max() + reach[others].max()
            pairs = tree.sparse_distance_matrix(finer, within, output_type="coo_matrix")
            found.append(np.column_stack([rows[pairs.row], others[pairs.col]]))
    pairs = np.concatenate(found) if found else np.zeros((0, 2), dtype=np.int64)
    pairs = np.sort(pairs[pairs[:, 0] != pairs[:, 1]], axis=1).astype(np.int64)
    apart = place[pairs[:, 1]] - place[pairs[:, 0]]
    pairs = pairs[np.hypot(apart[:, 0], apart[:, 1]) <= reach[pairs[:, 0]] + reach[pairs[:, 1]]]
    return np.unique(pairs, axis=0)
