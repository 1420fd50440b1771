"""A binary heap of meetings, earliest first; equal times in the order of the discs' numbers.

times: shape (capacity,), s. meetings: shape (capacity, 4): two discs, and how many changes of path each had
had when the meeting was foreseen. A meeting is void once either disc has changed its path since.
"""

from systems.kernels import compiled


@compiled
def _before(time, i, j, other_time, other_i, other_j):
    if time != other_time:
        return time < other_time
    if i != other_i:
        return i < other_i
    return j < other_j


@compiled
def _place(times, meetings, k, time, i, j, changes_i, changes_j):
    times[k] = time
    meetings[k, 0] = i
    meetings[k, 1] = j
    meetings[k, 2] = changes_i
    meetings[k, 3] = changes_j


@compiled
def _move(times, meetings, source, target):
    times[target] = times[source]
    for c in range(4):
        meetings[target, c] = meetings[source, c]


@compiled
def push(times, meetings, size, time, i, j, changes_i, changes_j):
    """Add a meeting to a heap of `size` that has room for it."""
    k = size
    while k > 0:
        parent = (k - 1) // 2
        if not _before(time, i, j, times[parent], meetings[parent, 0], meetings[parent, 1]):
            break
        _move(times, meetings, parent, k)
        k = parent
    _place(times, meetings, k, time, i, j, changes_i, changes_j)


@compiled
def _sink(times, meetings, size, k):
    """Let the meeting at k sink to where it belongs."""
    time = times[k]
    i, j = meetings[k, 0], meetings[k, 1]
    changes_i, changes_j = meetings[k, 2], meetings[k, 3]
    while True:
        child = 2 * k + 1
        if child >= size:
            break
        right = child + 1
        if right < size and _before(
            times[right],
            meetings[right, 0],
            meetings[right, 1],
            times[child],
            meetings[child, 0],
            meetings[child, 1],
        ):
            child = right
        if not _before(times[child], meetings[child, 0], meetings[child, 1], time, i, j):
            break
        _move(times, meetings, child, k)
        k = child
    _place(times, meetings, k, time, i, j, changes_i, changes_j)


@compiled
def drop_first(times, meetings, size):
    """Remove the earliest meeting; the heap then has size − 1."""
    if size > 1:
        _move(times, meetings, size - 1, 0)
        _sink(times, meetings, size - 1, 0)


@compiled
def is_void(meetings, k, changes):
    """True if a disc of the meeting has changed its path since."""
    return meetings[k, 2] != changes[meetings[k, 0]] or meetings[k, 3] != changes[meetings[k, 1]]


@compiled
def purge(times, meetings, size, changes):
    """Remove the void meetings; returns how many are left."""
    kept = 0
    for k in range(size):
        if not is_void(meetings, k, changes):
            _move(times, meetings, k, kept)
            kept += 1
    for k in range(kept // 2 - 1, -1, -1):
        _sink(times, meetings, kept, k)
    return kept
