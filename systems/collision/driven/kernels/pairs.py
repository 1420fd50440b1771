"""Pairs of driven particles, or of a particle and an obstacle: their gaps, and groups that shared particles connect.

The numbers of obstacles follow those of the particles; obstacles have no displacement. What cannot move connects none.
"""

import math

from pinjoint.systems.collision.columns import NONE
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.time_of_impact import nearest_of_piece


@compiled
def gap_of(i, j, position, displacement, radius, span):
    """Distance between the rims of two, and the unit vector from the first centre to the second."""
    dx, dy = position[j, 0] - position[i, 0], position[j, 1] - position[i, 1]
    if j < displacement.shape[0]:
        dx += displacement[j, 0] - displacement[i, 0]
        dy += displacement[j, 1] - displacement[i, 1]
    else:
        dx -= displacement[i, 0]
        dy -= displacement[i, 1]
    dx, dy, _ = nearest_of_piece(dx, dy, span[j, 0], span[j, 1])
    distance = math.hypot(dx, dy)
    unit = distance if distance > 0.0 else 1.0
    return distance - (radius[i] + radius[j]), dx / unit, dy / unit


@compiled
def opening(i, j, nx, ny, speed):
    """Speed (m/s) at which a pair parts along the line of centres."""
    x, y = -speed[i, 0], -speed[i, 1]
    if j < speed.shape[0]:
        x, y = speed[j, 0] + x, speed[j, 1] + y
    return nx * x + ny * y


@compiled
def chain_groups(driven, count, n):
    """Chain the first `count` pairs in `touching`, group by group; `place` of the group's root is the first of them."""
    for t in range(count):
        k = driven.touching[t]
        i, j = driven.pairs[k, 0], driven.pairs[k, 1]
        if j < n and moves(driven, i) and moves(driven, j):
            first, second = _root(driven, i), _root(driven, j)
            if first != second:
                driven.parent[max(first, second)] = min(first, second)
    for t in range(count - 1, -1, -1):
        root = root_of(driven, driven.touching[t], n)
        driven.chain[t] = driven.group.place[root]
        driven.group.place[root] = t


@compiled
def end_groups(driven, count, n):
    """Forget the groups."""
    for t in range(count):
        for e in range(2):
            i = driven.pairs[driven.touching[t], e]
            driven.parent[i] = NONE
            driven.group.place[i] = NONE


@compiled
def root_of(driven, k, n):
    """The particle by which the group of a pair goes."""
    i, j = driven.pairs[k, 0], driven.pairs[k, 1]
    return _root(driven, i if j >= n or moves(driven, i) else j)


@compiled
def moves(driven, i):
    """True for a particle that supports do not hold in both directions."""
    return driven.weight[i, 0] > 0.0 or driven.weight[i, 1] > 0.0


@compiled
def _root(driven, i):
    while driven.parent[i] != NONE:
        i = driven.parent[i]
    return i
