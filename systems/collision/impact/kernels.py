"""Impacts of one or many contacts at the same instant, by generalized reflections.

Smith, Kaufman, Vouga, Tamstorf, Grinspun, "Reflections on simultaneous impact", ACM Trans. Graph. 31 (2012):
project the velocities, in the metric of the masses, onto those at which no approaching contact approaches any
more; reflect about that projection; repeat with the contacts that approach now until none does. Energy,
momentum and symmetry are kept. Restitution e blends this with the plastic answer, the projection onto all
contacts at once: v = e v_elastic + (1 − e) v_plastic. For a single contact it is Newton's law.

A group is a set of discs ("members" 0, 1, …) and of contacts between them:

links: shape (c, 2), the two members of each contact.
contacts: shape (c, 5), the columns below.
mobility: shape (m, 2), inverse mass of each member in each direction, 1/kg, 0 where it is held, so that
    N_cᵀ M⁻¹ N_d is the compliance of the contacts under the members' supports.
velocities: shape (4, m, 2), m/s; MOTION is what impulses change, the others are notes of earlier motion.
marks: shape (3, c), work space; matrix: shape (DIRECT + 2, DIRECT), work space.
"""

import math

from systems.collision.disc import EPSILON, SPEED_NOISE
from systems.kernels import compiled

NX, NY = 0, 1  # unit vector from the first member to the second
GIVEN = 2  # impulse of the present projection, N·s
IMPULSE = 3  # of the whole impact
OPENING = 4  # compliance of the contact itself, 1/kg

MOTION, INITIAL, START, ELASTIC = 0, 1, 2, 3
ACTIVE, STATE, CHOSEN = 0, 1, 2
IDLE, FITTED, DEPENDENT = 0, 1, 2

DIRECT = 48  # contacts up to which a projection is solved directly; more: by sweeps
MOST_SWEEPS = 20000  # over the contacts of a projection; more: nearer to round-off in large groups, slower
MOST_REFLECTIONS = 1000000  # in one impact; after that the rest of it is taken as plastic


@compiled
def separation_speed(c, links, contacts, motion):
    """Rate at which a contact opens, m/s; negative: its discs approach."""
    a, b = links[c, 0], links[c, 1]
    x, y = motion[b, 0] - motion[a, 0], motion[b, 1] - motion[a, 1]
    return contacts[c, NX] * x + contacts[c, NY] * y


@compiled
def compliance(c, d, links, contacts, mobility):
    """Speed at which a unit impulse in contact d opens contact c: N_cᵀ M⁻¹ N_d, 1/kg."""
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
    """Give the discs of a contact opposite impulses (N·s) that push them apart."""
    a, b = links[c, 0], links[c, 1]
    motion[a, 0] -= mobility[a, 0] * contacts[c, NX] * impulse
    motion[a, 1] -= mobility[a, 1] * contacts[c, NY] * impulse
    motion[b, 0] += mobility[b, 0] * contacts[c, NX] * impulse
    motion[b, 1] += mobility[b, 1] * contacts[c, NY] * impulse


@compiled
def respond(members, count, restitution, links, contacts, mobility, velocities, marks, matrix):
    """Carry out the impact of a group of `count` contacts.

    MOTION goes from the velocities before to those after, INITIAL keeps those before; the column IMPULSE is
    set. The columns NX and NY must be set.
    """
    motion, initial = velocities[MOTION], velocities[INITIAL]
    _copy(motion, initial, members)
    for c in range(count):
        contacts[c, OPENING] = compliance(c, c, links, contacts, mobility)
        contacts[c, IMPULSE] = 0.0
    if count == 1:
        _respond_alone(restitution, links, contacts, mobility, motion)
        return
    if restitution > 0.0:
        _reflect(members, count, links, contacts, mobility, velocities, marks, matrix)
    if restitution < 1.0:
        _copy(motion, velocities[ELASTIC], members)
        _copy(initial, motion, members)
        _make_plastic(members, count, links, contacts, mobility, velocities, marks, matrix)
        _blend(members, count, restitution, contacts, velocities)


@compiled
def _copy(source, target, members):
    for m in range(members):
        target[m, 0], target[m, 1] = source[m, 0], source[m, 1]


@compiled
def _respond_alone(restitution, links, contacts, mobility, motion):
    """Newton's law: the speed of approach is reversed and multiplied by the restitution."""
    speed = separation_speed(0, links, contacts, motion)
    if speed < 0.0 and contacts[0, OPENING] > 0.0:
        contacts[0, IMPULSE] = -(1.0 + restitution) * speed / contacts[0, OPENING]
        push_apart(0, contacts[0, IMPULSE], links, contacts, mobility, motion)


