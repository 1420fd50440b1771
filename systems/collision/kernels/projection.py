"""The least change of a group's motion, in the metric of its masses, after which no contact closes.

It minimizes ½ |m − m₀|²_M over N m + b ≥ 0. Its multipliers are the impulses, or the forces: none pulls, and
none acts at a contact that opens. The motion is unique; where contacts depend on one another the forces are one
solution of many.
"""

import math

from pinjoint.systems.collision.columns import DIRECT, EPSILON, SPEED_NOISE, Contact
from pinjoint.systems.collision.kernels import compiled

IDLE, TAKEN = 0, 1  # of contacts: TAKEN: fitted, or dependent on such
MOST_SWEEPS = 20000  # over the contacts of a large group; more: nearer to round-off, slower
MOST_CROWD_SWEEPS = 200  # over the contacts of a crowd; its next step continues from the impulses reached


@compiled
def opening_rate(c, motion, group):
    """Rate at which a contact opens; negative: it closes."""
    a, b = group.links[c, 0], group.links[c, 1]
    x, y = motion[b, 0] - motion[a, 0], motion[b, 1] - motion[a, 1]
    nx, ny = group.contacts[c, Contact.NX], group.contacts[c, Contact.NY]
    return nx * x + ny * y + group.contacts[c, Contact.BIAS]


@compiled
def compliance(c, d, group):
    """Rate at which a unit impulse in contact d opens contact c: N_cᵀ M⁻¹ N_d, 1/kg."""
    first, second = group.contacts[c], group.contacts[d]
    nx, ny, px, py = first[Contact.NX], first[Contact.NY], second[Contact.NX], second[Contact.NY]
    return coupling((group.links[c], group.links[d]), nx, ny, px, py, group.mobility)


@compiled
def coupling(ends, nx, ny, px, py, mobility):
    """Rate along (nx, ny) at which the first pair parts where a unit impulse along (px, py) pushes the second apart."""
    total = 0.0
    for p in range(2):
        for q in range(2):
            m = ends[0][p]
            if m == ends[1][q]:
                along = mobility[m, 0] * nx * px
                along += mobility[m, 1] * ny * py
                total += along if p == q else -along
    return total


@compiled
def push_apart(c, impulse, group):
    """Give the discs of a contact opposite impulses that push them apart."""
    motion, mobility = group.motion, group.mobility
    a, b = group.links[c, 0], group.links[c, 1]
    x, y = group.contacts[c, Contact.NX] * impulse, group.contacts[c, Contact.NY] * impulse
    motion[a, 0] -= mobility[a, 0] * x
    motion[a, 1] -= mobility[a, 1] * y
    motion[b, 0] += mobility[b, 0] * x
    motion[b, 1] += mobility[b, 1] * y


@compiled
def copy_motion(source, target, members):
    """Copy a motion."""
    for m in range(members):
        target[m, 0], target[m, 1] = source[m, 0], source[m, 1]


@compiled
def begin(members, group):
    """Copy the motion to `initial`, and set the noise."""
    copy_motion(group.motion, group.initial, members)
    set_noise(members, group)


@compiled
def set_noise(members, group):
    """Set the noise to the round-off of the largest part of the motion."""
    largest = 0.0
    for m in range(members):
        largest = max(largest, abs(group.motion[m, 0]) + abs(group.motion[m, 1]))
    group.noise[0] = 2.0 * SPEED_NOISE * largest


@compiled
def project(members, active, tolerance, most, group):
    """Project the motion for the first so many contacts of group.active; impulses in column IMPULSE.

    tolerance: rate at which a contact of a large group may still close. most: sweeps over its contacts. Large groups
    start from the impulses that IMPULSE holds, small ones from none.
    """
    copy_motion(group.motion, group.start, members)
    if active <= DIRECT:
        for k in range(active):
            c = group.active[k]
            group.contacts[c, Contact.IMPULSE] = 0.0
            group.state[c] = IDLE
        _solve_by_active_set(members, active, group)
        tolerance = 0.0
    else:
        for k in range(active):
            c = group.active[k]
            push_apart(c, group.contacts[c, Contact.IMPULSE], group)
    sweep(active, most, tolerance, group)


