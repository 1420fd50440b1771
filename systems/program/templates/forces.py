"""Forces of a state, the history of rods, and the energy that either takes or brings."""

# ruff: noqa: F821, F841
# mypy: ignore-errors


def external(time, dt, displacement, velocity, force, resisting, *columns):
    """force ← constant forces, varying loads, laws of particles (kN); resisting ← laws that resist their motion."""
    insert(particle_forces)


def forces(time, dt, state, *columns):
    """force ← all but dampers and drag (kN); resisting ← dampers and drag; direction ← of the rods."""
    external(time, dt, displacement, velocity, force, resisting, *columns)
    insert(rod_forces)


def accept(time, dt, state, account, *columns):
    """As forces(), at the end of a step: history is brought up to date first."""
    external(time, dt, displacement, velocity, force, resisting, *columns)
    insert(rod_forces)


def resist(time, dt, displacement, velocity, resisting, direction, power, *columns):
    """resisting ← dampers and drag at this velocity (kN); power ← what each account gains per second (kW)."""
    insert(resistance)


def load_power(time, velocity, *columns):
    """What the varying loads do per second at a velocity (kW)."""
    power = 0.0
    insert(loads)
    return power


def evaluate(time, dt, state, power, *columns):
    """As forces(), at any stage of a step; power ← what each account gains per second there (kW)."""
    insert(trial_forces)


def remember(time, dt, displacement, account, *columns):
    """Bring the history of all rods up to date at the end of a step."""
    insert(history)


def commit(time, dt, state, account, *columns):
    """Bring history up to date in a state that no step has led to."""
    if ALIKE:
        accept(time, dt, *state, account, *columns)
    else:
        remember(time, dt, displacement, account, *columns)


def present():
    """The forces of the present state, and what follows from them."""
    if ALIKE:
        forces(control[Control.TIME], control[Control.STEP_SIZE], *state, *columns)
        if POWERS:
            resist(
                control[Control.TIME],
                control[Control.STEP_SIZE],
                displacement,
                velocity,
                resisting,
                direction,
                power,
                *columns,
            )
    else:
        evaluate(control[Control.TIME], control[Control.STEP_SIZE], *state, power, *columns)
        accelerate(force, resisting, work[0], particles_mobility)


def each_pair():
    """Every pair of near particles `i` < `j`, at (x, y) from each other; all pairs where there is no list (near_pairs.py).

    Pairs go by ascending rows, and those beyond the cutoff add nothing: no bit of a sum depends on when the list was made,
    or on whether there is one.
    """
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
