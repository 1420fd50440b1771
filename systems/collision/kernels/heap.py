"""A binary heap of impacts, earliest first; equal times in the order of the discs' numbers."""

import numpy as np

from pinjoint.systems.collision.columns import Count, Disc
from pinjoint.systems.collision.kernels import compiled

MOST_CHANGES = 2**31 - 1  # mask: the part of a disc's number of changes that an impact in the queue keeps


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
def queue_impact(time, i, j, discs, queue, counts):
    """Queue an impact of two discs, i ≤ j. False if the queue is full."""
    capacity = queue.times.shape[0]
    if counts[Count.QUEUED] == capacity:
        counts[Count.QUEUED] = _purge(queue, capacity, discs)
        if counts[Count.QUEUED] > capacity - capacity // 8:
            return False
    k = counts[Count.QUEUED]
    while k > 0:
        parent = (k - 1) // 2
        if not _before(time, i, j, parent, queue):
            break
        _move(queue, parent, k)
        k = parent
    _place(queue, k, time, i, j, _changes(i, discs), _changes(j, discs))
    counts[Count.QUEUED] += 1
    return True


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
def drop_first(queue, counts):
    """Remove the earliest impact."""
    counts[Count.QUEUED] -= 1
    size = counts[Count.QUEUED]
    if size > 0:
        _move(queue, size, 0)
        _sink(queue, size, 0)


@compiled
def drop_void(queue, discs, counts):
    """Remove the earliest impacts as long as they are void."""
    while counts[Count.QUEUED] > 0 and _is_void(queue, 0, discs):
        drop_first(queue, counts)


@compiled
def _changes(i, discs):
    """Number of changes of the path of a disc, as the queue keeps it."""
    return int(discs[i, Disc.CHANGES]) & MOST_CHANGES


@compiled
def _is_void(queue, k, discs):
    """True if a disc of the impact at k has changed its path since."""
    _, i, j, changes_i, changes_j = _impact_at(queue, k)
    return changes_i != _changes(i, discs) or changes_j != _changes(j, discs)


@compiled
def _purge(queue, size, discs):
    """Remove the void impacts; returns the number of impacts that are left."""
    kept = 0
    for k in range(size):
        if not _is_void(queue, k, discs):
            _move(queue, k, kept)
            kept += 1
    for k in range(kept // 2 - 1, -1, -1):
        _sink(queue, kept, k)
    return kept
