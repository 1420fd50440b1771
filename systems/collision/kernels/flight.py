"""Flight of discs from event to event: the earliest impact happens, then the impacts of discs on new paths are computed.

Every disc keeps the epoch of its own last change; other discs are not touched. Discs that touch at the instant of an
event, directly or through others, take part in it together. Where contacts persist, events are also the ends of steps,
when their forces are renewed.
"""

import math

import numpy as np

from pinjoint.systems.collision.columns import (
    NONE,
    SPEED_NOISE,
    TINY,
    Contact,
    Count,
    Disc,
    Entry,
    Number,
    Reason,
)
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.grid import enclose_anew, neighbours, sort
from pinjoint.systems.collision.kernels.heap import drop_first, drop_void
from pinjoint.systems.collision.kernels.horizon import schedule_impact
from pinjoint.systems.collision.kernels.impact import respond
from pinjoint.systems.collision.kernels.pair_impact import strike
from pinjoint.systems.collision.kernels.persistent_contact import (
    enter_persistent,
    find_persistent,
    forget_persistent,
    hold_together,
    is_held,
    support,
)
from pinjoint.systems.collision.kernels.pile import begin_steps, crowded, enter_impact, step
from pinjoint.systems.collision.kernels.pile_pairs import enter_pushing_pairs
from pinjoint.systems.collision.kernels.projection import compliance, opening_rate
from pinjoint.systems.collision.kernels.time_of_impact import (
    INFINITY,
    are_touching,
    displacement_at,
    is_shared_end,
    nearest,
    relative_motion,
    relative_state,
    rest_speed,
    rim,
    touch_speed,
    velocity_at,
)


@compiled
def fly(until, most_events, discs, grid, constraints, queue, group, report, numbers, counts):
    """Let the events of the present horizon happen up to a time (s), at most `most_events` of them. Returns a Reason.

    After DONE, every disc is on its path at `until`; after any other reason, remove the reason and call again.
    """
    last = counts[Count.EVENTS] + most_events
    while counts[Count.RENEW] == 0 and counts[Count.STEPPING] == 0:
        drop_void(queue, discs, counts)
        stop = min(until, numbers[Number.HORIZON_END])
        if counts[Count.QUEUED] == 0 or queue.times[0] > stop:
            numbers[Number.NOW] = max(numbers[Number.NOW], stop)
            if until <= numbers[Number.HORIZON_END]:
                return Reason.DONE
            counts[Count.RENEW] = 1
        elif counts[Count.EVENTS] >= last:
            return Reason.BUSY
        else:
            numbers[Number.NOW] = max(numbers[Number.NOW], queue.times[0])
            reason = _next_event(discs, grid, constraints, queue, group, report, numbers, counts)
            if reason != Reason.DONE:
                return reason
    return Reason.GO_ON


@compiled
def _next_event(discs, grid, constraints, queue, group, report, numbers, counts):
    """Let the first event of the queue happen. Returns a Reason."""
    i, j = np.int64(queue.impacts[0, 0]), np.int64(queue.impacts[0, 1])
    if i != j:
        reason = strike(i, j, discs, grid, constraints, queue, report, numbers, counts)
        if reason != Reason.GO_ON:
            return reason
    count, touching = _gather(i, j, discs, grid, constraints, group, numbers, counts)
    full = touching > group.links.shape[0] or 2 * touching > counts[Count.SPARES]
    if full or counts[Count.REPORTED] + touching > report.shape[0]:
        _dismiss(count, group)
        return Reason.GROUP_FULL if full else Reason.REPORT_FULL
    if crowded(touching, numbers, counts):
        _dismiss(count, group)
        begin_steps(numbers, counts)
        return Reason.DONE
    drop_first(queue, counts)
    counts[Count.EVENTS] += 1
    hold_together(count, touching, discs, group, numbers)
    respond(count, touching, _restitution(touching, discs, group, numbers), group)
    _report(touching, discs, group, report, numbers, counts)
    _set_noise(count, touching, discs, group)
    duration = support(count, touching, discs, group, numbers)
    _keep_contacts(count, touching, discs, constraints, group, counts)
    struck = 0 if i == j else 2
    _redirect(count, struck, duration, discs, group, numbers)
    _enclose_anew(count, discs, grid, group, numbers, counts)
    reason = Reason.DONE
    if not _schedule_anew(count, discs, grid, constraints, queue, group, numbers, counts):
        counts[Count.RENEW] = 1
        reason = Reason.QUEUE_FULL
    _dismiss(count, group)
    return reason


