"""What is computed of one rod `r` from particle `a` to `b`: fragments, pasted into loops over the rods.

sx, sy: displacement of b relative to a (m). drift_x, drift_y: velocity of b relative to a (m/s).
"""

# ruff: noqa: F821, F841, RUF059, SIM108
# mypy: ignore-errors


def geometry():
    """Elongation (2D + Δu)·Δu / (L + L_original) + misfit (m): no digits cancel.

    Where no rod is warm the misfit is L_original − L₀, and both are at hand. A rod whose ends meet has no
    direction and pulls nowhere, until something else parts them.

    Of one that bends also the rotation of its chord, the slopes of its ends to it, and the elongation of its axis, which
    bows. The chord turns by 2 atan(S / (P + |C|)), S = D × Δu, C = D · x, P = L_original L: nothing cancels. The arctangent
    is Cephes' (argument halving, a rational function of degree 4/5, 3e-16): additions, multiplications, divisions and
    choices alone have the same bits everywhere, and vectorise. Full turns are told by the mean rotation of the rigid ends;
    adding and subtracting 1.5·2⁵² rounds to whole numbers.
    """
    dx = rods_difference[r, 0]
    dy = rods_difference[r, 1]
    x = dx + sx
    y = dy + sy
    original = rods_original_length[r]
    length = math.sqrt(x * x + y * y)
    inverse = 1.0 / length if length > 0.0 else 0.0
    nx = x * inverse
    ny = y * inverse
    both = length + original
    stretch = ((dx + x) * sx + (dy + y) * sy) / both if both > 0.0 else 0.0
    if WARM:
        elongation = stretch + rods_misfit[r]
    else:
        elongation = stretch + (original - rods_rest_length[r])
    if BENDS:
        if KINKED:
            turn_a -= rods_plastic_rotation[r, 0]
            turn_b -= rods_plastic_rotation[r, 1]
        sine = dx * sy - dy * sx
        cosine = dx * x + dy * y
        reach = length * original + abs(cosine)
        steep = abs(sine)
        folded = steep > 0.66 * reach
        under = steep + reach if folded else reach
        z = (steep - reach if folded else steep) / under if under > 0.0 else 0.0
        w = z * z
        above = (
            ((-0.8750608600031904 * w - 16.157537187333652) * w - 75.00855792314705) * w - 122.88666844901361
        ) * w
        below = (
            (((w + 24.858464901423062) * w + 165.02700983169885) * w + 432.88106049129027) * w
            + 485.3903996359137
        ) * w
        z += z * (w * (above - 64.85021904942025) / (below + 194.5506571482614))
        turned = 2.0 * (z + 0.7853981633974483 if folded else z)
        turned = 3.141592653589793 - turned if cosine < 0.0 else turned
        turned = -turned if sine < 0.0 else turned
        share_start = rods_turning_shares[r, 0]
        share_end = rods_turning_shares[r, 1]
        turns = (share_start * turn_a + share_end * turn_b - turned) * 0.15915494309189535
        chord = turned + 6.283185307179586 * ((turns + 6755399441055744.0) - 6755399441055744.0)
        slope_start = turn_a - chord
        slope_end = turn_b - chord
        bow_start = rods_bowing[r, 0] * slope_start + rods_bowing[r, 1] * slope_end
        bow_end = rods_bowing[r, 1] * slope_start + rods_bowing[r, 2] * slope_end
        rest = rods_rest_length[r]
        if SLIPS:
            straight = elongation
        elongation += 0.5 * rest * (slope_start * bow_start + slope_end * bow_end)
        if SLIPS:
            insert(unslipped)
            free_start = slope_start
            free_end = slope_end
            slip_start = 0.0
            slip_end = 0.0
            rare = (abs(moment_start) > rods_moment_limit[r, 0]) | (abs(moment_end) > rods_moment_limit[r, 1])
            if rare:
                slip_start, slip_end, moment_start, moment_end, thrust = slipping(
                    r, 1.0, straight, slope_start, slope_end, nx, ny, *needed
                )
                slope_start -= slip_start
                slope_end -= slip_end
                bow_start = rods_bowing[r, 0] * slope_start + rods_bowing[r, 1] * slope_end
                bow_end = rods_bowing[r, 1] * slope_start + rods_bowing[r, 2] * slope_end
                elongation = straight + 0.5 * rest * (slope_start * bow_start + slope_end * bow_end)


