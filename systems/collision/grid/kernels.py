"""A hierarchical hash grid of boxes: which discs can meet before the present window ends.

Every disc has a box around its path until the window's end, and belongs to the finest layer whose cells are
larger than the box. It is entered as native into the one to four cells of that layer that its box overlaps,
and as guest into those of all coarser layers. Two boxes that overlap then share a cell of the coarser one's
layer, whatever their sizes: a very large or very fast disc costs no more than a look at all others.

The entries 4 (disc × layers + layer) to + 3 are a disc's cells in a layer; those of a bucket are chained.
"""

import math

from systems.collision.arrays import (
    AFTER,
    AX,
    AY,
    BEFORE,
    EPOCH,
    KEY,
    NONE,
    OX,
    OY,
    RADIUS,
    TX,
    TY,
    UX,
    UY,
    VX,
    VY,
)
from systems.collision.gap.kernels import extent
from systems.collision.kernels import compiled

FARTHEST_CELL = 2.0**40  # cells from the origin; farther out cells grow, so that they can be told apart
COARSEST = 63
MARGIN = 1e-13  # of a disc's coordinates, added to its box: above what counts as touching


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
    """Set the box of a disc to what its path covers from now to end."""
    start, stop = now - discs[i, EPOCH], end - discs[i, EPOCH]
    low_x, high_x = _range(discs[i, UX], discs[i, VX], discs[i, AX], start, stop)
    low_y, high_y = _range(discs[i, UY], discs[i, VY], discs[i, AY], start, stop)
    low_x, high_x = low_x + min(discs[i, TX], 0.0), high_x + max(discs[i, TX], 0.0)
    low_y, high_y = low_y + min(discs[i, TY], 0.0), high_y + max(discs[i, TY], 0.0)
    margin = MARGIN * max(extent(discs, i, now), extent(discs, i, end))
    around = discs[i, RADIUS] + margin
    grid.boxes[i, 0] = discs[i, OX] + low_x - around
    grid.boxes[i, 1] = discs[i, OY] + low_y - around
    grid.boxes[i, 2] = discs[i, OX] + high_x + around
    grid.boxes[i, 3] = discs[i, OY] + high_y + around


@compiled
def place_box(i, discs, now):
    """Box around what a disc covers now."""
    s = now - discs[i, EPOCH]
    x = discs[i, OX] + (discs[i, UX] + s * (discs[i, VX] + 0.5 * s * discs[i, AX]))
    y = discs[i, OY] + (discs[i, UY] + s * (discs[i, VY] + 0.5 * s * discs[i, AY]))
    around = discs[i, RADIUS] + MARGIN * extent(discs, i, now)
    return x - around, y - around, x + around, y + around


@compiled
def box_size(i, grid):
    """The longer side of a disc's box."""
    boxes = grid.boxes
    return max(boxes[i, 2] - boxes[i, 0], boxes[i, 3] - boxes[i, 1])


@compiled
def level_of(i, grid, cell):
    """The finest level (0: cells of size `cell`, then doubling) that suits the box of a disc."""
    boxes = grid.boxes
    away = max(abs(boxes[i, 0] + boxes[i, 2]), abs(boxes[i, 1] + boxes[i, 3]))
    size = 1.001 * max(box_size(i, grid), 0.5 * away / FARTHEST_CELL)  # a box overlaps two cells, not three
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
def _key(cx, cy, kind):
    """Mixes a cell and 2 × layer (+ 1 for guests) into 64 bits."""
    h = cx * 0x9E3779B97F4A7C1 + cy * 0xC2B2AE3D27D4EB4 + kind * 0x165667B19E3779F
    h = (h ^ ((h >> 29) & 0x7FFFFFFFF)) * 0xBF58476D1CE4E5B
    return (h ^ ((h >> 32) & 0xFFFFFFFF)) & 0x7FFFFFFFFFFFFFFF  # not negative: NONE is no key


@compiled
def _inverse_size(cell, level):
    return math.ldexp(1.0 / cell, -level)


@compiled
def enter(i, grid, layers, cell):
    """Enter a disc into its layer and all coarser ones."""
    boxes, entries = grid.boxes, grid.entries
    for k in range(grid.layer[i], layers):
        inverse = _inverse_size(cell, grid.levels[k])
        left, right = math.floor(boxes[i, 0] * inverse), math.floor(boxes[i, 2] * inverse)
        bottom, top = math.floor(boxes[i, 1] * inverse), math.floor(boxes[i, 3] * inverse)
        kind = 2 * k + (1 if k > grid.layer[i] else 0)
        for q in range(4):
            entry = 4 * (i * layers + k) + q
            cx, cy = left + q // 2, bottom + q % 2
            if cx <= right and cy <= top:
                _insert(entry, _key(cx, cy, kind), grid.heads, entries)
            else:
                entries[entry, KEY] = NONE


@compiled
def _insert(entry, key, heads, entries):
    bucket = key & (heads.shape[0] - 1)
    first = heads[bucket]
    entries[entry, KEY] = key
    entries[entry, BEFORE] = NONE
    entries[entry, AFTER] = first
    if first != NONE:
        entries[first, BEFORE] = entry
    heads[bucket] = entry


@compiled
def leave(i, grid, layers):
    """Take a disc out of the grid."""
    heads, entries = grid.heads, grid.entries
    for entry in range(4 * (i * layers + grid.layer[i]), 4 * (i + 1) * layers):
        key = entries[entry, KEY]
        if key != NONE:
            previous, following = entries[entry, BEFORE], entries[entry, AFTER]
            if previous == NONE:
                heads[key & (heads.shape[0] - 1)] = following
            else:
                entries[previous, AFTER] = following
            if following != NONE:
                entries[following, BEFORE] = previous


@compiled
def neighbours(i, left, bottom, right, top, grid, layers, cell):
    """Discs other than i whose boxes overlap a part of that of i, each once, into `found`; returns how many."""
    boxes, heads, entries, found = grid.boxes, grid.heads, grid.entries, grid.found
    count = 0
    for k in range(grid.layer[i], layers):
        inverse = _inverse_size(cell, grid.levels[k])
        for cx in range(math.floor(left * inverse), math.floor(right * inverse) + 1):
            for cy in range(math.floor(bottom * inverse), math.floor(top * inverse) + 1):
                for guests in range(2 if k == grid.layer[i] and k > 0 else 1):
                    key = _key(cx, cy, 2 * k + guests)
                    entry = heads[key & (heads.shape[0] - 1)]
                    while entry != NONE:
                        j = entry // (4 * layers)
                        x, y = max(boxes[j, 0], left), max(boxes[j, 1], bottom)
                        if (
                            x <= min(boxes[j, 2], right)
                            and y <= min(boxes[j, 3], top)
                            and j != i
                            and math.floor(x * inverse) == cx  # of the cells both overlap, count one
                            and math.floor(y * inverse) == cy
                            and entries[entry, KEY] == key
                            and count < boxes.shape[0]
                        ):
                            found[count] = j
                            count += 1
                        entry = entries[entry, AFTER]
    return count