@compiled
def _reflect(members, count, links, contacts, mobility, velocities, marks, matrix):
    """The elastic impact."""
    motion, start = velocities[MOTION], velocities[START]
    for _ in range(MOST_REFLECTIONS):
        approaching = 0
        for c in range(count):
            speed = separation_speed(c, links, contacts, motion)
            if speed < -_noise(c, links, velocities) and contacts[c, OPENING] > 0.0:
                marks[ACTIVE, approaching] = c
                approaching += 1
        if approaching == 0:
            return
        _copy(motion, start, members)
        _project(members, approaching, links, contacts, mobility, velocities, marks, matrix)
        for m in range(members):
            for d in range(2):
                motion[m, d] += motion[m, d] - start[m, d]
        for k in range(approaching):
            c = marks[ACTIVE, k]
            contacts[c, IMPULSE] += 2.0 * contacts[c, GIVEN]
    _make_plastic(members, count, links, contacts, mobility, velocities, marks, matrix)
    for c in range(count):
        contacts[c, IMPULSE] += contacts[c, GIVEN]


@compiled
def _make_plastic(members, count, links, contacts, mobility, velocities, marks, matrix):
    """The plastic impact of all contacts; impulses in column GIVEN."""
    active = 0
    for c in range(count):
        contacts[c, GIVEN] = 0.0
        if contacts[c, OPENING] > 0.0:
            marks[ACTIVE, active] = c
            active += 1
    _copy(velocities[MOTION], velocities[START], members)
    _project(members, active, links, contacts, mobility, velocities, marks, matrix)


@compiled
def _blend(members, count, restitution, contacts, velocities):
    motion, elastic = velocities[MOTION], velocities[ELASTIC]
    for m in range(members):
        for d in range(2):
            motion[m, d] = restitution * elastic[m, d] + (1.0 - restitution) * motion[m, d]
    for c in range(count):
        elastic_impulse = contacts[c, IMPULSE]
        contacts[c, IMPULSE] = restitution * elastic_impulse + (1.0 - restitution) * contacts[c, GIVEN]


@compiled
def _noise(c, links, velocities):
    """Speed below which the approach of a contact is round-off."""
    total = 0.0
    for p in range(2):
        m = links[c, p]
        for note in (MOTION, INITIAL):
            total += abs(velocities[note, m, 0]) + abs(velocities[note, m, 1])
    return SPEED_NOISE * total


# --- projection: the least change, in the metric of the masses, after which no active contact approaches ---


@compiled
def _project(members, active, links, contacts, mobility, velocities, marks, matrix):
    """Project MOTION for the first `active` contacts of marks[ACTIVE]; impulses in column GIVEN.

    START must equal MOTION.
    """
    for k in range(active):
        c = marks[ACTIVE, k]
        contacts[c, GIVEN] = 0.0
        marks[STATE, c] = IDLE
    if active <= DIRECT:
        _project_directly(members, active, links, contacts, mobility, velocities, marks, matrix)
    _project_by_sweeps(active, links, contacts, mobility, velocities, marks)


@compiled
def _project_directly(members, active, links, contacts, mobility, velocities, marks, matrix):
    """By an active set: non-negative least squares, Lawson and Hanson 1974, chapter 23."""
    motion, start = velocities[MOTION], velocities[START]
    fitted = 0
    for _ in range(8 * DIRECT):
        worst = _worst(active, links, contacts, velocities, marks)
        if worst < 0:
            return
        marks[CHOSEN, fitted] = worst
        marks[STATE, worst] = FITTED
        fitted = _fit(fitted + 1, links, contacts, mobility, start, marks, matrix)
        _copy(start, motion, members)
        for r in range(fitted):
            c = marks[CHOSEN, r]
            push_apart(c, contacts[c, GIVEN], links, contacts, mobility, motion)


@compiled
def _worst(active, links, contacts, velocities, marks):
    """The idle contact that approaches fastest, or −1."""
    worst, fastest = -1, 0.0
    for k in range(active):
        c = marks[ACTIVE, k]
        if marks[STATE, c] == IDLE:
            speed = separation_speed(c, links, contacts, velocities[MOTION])
            if speed < fastest and speed < -_noise(c, links, velocities):
                worst, fastest = c, speed
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
    """Impulses that bring the chosen contacts' speeds to 0, into row DIRECT of the matrix, by Cholesky.

    False if the last row depends on the others.
    """
    values = matrix[DIRECT]
    for r in range(count):
        row = marks[CHOSEN, r]
        values[r] = -separation_speed(row, links, contacts, start)
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
def _project_by_sweeps(active, links, contacts, mobility, velocities, marks):
    """Gauss–Seidel, to and fro, from the impulses GIVEN so far, until nothing but round-off changes."""
    motion = velocities[MOTION]
    for sweep in range(MOST_SWEEPS):
        settled = True
        for k in range(active):
            c = marks[ACTIVE, k if sweep % 2 == 0 else active - 1 - k]
            speed = separation_speed(c, links, contacts, motion)
            impulse = max(contacts[c, GIVEN] - speed / contacts[c, OPENING], 0.0)
            change = impulse - contacts[c, GIVEN]
            if abs(change) * contacts[c, OPENING] > _noise(c, links, velocities):
                push_apart(c, change, links, contacts, mobility, motion)
                contacts[c, GIVEN] = impulse
                settled = False
        if settled:
            return
