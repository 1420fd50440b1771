"""Persistent contacts: discs that rest on one another or slide along one another.

A contact persists while its force pushes: forces F ≥ 0 and accelerations satisfy, at the contacts whose discs do not
separate, n·Δa + |Δv|²/d ≥ 0, and F = 0 where it is > 0. Discs that are at rest under these forces stay where they are,
at no cost. Discs that slide take steps h of RATTLE (Andersen, J. Comput. Phys. 52, 1983) with one-sided constraints:
constant forces along the normals at the start such that the discs touch at the end of the step,
    u₁ = u₀ + h v₀ + h²/2 (g + W N F),   gap(u₁) ≥ 0 ⟂ F ≥ 0,
and velocities v₁ = v₀ + h/2 (g + W N F) + h/2 g + W N₁ p with n₁·Δv₁ ≥ 0 ⟂ p ≥ 0. In between they are on
parabolas like all others, so that impacts with them are found as exactly.
"""

import math

from systems.collision.columns import NONE, Contact, Count, Disc, Entry, Mark, Number
from systems.collision.kernels import compiled
from systems.collision.kernels.projection import MOST_SWEEPS, begin, copy_motion, opening_rate, project
from systems.collision.kernels.time_of_impact import (
    INFINITY,
    is_straight,
    passing,
    place_noise,
    relative_motion,
    speed_noise,
    touch_speed,
)

STILL = 1e-10  # of the speed and acceleration that gravity gives: a slower disc is at rest
STEP_ANGLE = 0.0156  # by which discs turn around one another in a step; discs sink by its cube / 8 of a radius
LEAST_SHARE = 1e-4  # of such a step: error of the time at which a flat side or a contact ends
MOST_CORRECTIONS = 40  # of the forces in a step; 3 are usual
MOST_VAIN_CORRECTIONS = 5  # consecutive corrections that do not halve the largest gap


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
    """Enter a persistent contact with j for disc i, unless i is held."""
    if not is_held(i, discs):
        entry = counts[Count.SPARE]
        counts[Count.SPARE] = constraints.persistent[entry, Entry.NEXT]
        counts[Count.SPARES] -= 1
        constraints.persistent[entry, Entry.OTHER] = j
        constraints.persistent[entry, Entry.NEXT] = constraints.first_persistent[i]
        constraints.forces[entry] = force
        constraints.first_persistent[i] = entry


# --- the end of a step --------------------------------------------------------------------------------------


@compiled
def stop_sinking(count, touching, group):
    """Project the velocities in `motion` for the contacts that have persisted until now."""
    active = 0
    for c in range(touching):
        group.contacts[c, Contact.IMPULSE] = 0.0
        if group.contacts[c, Contact.FORCE] > 0.0 and group.contacts[c, Contact.COMPLIANCE] > 0.0:
            group.marks[Mark.ACTIVE, active] = c
            active += 1
    if active > 0:
        begin(count, group)
        project(count, active, 0.0, MOST_SWEEPS, group)


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
            met = _meet_at_end(duration, count, closed, discs, group, numbers)
            while duration > least and (not met or _one_lets_go(closed, group)):  # or they touch again at once
                duration = max(0.25 * duration, least)
                closed = _push_now(count, touching, discs, group, numbers)
                met = _meet_at_end(duration, count, closed, discs, group, numbers)
            if not met:
                closed = _push_now(count, touching, discs, group, numbers)
    for k in range(closed):
        c = group.marks[Mark.ACTIVE, k]
        group.contacts[c, Contact.FORCE] = group.contacts[c, Contact.IMPULSE]
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
        c = group.marks[Mark.ACTIVE, k]
        group.contacts[c, Contact.FORCE] = group.contacts[c, Contact.IMPULSE]
    return closed


@compiled
def _one_lets_go(closed, group):
    """True if a contact that pushes at the start of a step has opened at its end."""
    for k in range(closed):
        c = group.marks[Mark.ACTIVE, k]
        if group.contacts[c, Contact.FORCE] > 0.0 and group.contacts[c, Contact.IMPULSE] == 0.0:
            return True
    return False


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
            group.marks[Mark.ACTIVE, closed] = c
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
        c = group.marks[Mark.ACTIVE, k]
        if group.contacts[c, Contact.IMPULSE] > 0.0:
            for p in range(2):
                m = group.links[c, p]
                speed = STILL * math.sqrt(pull * discs[group.members[m], Disc.RADIUS])
                if _size(group.motion, m) > STILL * pull or _size(group.other, m) > speed:
                    return False
    for k in range(closed):
        c = group.marks[Mark.ACTIVE, k]
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
        c = group.marks[Mark.ACTIVE, k]
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
    x, y, _, _, _, _ = relative_motion(discs, i, j, numbers[Number.NOW])
    vx, vy = _relative(c, group.other, group)
    ax, ay = _relative(c, group.motion, group)
    return passing(-(x * tx + y * ty), -(vx * tx + vy * ty), -(ax * tx + ay * ty), length, 0.0)


@compiled
def _end_gap(c, h, discs, group):
    """Gap of a contact after a time h with the accelerations in `motion` and the velocities in `other`.

    The nearest point of an obstacle is taken to be on the same end or flat side as at the start.
    """
    vx, vy = _relative(c, group.other, group)
    ax, ay = _relative(c, group.motion, group)
    x = group.contacts[c, Contact.NX] * group.contacts[c, Contact.DISTANCE] + h * (vx + 0.5 * h * ax)
    y = group.contacts[c, Contact.NY] * group.contacts[c, Contact.DISTANCE] + h * (vy + 0.5 * h * ay)
    i, j = group.members[group.links[c, 0]], group.members[group.links[c, 1]]
    reach = discs[i, Disc.RADIUS] + discs[j, Disc.RADIUS]
    if group.contacts[c, Contact.ROUND] == 0.0:
        return group.contacts[c, Contact.NX] * x + group.contacts[c, Contact.NY] * y - reach
    return math.sqrt(x * x + y * y) - reach


@compiled
def _meet_at_end(h, count, closed, discs, group, numbers):
    """Correct the forces until the closed contacts have, after a time h, the same gap as now, or are open; False if none do.

    A gap that now is negative by round-off stays so: of discs jammed between others not all can be corrected, and
    every attempt would push harder.
    """
    contacts = group.contacts
    before, in_vain = INFINITY, 0
    for _ in range(MOST_CORRECTIONS):
        met, worst = True, 0.0
        for k in range(closed):
            c = group.marks[Mark.ACTIVE, k]
            gap = _end_gap(c, h, discs, group) - min(_end_gap(c, 0.0, discs, group), 0.0)
            i, j = group.members[group.links[c, 0]], group.members[group.links[c, 1]]
            noise = place_noise(discs, i, j, numbers[Number.NOW])
            if gap < -noise or (gap > noise and contacts[c, Contact.IMPULSE] > 0.0):
                met, worst = False, max(worst, abs(gap))
            contacts[c, Contact.BIAS] += 2.0 * gap / (h * h) - opening_rate(c, group.motion, group)
        in_vain = in_vain + 1 if worst > 0.5 * before else 0
        if met or in_vain == MOST_VAIN_CORRECTIONS:
            return met
        before = worst
        _pull(count, discs, group)
        project(count, closed, 0.0, MOST_SWEEPS, group)
    return False
