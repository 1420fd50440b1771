"""A binary heap of impacts, earliest first; equal times in the order of the discs' numbers."""

import numpy as np

from pinjoint.systems.collision.columns import MOST_CHANGES, Disc
from pinjoint.systems.collision.kernels import compiled


@compiled
def _before(time, i, j, k, queue):
    """True if an impact comes before the one at k."""
    other = queue.times[k]
    if time != other:
        return time < other
    if i != queue.impacts[k, 0]:
        return i < queue.impacts[k, 0]
    return j < queue.impacts[k, 1]


@compiled
def _place(queue, k, time, i, j, changes_i, changes_j):
    queue.times[k] = time
    queue.impacts[k, 0] = i
    queue.impacts[k, 1] = j
    queue.impacts[k, 2] = changes_i
    queue.impacts[k, 3] = changes_j


@compiled
def _impact_at(queue, k):
    """The impact at k, as int64: 32-bit numbers would be compiled separately wherever they are used."""
    i, j = np.int64(queue.impacts[k, 0]), np.int64(queue.impacts[k, 1])
    return queue.times[k], i, j, np.int64(queue.impacts[k, 2]), np.int64(queue.impacts[k, 3])


@compiled
def _move(queue, source, target):
    queue.times[target] = queue.times[source]
    for c in range(4):
        queue.impacts[target, c] = queue.impacts[source, c]


@compiled
def push(queue, size, time, i, j, changes_i, changes_j):
    """Add an impact to a heap of `size` that has room for it."""
    k = size
    while k > 0:
        parent = (k - 1) // 2
        if not _before(time, i, j, parent, queue):
            break
        _move(queue, parent, k)
        k = parent
    _place(queue, k, time, i, j, changes_i, changes_j)


@compiled
def _sink(queue, size, k):
    """Let the impact at k sink to its place."""
    time, i, j, changes_i, changes_j = _impact_at(queue, k)
    while 2 * k + 1 < size:
        child = 2 * k + 1
        right = child + 1
        if right < size:
            other, a, b, _, _ = _impact_at(queue, right)
            if _before(other, a, b, child, queue):
                child = right
        if _before(time, i, j, child, queue):
            break
        _move(queue, child, k)
        k = child
    _place(queue, k, time, i, j, changes_i, changes_j)


@compiled
def drop_first(queue, size):
    """Remove the earliest impact; the heap then has size − 1."""
    if size > 1:
        _move(queue, size - 1, 0)
        _sink(queue, size - 1, 0)


@compiled
def changes(i, discs):
    """Number of changes of the path of a disc, as the queue keeps it."""
    return int(discs[i, Disc.CHANGES]) & MOST_CHANGES


@compiled
def is_void(queue, k, discs):
    """True if a disc of the impact at k has changed its path since."""
    _, i, j, changes_i, changes_j = _impact_at(queue, k)
    return changes_i != changes(i, discs) or changes_j != changes(j, discs)


@compiled
def purge(queue, size, discs):
    """Remove the void impacts; returns the number of impacts that are left."""
    kept = 0
    for k in range(size):
        if not is_void(queue, k, discs):
            _move(queue, k, kept)
            kept += 1
    for k in range(kept // 2 - 1, -1, -1):
        _sink(queue, kept, k)
    return kept
