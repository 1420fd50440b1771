"""Flight of discs from impact to impact: the earliest meeting happens, then what it changed is foreseen anew.

Every disc keeps the epoch of its own last impact; nothing else is touched. Discs that touch at the instant of
an impact, directly or through others, take part in it together.

A group's members: members[MEMBER, m] is a disc, members[PLACE, i] the member that disc i is, or −1.
report: shape (capacity, 2), the discs of an impact; details: shape (capacity, 3), its time (s), impulse (N·s) and
energy lost (J).
"""

import math

from systems.collision.disc import AX, AY, EPOCH, GX, GY, RADIUS, UX, UY, VX, VY, WX, WY
from systems.collision.gap.kernels import place_noise, relative_motion
from systems.collision.grid.kernels import enclose, enter, layer_of, leave, level_of, neighbours, place_box
from systems.collision.impact.kernels import IMPULSE, INITIAL, MOTION, NX, NY, respond, separation_speed
from systems.collision.queue.kernels import drop_first, is_void
from systems.collision.state import (
    CELL,
    END,
    IMPACTS,
    LAYERS,
    LEVEL,
    NOW,
    QUEUED,
    RENEW,
    REPORTED,
    REST_HEIGHT,
    RESTITUTION,
    STRIKES,
    Reason,
)
from systems.collision.window.kernels import expect, find_bond, is_held, open_window
from systems.kernels import compiled

DONE, BUSY, REPORT_FULL = int(Reason.DONE), int(Reason.BUSY), int(Reason.REPORT_FULL)
QUEUE_FULL, GROUP_FULL = int(Reason.QUEUE_FULL), int(Reason.GROUP_FULL)
MEMBER, PLACE = 0, 1


@compiled
def advance(
    until, most_strikes,
    discs, changes, boxes, layer, levels, heads, entries, first, partners, bonds, times, meetings, found,
    members, links, contacts, mobility, velocities, marks, matrix, report, details, numbers, counts,
):  # fmt: skip
    """Let everything happen up to a time (s), at most `most_strikes` strikes. Returns a Reason.

    After DONE, every disc is on its path at `until`; after any other reason, call again when it is dealt with.
    """
    last = counts[STRIKES] + most_strikes
    while True:
        if counts[RENEW]:
            reason = open_window(
                discs, changes, boxes, layer, levels, heads, entries, first, partners, bonds, times, meetings,
                found, numbers, counts,
            )  # fmt: skip
            if reason != DONE:
                return reason
        while counts[QUEUED] > 0 and is_void(meetings, 0, changes):
            drop_first(times, meetings, counts[QUEUED])
            counts[QUEUED] -= 1
        stop = min(until, numbers[END])
        if counts[QUEUED] == 0 or times[0] > stop:
            numbers[NOW] = max(numbers[NOW], stop)
            if until <= numbers[END]:
                return DONE
            counts[RENEW] = 1
            continue
        if counts[STRIKES] == last:
            return BUSY
        numbers[NOW] = max(numbers[NOW], times[0])
        reason = _strike(
            meetings[0, 0], meetings[0, 1],
            discs, changes, boxes, layer, levels, heads, entries, first, partners, bonds, times, meetings, found,
            members, links, contacts, mobility, velocities, marks, matrix, report, details, numbers, counts,
        )  # fmt: skip
        if reason != DONE:
            return reason


@compiled
def _strike(
    i, j,
    discs, changes, boxes, layer, levels, heads, entries, first, partners, bonds, times, meetings, found,
    members, links, contacts, mobility, velocities, marks, matrix, report, details, numbers, counts,
):  # fmt: skip
    """The meeting of i and j, now the first of the queue, happens. Returns a Reason."""
    count, touching = _gather(
        i, j, discs, boxes, layer, levels, heads, entries, first, partners, bonds, found, members, links,
        contacts, mobility, velocities, numbers, counts,
    )  # fmt: skip
    if touching > links.shape[0] or counts[REPORTED] + touching > report.shape[0]:
        _dismiss(count, members)
        return GROUP_FULL if touching > links.shape[0] else REPORT_FULL
    restitution = _restitution(touching, discs, members, links, contacts, velocities, numbers)
    respond(count, touching, restitution, links, contacts, mobility, velocities, marks, matrix)
    _report(touching, members, links, contacts, velocities, report, details, numbers, counts)
    drop_first(times, meetings, counts[QUEUED])
    counts[QUEUED] -= 1
    counts[STRIKES] += 1
    _redirect(count, discs, changes, members, velocities, numbers)
    _enclose_anew(count, discs, boxes, layer, levels, heads, entries, members, numbers, counts)
    reason = DONE
    if not _expect_anew(
        count, discs, changes, boxes, layer, levels, heads, entries, first, partners, bonds, times, meetings,
        found, members, numbers, counts,
    ):  # fmt: skip
        counts[RENEW] = 1
        reason = QUEUE_FULL
    _dismiss(count, members)
    return reason


