"""Persistent contacts: discs that rest on one another or slide along one another.

A contact persists while its force pushes: forces F ≥ 0 and accelerations satisfy, at the contacts whose discs do not
separate, n·Δa + |Δv|²/d ≥ 0, and F = 0 where it is > 0. Discs that are at rest under these forces stay where they are,
at no cost. Discs that slide take steps h of the classical Runge–Kutta method with these accelerations. At the end of a
step places and velocities are projected, by W N₁ p, onto gap = 0 and n₁·Δv = 0 (Hairer, Wanner, Solving Ordinary
Differential Equations II, 2nd ed., section VII.2), so that gaps and energy drift by the fifth power of h at most. In
between, paths are polynomials of the fourth degree through both ends: parabolas, near which impacts are sought, and a bend.
"""

import math

from pinjoint.systems.collision.columns import NONE, Contact, Count, Disc, Entry, Number
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.projection import (
    MOST_SWEEPS,
    begin,
    compliance,
    copy_motion,
    opening_rate,
    project,
    push_apart,
    set_noise,
)
from pinjoint.systems.collision.kernels.time_of_impact import (
    INFINITY,
    is_straight,
    passing,
    place_noise,
    relative_state,
    speed_noise,
    touch_speed,
)

STILL = 1e-10  # of the speed and acceleration that gravity gives: a slower disc is at rest
STEP_ANGLE = 0.0156  # by which discs turn around one another in a step; discs sink by its cube / 8 of a radius
LEAST_SHARE = 1e-4  # of such a step: error of the time at which a flat side or a contact ends


@compiled
def is_held(i, discs):
    """True if a disc cannot move at all."""
    return discs[i, Disc.WX] == 0.0 and discs[i, Disc.WY] == 0.0


# --- the table ----------------------------------------------------------------------------------------------


@compiled
def find_persistent(i, j, constraints):
    """Entry of the persistent contact of two discs, in the chain of either; NONE if they have none."""
    for a, b in ((i, j), (j, i)):
        entry = constraints.first_persistent[a]
        while entry != NONE:
            if constraints.persistent[entry, Entry.OTHER] == b:
                return entry
            entry = constraints.persistent[entry, Entry.NEXT]
    return NONE


@compiled
def forget_persistent(i, constraints, counts):
    """Remove all entries of a disc."""
    entry = constraints.first_persistent[i]
    while entry != NONE:
        following = constraints.persistent[entry, Entry.NEXT]
        constraints.persistent[entry, Entry.NEXT] = counts[Count.SPARE]
        counts[Count.SPARE] = entry
        counts[Count.SPARES] += 1
        entry = following
    constraints.first_persistent[i] = NONE


@compiled
def enter_persistent(i, j, force, discs, constraints, counts):
    """Enter a persistent contact of two discs for each that is not held."""
    for disc, other in ((i, j), (j, i)):
        if not is_held(disc, discs):
            entry = counts[Count.SPARE]
            counts[Count.SPARE] = constraints.persistent[entry, Entry.NEXT]
            counts[Count.SPARES] -= 1
            constraints.persistent[entry, Entry.OTHER] = other
            constraints.persistent[entry, Entry.NEXT] = constraints.first_persistent[disc]
            constraints.forces[entry] = force
            constraints.first_persistent[disc] = entry


# --- the end of a step --------------------------------------------------------------------------------------


@compiled
def hold_together(count, touching, discs, group, numbers):
    """Project the velocities in `motion` for the contacts that have persisted until now."""
    active = 0
    for c in range(touching):
        group.contacts[c, Contact.IMPULSE] = 0.0
        if group.contacts[c, Contact.FORCE] > 0.0 and group.contacts[c, Contact.COMPLIANCE] > 0.0:
            lasted = 0.0
            for p in range(2):
                i = group.members[group.links[c, p]]
                if discs[i, Disc.STEP] < INFINITY:
                    lasted = numbers[Number.NOW] - discs[i, Disc.EPOCH]
            _pull_together(c, 0.5 * lasted * group.contacts[c, Contact.FORCE], group)
            group.active[active] = c
            active += 1
    if active > 0:
        begin(count, group)
        project(count, active, 0.0, MOST_SWEEPS, group)


