"""Plastic hinges: ends of rods turn beyond what is elastic, so that no moment passes the plastic moment.

With slopes φ, axial force N and elastic matrix A = K + N L₀ B the moments are A (φ − x) + c; the slips x of the ends solve
|M| ≤ M_p, x = 0 where less, x having the sign of M: a linear complementarity problem of two ends. N follows from the bow of
what stays elastic, b = ½ (φ − x)ᵀ B (φ − x), which falls as N grows: one equation with one root. M_p does not depend on N.
"""

import math

from pinjoint.systems.plasticity.kernels import AT_LIMIT
from pinjoint.systems.program.kernel import compiled

CLOSE = 2e-16  # share of EA × strains below which axial forces do not differ
MOST_TRIALS = 50  # of the axial force; more would not tell its last bits
FIRM = (
    -11.0
)  # N L₀²/EI from which on A counts as it is there: at −12 the rod buckles within itself, and A is singular


@compiled
def slips(moment_start, moment_end, limit_start, limit_end, thrust, rods_end_stiffness, rods_bowing):
    """How far the ends of a rod slip (rad), given the moments that they had without, plastic moments, and thrust = N L₀.

    Of neither, one and both ends slipping, one case agrees with its own moments: that which rounding spoils least.
    """
    if abs(moment_start) <= limit_start and abs(moment_end) <= limit_end:
        return 0.0, 0.0
    start = rods_end_stiffness[0] + thrust * rods_bowing[0]
    mixed = rods_end_stiffness[1] + thrust * rods_bowing[1]
    end = rods_end_stiffness[2] + thrust * rods_bowing[2]
    least, slip_start, slip_end = math.inf, 0.0, 0.0
    if abs(moment_start) > limit_start:
        slip = (moment_start - math.copysign(limit_start, moment_start)) / start
        least, slip_start = abs(moment_end - mixed * slip) - limit_end, slip
    if abs(moment_end) > limit_end and least > 0.0:
        slip = (moment_end - math.copysign(limit_end, moment_end)) / end
        wrong = abs(moment_start - mixed * slip) - limit_start
        if wrong < least:
            least, slip_start, slip_end = wrong, 0.0, slip
    if least > 0.0 and limit_start < math.inf and limit_end < math.inf:
        rest = start * end - mixed * mixed
        for case in range(4):
            sign_start, sign_end = 1.0 - 2.0 * (case % 2), 1.0 - 2.0 * (case // 2)
            over_start, over_end = moment_start - sign_start * limit_start, moment_end - sign_end * limit_end
            one = (end * over_start - mixed * over_end) / rest
            other = (start * over_end - mixed * over_start) / rest
            wrong = max(-sign_start * one * start, -sign_end * other * end)
            if wrong < least:
                least, slip_start, slip_end = wrong, one, other
    return slip_start, slip_end


@compiled
def softening(thrust, bow_start, bow_end, slip_start, slip_end, rods_end_stiffness, rods_bowing):
    """By how much the bow falls as thrust grows while ends slip: −∂b/∂(N L₀) = wᵀ A⁻¹ w of these, w = B (φ − x)."""
    start = rods_end_stiffness[0] + thrust * rods_bowing[0]
    mixed = rods_end_stiffness[1] + thrust * rods_bowing[1]
    end = rods_end_stiffness[2] + thrust * rods_bowing[2]
    if slip_start != 0.0 and slip_end != 0.0:
        above = end * bow_start * bow_start - 2.0 * mixed * bow_start * bow_end + start * bow_end * bow_end
        return above / (start * end - mixed * mixed)
    if slip_start != 0.0:
        return bow_start * bow_start / start
    return bow_end * bow_end / end if slip_end != 0.0 else 0.0


@compiled
def narrowed(force, missed, steepness, low, high):
    """The next axial force to try, and the bounds between which it must be.

    missed: by how much an axial force is more than what follows from it, which grows at least as fast as it. steepness: how
    fast.
    """
    low, high = (low, force) if missed > 0.0 else (force, high)
    nearer = force - missed / steepness
    if not low < nearer < high:
        nearer = 0.5 * (max(low, force - abs(missed)) + min(high, force + abs(missed)))
    return nearer, low, high


@compiled
def turned(slip_start, slip_end, rods_plastic_rotation, rods_moment_limit):
    """The plastic rotations of both ends after they slipped, and the dissipated energy |M Δp|."""
    lost = 0.0
    if slip_start != 0.0:
        lost += rods_moment_limit[0] * abs(slip_start)
    if slip_end != 0.0:
        lost += rods_moment_limit[1] * abs(slip_end)
    return rods_plastic_rotation[0] + slip_start, rods_plastic_rotation[1] + slip_end, lost


@compiled
def first_hinges(time, moment_start, moment_end, rods_moment_limit, rods_hinge_formed_at):
    """When the moments at the ends first came to the plastic moment; and no energy."""
    start, end = rods_hinge_formed_at
    if start < 0.0 and abs(moment_start) >= rods_moment_limit[0] * (1.0 - AT_LIMIT):
        start = time
    if end < 0.0 and abs(moment_end) >= rods_moment_limit[1] * (1.0 - AT_LIMIT):
        end = time
    return start, end, 0.0


@compiled
def branch(moment_start, moment_end, gain_start, gain_end):
    """3 × the sign of the moment at the start if that end goes on slipping, + that at the end likewise."""
    start = math.copysign(1.0, moment_start) if gain_start * moment_start > 0.0 else 0.0
    end = math.copysign(1.0, moment_end) if gain_end * moment_end > 0.0 else 0.0
    return 3.0 * start + end


@compiled
def margin(
    branch,
    dt,
    moment_start,
    moment_end,
    gain_start,
    gain_end,
    thrust,
    rods_end_stiffness,
    rods_bowing,
    rods_moment_limit,
):
    """Elastic: distance of the moment, if the other end does as its branch says, from the limit; slipping: its growth.

    Both relative to the plastic moment; that of the end where it is less.
    """
    limit_start, limit_end = rods_moment_limit
    start = rods_end_stiffness[0] + thrust * rods_bowing[0]
    mixed = rods_end_stiffness[1] + thrust * rods_bowing[1]
    end = rods_end_stiffness[2] + thrust * rods_bowing[2]
    sign_start = 1.0 if branch > 1.5 else -1.0 if branch < -1.5 else 0.0
    sign_end = branch - 3.0 * sign_start
    low = 1.0
    if sign_start != 0.0:
        low = min(low, sign_start * gain_start * dt * start / limit_start)
        if sign_end == 0.0:
            moment_end -= mixed / start * (moment_start - sign_start * limit_start)
    elif sign_end != 0.0:
        moment_start -= mixed / end * (moment_end - sign_end * limit_end)
    if sign_end != 0.0:
        low = min(low, sign_end * gain_end * dt * end / limit_end)
    if sign_start == 0.0 and limit_start < math.inf:
        low = min(low, 1.0 - abs(moment_start) / limit_start)
    if sign_end == 0.0 and limit_end < math.inf:
        low = min(low, 1.0 - abs(moment_end) / limit_end)
    return low
