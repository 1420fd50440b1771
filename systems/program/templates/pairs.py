"""Pairs of particles that are near each other: which they are, and a loop over them.

    pair_reach    squares of the distance that particles may travel before the list is renewed and, from the third
                  entry on, of the cutoff of each law (m²); second entry: distance up to which pairs are listed (m)
    pair_listed   displacements at which the list was made, shape (particles, 2)
    pair_order    particles in the order of their places along x
    pair_first    where the pairs of each particle begin in pair_other
    pair_other    the second particles of all pairs, of each first one in ascending order
    pair_count    how many pairs the list has; -1: none was made yet; more than pair_other holds: it has no room for them

Pairs go by ascending rows, and those beyond the cutoff add nothing: no bit of a sum depends on when the list was made,
or on whether there is one.
"""

# ruff: noqa: F821, F841
# mypy: ignore-errors


def each_pair():
    """Every pair of particles `i` < `j`, at (x, y) from each other; all pairs where there is no list."""
    listed = list_pairs(displacement, *columns)
    for i in range(displacement.shape[0]):
        begin = pair_first[i] if listed else i + 1
        end = pair_first[i + 1] if listed else displacement.shape[0]
        for k in range(begin, end):
            j = pair_other[k] if listed else k
            x = (particles_position[j, 0] - particles_position[i, 0]) + (
                displacement[j, 0] - displacement[i, 0]
            )
            y = (particles_position[j, 1] - particles_position[i, 1]) + (
                displacement[j, 1] - displacement[i, 1]
            )
            squared = x * x + y * y
            insert(laws)


def list_pairs(displacement, *columns):
    """Renew the list if a particle has travelled too far since it was made; False: all pairs are to be looked at."""
    if pair_reach[1] == math.inf:
        return False
    count = displacement.shape[0]
    if pair_count[0] >= 0:
        travelled = 0.0
        for i in range(count):
            dx = displacement[i, 0] - pair_listed[i, 0]
            dy = displacement[i, 1] - pair_listed[i, 1]
            travelled = max(travelled, dx * dx + dy * dy)
        if travelled <= pair_reach[0]:
            return pair_count[0] <= pair_other.shape[0]
    for i in range(count):
        pair_listed[i, 0] = displacement[i, 0]
        pair_listed[i, 1] = displacement[i, 1]
        pair_first[i + 1] = 0
    pair_first[0] = 0
    sort_along_x(particles_position, pair_listed, pair_order)
    pair_count[0] = sweep(
        particles_position, pair_listed, pair_order, pair_reach[1], pair_first, pair_other, False
    )
    for i in range(count):
        pair_first[i + 1] += pair_first[i]
    if pair_count[0] > pair_other.shape[0]:
        return False
    sweep(particles_position, pair_listed, pair_order, pair_reach[1], pair_first, pair_other, True)
    for i in range(count, 0, -1):  # each now is where the next begins
        pair_first[i] = pair_first[i - 1]
    pair_first[0] = 0
    for i in range(count):
        sort_row(pair_other, pair_first[i], pair_first[i + 1])
    return True


def sort_along_x(particles_position, pair_listed, pair_order):
    """Bring particles into the order of their places along x, in which they nearly are."""
    for k in range(1, pair_order.shape[0]):
        i = pair_order[k]
        x = particles_position[i, 0] + pair_listed[i, 0]
        while k > 0:
            j = pair_order[k - 1]
            if not particles_position[j, 0] + pair_listed[j, 0] > x:
                break
            pair_order[k] = j
            k -= 1
        pair_order[k] = i


def sweep(particles_position, pair_listed, pair_order, reach, pair_first, pair_other, enter):
    """Count the pairs within reach, of each first particle at the entry after its own; or enter them in the list."""
    found = 0
    for k in range(pair_order.shape[0]):
        a = pair_order[k]
        x = particles_position[a, 0] + pair_listed[a, 0]
        for n in range(k + 1, pair_order.shape[0]):
            b = pair_order[n]
            beside = particles_position[b, 0] + pair_listed[b, 0]
            if beside - x > reach + 1e-15 * (abs(x) + abs(beside)):
                break
            dx = (particles_position[b, 0] - particles_position[a, 0]) + (pair_listed[b, 0] - pair_listed[a, 0])
            dy = (particles_position[b, 1] - particles_position[a, 1]) + (pair_listed[b, 1] - pair_listed[a, 1])
            if dx * dx + dy * dy <= reach * reach:
                low = min(a, b)
                if enter:
                    pair_other[pair_first[low]] = max(a, b)
                    pair_first[low] += 1
                else:
                    pair_first[low + 1] += 1
                found += 1
    return found


def sort_row(pair_other, begin, end):
    """Sort a few numbers."""
    for k in range(begin + 1, end):
        value = pair_other[k]
        while k > begin and pair_other[k - 1] > value:
            pair_other[k] = pair_other[k - 1]
            k -= 1
        pair_other[k] = value
