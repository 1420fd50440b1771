"""A hierarchical hash grid of boxes: which discs can collide before the present horizon ends.

Every disc has a box around its path until the horizon's end, and belongs to the finest layer whose cells are
larger than the box. It is entered as native into the one to four cells of that layer that its box overlaps,
and as guest into those of all coarser layers. Two boxes that overlap then share a cell of the coarser one's
layer, whatever their sizes: a very large or very fast disc costs no more than a look at all others.

The entries 4 (kind × discs + disc) to + 3 are a disc's cells, with kind = 2 × layer, + 1 for guests: left bottom,
left top, right bottom, right top. The entries of a bucket are chained; the cell of an entry follows from the disc's box.
"""

import math

from systems.collision.columns import NONE, Disc
from systems.collision.kernels import compiled
from systems.collision.kernels.time_of_impact import extent

FARTHEST_CELL = 2.0**40  # cells from the origin; farther out cells grow, so that they can be told apart
COARSEST = 63
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
def _bucket(cx, cy, kind, grid):
    """The bucket of a cell; neighbouring cells lie together in memory."""
    return (cx + cy * 0x9E3779B97F4A7C1 + kind * 0x165667B19E3779F) & (grid.heads.shape[0] - 1)


@compiled
def _inverse_size(cell, level):
    return math.ldexp(1.0 / cell, -level)


@compiled
def _cells(i, boxes, inverse):
    """The cells of a layer that a disc's box overlaps: first and last in x, in y; two at most."""
    left, bottom = math.floor(boxes[i, 0] * inverse), math.floor(boxes[i, 1] * inverse)
    right, top = math.floor(boxes[i, 2] * inverse), math.floor(boxes[i, 3] * inverse)
    return left, bottom, min(right, left + 1), min(top, bottom + 1)


@compiled
def enter(i, grid, layers, cell):
    """Enter a disc into its layer and all coarser ones."""
    boxes, heads = grid.boxes, grid.heads
    for k in range(grid.layer[i], layers):
        inverse = _inverse_size(cell, grid.levels[k])
        left, bottom, right, top = _cells(i, boxes, inverse)
        kind = 2 * k + (1 if k > grid.layer[i] else 0)
        first = 4 * (kind * boxes.shape[0] + i)
        for cx in range(left, right + 1):
            for cy in range(bottom, top + 1):
                entry = first + 2 * (cx - left) + cy - bottom
                bucket = _bucket(cx, cy, kind, grid)
                grid.after[entry] = heads[bucket]
                heads[bucket] = entry


@compiled
def leave(i, grid, layers, cell):
    """Take a disc out of the grid, before its box changes."""
    boxes, heads, after = grid.boxes, grid.heads, grid.after
    for k in range(grid.layer[i], layers):
        inverse = _inverse_size(cell, grid.levels[k])
        left, bottom, right, top = _cells(i, boxes, inverse)
        kind = 2 * k + (1 if k > grid.layer[i] else 0)
        first = 4 * (kind * boxes.shape[0] + i)
        for cx in range(left, right + 1):
            for cy in range(bottom, top + 1):
                entry = first + 2 * (cx - left) + cy - bottom
                bucket = _bucket(cx, cy, kind, grid)
                if heads[bucket] == entry:
                    heads[bucket] = after[entry]
                else:
                    previous = heads[bucket]
                    while after[previous] != entry:
                        previous = after[previous]
                    after[previous] = after[entry]


@compiled
def neighbours(i, left, bottom, right, top, grid, layers, cell):
    """Discs other than i whose boxes overlap a part of that of i, each once, into `found`; returns how many."""
    count = 0
    for k in range(grid.layer[i], layers):
        inverse = _inverse_size(cell, grid.levels[k])
        for cx in range(math.floor(left * inverse), math.floor(right * inverse) + 1):
            for cy in range(math.floor(bottom * inverse), math.floor(top * inverse) + 1):
                for guests in range(2 if k == grid.layer[i] and k > 0 else 1):
                    kind = 2 * k + guests
                    count = _look_into(cx, cy, kind, inverse, i, left, bottom, right, top, count, grid)
    return count


@compiled
def _look_into(cx, cy, kind, inverse, i, left, bottom, right, top, count, grid):
    """Add the discs of one cell whose boxes overlap a part of that of i."""
    boxes = grid.boxes
    first = kind * boxes.shape[0]
    entry = grid.heads[_bucket(cx, cy, kind, grid)]
    while entry != NONE:
        j = (entry >> 2) - first
        if 0 <= j < boxes.shape[0]:
            x, y = max(boxes[j, 0], left), max(boxes[j, 1], bottom)
            if (
                x <= min(boxes[j, 2], right)
                and y <= min(boxes[j, 3], top)
                and j != i
                and math.floor(x * inverse) == cx  # of the cells both overlap, count one
                and math.floor(y * inverse) == cy
                and math.floor(boxes[j, 0] * inverse) + ((entry >> 1) & 1)
                == cx  # not of another in this bucket
                and math.floor(boxes[j, 1] * inverse) + (entry & 1) == cy
                and count < boxes.shape[0]
            ):
                grid.found[count] = j
                count += 1
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
