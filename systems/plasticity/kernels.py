"""Linear elastic, perfectly plastic: both limits move with the plastic strain."""

import math

from pinjoint.systems.program.kernel import compiled

AT_LIMIT = 1e-9  # relative distance from a limit within which a rod that moves on yields


@compiled
def limited(axial_force, rods_tension_limit, rods_compression_limit):
    """The axial force within the strengths."""
    return min(max(axial_force, -rods_compression_limit), rods_tension_limit)


@compiled
def branch(
    elongation,
    rate,
    rods_stiffness,
    rods_rest_length,
    rods_plastic_strain,
    rods_tension_limit,
    rods_compression_limit,
):
    """1: yielding in tension, −1: in compression, 0: elastic."""
    trial = rods_stiffness * (elongation / rods_rest_length - rods_plastic_strain)
    if rate > 0.0 and trial >= rods_tension_limit * (1.0 - AT_LIMIT):
        return 1.0
    if rate < 0.0 and trial <= -rods_compression_limit * (1.0 - AT_LIMIT):
        return -1.0
    return 0.0


@compiled
def margin(
    branch,
    elongation,
    rate,
    dt,
    rods_stiffness,
    rods_rest_length,
    rods_plastic_strain,
    rods_tension_limit,
    rods_compression_limit,
):
    """Elastic: distance of the axial force from the nearer limit; yielding: its growth in a step.

    Both relative to the strength.
    """
    strength = min(rods_tension_limit, rods_compression_limit)
    if strength == math.inf:
        return 1.0
    if branch != 0.0:
        return branch * rate * dt * rods_stiffness / (rods_rest_length * strength)
    trial = rods_stiffness * (elongation / rods_rest_length - rods_plastic_strain)
    return min(rods_tension_limit - trial, rods_compression_limit + trial) / strength


@compiled
def first_yield(time, axial_force, rods_tension_limit, rods_compression_limit, rods_yielded_at):
    """When the rod first came to a strength: the end of a step, which some integrators let end there; and no energy."""
    nearly = 1.0 - AT_LIMIT
    at_limit = axial_force >= rods_tension_limit * nearly or axial_force <= -rods_compression_limit * nearly
    if at_limit and math.isnan(rods_yielded_at):
        return time, 0.0
    return rods_yielded_at, 0.0


@compiled
def yielded(
    elongation,
    rods_stiffness,
    rods_rest_length,
    rods_plastic_strain,
    rods_tension_limit,
    rods_compression_limit,
):
    """The plastic strain ε_p after return to the elastic range, and the dissipated energy |N| |Δε_p| L₀."""
    strain = elongation / rods_rest_length
    trial = rods_stiffness * (strain - rods_plastic_strain)
    if trial > rods_tension_limit:
        plastic = strain - rods_tension_limit / rods_stiffness
        return plastic, rods_tension_limit * (plastic - rods_plastic_strain) * rods_rest_length
    if trial < -rods_compression_limit:
        plastic = strain + rods_compression_limit / rods_stiffness
        return plastic, rods_compression_limit * (rods_plastic_strain - plastic) * rods_rest_length
    return rods_plastic_strain, 0.0