@compiled
def take_steps(until, most_steps, discs, grid, constraints, pile, report, numbers, counts):
    """Let a pile take its steps, at most `most_steps`, until it is at rest or dissolved. Returns a Reason."""
    last, reason = counts[Count.EVENTS] + most_steps, Reason.GO_ON
    while counts[Count.STEPPING] and reason == Reason.GO_ON:
        if numbers[Number.STEP_END] > until or numbers[Number.STEP_END] >= numbers[Number.STOP]:
            numbers[Number.NOW] = max(numbers[Number.NOW], until)
            reason = Reason.DONE
        elif counts[Count.EVENTS] >= last:
            reason = Reason.BUSY
        else:
            numbers[Number.NOW] = numbers[Number.STEP_END]
            reason = step(discs, grid, constraints, pile, report, numbers, counts)
            if reason == Reason.DONE:
                counts[Count.EVENTS] += 1
                reason = Reason.GO_ON
    if counts[Count.STEPPING]:
        enter_pushing_pairs(discs, constraints, pile, counts)
    return reason


# --- who takes part -----------------------------------------------------------------------------------------


@compiled
def _admit(i, count, discs, group, time):
    """Make a disc the next member of the group, with its velocity at the time."""
    group.members[count] = i
    group.place[i] = count
    group.mobility[count, 0], group.mobility[count, 1] = discs[i, Disc.WX], discs[i, Disc.WY]
    group.motion[count, 0], group.motion[count, 1] = velocity_at(i, discs, time)


@compiled
def _dismiss(count, group):
    for m in range(count):
        group.place[group.members[m]] = NONE


@compiled
def _link(i, j, force, touching, discs, group, time):
    """Add a contact to the group; a contact for which there is no room is only counted."""
    if touching < group.links.shape[0]:
        dx, dy, _, _ = relative_state(discs, i, j, time)
        dx, dy, rounded = nearest(dx, dy, j, discs)
        distance = math.sqrt(dx * dx + dy * dy)
        group.links[touching, 0], group.links[touching, 1] = group.place[i], group.place[j]
        contact = group.contacts[touching]
        contact[Contact.ROUND] = rounded
        if distance == 0.0:  # no direction is better than another
            dx = distance = TINY
        contact[Contact.NX], contact[Contact.NY] = dx / distance, dy / distance
        contact[Contact.DISTANCE] = distance
        contact[Contact.SX], contact[Contact.SY] = dx, dy
        contact[Contact.BIAS], contact[Contact.FORCE] = 0.0, force
        contact[Contact.COMPLIANCE] = compliance(touching, touching, group)
    return touching + 1


@compiled
def _gather(i, j, discs, grid, constraints, group, numbers, counts):
    """Gather the group of i and j: all discs that touch them now, directly or through discs that can move.

    Returns the numbers of members and contacts. The contact of i and j, if they are two, is the first.
    """
    now = numbers[Number.NOW]
    _admit(i, 0, discs, group, now)
    count, touching = 1, 0
    if i != j:
        _admit(j, 1, discs, group, now)
        count, touching = 2, _link(i, j, 0.0, 0, discs, group, now)
    m = 0
    while m < count:
        a = group.members[m]
        if not is_held(a, discs):
            count, touching = _gather_persistent(m, count, touching, discs, constraints, group, now)
            near = neighbours(a, grid, counts[Count.LAYERS], 0)
            sort(grid.found, near)
            for k in range(near):
                b = grid.found[k]
                met = i != j and m < 2 and group.place[b] == 1 - m
                if not met and _is_new(m, b, discs, group) and _touch(a, b, discs, constraints, now):
                    if group.place[b] == NONE:
                        _admit(b, count, discs, group, now)
                        count += 1
                    touching = _link(a, b, 0.0, touching, discs, group, now)
        m += 1
    return count, touching


