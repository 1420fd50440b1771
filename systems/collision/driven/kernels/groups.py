"""Groups of pairs that shared particles connect; what cannot move connects none."""

from pinjoint.systems.collision.columns import NONE
from pinjoint.systems.collision.kernels import compiled


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