# --- who takes part ---------------------------------------------------------------------------------------


@compiled
def _admit(i, count, discs, members, mobility, velocities, time):
    """Make a disc the next member of the group."""
    members[MEMBER, count] = i
    members[PLACE, i] = count
    s = time - discs[i, EPOCH]
    velocities[MOTION, count, 0] = discs[i, VX] + s * discs[i, AX]
    velocities[MOTION, count, 1] = discs[i, VY] + s * discs[i, AY]
    mobility[count, 0], mobility[count, 1] = discs[i, WX], discs[i, WY]


@compiled
def _dismiss(count, members):
    for m in range(count):
        members[PLACE, members[MEMBER, m]] = -1


@compiled
def _link(i, j, touching, members, links, contacts, dx, dy):
    """Note a contact of the group; more than there is room for are only counted."""
    if touching < links.shape[0]:
        links[touching, 0], links[touching, 1] = members[PLACE, i], members[PLACE, j]
        distance = math.sqrt(dx * dx + dy * dy)
        contacts[touching, NX], contacts[touching, NY] = dx / distance, dy / distance
    return touching + 1


@compiled
def _gather(
    i, j, discs, boxes, layer, levels, heads, entries, first, partners, bonds, found, members, links, contacts,
    mobility, velocities, numbers, counts,
):  # fmt: skip
    """The group of i and j: all that touches them now, directly or through others that can move.

    Returns how many members and contacts it has. The contact of i and j is the first.
    """
    now = numbers[NOW]
    _admit(i, 0, discs, members, mobility, velocities, now)
    _admit(j, 1, discs, members, mobility, velocities, now)
    dx, dy, _, _, _, _ = relative_motion(discs, i, j, now)
    touching = _link(i, j, 0, members, links, contacts, dx, dy)
    count = 2
    m = 0
    while m < count:
        a = members[MEMBER, m]
        near = 0
        if not is_held(discs, a):
            left, bottom, right, top = place_box(a, discs, now)
            near = neighbours(
                a, left, bottom, right, top,
                boxes, layer, levels, counts[LAYERS], numbers[CELL], heads, entries, found,
            )  # fmt: skip
        for k in range(near):
            b = found[k]
            place = members[PLACE, b]
            if (0 <= place < m and not is_held(discs, b)) or (m < 2 and place == 1 - m):
                continue  # this contact is noted already
            dx, dy, _, _, _, _ = relative_motion(discs, a, b, now)
            reach = discs[a, RADIUS] + discs[b, RADIUS] + place_noise(discs, a, b, now)
            if dx * dx + dy * dy <= reach * reach and find_bond(a, b, first, partners, bonds) < 0:
                if place < 0:
                    _admit(b, count, discs, members, mobility, velocities, now)
                    count += 1
                touching = _link(a, b, touching, members, links, contacts, dx, dy)
        m += 1
    return count, touching


# --- what it does ------------------------------------------------------------------------------------------


@compiled
def rest_speed(i, j, discs, restitution, rest_height, time):
    """Speed (m/s) of two discs from each other below which they stay in contact: √(2 g h).

    g is the larger acceleration of the two, h the height that is not worth a bounce.
    """
    height = place_noise(discs, i, j, time)
    if restitution < 1.0:
        height = max(height, rest_height * min(discs[i, RADIUS], discs[j, RADIUS]))
    pull = max(
        discs[i, GX] * discs[i, GX] + discs[i, GY] * discs[i, GY],
        discs[j, GX] * discs[j, GX] + discs[j, GY] * discs[j, GY],
    )
    return math.sqrt(2.0 * math.sqrt(pull) * height)