@compiled
def _is_new(m, b, discs, group):
    """False if the contacts of disc b, and so its contact with member m, are in the group already."""
    return group.place[b] == NONE or group.place[b] > m or is_held(b, discs)


@compiled
def _touch(a, b, discs, constraints, now):
    """True if two discs touch and have no persistent contact."""
    if not are_touching(relative_motion(discs, a, b, now), a, b, discs, now):
        return False
    dx, dy, _, _ = relative_state(discs, a, b, now)
    return not is_shared_end(dx, dy, b, discs) and find_persistent(a, b, constraints) == NONE


@compiled
def _gather_persistent(m, count, touching, discs, constraints, group, now):
    """Add the persistent contacts of member m."""
    a = group.members[m]
    entry = constraints.first_persistent[a]
    while entry != NONE:
        b = constraints.persistent[entry, Entry.OTHER]
        dx, dy, _, _ = relative_state(discs, a, b, now)
        if _is_new(m, b, discs, group) and not is_shared_end(dx, dy, b, discs):
            if group.place[b] == NONE:
                _admit(b, count, discs, group, now)
                count += 1
            touching = _link(a, b, constraints.forces[entry], touching, discs, group, now)
        entry = constraints.persistent[entry, Entry.NEXT]
    return count, touching


# --- the event -------------------------------------------------------------------------------------------


@compiled
def _restitution(touching, discs, group, numbers):
    """The least restitution of the contacts that approach faster than the speed of rest; 0 if there are none."""
    least = INFINITY
    for c in range(touching):
        i, j = group.members[group.links[c, 0]], group.members[group.links[c, 1]]
        slow = rest_speed(i, j, discs, numbers[Number.NOW])
        if opening_rate(c, group.motion, group) < -slow:
            least = min(least, discs[j, Disc.BOUNCE])
    return least if least < INFINITY else 0.0


@compiled
def _report(touching, discs, group, report, numbers, counts):
    """Report the contacts with an impulse larger than one that stops a motion of round-off only.

    The energy lost is −Σ p (s + s')/2, with s, s' the speeds of separation before and after; in a joint
    impact, where contacts pass energy on, each has a share of the sum in proportion to its impulse.
    """
    loss, impulses = 0.0, 0.0
    for c in range(touching):
        before, after = opening_rate(c, group.initial, group), opening_rate(c, group.motion, group)
        loss -= 0.5 * group.contacts[c, Contact.TOTAL_IMPULSE] * (before + after)
        impulses += group.contacts[c, Contact.TOTAL_IMPULSE]
    numbers[Number.LOSS] += loss
    for c in range(touching):
        impulse = group.contacts[c, Contact.TOTAL_IMPULSE]
        i, j = group.members[group.links[c, 0]], group.members[group.links[c, 1]]
        slow = max(group.noise[0], touch_speed(discs, i, j, numbers[Number.NOW]))
        if impulse * group.contacts[c, Contact.COMPLIANCE] > slow:
            nx, ny = group.contacts[c, Contact.NX], group.contacts[c, Contact.NY]
            place = rim(i, nx, ny, discs, numbers[Number.NOW])
            enter_impact(i, j, numbers[Number.NOW], impulse, loss * (impulse / impulses), place, report, counts)


@compiled
def _keep_contacts(count, touching, discs, constraints, group, counts):
    """Enter the contacts with a force into the table of persistent contacts, in place of all entries of the members."""
    for m in range(count):
        forget_persistent(group.members[m], constraints, counts)
    for c in range(touching):
        force = group.contacts[c, Contact.FORCE]
        if force > 0.0:
            i, j = group.members[group.links[c, 0]], group.members[group.links[c, 1]]
            enter_persistent(i, j, force, discs, constraints, counts)
            for disc in (i, j):
                pull = math.hypot(discs[disc, Disc.GX], discs[disc, Disc.GY])
                discs[disc, Disc.NOISE] += SPEED_NOISE * math.sqrt(pull * discs[disc, Disc.RADIUS])


