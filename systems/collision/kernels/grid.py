"""A hierarchical hash grid of boxes: which discs can collide before the present horizon ends.

Every disc has a box around its path until the horizon's end, and belongs to the finest layer whose cells are
larger than the box, so that it overlaps at most four of them. It is entered as native into these, and as guest into
those of all coarser layers. Discs whose boxes overlap share a cell of the coarser of their layers, whatever their sizes:
a very large or very fast disc costs no more than a look at all others. They may share more; they find each other in that
of the left bottom corner of what overlaps.

Corner × (a power of two) + kind × discs + disc is the entry of a disc in a layer, with kind = 2 × layer, + 1 for guests,
and corner from 0 to 3 for the cells that its box overlaps, most often one. The entries of a bucket are chained, to and
fro. The buckets of neighbouring cells differ.
"""

import math

from pinjoint.systems.collision.columns import NONE, Count, Disc, Number
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.time_of_impact import extent

CORNERS = 4  # cells of its layer, or of a coarser one, that a box overlaps at most
FARTHEST_CELL = 2.0**40  # cells from the origin; farther out cells grow, so that they can be told apart
COARSEST = 63
SAMPLED_DISCS = 128  # discs that decide the size of the cells
GOLDEN_SECTION = 0.6180339887498949
KIND = 0x165667B19  # far from 0 in any number of buckets
BOX_MARGIN = 1e-13  # of a disc's coordinates, added to its box: more than the noise of a gap
NOWHERE = 1e150  # m; what is farther away is lost


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
def set_box(i, x, y, tx, ty, around, away, grid):
    """Set the box around a straight piece from (x, y), or around a point; that of what is lost is of no use.

    around: how wide it is beyond that (m). away: magnitude of the numbers that make up its place (m).
    """
    if not away + around < NOWHERE:
        x, y, tx, ty, around, away = 0.0, 0.0, 0.0, 0.0, 1.0, 1.0
    around += BOX_MARGIN * (around + away)
    grid.boxes[i, 0], grid.boxes[i, 1] = x + min(tx, 0.0) - around, y + min(ty, 0.0) - around
    grid.boxes[i, 2], grid.boxes[i, 3] = x + max(tx, 0.0) + around, y + max(ty, 0.0) + around


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
def _level_of(i, grid, cell):
    """The finest level (0: cells of size `cell`, then doubling) that suits the box of a disc."""
    size = suitable_size(i, grid)
    if size <= cell:
        return 0
    mantissa, exponent = math.frexp(size / cell)
    return min(exponent - 1 if mantissa == 0.5 else exponent, COARSEST)


@compiled
def _layer_of(level, grid, layers):
    """The finest layer of at least this level; `layers` if all are finer."""
    k = 0
    while k < layers and grid.levels[k] < level:
        k += 1
    return k


@compiled
def _choose_layers(grid, cell, coarsest):
    """Choose the layers that the boxes need, and one of at least the level `coarsest`; returns how many.

    cell: size of the finest cells. Every disc is given its layer.
    """
    count = grid.boxes.shape[0]
    needed = 1 << min(coarsest, COARSEST)
    for i in range(count):
        grid.layer[i] = _level_of(i, grid, cell)
        needed |= 1 << grid.layer[i]
    layers = 0
    for level in range(COARSEST + 1):
        if (needed >> level) & 1:
            grid.levels[layers] = level
            grid.inverse[layers] = math.ldexp(1.0 / cell, -level)
            layers += 1
    for i in range(count):
        grid.layer[i] = _layer_of(grid.layer[i], grid, layers)
    return layers


@compiled
def _cell_size(grid):
    """About twice the largest of the boxes, but not more than a few times the small ones (measured).

    Nor so small that no layer is coarse enough for the largest: every box overlaps few cells, however small others are.
    """
    if grid.boxes.shape[0] == 0:
        return 1.0
    small, large = _quantile(grid, 0.1), _quantile(grid, 0.9)
    least = 0.0
    for i in range(grid.boxes.shape[0]):
        least = max(least, math.ldexp(suitable_size(i, grid), 1 - COARSEST))
    return max(2.0 * large if large <= 8.0 * small else 4.0 * small, least)