def slipping(r, share, straight, slope_start, slope_end, nx, ny, *needed):
    """Slips of the ends of rod `r` beyond its plastic rotations, its moments as if they did not slip further, and N L₀.

    share: of the plastic moments that counts. straight: elongation of the chord. Slips follow from the axial force, and that
    from the axis, which bows less for them: one equation, see systems/plasticity/hinges.py.
    """
    rest = rods_rest_length[r]
    bow_start = rods_bowing[r, 0] * slope_start + rods_bowing[r, 1] * slope_end
    bow_end = rods_bowing[r, 1] * slope_start + rods_bowing[r, 2] * slope_end
    elongation = straight + 0.5 * rest * (slope_start * bow_start + slope_end * bow_end)
    insert(unslipped)
    limit_start = share * rods_moment_limit[r, 0]
    limit_end = share * rods_moment_limit[r, 1]
    slip_start, slip_end = insert(slips)
    if slip_start == 0.0 and slip_end == 0.0:
        return slip_start, slip_end, moment_start, moment_end, thrust
    free_start = slope_start
    free_end = slope_end
    pulled_start = bow_start
    pulled_end = bow_end
    bent_start = moment_start - thrust * bow_start
    bent_end = moment_end - thrust * bow_end
    firm = FIRM * rods_bending_stiffness[r] / rest
    stiffness = rods_stiffness[r] / rest
    close = CLOSE * stiffness * (abs(straight) + abs(elongation))
    low = -math.inf
    high = math.inf
    for _ in range(MOST_TRIALS):
        slope_start = free_start - slip_start
        slope_end = free_end - slip_end
        bow_start = rods_bowing[r, 0] * slope_start + rods_bowing[r, 1] * slope_end
        bow_end = rods_bowing[r, 1] * slope_start + rods_bowing[r, 2] * slope_end
        tried = axial_force
        elongation = straight + 0.5 * rest * (slope_start * bow_start + slope_end * bow_end)
        insert(axial_force)
        missed = tried - axial_force
        if abs(missed) <= close:
            break
        softer = softening(
            thrust, bow_start, bow_end, slip_start, slip_end, insert(end_stiffness), insert(bowing)
        )
        here = axial_force
        elongation += 1e-6 * rest
        insert(axial_force)
        stiffness = max(axial_force - here, 0.0) / (1e-6 * rest)
        steepness = 1.0 + stiffness * rest * rest * softer if thrust > firm else 1.0
        axial_force, low, high = narrowed(tried, missed, steepness, low, high)
        if axial_force == tried:
            break
        thrust = max(axial_force * rest, firm)
        moment_start = bent_start + thrust * pulled_start
        moment_end = bent_end + thrust * pulled_end
        slip_start, slip_end = insert(slips)
    return slip_start, slip_end, moment_start, moment_end, thrust


def tangent_of_ends():
    """How moments and axial force follow slopes and elongation; `drawn`: the axial laws' stiffness × by_x.

    SLIPS: moments on ends that slip do not follow them, which condenses them like hinges.
    """
    rod_work[2, r] = drawn * rest * bow_start
    rod_work[3, r] = drawn * rest * bow_end
    thrust = by_x * axial_force * rest
    bowed = drawn * rest * rest
    rod_work[4, r] = thrust * rods_bowing[r, 0] + bowed * bow_start * bow_start
    rod_work[5, r] = thrust * rods_bowing[r, 1] + bowed * bow_start * bow_end
    rod_work[6, r] = thrust * rods_bowing[r, 2] + bowed * bow_end * bow_end
    insert(by_slopes)
    if SLIPS:
        if slip_start != 0.0 and rod_work[4, r] > 0.0:
            along = rod_work[2, r] / rod_work[4, r]
            across = rod_work[5, r] / rod_work[4, r]
            rod_work[0, r] -= along * rod_work[2, r]
            rod_work[3, r] -= along * rod_work[5, r]
            rod_work[6, r] -= across * rod_work[5, r]
            rod_work[2, r] = 0.0
            rod_work[4, r] = 0.0
            rod_work[5, r] = 0.0
        if slip_end != 0.0 and rod_work[6, r] > 0.0:
            along = rod_work[3, r] / rod_work[6, r]
            across = rod_work[5, r] / rod_work[6, r]
            rod_work[0, r] -= along * rod_work[3, r]
            rod_work[2, r] -= along * rod_work[5, r]
            rod_work[4, r] -= across * rod_work[5, r]
            rod_work[3, r] = 0.0
            rod_work[5, r] = 0.0
            rod_work[6, r] = 0.0
    insert(by_rates)
    insert(moments)
    rod_work[7, r] = by_x * (moment_start + moment_end) * inverse * inverse
    direction[r, 2] = inverse


