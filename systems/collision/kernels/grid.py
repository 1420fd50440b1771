"""A hierarchical hash grid of boxes: which discs can collide before the present horizon ends.

Every disc has a box around its path until the horizon's end, and belongs to the finest layer whose cells are
larger than the box. It is entered as native into the cell of that layer that holds the box's left bottom corner, and
as guest into that of all coarser layers. A box that overlaps another of the same layer then has its corner at most one
cell to the left of the other, or below, whatever their sizes: a very large or very fast disc costs no more than a look
at all others.

The entry kind × discs + disc is that of a disc in a layer, with kind = 2 × layer, + 1 for guests. The entries of a
bucket are chained, to and fro. The buckets of neighbouring cells differ.
"""

import math

from systems.collision.columns import NONE, Disc
from systems.collision.kernels import compiled
from systems.collision.kernels.time_of_impact import extent

FARTHEST_CELL = 2.0**40  # cells from the origin; farther out cells grow, so that they can be told apart
COARSEST = 63
GOLDEN_SECTION = 0.6180339887498949
KIND = 0x165667B19  # far from 0 in any number of buckets
BOX_MARGIN = 1e-13  # of a disc's coordinates, added to its box: more than the noise of a gap


@compiled
def _range(u, v, a, start, end):
    """Least and greatest of u + v s + a s²/2 for s between start and end."""
    first = u + start * (v + 0.5 * start * a)
    last = u + end * (v + 0.5 * end * a)
    low, high = min(first, last), max(first, last)
    if a != 0.0 and start < -v / a < end:
        turn = u - 0.5 * v * v / a
        low, high = min(low, turn), max(high, turn)
    return low, high


@compiled
def enclose(i, discs, grid, now, end):
    """Set the box of a disc around its path from now to end."""
    start, stop = now - discs[i, Disc.EPOCH], end - discs[i, Disc.EPOCH]
    low_x, high_x = _range(discs[i, Disc.UX], discs[i, Disc.VX], discs[i, Disc.AX], start, stop)
    low_y, high_y = _range(discs[i, Disc.UY], discs[i, Disc.VY], discs[i, Disc.AY], start, stop)
    low_x, high_x = low_x + min(discs[i, Disc.TX], 0.0), high_x + max(discs[i, Disc.TX], 0.0)
    low_y, high_y = low_y + min(discs[i, Disc.TY], 0.0), high_y + max(discs[i, Disc.TY], 0.0)
    margin = BOX_MARGIN * max(extent(discs, i, now), extent(discs, i, end))
    around = discs[i, Disc.RADIUS] + margin
    grid.boxes[i, 0] = discs[i, Disc.OX] + low_x - around
    grid.boxes[i, 1] = discs[i, Disc.OY] + low_y - around
    grid.boxes[i, 2] = discs[i, Disc.OX] + high_x + around
    grid.boxes[i, 3] = discs[i, Disc.OY] + high_y + around


@compiled
def place_box(i, discs, now):
    """Box around a disc at its present place."""
    s = now - discs[i, Disc.EPOCH]
    x = discs[i, Disc.OX] + (discs[i, Disc.UX] + s * (discs[i, Disc.VX] + 0.5 * s * discs[i, Disc.AX]))
    y = discs[i, Disc.OY] + (discs[i, Disc.UY] + s * (discs[i, Disc.VY] + 0.5 * s * discs[i, Disc.AY]))
    around = discs[i, Disc.RADIUS] + BOX_MARGIN * extent(discs, i, now)
    return x - around, y - around, x + around, y + around


@compiled
def box_size(i, grid):
    """The longer side of a disc's box."""
    boxes = grid.boxes
    return max(boxes[i, 2] - boxes[i, 0], boxes[i, 3] - boxes[i, 1])


@compiled
def suitable_size(i, grid):
    """The least size of cells of which the box of a disc overlaps two, not three, and that can be told apart there."""
    boxes = grid.boxes
    away = max(abs(boxes[i, 0] + boxes[i, 2]), abs(boxes[i, 1] + boxes[i, 3]))
    return 1.001 * max(box_size(i, grid), 0.5 * away / FARTHEST_CELL)


