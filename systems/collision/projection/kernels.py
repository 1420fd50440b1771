"""The least change of a group's motion, in the metric of its masses, after which no contact closes.

It minimizes ½ |m − m₀|²_M over N m + b ≥ 0. Its multipliers are the impulses, or the forces: none pulls, and
none acts at a contact that opens. The motion is unique; where contacts depend on one another the forces are one
solution of many.
"""

import math

from systems.collision.disc import EPSILON, SPEED_NOISE
from systems.collision.group import (
    ACTIVE,
    BIAS,
    CHOSEN,
    DIRECT,
    GIVEN,
    INITIAL,
    MOTION,
    NX,
    NY,
    OPENING,
    START,
    STATE,
)
from systems.kernels import compiled

IDLE, FITTED, DEPENDENT = 0, 1, 2
MOST_SWEEPS = 20000  # over the contacts of a projection; more: nearer to round-off in large groups, slower


@compiled
def opening_rate(c, links, contacts, motion):
    """Rate at which a contact opens; negative: it closes."""
    a, b = links[c, 0], links[c, 1]
    x, y = motion[b, 0] - motion[a, 0], motion[b, 1] - motion[a, 1]
    return contacts[c, NX] * x + contacts[c, NY] * y + contacts[c, BIAS]


@compiled
def compliance(c, d, links, contacts, mobility):
    """Rate at which a unit impulse in contact d opens contact c: N_cᵀ M⁻¹ N_d, 1/kg."""
    total = 0.0
    for p in range(2):
        for q in range(2):
            m = links[c, p]
            if m == links[d, q]:
                along = mobility[m, 0] * contacts[c, NX] * contacts[d, NX]
                along += mobility[m, 1] * contacts[c, NY] * contacts[d, NY]
                total += along if p == q else -along
    return total


@compiled
def push_apart(c, impulse, links, contacts, mobility, motion):
    """Give the discs of a contact opposite impulses that push them apart."""
    a, b = links[c, 0], links[c, 1]
    motion[a, 0] -= mobility[a, 0] * contacts[c, NX] * impulse
    motion[a, 1] -= mobility[a, 1] * contacts[c, NY] * impulse
    motion[b, 0] += mobility[b, 0] * contacts[c, NX] * impulse
    motion[b, 1] += mobility[b, 1] * contacts[c, NY] * impulse


@compiled
def copy_motion(source, target, members):
    """Note a motion."""
    for m in range(members):
        target[m, 0], target[m, 1] = source[m, 0], source[m, 1]


@compiled
def rate_noise(c, links, motions):
    """Rate below which a contact closes by round-off only."""
    total = 0.0
    for p in range(2):
        m = links[c, p]
        for note in (MOTION, INITIAL):
            total += abs(motions[note, m, 0]) + abs(motions[note, m, 1])
    return SPEED_NOISE * total


@compiled
def project(members, active, tolerance, links, contacts, mobility, motions, marks, matrix):
    """Project MOTION for the first `active` contacts of marks[ACTIVE]; impulses in column GIVEN.

    tolerance: rate at which a contact of a large group may still close. Large groups start from the
    impulses that GIVEN holds, small ones from none.
    """
    motion, start = motions[MOTION], motions[START]
    copy_motion(motion, start, members)
    if active <= DIRECT:
        for k in range(active):
            c = marks[ACTIVE, k]
            contacts[c, GIVEN] = 0.0
            marks[STATE, c] = IDLE
        _solve_by_active_set(members, active, links, contacts, mobility, motions, marks, matrix)
        tolerance = 0.0
    else:
        for k in range(active):
            c = marks[ACTIVE, k]
            push_apart(c, contacts[c, GIVEN], links, contacts, mobility, motion)
    _solve_by_sweeps(active, tolerance, links, contacts, mobility, motions, marks)


