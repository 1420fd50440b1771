"""What is computed of one rod `r` from particle `a` to `b`: fragments, pasted into loops over the rods.

sx, sy: displacement of b relative to a (m). drift_x, drift_y: velocity of b relative to a (m/s).
"""

# ruff: noqa: F821, F841, SIM108
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
        elongation += 0.5 * rest * (slope_start * bow_start + slope_end * bow_end)


def tangent_of_ends():
    """How moments and axial force follow slopes and elongation; `drawn`: the axial laws' stiffness × by_x."""
    rod_work[2, r] = drawn * rest * bow_start
    rod_work[3, r] = drawn * rest * bow_end
    thrust = by_x * axial_force * rest
    bowed = drawn * rest * rest
    rod_work[4, r] = thrust * rods_bowing[r, 0] + bowed * bow_start * bow_start
    rod_work[5, r] = thrust * rods_bowing[r, 1] + bowed * bow_start * bow_end
    rod_work[6, r] = thrust * rods_bowing[r, 2] + bowed * bow_end * bow_end
    insert(by_slopes)
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


def rate():
    """How fast the rod grows longer (m/s), and the slopes of its ends grow (rad/s); OF_AXIS: also its bowed axis (m/s)."""
    rate = drift_x * nx + drift_y * ny
    if BENDS:
        chord_spin = (nx * drift_y - ny * drift_x) * inverse
        rate_start = spin_a - chord_spin
        rate_end = spin_b - chord_spin
        if OF_AXIS:
            axis_rate = rate + rest * (bow_start * rate_start + bow_end * rate_end)


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
