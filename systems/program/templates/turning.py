"""The second block of coordinates: rotations, of models that bend. Fragments, pasted where others say insert(name).

rotation (rad), angular_velocity (rad/s), moment and twisting (kN·m) are to displacement, velocity, force and resisting
what turns, shape (rows, particles, 1), is to `work`. What treats coordinates one by one is written a second time by
pasting.projected, under the same name with `_turns` at its end.
"""

# ruff: noqa: F821, F841
# mypy: ignore-errors


# --- integrators with fixed steps --------------------------------------------------------------------


def push_turns():
    push_of_turns(dt, angular_velocity, moment, twisting, predicted_spin, particles_turning)


# --- integrators that control their steps -------------------------------------------------------------


def trial_turns():
    trial_rotation, trial_spin = turns[STAGES], turns[STAGES + 1]


def extrapolate_turns():
    extrapolate_of_turns(s, dt, rotation, angular_velocity, turns, trial_rotation, trial_spin)


def accelerate_turns():
    accelerate_of_turns(moment, twisting, turns[s], particles_turning)


def begin_turns():
    accelerate_of_turns(moment, twisting, turns[0], particles_turning)


def combine_turns():
    """The error of a step is the larger of those of the two blocks."""
    turned = combine_of_turns(h, tolerance, rotation, angular_velocity, turns, control, search)
    if error >= 0.0 and not error >= turned:
        error = turned


def accept_turns():
    for i in range(rotation.shape[0]):
        rotation[i, 0] = turns[STAGES, i, 0]
        angular_velocity[i, 0] = turns[STAGES + 1, i, 0]


def largest_turns():
    control[Control.LARGEST_ROTATION] = search[Search.LARGEST_ROTATION]
    control[Control.LARGEST_SPIN] = search[Search.LARGEST_SPIN]


def allow_turns():
    allowed = max(
        allowed,
        (tolerance if tolerance > 0.0 else FIXED_TOLERANCE)
        * (control[Control.LARGEST_SPIN] * search[Search.REACH]),
    )


# --- implicit stages ----------------------------------------------------------------------------------


def known_turns():
    known_rotation, known_spin = turns[STAGES + 2], turns[STAGES + 3]
    turning_correction = turns[STAGES + 4]
    reach = search[Search.REACH]


def extrapolate_known_turns():
    extrapolate_of_turns(s, dt, rotation, angular_velocity, turns, known_rotation, known_spin)
    turning_acceleration = turns[s]
    for i in range(rotation.shape[0]):
        turning_acceleration[i, 0] = turns[s - 1, i, 0]


def predict_turns():
    for i in range(rotation.shape[0]):
        trial_spin[i, 0] = known_spin[i, 0] + by_v * turning_acceleration[i, 0]
        trial_rotation[i, 0] = known_rotation[i, 0] + by_x * turning_acceleration[i, 0]


def change_turns():
    for i in range(rotation.shape[0]):
        turning_acceleration[i, 0] += turning_correction[i, 0]
        change += (reach * turning_correction[i, 0]) ** 2


def size_of_turns():
    for i in range(turning_acceleration.shape[0]):
        size += (reach * turning_acceleration[i, 0]) ** 2


def tangent_turns():
    turning_diagonal[i, 0] = 0.001 * particles_inertia[i]


def correct_turns():
    turning_residual, turning_search = turns[STAGES + 5], turns[STAGES + 6]
    turning_product, turning_solved = turns[STAGES + 7], turns[STAGES + 8]
    turning_diagonal, turning_straight = turns[STAGES + 9], turns[STAGES + 10]


def tangent_rows_turns():
    tangents = rod_work


def residual_turns():
    for i in range(trial.shape[0]):
        turning_correction[i, 0] = 0.0
        turning_residual[i, 0] = 0.0
        if particles_turning[i, 0] > 0.0:
            total = moment[i, 0] - turning_acceleration[i, 0] * (0.001 * particles_inertia[i])
            if RATES:
                total += twisting[i, 0]
            turning_residual[i, 0] = total


def search_turns():
    for i in range(trial.shape[0]):
        turning_search[i, 0] = turning_solved[i, 0]