@compiled
def _solve_by_active_set(members, active, links, contacts, mobility, motions, marks, matrix):
    """Non-negative least squares after Lawson and Hanson, Solving Least Squares Problems (1974), chapter 23."""
    motion, start = motions[MOTION], motions[START]
    fitted = 0
    for _ in range(8 * DIRECT):
        worst = _worst(active, links, contacts, motions, marks)
        if worst < 0:
            return
        marks[CHOSEN, fitted] = worst
        marks[STATE, worst] = FITTED
        fitted = _fit(fitted + 1, links, contacts, mobility, start, marks, matrix)
        copy_motion(start, motion, members)
        for r in range(fitted):
            c = marks[CHOSEN, r]
            push_apart(c, contacts[c, GIVEN], links, contacts, mobility, motion)


@compiled
def _worst(active, links, contacts, motions, marks):
    """The idle contact that closes fastest, or −1."""
    worst, fastest = -1, 0.0
    for k in range(active):
        c = marks[ACTIVE, k]
        if marks[STATE, c] == IDLE:
            rate = opening_rate(c, links, contacts, motions[MOTION])
            if rate < fastest and rate < -rate_noise(c, links, motions):
                worst, fastest = c, rate
    return worst


@compiled
def _fit(fitted, links, contacts, mobility, start, marks, matrix):
    """Impulses that stop the chosen contacts, without those that would have to pull; returns how many are left."""
    values = matrix[DIRECT]
    while fitted > 0:
        if not _solve(fitted, links, contacts, mobility, start, marks, matrix):
            fitted -= 1  # the newest depends on the others, which stop it already
            c = marks[CHOSEN, fitted]
            contacts[c, GIVEN] = 0.0
            marks[STATE, c] = DEPENDENT
            continue
        share = 1.0
        for r in range(fitted):
            if values[r] <= 0.0:
                given = contacts[marks[CHOSEN, r], GIVEN]
                share = min(share, given / (given - values[r]))
        kept = 0
        for r in range(fitted):
            c = marks[CHOSEN, r]
            given = contacts[c, GIVEN]
            if values[r] <= 0.0 and given <= share * (given - values[r]):
                contacts[c, GIVEN] = 0.0
                marks[STATE, c] = IDLE
            else:
                contacts[c, GIVEN] = given + share * (values[r] - given)
                marks[CHOSEN, kept] = c
                kept += 1
        if kept == fitted:
            return fitted
        fitted = kept
    return 0


@compiled
def _solve(count, links, contacts, mobility, start, marks, matrix):
    """Impulses that bring the chosen contacts' rates to 0, into row DIRECT of the matrix, by Cholesky.

    False if the last row depends on the others.
    """
    values = matrix[DIRECT]
    for r in range(count):
        row = marks[CHOSEN, r]
        values[r] = -opening_rate(row, links, contacts, start)
        for c in range(r + 1):
            value = compliance(row, marks[CHOSEN, c], links, contacts, mobility)
            for k in range(c):
                value -= matrix[r, k] * matrix[c, k]
            if c < r:
                matrix[r, c] = value / matrix[c, c]
            elif value > 64.0 * EPSILON * contacts[row, OPENING]:
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
def _solve_by_sweeps(active, tolerance, links, contacts, mobility, motions, marks):
    """Gauss–Seidel, to and fro, from the impulses GIVEN so far, until rates change by less than the tolerance."""
    motion = motions[MOTION]
    for sweep in range(MOST_SWEEPS):
        settled = True
        for k in range(active):
            c = marks[ACTIVE, k if sweep % 2 == 0 else active - 1 - k]
            rate = opening_rate(c, links, contacts, motion)
            impulse = max(contacts[c, GIVEN] - rate / contacts[c, OPENING], 0.0)
            change = impulse - contacts[c, GIVEN]
            if abs(change) * contacts[c, OPENING] > max(tolerance, rate_noise(c, links, motions)):
                push_apart(c, change, links, contacts, mobility, motion)
                contacts[c, GIVEN] = impulse
                settled = False
        if settled:
            return