def tangent_by():
    """How the moments that `laws` give follow the slopes (or their rates), times `share`: central differences."""
    small = 1e-6
    scaled = 0.5 * insert(share) / small
    present = slope_start
    slope_start = present + small
    insert(laws)
    above_start, above_end = summed_start, summed_end
    slope_start = present - small
    insert(laws)
    slope_start = present
    rod_work[4, r] += scaled * (above_start - summed_start)
    rod_work[5, r] += 0.5 * scaled * (above_end - summed_end)
    present = slope_end
    slope_end = present + small
    insert(laws)
    above_start, above_end = summed_start, summed_end
    slope_end = present - small
    insert(laws)
    slope_end = present
    rod_work[5, r] += 0.5 * scaled * (above_start - summed_start)
    rod_work[6, r] += scaled * (above_end - summed_end)


def end_moments():
    """Moments on the ends by the laws of ends (`law`), the axial force in the bowed axis, and what acts between the ends.

    SLIPS: none passes its plastic moment, by round-off neither.

    Forces, along and across the chord, act on the bent axis, so that they make a couple. TURNED: couples act, too.
    """
    insert(law)
    thrust = axial_force * rest
    moment_start += thrust * bow_start
    moment_end += thrust * bow_end
    if LOADED:
        across_start = rods_span_load[r, 1] * nx - rods_span_load[r, 0] * ny
        across_end = rods_span_load[r, 4] * nx - rods_span_load[r, 3] * ny
        couple = -(rods_span_load[r, 0] * nx + rods_span_load[r, 1] * ny) * slope_start
        couple -= (rods_span_load[r, 3] * nx + rods_span_load[r, 4] * ny) * slope_end
        if TURNED:
            across_start += rods_span_load[r, 2]
            across_end += rods_span_load[r, 5]
            couple += rods_span_load[r, 6]
        moment_start -= across_start
        moment_end -= across_end
    if SLIPS:
        moment_start = min(max(moment_start, -rods_moment_limit[r, 0]), rods_moment_limit[r, 0])
        moment_end = min(max(moment_end, -rods_moment_limit[r, 1]), rods_moment_limit[r, 1])


def rate():
    """How fast the rod grows longer (m/s), and the slopes of its ends grow (rad/s); OF_AXIS: also its bowed axis (m/s)."""
    rate = drift_x * nx + drift_y * ny
    if BENDS:
        chord_spin = (nx * drift_y - ny * drift_x) * inverse
        rate_start = spin_a - chord_spin
        rate_end = spin_b - chord_spin
        if OF_AXIS:
            axis_rate = rate + rest * (bow_start * rate_start + bow_end * rate_end)


def slip_rates():
    """How fast the ends slip now (gain) and a little later (then), by states a part and two parts `ahead` of a step.

    Limits a little lower tell an end that is about to slip or has just stopped from one that is elastic.
    """
    small = insert(ahead) * dt
    now_start, now_end, moment_start, moment_end, thrust = slipping(
        r, insert(share), straight, free_start, free_end, nx, ny, *needed
    )
    ahead_start = free_start + rate_start * small
    ahead_end = free_end + rate_end * small
    soon_start, soon_end, soon_moment_start, soon_moment_end, soon_thrust = slipping(
        r, insert(share), straight + rate * small, ahead_start, ahead_end, nx, ny, *needed
    )
    ahead_start += rate_start * small
    ahead_end += rate_end * small
    late_start, late_end, _, _, _ = slipping(
        r, insert(share), straight + 2.0 * rate * small, ahead_start, ahead_end, nx, ny, *needed
    )
    gain_start = (soon_start - now_start) / small
    gain_end = (soon_end - now_end) / small
    then_start = (late_start - soon_start) / small
    then_end = (late_end - soon_end) / small
    axis_rate -= rest * (bow_start * gain_start + bow_end * gain_end)


def stored():
    """Elastic energy, largest force and stiffness, from the force that stores energy, and from what the ends store."""
    flexibility = rods_rest_length[r] / rods_stiffness[r]
    largest = max(largest, abs(axial_force))
    stiffest = max(stiffest, 1.0 / flexibility)
    elastic += axial_force * axial_force * flexibility
    insert(of_axes)
    if BENDS:
        insert(moments)
        largest = max(largest, abs(moment_start) / rest, abs(moment_end) / rest)
        firmest = max(firmest, max(rods_end_stiffness[r, 0], rods_end_stiffness[r, 2]) / rest)
        insert(energies)
    if LOADED:
        potential += across_start * slope_start + across_end * slope_end
        if TURNED:
            potential += rods_span_load[r, 6] * chord


def observed():
    """The derived columns of rods. A rod yields where its axial force is at its strength, but for round-off."""
    rods_axial_force[r] = axial_force
    rods_length[r] = length
    rods_strain[r] = elongation / rods_rest_length[r]
    low, high = -insert(at_strength) * compression[r], insert(at_strength) * tension[r]
    yielding[r] = yields and (axial_force >= high or axial_force <= low)
    if BENDS:
        insert(moments)
        rods_end_moment[r, 0] = moment_start
        rods_end_moment[r, 1] = moment_end
