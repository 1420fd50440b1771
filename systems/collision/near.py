"""Pairs of discs that are near each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Rows = NDArray[np.int64]

WIDER = 1.0 + 1e-9  # than it need be is the search by trees, whose round-off loses no pair then


def near_pairs(place: Floats, reach: Floats) -> Rows:
    """Pairs i < j whose centres are at most reach[i] + reach[j] apart, in ascending order, shape (k, 2).

    place: centres, shape (n, 2), m. reach: shape (n,), m. Discs are sought by size, so that a few large ones
    among many small ones do not make every small one look far.
    """
    from scipy.spatial import cKDTree

    sizes = np.frexp(reach)[1]
    classes = np.unique(sizes)
    trees = {size: (rows := np.flatnonzero(sizes == size), cKDTree(place[rows])) for size in classes}
    found = [np.zeros((0, 2), dtype=np.int64)]
    for size in classes:
        rows, tree = trees[size]
        found.append(rows[tree.query_pairs(WIDER * 2.0 * reach[rows].max(), output_type="ndarray")])
        for smaller in classes[classes < size]:
            others, finer = trees[smaller]
            within = WIDER * (reach[rows].max() + reach[others].max())
            pairs = tree.sparse_distance_matrix(finer, within, output_type="coo_matrix")
            found.append(np.sort(np.column_stack([rows[pairs.row], others[pairs.col]]), axis=1))
    first, second = np.concatenate(found).T
    apart = place[second] - place[first]
    near = np.hypot(apart[:, 0], apart[:, 1]) <= reach[first] + reach[second]
    keys = np.sort((first * len(place) + second)[near])
    return np.column_stack(np.divmod(keys, len(place)))