def curvature_turns():
    for i in range(trial.shape[0]):
        curvature += turning_search[i, 0] * turning_product[i, 0]


def improve_turns():
    for i in range(trial.shape[0]):
        turning_correction[i, 0] += share * turning_search[i, 0]
        turning_residual[i, 0] -= share * turning_product[i, 0]


def search_on_turns():
    for i in range(trial.shape[0]):
        turning_search[i, 0] = turning_solved[i, 0] + ratio * turning_search[i, 0]


def multiply_turns():
    """The product with the matrix; the shear of a rod turns with its chord."""
    for i in range(turning_vector.shape[0]):
        turning_product[i, 0] = turning_diagonal[i, 0] * turning_vector[i, 0]


def multiply_rod_turns():
    inverse = direction[r, 2]
    stretched = nx * sx + ny * sy
    aside = nx * sy - ny * sx
    leaning = aside * inverse
    slope_a = turning_vector[a, 0] - leaning
    slope_b = turning_vector[b, 0] - leaning
    turned_a = tangents[2, r] * stretched + tangents[4, r] * slope_a + tangents[5, r] * slope_b
    turned_b = tangents[3, r] * stretched + tangents[5, r] * slope_a + tangents[6, r] * slope_b
    pulled = tangents[2, r] * slope_a + tangents[3, r] * slope_b + tangents[7, r] * aside
    pushed = tangents[7, r] * stretched - (turned_a + turned_b) * inverse
    px += pulled * nx - pushed * ny
    py += pulled * ny + pushed * nx
    turning_product[a, 0] += turned_a
    turning_product[b, 0] += turned_b


def held_turns():
    for i in range(turning_vector.shape[0]):
        if particles_turning[i, 0] == 0.0:
            turning_product[i, 0] = 0.0


def precondition_turns():
    for i in range(turning_diagonal.shape[0]):
        turning_straight[i, 0] = turning_diagonal[i, 0]


def precondition_rod_turns():
    inverse = direction[r, 2]
    leaning = (tangents[4, r] + 2.0 * tangents[5, r] + tangents[6, r]) * inverse * inverse
    sideways += max(leaning, 0.0)
    stiffer -= max(leaning, 0.0)
    turning_straight[rods_between[r, 0], 0] += max(tangents[4, r], 0.0)
    turning_straight[rods_between[r, 1], 0] += max(tangents[6, r], 0.0)


def inverted_turns():
    for i in range(turning_diagonal.shape[0]):
        free = particles_turning[i, 0] > 0.0
        turning_straight[i, 0] = 1.0 / turning_straight[i, 0] if free else 0.0


def relax_turns():
    for i in range(turning_residual.shape[0]):
        turning_solved[i, 0] = turning_straight[i, 0] * turning_residual[i, 0]
        size += turning_solved[i, 0] * turning_residual[i, 0]


# --- reading a state ----------------------------------------------------------------------------------


def turning():
    """Energies, residual and scales of the rotations; a moment counts as a force by the shortest rod at its particle."""
    rolled = 0.0
    for i in range(displacement.shape[0]):
        spin = angular_velocity[i, 0] if particles_turning[i, 0] > 0.0 else 0.0
        kinetic += particles_inertia[i] * spin * spin
        potential += particles_constant_moment[i] * rotation[i, 0]
        total = moment[i, 0] + twisting[i, 0] if RATES else moment[i, 0]
        power_norm += total * particles_turning[i, 0] * total
        if particles_turning[i, 0] > 0.0:
            power += total * spin
            residual = max(residual, abs(moment[i, 0]) * lever[i])
        largest = max(largest, abs(particles_constant_moment[i]) * lever[i])
        rolled = max(rolled, abs(rotation[i, 0]))
    firmest = 0.0


def turned():
    round_off += insert(round_off) * firmest * rolled


def clamps():
    """Moments of clamps."""
    for i in range(displacement.shape[0]):
        clamp = 0.0 - (moment[i, 0] + twisting[i, 0]) if clamped[i] else 0.0
        reaction_moment[i] = clamp