@compiled
def _restitution(touching, discs, members, links, contacts, velocities, numbers):
    """The restitution, or 0 if nothing in the group approaches faster than rest."""
    for c in range(touching):
        i, j = members[MEMBER, links[c, 0]], members[MEMBER, links[c, 1]]
        speed = rest_speed(i, j, discs, numbers[RESTITUTION], numbers[REST_HEIGHT], numbers[NOW])
        if separation_speed(c, links, contacts, velocities[MOTION]) < -speed:
            return numbers[RESTITUTION]
    return 0.0


@compiled
def _report(touching, members, links, contacts, velocities, report, details, numbers, counts):
    """Report the contacts that had an impulse.

    The energy lost is −Σ p (s + s')/2, with s, s' the speeds of separation before and after; in a joint
    impact, where contacts pass energy on, each has a share of the sum in proportion to its impulse.
    """
    loss, impulses = 0.0, 0.0
    for c in range(touching):
        before = separation_speed(c, links, contacts, velocities[INITIAL])
        after = separation_speed(c, links, contacts, velocities[MOTION])
        loss -= 0.5 * contacts[c, IMPULSE] * (before + after)
        impulses += contacts[c, IMPULSE]
    for c in range(touching):
        if contacts[c, IMPULSE] > 0.0:
            k = counts[REPORTED]
            i, j = members[MEMBER, links[c, 0]], members[MEMBER, links[c, 1]]
            report[k, 0], report[k, 1] = min(i, j), max(i, j)
            details[k, 0] = numbers[NOW]
            details[k, 1] = contacts[c, IMPULSE]
            details[k, 2] = loss * (contacts[c, IMPULSE] / impulses)
            counts[REPORTED] += 1
            counts[IMPACTS] += 1


@compiled
def _has_new_path(m, discs, members, velocities):
    """True for the two that met and those whose velocity changed, unless held."""
    changed = velocities[MOTION, m, 0] != velocities[INITIAL, m, 0]
    changed = changed or velocities[MOTION, m, 1] != velocities[INITIAL, m, 1]
    return (m < 2 or changed) and not is_held(discs, members[MEMBER, m])


@compiled
def _redirect(count, discs, changes, members, velocities, numbers):
    """Start new paths now."""
    for m in range(count):
        if _has_new_path(m, discs, members, velocities):
            i = members[MEMBER, m]
            s = numbers[NOW] - discs[i, EPOCH]
            discs[i, UX] += s * (discs[i, VX] + 0.5 * s * discs[i, AX])
            discs[i, UY] += s * (discs[i, VY] + 0.5 * s * discs[i, AY])
            discs[i, VX], discs[i, VY] = velocities[MOTION, m, 0], velocities[MOTION, m, 1]
            discs[i, EPOCH] = numbers[NOW]
            changes[i] += 1


@compiled
def _enclose_anew(count, discs, boxes, layer, levels, heads, entries, members, numbers, counts):
    """Give the discs with new paths new boxes; the window is opened anew if one is too large for the grid."""
    layers = counts[LAYERS]
    for m in range(count):
        i = members[MEMBER, m]
        if discs[i, EPOCH] == numbers[NOW] and not is_held(discs, i):
            leave(i, layer, layers, heads, entries)
            enclose(i, discs, boxes, numbers[NOW], numbers[END])
            level = level_of(i, boxes, numbers[CELL])
            layer[i] = layer_of(level, levels, layers)
            if layer[i] == layers:
                counts[LEVEL] = max(counts[LEVEL], level)
                counts[RENEW] = 1
            enter(i, boxes, layer, levels, layers, numbers[CELL], heads, entries)


@compiled
def _expect_anew(
    count, discs, changes, boxes, layer, levels, heads, entries, first, partners, bonds, times, meetings, found,
    members, numbers, counts,
):  # fmt: skip
    """Foresee the meetings of the discs with new paths. False if the queue is full."""
    if counts[RENEW]:
        return True
    for m in range(count):
        i = members[MEMBER, m]
        if discs[i, EPOCH] != numbers[NOW] or is_held(discs, i):
            continue
        near = neighbours(
            i, boxes[i, 0], boxes[i, 1], boxes[i, 2], boxes[i, 3],
            boxes, layer, levels, counts[LAYERS], numbers[CELL], heads, entries, found,
        )  # fmt: skip
        for k in range(near):
            j = found[k]
            again = members[PLACE, j] >= 0 and j < i and discs[j, EPOCH] == numbers[NOW]
            if not (again and not is_held(discs, j)) and not expect(
                i, j, discs, changes, first, partners, bonds, times, meetings, numbers, counts
            ):
                return False
    return True