@compiled
def _set_noise(count, touching, discs, group):
    """Set the round-off in the members' velocities: of the velocities and of the impulses that caused them.

    Of impulses of several contacts, it is the tolerance of their projection.
    """
    for m in range(count):
        speed = abs(group.motion[m, 0]) + abs(group.motion[m, 1])
        discs[group.members[m], Disc.NOISE] = group.noise[0] if touching > 1 else SPEED_NOISE * speed
    if touching == 1:
        for m in range(count):
            change = group.contacts[0, Contact.TOTAL_IMPULSE] * max(group.mobility[m, 0], group.mobility[m, 1])
            discs[group.members[m], Disc.NOISE] += SPEED_NOISE * change


@compiled
def _redirect(count, struck, duration, discs, group, numbers):
    """Start new paths now: of the first `struck` members and of all whose velocity or acceleration changed.

    The end of the group's step is due for members that contacts push as they move.
    """
    now = numbers[Number.NOW]
    for m in range(count):
        i = group.members[m]
        s = now - discs[i, Disc.EPOCH]
        vx, vy, ax, ay = group.other[m, 0], group.other[m, 1], group.motion[m, 0], group.motion[m, 1]
        old = vx == discs[i, Disc.VX] + s * discs[i, Disc.AX] and ax == discs[i, Disc.AX]
        old = old and vy == discs[i, Disc.VY] + s * discs[i, Disc.AY] and ay == discs[i, Disc.AY]
        pushed = ax != discs[i, Disc.GX] or ay != discs[i, Disc.GY]
        pushed = pushed and (vx != 0.0 or vy != 0.0 or ax != 0.0 or ay != 0.0)
        ux, uy = displacement_at(i, discs, now)
        discs[i, Disc.STEP] = now + duration if pushed else INFINITY
        if is_held(i, discs) or (old and m >= struck and not pushed):
            continue
        discs[i, Disc.UX], discs[i, Disc.UY] = ux, uy
        for d in range(2):
            discs[i, Disc.BX + d], discs[i, Disc.CX + d] = 0.0, 0.0
            if discs[i, Disc.STEP] < INFINITY:
                discs[i, Disc.BX + d] = group.bend[m, d]
                discs[i, Disc.CX + d] = group.curve[m, d]
        discs[i, Disc.VX], discs[i, Disc.VY], discs[i, Disc.AX], discs[i, Disc.AY] = vx, vy, ax, ay
        discs[i, Disc.EPOCH] = now
        discs[i, Disc.CHANGES] += 1.0


@compiled
def _enclose_anew(count, discs, grid, group, numbers, counts):
    """Set the boxes of the discs with new paths; a new horizon is opened if a box is too large for the grid."""
    for m in range(count):
        i = group.members[m]
        anew = discs[i, Disc.EPOCH] == numbers[Number.NOW] and not is_held(i, discs)
        if anew and not enclose_anew(i, discs, grid, numbers, counts):
            counts[Count.RENEW] = 1


@compiled
def _schedule_anew(count, discs, grid, constraints, queue, group, numbers, counts):
    """Schedule the impacts of the discs with new paths. False if the queue is full."""
    if counts[Count.RENEW]:
        return True
    for m in range(count):
        i = group.members[m]
        if discs[i, Disc.EPOCH] != numbers[Number.NOW] or is_held(i, discs):
            continue
        near = neighbours(i, grid, counts[Count.LAYERS], 0)
        grid.found[near] = i  # and the end of the step of its persistent contacts
        for k in range(near + 1):
            j = grid.found[k]
            again = group.place[j] != NONE and j < i and discs[j, Disc.EPOCH] == numbers[Number.NOW]
            again = again and not is_held(j, discs)
            if not again and not schedule_impact(i, j, discs, constraints, queue, numbers, counts):
                return False
    return True