@compiled
def _pull_together(c, impulse, group):
    """Pull the discs of a contact together, so that a projection, which only pushes, corrects what opens, too."""
    if impulse > 0.0:
        push_apart(c, -impulse, group)
        group.contacts[c, Contact.IMPULSE] = impulse


# --- the forces from now on ---------------------------------------------------------------------------------


@compiled
def support(count, touching, discs, group, numbers):
    """Find the forces in the contacts of a group whose velocities are in `motion`.

    Returns the time for which the forces are valid (s): INFINITY if no disc slides. `motion` becomes the
    accelerations, `other` the velocities; sets the column FORCE.
    """
    copy_motion(group.motion, group.other, count)
    closed = _push_now(count, touching, discs, group, numbers)
    duration = INFINITY
    if not _stop_where_still(count, closed, discs, group):
        duration = _duration(closed, discs, group, numbers)
        if duration < INFINITY:
            least = LEAST_SHARE * duration
            while not _take_step(duration, count, closed, discs, group, numbers) and duration > least:
                duration = max(0.25 * duration, least)
                for c in range(touching):
                    _turn(c, 0.0, 0.0, group)
                closed = _push_now(count, touching, discs, group, numbers)
    return duration


@compiled
def _push_now(count, touching, discs, group, numbers):
    """The forces at this instant, in the columns FORCE and IMPULSE of the closed contacts; returns how many these are."""
    closed = _list_closed(touching, discs, group, numbers)
    for c in range(touching):
        group.contacts[c, Contact.FORCE] = 0.0
    _pull(count, discs, group)
    begin(count, group)
    project(count, closed, 0.0, MOST_SWEEPS, group)
    for k in range(closed):
        c = group.active[k]
        group.contacts[c, Contact.FORCE] = group.contacts[c, Contact.IMPULSE]
    return closed


@compiled
def _pull(count, discs, group):
    """Set `motion` to the accelerations without contact forces."""
    for m in range(count):
        i = group.members[m]
        group.motion[m, 0], group.motion[m, 1] = discs[i, Disc.GX], discs[i, Disc.GY]


@compiled
def _relative(c, motion, group):
    """Motion of a contact's second member relative to its first."""
    a, b = group.links[c, 0], group.links[c, 1]
    return motion[b, 0] - motion[a, 0], motion[b, 1] - motion[a, 1]


@compiled
def _list_closed(touching, discs, group, numbers):
    """List the contacts that do not separate, and set their bias to |Δv|²/d. Returns their number."""
    contacts = group.contacts
    closed = 0
    for c in range(touching):
        contacts[c, Contact.BIAS] = 0.0
        i, j = group.members[group.links[c, 0]], group.members[group.links[c, 1]]
        slow = max(4.0 * group.noise[0], touch_speed(discs, i, j, numbers[Number.NOW]))
        if contacts[c, Contact.COMPLIANCE] > 0.0 and opening_rate(c, group.other, group) <= slow:
            x, y = _relative(c, group.other, group)
            turning = contacts[c, Contact.ROUND] * (x * x + y * y)
            contacts[c, Contact.BIAS] = turning / contacts[c, Contact.DISTANCE]
            contacts[c, Contact.IMPULSE] = contacts[c, Contact.FORCE]
            group.active[closed] = c
            closed += 1
    return closed


@compiled
def _stop_where_still(count, closed, discs, group):
    """Bring to rest the discs that contacts push if none of them moves or accelerates; else return False."""
    pull = 0.0
    for m in range(count):
        i = group.members[m]
        pull = max(pull, abs(discs[i, Disc.GX]) + abs(discs[i, Disc.GY]))
    for k in range(closed):
        c = group.active[k]
        if group.contacts[c, Contact.IMPULSE] > 0.0:
            for p in range(2):
                m = group.links[c, p]
                speed = STILL * math.sqrt(pull * discs[group.members[m], Disc.RADIUS])
                if _size(group.motion, m) > STILL * pull or _size(group.other, m) > speed:
                    return False
    for k in range(closed):
        c = group.active[k]
        if group.contacts[c, Contact.IMPULSE] > 0.0:
            for p in range(2):
                m = group.links[c, p]
                group.motion[m, 0], group.motion[m, 1] = 0.0, 0.0
                group.other[m, 0], group.other[m, 1] = 0.0, 0.0
    return True