@compiled
def separate_motion(members, count, tolerance, group):
    """Change the motion of a group as little as possible so that no contact closes faster than its bias.

    Links, normals, biases and first impulses are set; column IMPULSE then holds the impulses. Where sweeps are too few
    to find them, all are reduced so that they do no work in sum.
    """
    active = 0
    for c in range(count):
        opening = compliance(c, c, group)
        group.contacts[c, Contact.COMPLIANCE] = opening
        if opening > 0.0:
            group.active[active] = c
            active += 1
    begin(members, group)
    project(members, active, tolerance, MOST_CROWD_SWEEPS, group)
    _limit_work(members, active, tolerance, group)


@compiled
def _limit_work(members, active, tolerance, group):
    """Reduce all impulses p by one factor so that p · (N m + b) ≤ 0 for the motion m after them.

    Before that, take impulses back that the last acceleration of the sweeps turned into a pull, and those too small for a
    sweep to take back where a contact opens.
    """
    before, after, least = 0.0, 0.0, max(tolerance, group.noise[0])
    for k in range(active):
        c = group.active[k]
        small = group.contacts[c, Contact.IMPULSE] * group.contacts[c, Contact.COMPLIANCE] <= least
        if group.contacts[c, Contact.IMPULSE] < 0.0 or (small and opening_rate(c, group.motion, group) > least):
            push_apart(c, -group.contacts[c, Contact.IMPULSE], group)
            group.contacts[c, Contact.IMPULSE] = 0.0
    for k in range(active):
        c = group.active[k]
        before += group.contacts[c, Contact.IMPULSE] * opening_rate(c, group.initial, group)
        after += group.contacts[c, Contact.IMPULSE] * opening_rate(c, group.motion, group)
    if after <= 0.0:
        return
    share = -before / (after - before) if before < 0.0 else 0.0
    for k in range(active):
        group.contacts[group.active[k], Contact.IMPULSE] *= share
    for m in range(members):
        for d in range(2):
            group.motion[m, d] = group.initial[m, d] + share * (group.motion[m, d] - group.initial[m, d])


@compiled
def _solve_by_active_set(members, active, group):
    """Non-negative least squares after Lawson and Hanson, Solving Least Squares Problems (1974), chapter 23."""
    fitted = 0
    for _ in range(8 * DIRECT):
        worst = _worst(active, group)
        if worst < 0:
            return
        group.chosen[fitted] = worst
        group.state[worst] = TAKEN
        fitted = _fit(fitted + 1, group)
        copy_motion(group.start, group.motion, members)
        for r in range(fitted):
            c = group.chosen[r]
            push_apart(c, group.contacts[c, Contact.IMPULSE], group)


@compiled
def _worst(active, group):
    """The idle contact that closes fastest, or −1."""
    worst, fastest = -1, 0.0
    for k in range(active):
        c = group.active[k]
        if group.state[c] == IDLE:
            rate = opening_rate(c, group.motion, group)
            if rate < fastest and rate < -group.noise[0]:
                worst, fastest = c, rate
    return worst


@compiled
def _fit(fitted, group):
    """Impulses that stop the chosen contacts, without those that would have to pull; returns how many are left."""
    contacts, values = group.contacts, group.matrix[DIRECT]
    while fitted > 0:
        if not _solve(fitted, group):
            fitted -= 1  # the newest depends on the others, which stop it already
            c = group.chosen[fitted]
            contacts[c, Contact.IMPULSE] = 0.0
            group.state[c] = TAKEN
            continue
        share = 1.0
        for r in range(fitted):
            if values[r] <= 0.0:
                present = contacts[group.chosen[r], Contact.IMPULSE]
                share = min(share, present / (present - values[r]))
        kept = 0
        for r in range(fitted):
            c = group.chosen[r]
            present = contacts[c, Contact.IMPULSE]
            if values[r] <= 0.0 and not present / (present - values[r]) > share:  # to the bit as above
                contacts[c, Contact.IMPULSE] = 0.0
                group.state[c] = IDLE
            else:
                contacts[c, Contact.IMPULSE] = present + share * (values[r] - present)
                group.chosen[kept] = c
                kept += 1
        if kept == fitted:
            return fitted
        fitted = kept
    return 0


