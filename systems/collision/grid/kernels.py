"""A hierarchical hash grid of boxes: which discs can meet before the present window ends.

Every disc has a box around its path until the window's end, and belongs to the finest layer whose cells are at
least as large as the box. It is entered there as native, by the cell of its box's centre, and as guest in all
coarser layers, so that two boxes that overlap are in adjacent cells of the coarser one's layer, whatever their
sizes; a very large or very fast disc costs no more than a look at all others.

boxes: shape (n, 4): left, bottom, right, top, m. layer: the layer of each disc, shape (n,). levels: the cells
of layer k have the size cell × 2^levels[k]; ascending. Entry disc × layers + layer of `entries`, shape
(capacity, 3), holds the entries after and before it in its bucket (−1: none) and the hash of its cell; heads
are the first entries of the buckets, a power of two of them.
"""

import math

from systems.collision.disc import AX, AY, EPOCH, OX, OY, RADIUS, UX, UY, VX, VY
from systems.collision.gap.kernels import extent
from systems.kernels import compiled

NONE = -1
AFTER, BEFORE, KEY = 0, 1, 2
FARTHEST_CELL = 2.0**40  # cells from the origin; farther out cells grow, so that they stay whole numbers
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
def enclose(i, discs, boxes, now, end):
    """Set the box of a disc to what its path covers from now to end."""
    start, stop = now - discs[i, EPOCH], end - discs[i, EPOCH]
    low_x, high_x = _range(discs[i, UX], discs[i, VX], discs[i, AX], start, stop)
    low_y, high_y = _range(discs[i, UY], discs[i, VY], discs[i, AY], start, stop)
    margin = MARGIN * max(extent(discs, i, now), extent(discs, i, end))
    around = discs[i, RADIUS] + margin
    boxes[i, 0] = discs[i, OX] + low_x - around
    boxes[i, 1] = discs[i, OY] + low_y - around
    boxes[i, 2] = discs[i, OX] + high_x + around
    boxes[i, 3] = discs[i, OY] + high_y + around


@compiled
def box_size(i, boxes):
    """The longer side of a disc's box."""
    return max(boxes[i, 2] - boxes[i, 0], boxes[i, 3] - boxes[i, 1])


@compiled
def level_of(i, boxes, cell):
    """The finest level (0: cells of size `cell`, then doubling) that suits the box of a disc."""
    away = max(abs(boxes[i, 0] + boxes[i, 2]), abs(boxes[i, 1] + boxes[i, 3]))
    size = max(box_size(i, boxes), 0.5 * away / FARTHEST_CELL)
    if size <= cell:
        return 0
    mantissa, exponent = math.frexp(size / cell)
    return min(exponent - 1 if mantissa == 0.5 else exponent, COARSEST)


@compiled
def layer_of(level, levels, layers):
    """The finest layer of at least this level; `layers` if all are finer."""
    k = 0
    while k < layers and levels[k] < level:
        k += 1
    return k


@compiled
def _key(cx, cy, kind):
    """Mixes a cell and 2 × layer (+ 1 for guests) into 64 bits."""
    h = cx * 0x9E3779B97F4A7C1 + cy * 0xC2B2AE3D27D4EB4 + kind * 0x165667B19E3779F
    h = (h ^ ((h >> 29) & 0x7FFFFFFFF)) * 0xBF58476D1CE4E5B
    return h ^ ((h >> 32) & 0xFFFFFFFF)


@compiled
def _inverse_size(cell, level):
    return math.ldexp(1.0 / cell, -level)


@compiled
def enter(i, boxes, layer, levels, layers, cell, heads, entries):
    """Enter a disc into its layer and all coarser ones."""
    x, y = 0.5 * (boxes[i, 0] + boxes[i, 2]), 0.5 * (boxes[i, 1] + boxes[i, 3])
    for k in range(layer[i], layers):
        inverse = _inverse_size(cell, levels[k])
        guest = 1 if k > layer[i] else 0
        key = _key(math.floor(x * inverse), math.floor(y * inverse), 2 * k + guest)
        bucket = key & (heads.shape[0] - 1)
        entry = i * layers + k
        first = heads[bucket]
        entries[entry, KEY] = key
        entries[entry, BEFORE] = NONE
        entries[entry, AFTER] = first
        if first != NONE:
            entries[first, BEFORE] = entry
        heads[bucket] = entry


@compiled
def leave(i, layer, layers, heads, entries):
    """Take a disc out of the grid."""
    for k in range(layer[i], layers):
        entry = i * layers + k
        previous, following = entries[entry, BEFORE], entries[entry, AFTER]
        if previous == NONE:
            heads[entries[entry, KEY] & (heads.shape[0] - 1)] = following
        else:
            entries[previous, AFTER] = following
        if following != NONE:
            entries[following, BEFORE] = previous


@compiled
def _collect(i, key, boxes, layers, heads, entries, found, count):
    """Add the discs of one cell whose boxes overlap that of disc i."""
    left, bottom, right, top = boxes[i, 0], boxes[i, 1], boxes[i, 2], boxes[i, 3]
    entry = heads[key & (heads.shape[0] - 1)]
    while entry != NONE:
        if entries[entry, KEY] == key:
            j = entry // layers
            apart = boxes[j, 0] > right or boxes[j, 2] < left or boxes[j, 1] > top or boxes[j, 3] < bottom
            if not apart and j != i and count < found.shape[0]:
                found[count] = j
                count += 1
        entry = entries[entry, AFTER]
    return count


@compiled
def neighbours(i, boxes, layer, levels, layers, cell, heads, entries, found):
    """Discs whose boxes overlap that of disc i, each once, into `found`, shape (n,); returns how many."""
    count = 0
    x, y = 0.5 * (boxes[i, 0] + boxes[i, 2]), 0.5 * (boxes[i, 1] + boxes[i, 3])
    size = box_size(i, boxes)
    for k in range(layer[i], layers):
        inverse = _inverse_size(cell, levels[k])
        reach = 0.501 * (size * inverse + 1.0)  # in cells; the excess covers rounding
        left, right = math.floor(x * inverse - reach), math.floor(x * inverse + reach)
        bottom, top = math.floor(y * inverse - reach), math.floor(y * inverse + reach)
        guests = k == layer[i] and k > 0
        for cx in range(left, right + 1):
            for cy in range(bottom, top + 1):
                count = _collect(i, _key(cx, cy, 2 * k), boxes, layers, heads, entries, found, count)
                if guests:
                    count = _collect(i, _key(cx, cy, 2 * k + 1), boxes, layers, heads, entries, found, count)
    return count