@compiled
def _size(motion, m):
    return abs(motion[m, 0]) + abs(motion[m, 1])


@compiled
def _duration(closed, discs, group, numbers):
    """Time (s) in which discs that push one another turn around one another by about STEP_ANGLE.

    From rest, their weight across the line of centres turns them. Along the flat side of an obstacle no normal turns;
    the time is that to the end of the side.
    """
    duration = INFINITY
    for k in range(closed):
        c = group.active[k]
        if group.contacts[c, Contact.IMPULSE] > 0.0:
            distance = group.contacts[c, Contact.DISTANCE]
            speed = math.hypot(*_relative(c, group.other, group))
            turn = STEP_ANGLE * distance / speed
            for p in range(2):
                i = group.members[group.links[c, p]]
                pull = math.hypot(discs[i, Disc.GX], discs[i, Disc.GY])
                turn = min(turn, STEP_ANGLE * math.sqrt(distance / pull))
            if is_straight(group.members[group.links[c, 1]], discs):
                stay = max(_stay(c, discs, group, numbers), LEAST_SHARE * turn)
                turn = stay if _slides(c, discs, group, numbers) else min(stay, turn)
            duration = min(duration, turn)
    return duration


@compiled
def _slides(c, discs, group, numbers):
    """True if a disc moves along a flat side, rather than away from it so slowly that it returns at once."""
    i, j = group.members[group.links[c, 0]], group.members[group.links[c, 1]]
    x, y = _relative(c, group.other, group)
    rate = group.contacts[c, Contact.NX] * x + group.contacts[c, Contact.NY] * y
    noise = speed_noise(discs, i, j, numbers[Number.NOW])
    return group.contacts[c, Contact.ROUND] == 0.0 and abs(rate) <= noise


@compiled
def _stay(c, discs, group, numbers):
    """Time (s) until the foot of a disc on an obstacle passes an end of the obstacle."""
    i, j = group.members[group.links[c, 0]], group.members[group.links[c, 1]]
    length = math.hypot(discs[j, Disc.TX], discs[j, Disc.TY])
    tx, ty = discs[j, Disc.TX] / length, discs[j, Disc.TY] / length
    x, y, _, _ = relative_state(discs, i, j, numbers[Number.NOW])
    vx, vy = _relative(c, group.other, group)
    ax, ay = _relative(c, group.motion, group)
    return passing(-(x * tx + y * ty), -(vx * tx + vy * ty), -(ax * tx + ay * ty), length, 0.0)


# --- a step -------------------------------------------------------------------------------------------------


@compiled
def _turn(c, h, share, group):
    """Turn a contact to where its discs are after a time h with the velocities in `other`.

    And with `share` (s²) of the accelerations in BEFORE. The nearest point of an obstacle is taken to be on the same
    end or flat side as at the start.
    """
    contact = group.contacts[c]
    vx, vy = _relative(c, group.other, group)
    ax, ay = _relative(c, group.before, group)
    x, y = contact[Contact.SX] + h * vx + share * ax, contact[Contact.SY] + h * vy + share * ay
    if contact[Contact.ROUND] == 0.0:
        contact[Contact.DISTANCE] = contact[Contact.NX] * x + contact[Contact.NY] * y
        return
    distance = math.sqrt(x * x + y * y)
    contact[Contact.NX], contact[Contact.NY], contact[Contact.DISTANCE] = x / distance, y / distance, distance
    contact[Contact.COMPLIANCE] = compliance(c, c, group)


@compiled
def _gap(c, discs, group):
    """The gap of a contact (m) where it is now, more than where it began: one that was negative by round-off stays so.

    Of discs jammed between others not all can be corrected, and every attempt would push harder.
    """
    i, j = group.members[group.links[c, 0]], group.members[group.links[c, 1]]
    began = math.hypot(group.contacts[c, Contact.SX], group.contacts[c, Contact.SY])
    return group.contacts[c, Contact.DISTANCE] - min(discs[i, Disc.RADIUS] + discs[j, Disc.RADIUS], began)