@compiled
def _quantile(grid, share):
    """The least size of a sampled box that at least a share of the sampled boxes do not exceed."""
    count = grid.boxes.shape[0]
    stride = max(count // SAMPLED_DISCS, 1)
    sampled = (count + stride - 1) // stride
    best = math.inf
    for i in range(0, count, stride):
        size = box_size(i, grid)
        if size < best:
            smaller = 0
            for j in range(0, count, stride):
                if box_size(j, grid) <= size:
                    smaller += 1
            if smaller >= share * sampled:
                best = size
    return best


@compiled
def emptied(grid, layers):
    """Take all boxes out of the buckets; False if so many layers do not fit into the arrays."""
    for bucket in range(grid.heads.shape[0]):
        grid.heads[bucket] = NONE
    return 2 * grid.boxes.shape[0] * layers <= _plane(grid)


@compiled
def _plane(grid):
    """The number of entries of a corner, a power of two."""
    return grid.after.shape[0] // CORNERS


@compiled
def _row(grid):
    """How far the bucket of a cell is from that of the cell below: the golden section spreads rows evenly."""
    return int(GOLDEN_SECTION * grid.heads.shape[0]) | 1


@compiled
def _kind(i, k, grid):
    """2 k for a native of layer k, 2 k + 1 for a guest."""
    return 2 * k + (1 if k > grid.layer[i] else 0)


@compiled
def _cells(left, bottom, right, top, k, grid):
    """The first and last column and row of the cells of layer k that a box overlaps."""
    inverse = grid.inverse[k]
    x, y = math.floor(left * inverse), math.floor(bottom * inverse)
    return x, y, min(math.floor(right * inverse), x + 1), min(math.floor(top * inverse), y + 1)


@compiled
def enter(i, grid, layers):
    """Enter a disc into its layer and all coarser ones."""
    heads, after, before = grid.heads, grid.after, grid.before
    mask, row, plane = heads.shape[0] - 1, _row(grid), _plane(grid)
    left, bottom, right, top = grid.boxes[i]
    for k in range(grid.layer[i], layers):
        kind = _kind(i, k, grid)
        first_x, first_y, last_x, last_y = _cells(left, bottom, right, top, k, grid)
        entry = kind * grid.boxes.shape[0] + i
        for y in range(first_y, last_y + 1):
            for x in range(first_x, last_x + 1):
                bucket = (x + y * row + kind * KIND) & mask
                following = heads[bucket]
                after[entry], before[entry] = following, NONE
                if following != NONE:
                    before[following] = entry
                heads[bucket] = entry
                entry += plane


@compiled
def leave(i, grid, layers):
    """Take a disc out of the grid, before its box changes."""
    heads, after, before = grid.heads, grid.after, grid.before
    mask, row, plane = heads.shape[0] - 1, _row(grid), _plane(grid)
    left, bottom, right, top = grid.boxes[i]
    for k in range(grid.layer[i], layers):
        kind = _kind(i, k, grid)
        first_x, first_y, last_x, last_y = _cells(left, bottom, right, top, k, grid)
        entry = kind * grid.boxes.shape[0] + i
        for y in range(first_y, last_y + 1):
            for x in range(first_x, last_x + 1):
                following, previous = after[entry], before[entry]
                if following != NONE:
                    before[following] = previous
                if previous != NONE:
                    after[previous] = following
                else:
                    heads[(x + y * row + kind * KIND) & mask] = following
                entry += plane


@compiled
def neighbours(i, grid, layers, count):
    """Discs other than i whose boxes overlap that of i, each once, into `found` after the first `count`.

    Returns how many have been found then.
    """
    mask, row = grid.heads.shape[0] - 1, _row(grid)
    left, bottom, right, top = grid.boxes[i]
    for k in range(grid.layer[i], layers):
        first_x, first_y, last_x, last_y = _cells(left, bottom, right, top, k, grid)
        for kind in range(2 * k, 2 * k + (2 if k == grid.layer[i] and k > 0 else 1)):
            for y in range(first_y, last_y + 1):
                for x in range(first_x, last_x + 1):
                    entry = grid.heads[(x + y * row + kind * KIND) & mask]
                    if entry != NONE:
                        left_most, lowest = x == first_x, y == first_y
                        box = left, bottom, right, top
                        count = _look_into(entry, kind, i, box, x, y, left_most, lowest, k, count, grid)
    return count


@compiled
def _look_into(entry, kind, i, box, x, y, left_most, lowest, k, count, grid):
    """Add the discs of a bucket, from an entry on, whose boxes overlap that of i.

    Each in the cell of the left bottom corner of what overlaps. Which do is hard to predict for a processor: it is
    counted rather than branched upon.
    """
    boxes, found, inverse = grid.boxes, grid.found, grid.inverse[k]
    left, bottom, right, top = box
    first, mask = kind * boxes.shape[0], _plane(grid) - 1
    while entry != NONE:
        j = (entry & mask) - first
        if 0 <= j < boxes.shape[0]:
            found[count] = j
            near = (
                (boxes[j, 0] <= right) & (left <= boxes[j, 2]) & (boxes[j, 1] <= top) & (bottom <= boxes[j, 3])
            )
            here = left_most | (math.floor(boxes[j, 0] * inverse) == x)
            count += near & here & (lowest | (math.floor(boxes[j, 1] * inverse) == y)) & (j != i)
        entry = grid.after[entry]
    return count


@compiled
def set_layers(grid, numbers, counts):
    """Choose the finest cells and the layers that the boxes need, and give every disc its layer."""
    numbers[Number.CELL] = _cell_size(grid)
    counts[Count.LAYERS] = _choose_layers(grid, numbers[Number.CELL], counts[Count.LEVEL])
    counts[Count.LEVEL] = 0


@compiled
def enclose_anew(i, discs, grid, numbers, counts):
    """Set the box of a disc with a new path. False if it is too large for the grid: a new horizon must be opened."""
    layers = counts[Count.LAYERS]
    leave(i, grid, layers)
    enclose(i, discs, grid, numbers[Number.NOW], numbers[Number.HORIZON_END])
    level = _level_of(i, grid, numbers[Number.CELL])
    grid.layer[i] = _layer_of(level, grid, layers)
    enter(i, grid, layers)
    if grid.layer[i] < layers:
        return True
    counts[Count.LEVEL] = max(counts[Count.LEVEL], level)
    return False


@compiled
def sort(found, count):
    """Sort a few numbers: the order in which a grid finds discs depends on when it was made."""
    for k in range(1, count):
        value = found[k]
        while k > 0 and found[k - 1] > value:
            found[k] = found[k - 1]
            k -= 1
        found[k] = value


@compiled
def list_pairs(pairs, grid):
    """List the pairs of discs i < j whose boxes overlap, in ascending order, at the end of `pairs`.

    Returns how many, also where there is no room for all of them, or NONE if the grid has no room; and its layers.
    """
    layers, count, room = _choose_layers(grid, _cell_size(grid), 0), 0, pairs.shape[0]
    if not emptied(grid, layers):
        return NONE, layers
    # from the last on, so that those entered have higher numbers
    for i in range(grid.boxes.shape[0] - 1, -1, -1):
        near = neighbours(i, grid, layers, 0)
        sort(grid.found, near)
        for k in range(near - 1, -1, -1):
            count += 1
            if count <= room:
                pairs[room - count, 0], pairs[room - count, 1] = i, grid.found[k]
        enter(i, grid, layers)
    return count, layers


@compiled
def are_listed(position, displacement, reach, listed, count, pairs, grid):
    """Renew the list if a particle has travelled too far since it was made; False: all pairs are to be looked at.

    The arrays are those of systems/program/near_pairs.py.
    """
    if reach[1] == math.inf:
        return False
    travelled = 0.0
    for i in range(displacement.shape[0]):
        dx, dy = displacement[i, 0] - listed[i, 0], displacement[i, 1] - listed[i, 1]
        travelled = max(travelled, dx * dx + dy * dy)
    room = pairs.shape[0]
    if count[0] >= 0 and travelled <= reach[0]:
        return count[0] <= room
    for i in range(displacement.shape[0]):
        x, y, away = position[i, 0], position[i, 1], abs(position[i, 0]) + abs(position[i, 1])
        for d in range(2):
            listed[i, d] = displacement[i, d]
            away += abs(displacement[i, d])
        set_box(i, x + displacement[i, 0], y + displacement[i, 1], 0.0, 0.0, 0.5 * reach[1], away, grid)
    found, _ = list_pairs(pairs, grid)
    if found == NONE or found > room:
        count[0] = max(found, room + 1)
        return False
    near = 0
    for k in range(room - 1, room - 1 - found, -1):
        i, j = pairs[k, 0], pairs[k, 1]
        dx = (position[j, 0] - position[i, 0]) + (displacement[j, 0] - displacement[i, 0])
        dy = (position[j, 1] - position[i, 1]) + (displacement[j, 1] - displacement[i, 1])
        if dx * dx + dy * dy <= reach[1] * reach[1]:
            near += 1
            pairs[room - near, 0], pairs[room - near, 1] = i, j
    count[0] = near
    return True
