"""A loop over the pairs of particles that are near each other, by the list of systems/program/near_pairs.py.

Pairs go by ascending rows, and those beyond the cutoff add nothing: no bit of a sum depends on when the list was made,
or on whether there is one.
"""

# ruff: noqa: F821, F841
# mypy: ignore-errors


def each_pair():
    """Every pair of particles `i` < `j`, at (x, y) from each other; all pairs where there is no list."""
    listed = are_listed(
        particles_position, displacement, pair_reach, pair_listed, pair_count, pair_list, pair_grid
    )
    first = pair_list.shape[0] - pair_count[0]
    i = 0
    j = 0
    for k in range(pair_count[0] if listed else displacement.shape[0] * (displacement.shape[0] - 1) // 2):
        if listed:
            i = pair_list[first + k, 0]
            j = pair_list[first + k, 1]
        else:
            j += 1
            if j == displacement.shape[0]:
                i += 1
                j = i + 1
        x = (particles_position[j, 0] - particles_position[i, 0]) + (displacement[j, 0] - displacement[i, 0])
        y = (particles_position[j, 1] - particles_position[i, 1]) + (displacement[j, 1] - displacement[i, 1])
        squared = x * x + y * y
        insert(laws)