@compiled
def _take_step(h, count, closed, discs, group, numbers):
    """Take a step h with the accelerations in `motion`, which become those of the parabolas; sets BEND and CURVE.

    Returns False if h is too long: a contact that pushes lets go, or one that does not push closes.
    """
    first, bends, curves = group.initial, group.bend, group.curve
    copy_motion(group.motion, first, count)
    for m in range(count):
        for d in range(2):
            group.before[m, d], bends[m, d], curves[m, d] = 0.0, 0.0, 0.0
    fits = True
    for stage in range(1, 4):
        ahead, weight = (h, 1.0) if stage == 3 else (0.5 * h, 2.0)
        if not _accelerate(ahead, h, count, closed, discs, group):
            fits = False
        for m in range(count):
            for d in range(2):
                change = group.motion[m, d] - first[m, d]
                bends[m, d] += change if stage < 3 else 0.0
                curves[m, d] += weight * change
    return _end_step(h, count, closed, discs, group, numbers) and fits


@compiled
def _accelerate(ahead, h, count, closed, discs, group):
    """Set `motion` to the accelerations at the next stage of a step. Returns False if a contact that has pushed lets go.

    A contact that has not pushed may only do so where it has no gap.
    """
    contacts = group.contacts
    for k in range(closed):
        c = group.active[k]
        _turn(c, ahead, 0.5 * ahead * h, group)
        x, y = _relative(c, group.other, group)
        ax, ay = _relative(c, group.motion, group)
        x, y = x + ahead * ax, y + ahead * ay
        contacts[c, Contact.BIAS] = contacts[c, Contact.ROUND] * (x * x + y * y) / contacts[c, Contact.DISTANCE]
        if contacts[c, Contact.FORCE] == 0.0:
            contacts[c, Contact.BIAS] += 2.0 * max(_gap(c, discs, group), 0.0) / (ahead * ahead)
    copy_motion(group.motion, group.before, count)
    _pull(count, discs, group)
    project(count, closed, 0.0, MOST_SWEEPS, group)
    holds = True
    for k in range(closed):
        c = group.active[k]
        if contacts[c, Contact.FORCE] > 0.0 and contacts[c, Contact.IMPULSE] == 0.0:
            holds = holds and opening_rate(c, group.motion, group) <= 4.0 * group.noise[0]
    return holds


@compiled
def _end_step(h, count, closed, discs, group, numbers):
    """Project places and velocities at the end of a step, and set the paths that lead there.

    Returns False if a contact that did not push has closed.
    """
    contacts, first, path = group.contacts, group.initial, group.before
    bends, curves = group.bend, group.curve
    apart = True
    for m in range(count):
        for d in range(2):
            path[m, d] = first[m, d] + bends[m, d] / 3.0
            group.motion[m, d] = 0.0
    for k in range(closed):
        c = group.active[k]
        _turn(c, h, 0.5 * h * h, group)
        i, j = group.members[group.links[c, 0]], group.members[group.links[c, 1]]
        contacts[c, Contact.BIAS] = _gap(c, discs, group)
        if contacts[c, Contact.FORCE] == 0.0:
            apart = apart and contacts[c, Contact.BIAS] >= -place_noise(discs, i, j, numbers[Number.NOW])
        contacts[c, Contact.FORCE] = contacts[c, Contact.IMPULSE]
        _pull_together(c, 0.5 * h * h * contacts[c, Contact.FORCE], group)
    set_noise(count, group)
    project(count, closed, 0.0, MOST_SWEEPS, group)
    for m in range(count):
        for d in range(2):
            path[m, d] += 2.0 * group.motion[m, d] / (h * h)
            bends[m, d] = (path[m, d] - first[m, d]) / (2.0 * h)
            group.motion[m, d] = group.other[m, d] + h * first[m, d] + h * curves[m, d] / 6.0
    copy_motion(group.motion, first, count)
    for k in range(closed):
        c = group.active[k]
        contacts[c, Contact.BIAS], contacts[c, Contact.IMPULSE] = 0.0, 0.0
        _pull_together(c, 0.5 * h * contacts[c, Contact.FORCE], group)
    set_noise(count, group)
    project(count, closed, 0.0, MOST_SWEEPS, group)
    for m in range(count):
        for d in range(2):
            change = h * curves[m, d] / 6.0 + (group.motion[m, d] - first[m, d]) - 2.0 * h * h * bends[m, d]
            curves[m, d] = (change / (h * h) - bends[m, d]) / h
    copy_motion(path, group.motion, count)
    return apart