@compiled
def level_of(i, grid, cell):
    """The finest level (0: cells of size `cell`, then doubling) that suits the box of a disc."""
    size = suitable_size(i, grid)
    if size <= cell:
        return 0
    mantissa, exponent = math.frexp(size / cell)
    return min(exponent - 1 if mantissa == 0.5 else exponent, COARSEST)


@compiled
def layer_of(level, grid, layers):
    """The finest layer of at least this level; `layers` if all are finer."""
    k = 0
    while k < layers and grid.levels[k] < level:
        k += 1
    return k


@compiled
def _row(grid):
    """How far the bucket of a cell is from that of the cell below: the golden section spreads rows evenly."""
    return int(GOLDEN_SECTION * grid.heads.shape[0]) | 1


@compiled
def _bucket(i, k, grid):
    """The bucket of a disc in layer k."""
    cx = math.floor(grid.boxes[i, 0] * grid.inverse[k])
    cy = math.floor(grid.boxes[i, 1] * grid.inverse[k])
    kind = 2 * k + (1 if k > grid.layer[i] else 0)
    return (cx + cy * _row(grid) + kind * KIND) & (grid.heads.shape[0] - 1)


@compiled
def enter(i, grid, layers):
    """Enter a disc into its layer and all coarser ones."""
    heads, after, before = grid.heads, grid.after, grid.before
    for k in range(grid.layer[i], layers):
        bucket = _bucket(i, k, grid)
        entry = (2 * k + (1 if k > grid.layer[i] else 0)) * grid.boxes.shape[0] + i
        following = heads[bucket]
        after[entry], before[entry] = following, NONE
        if following != NONE:
            before[following] = entry
        heads[bucket] = entry


@compiled
def leave(i, grid, layers):
    """Take a disc out of the grid, before its box changes."""
    heads, after, before = grid.heads, grid.after, grid.before
    for k in range(grid.layer[i], layers):
        entry = (2 * k + (1 if k > grid.layer[i] else 0)) * grid.boxes.shape[0] + i
        following, previous = after[entry], before[entry]
        if following != NONE:
            before[following] = previous
        if previous != NONE:
            after[previous] = following
        else:
            heads[_bucket(i, k, grid)] = following


@compiled
def neighbours(i, left, bottom, right, top, grid, layers, count):
    """Discs other than i whose boxes overlap a part of that of i, each once, into `found` after the first `count`.

    Returns how many have been found then.
    """
    heads, mask, row = grid.heads, grid.heads.shape[0] - 1, _row(grid)
    for k in range(grid.layer[i], layers):
        inverse = grid.inverse[k]
        first_x, first_y = math.floor(left * inverse) - 1, math.floor(bottom * inverse) - 1
        columns, rows = math.floor(right * inverse) - first_x + 1, math.floor(top * inverse) - first_y + 1
        for guests in range(2 if k == grid.layer[i] and k > 0 else 1):
            kind = 2 * k + guests
            start = first_x + first_y * row + kind * KIND
            for _ in range(rows):
                for cell in range(start, start + columns):
                    count = _look_into(heads[cell & mask], kind, i, left, bottom, right, top, count, grid)
                start += row
    return count


@compiled
def _look_into(entry, kind, i, left, bottom, right, top, count, grid):
    """Add the discs of a bucket, from an entry on, whose boxes overlap a part of that of i.

    Which do is hard to predict for a processor: it is counted rather than branched upon.
    """
    boxes, found = grid.boxes, grid.found
    while entry != NONE:
        j = entry - kind * boxes.shape[0]
        if 0 <= j < boxes.shape[0]:
            found[count] = j
            beside = (boxes[j, 0] <= right) & (left <= boxes[j, 2])
            count += beside & (boxes[j, 1] <= top) & (bottom <= boxes[j, 3]) & (j != i)
        entry = grid.after[entry]
    return count


@compiled
def sort(found, count):
    """Sort a few numbers: the order in which a grid finds discs depends on when it was made."""
    for k in range(1, count):
        value = found[k]
        while k > 0 and found[k - 1] > value:
            found[k] = found[k - 1]
            k -= 1
        found[k] = value