@compiled
def _solve(count, group):
    """Impulses that bring the chosen contacts' rates to 0, into row DIRECT of the matrix, by Cholesky.

    False if a row depends on those before it.
    """
    matrix, values = group.matrix, group.matrix[DIRECT]
    for r in range(count):
        row = group.chosen[r]
        values[r] = -opening_rate(row, group.start, group)
        for c in range(r + 1):
            value = compliance(row, group.chosen[c], group)
            for k in range(c):
                value -= matrix[r, k] * matrix[c, k]
            if c < r:
                matrix[r, c] = value / matrix[c, c]
            elif value > 64.0 * EPSILON * group.contacts[row, Contact.COMPLIANCE]:
                matrix[r, r] = math.sqrt(value)
            else:
                return False
        for k in range(r):
            values[r] -= matrix[r, k] * values[k]
        values[r] /= matrix[r, r]
    for r in range(count - 1, -1, -1):
        for k in range(r + 1, count):
            values[r] -= matrix[k, r] * values[k]
        values[r] /= matrix[r, r]
    return True


@compiled
def sweep(active, most, tolerance, group):
    """Gauss–Seidel, to and fro, from the impulses so far, until rates change by less than the tolerance.

    Accelerated by conjugate directions: Silcowitz, Niebe, Erleben, "A nonsmooth nonlinear conjugate gradient method for
    interactive contact force problems", Vis. Comput. 26 (2010).
    """
    contacts, size = group.contacts, 0.0
    for turn in range(most):
        for k in range(active):
            c = group.active[k]
            contacts[c, Contact.PREVIOUS] = contacts[c, Contact.IMPULSE]
        settled = _relax_all(active, 1, tolerance, group)
        if settled:
            return
        _relax_all(active, -1, tolerance, group)
        previous, size = size, 0.0
        for k in range(active):
            c = group.active[k]
            change = contacts[c, Contact.IMPULSE] - contacts[c, Contact.PREVIOUS]
            size += change * change * contacts[c, Contact.COMPLIANCE]
        share = size / previous if size <= previous and previous > 0.0 else 0.0
        keep = 1.0 if turn == 0 or share > 0.0 else 0.0
        for k in range(active):
            c = group.active[k]
            more = share * contacts[c, Contact.DIRECTION] if turn > 0 else 0.0
            swept = more + contacts[c, Contact.IMPULSE] - contacts[c, Contact.PREVIOUS]
            contacts[c, Contact.DIRECTION] = keep * swept
            if more != 0.0:
                contacts[c, Contact.IMPULSE] += more
                push_apart(c, more, group)


@compiled
def _relax_all(active, way, tolerance, group):
    """Change the impulse of every contact, one by one, so that it neither closes nor pulls; True if none had to."""
    contacts, settled = group.contacts, True
    for k in range(active):
        c = group.active[k if way > 0 else active - 1 - k]
        rate = opening_rate(c, group.motion, group)
        impulse = max(contacts[c, Contact.IMPULSE] - rate / contacts[c, Contact.COMPLIANCE], 0.0)
        change = impulse - contacts[c, Contact.IMPULSE]
        if abs(change) * contacts[c, Contact.COMPLIANCE] > max(tolerance, group.noise[0]):
            push_apart(c, change, group)
            contacts[c, Contact.IMPULSE] = impulse
            settled = False
    return settled
