"""Crowds: driven particles, no nodes of structures, of which so many touch that single impacts no longer pay.

At the start of a step all impacts happen, and in it particles that would sink in push each other. Impacts and forces are
projections, of the velocities and of the displacements in the step: the least change after which no pair closes by more
than its gap along the line of centres at the start. Distances are convex, so that no particle sinks in; no force does
work; and no impact supplies energy.
"""

import math

from pinjoint.systems.base import StopReason
from pinjoint.systems.collision.columns import NONE, SHORTEST_SHARE, TINY, Contact
from pinjoint.systems.collision.driven.columns import Need, Order, Phase, Real, Whole
from pinjoint.systems.collision.driven.kernels.contacts import (
    CLOSED_GAP,
    MOST_FORCE_TRIES,
    SETTLING_HEIGHT,
    clear_support,
    enter_work,
    note_unclosed,
    raise_scale,
)
from pinjoint.systems.collision.driven.kernels.impacts import ROUND_OFF, report_impact
from pinjoint.systems.collision.driven.kernels.pairs import gap_of, opening
from pinjoint.systems.collision.driven.kernels.paths import take_back
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.projection import copy_motion, push_apart, separate_motion
from pinjoint.systems.program.entries import Account, Control

CROWD_CONTACTS = 24  # persistent contacts and impacts in the next step, from which on particles are a crowd
CROWD_PARTICLES = 8  # particles that are no nodes, below which they are no crowd
# of a radius, by which particles may sink in in a step; as long as tries are left, CLOSED_GAP
DEEPEST_OVERLAP = 1e-12
TOLD_OVERLAP = 1e-9  # of a radius: a message tells of more, where all tries leave it
TRAVEL = 0.35  # relative travel of two particles in a longer step than the shortest, at most, in radii of the smaller


@compiled
def crowd_span(driven, control, place, speed):
    """The margin within which pairs must be listed for a step of a crowd (m), or 0 where the list is complete."""
    real = driven.real
    if driven.loose.shape[0] < CROWD_PARTICLES:
        return 0.0
    longest = min(control[Control.STEP_SIZE], real[Real.CROWD_STEP], real[Real.HELD_LIMIT])
    fastest = 0.0
    for p in range(driven.loose.shape[0]):
        i = driven.loose[p]
        fastest = max(fastest, speed[i, 0] * speed[i, 0] + speed[i, 1] * speed[i, 1])
    travel = longest * (2.0 * math.sqrt(fastest) + longest * real[Real.STRONGEST])
    real[Real.CROWD_LENGTH], real[Real.CROWD_TRAVEL] = longest, travel
    for p in range(driven.loose.shape[0]):
        i = driven.loose[p]
        x, y = place[i, 0] - driven.listed[i, 0], place[i, 1] - driven.listed[i, 1]
        if math.sqrt(x * x + y * y) + 2.0 * travel > driven.margin[i]:
            return 2.0 * travel + TINY
    return 0.0


@compiled
def is_crowd(driven, place, speed):
    """True if the next step is one of a crowd, once crowd_span() is 0; how long it is to be then.

    It is none where nodes of a structure are near, since a structure answers to forces in its own way.
    """
    real, pairs, listed = driven.real, driven.pairs, driven.whole[Whole.LISTED]
    if driven.loose.shape[0] < CROWD_PARTICLES or 2 * listed < CROWD_CONTACTS:
        return False  # a pair counts twice at most: how many pairs are listed, by chance, must not matter
    longest, travel = real[Real.CROWD_LENGTH], real[Real.CROWD_TRAVEL]
    h = longest
    for k in range(listed):
        i, j = pairs[k, 0], pairs[k, 1]
        gap, nx, ny = gap_of(i, j, driven.position, place, driven.radius, driven.span)
        driven.room[k] = gap
        if gap > 2.0 * travel:
            continue
        if driven.node[i] or (j < place.shape[0] and driven.node[j]):
            return False
        driven.normal[k, 0], driven.normal[k, 1] = nx, ny
        driven.rate[k] = opening(i, j, nx, ny, speed)
        far = TRAVEL * _size(driven, k)
        if -driven.rate[k] * longest > max(far, gap):
            h = min(h, far / -driven.rate[k])
    h = max(h, SHORTEST_SHARE * longest)
    number = 0
    for k in range(listed):
        close = driven.room[k] <= 2.0 * travel
        number += driven.lasting[k]
        if close and _meets(driven, k, h) and driven.restitution[pairs[k, 1]] < 1.0:
            number += 1
    real[Real.CROWD_LENGTH] = h
    return number >= CROWD_CONTACTS


@compiled
def _size(driven, k):
    return min(driven.size[driven.pairs[k, 0]], driven.size[driven.pairs[k, 1]])


@compiled
def _meets(driven, k, h):
    return max(driven.room[k], 0.0) + h * driven.rate[k] < 0.0


@compiled
def begin_crowd(driven, account, speed):
    """Gather the contacts of a crowd, and carry out its impacts: `speed` is then that after them."""
    whole, group = driven.whole, driven.group
    count, members, least = 0, 0, math.inf
    for k in range(driven.whole[Whole.LISTED]):
        if driven.room[k] > 2.0 * driven.real[Real.CROWD_TRAVEL]:
            continue
        driven.room[k] = max(driven.room[k], 0.0)
        driven.touching[count] = k
        for e in range(2):
            i = driven.pairs[k, e]
            if group.place[i] == NONE:
                group.place[i], group.members[members] = members, i
                for d in range(2):
                    group.mobility[members, d] = driven.weight[i, d]
                members += 1
            group.links[count, e] = group.place[i]
        group.contacts[count, Contact.NX] = driven.normal[k, 0]
        group.contacts[count, Contact.NY] = driven.normal[k, 1]
        driven.pushes[k] = driven.forces[k] if driven.lasting[k] else 0.0
        least = min(least, _size(driven, k))
        count += 1
    for m in range(members):
        group.place[group.members[m]] = NONE
    whole[Whole.CHOSEN], whole[Whole.MEMBERS], whole[Whole.TURN] = count, members, 0
    driven.real[Real.CROWD_TOLERANCE] = 0.1 * CLOSED_GAP * least
    copy_motion(speed, driven.ahead_speed, speed.shape[0])
    _load(driven, speed)
    before = _energy(driven)
    _collide_all(driven, before, speed)
    _load(driven, speed)
    driven.real[Real.CROWD_LOSS] = before - _energy(driven)
    account[Account.DISSIPATED_IMPACT] += driven.real[Real.CROWD_LOSS]
    copy_motion(speed, driven.velocity, speed.shape[0])
    whole[Whole.FRESH] = 0


@compiled
def _energy(driven):
    """Of the motion of the members of a crowd, J."""
    energy, motion, mobility = 0.0, driven.group.motion, driven.group.mobility
    for m in range(driven.whole[Whole.MEMBERS]):
        for d in range(2):
            if mobility[m, d] > 0.0:
                energy += 0.5 * motion[m, d] * motion[m, d] / mobility[m, d]
    return energy


@compiled
def _collide_all(driven, energy, speed):
    """Poisson's law: e times the impulse of the plastic impact is added where two particles approach faster than two steps
    of free fall make them, and would rise more than SETTLING_HEIGHT.
    """
    group, h, back = driven.group, driven.real[Real.CROWD_LENGTH], False
    count = driven.whole[Whole.CHOSEN]
    for c in range(count):
        k = driven.touching[c]
        i, j = driven.pairs[k, 0], driven.pairs[k, 1]
        pull = max(driven.pull[i], driven.pull[j]) if j < speed.shape[0] else driven.pull[i]
        slow = max(2.0 * h * pull, math.sqrt(2.0 * pull * SETTLING_HEIGHT * _size(driven, k)))
        fast = _meets(driven, k, h) and driven.rate[k] < -slow
        group.contacts[c, Contact.BIAS] = 0.0 if fast else driven.room[k] / h
        group.contacts[c, Contact.IMPULSE] = 0.0
        driven.slow[k] = 1.0 if fast else 0.0
    separate_motion(driven.whole[Whole.MEMBERS], count, driven.real[Real.CROWD_TOLERANCE] / h, group)
    _store(driven, speed)
    for c in range(count):
        k = driven.touching[c]
        driven.impulses[k] = driven.slow[k] * group.contacts[c, Contact.IMPULSE]
        more = driven.restitution[driven.pairs[k, 1]] * driven.impulses[k]
        if more > 0.0:
            push_apart(c, more, group)
            back = True
        group.contacts[c, Contact.IMPULSE] = 0.0
    if not back:
        return
    separate_motion(driven.whole[Whole.MEMBERS], count, driven.real[Real.CROWD_TOLERANCE] / h, group)
    if _energy(driven) <= energy * (1.0 + ROUND_OFF):
        _store(driven, speed)
        for c in range(count):
            k = driven.touching[c]
            driven.impulses[k] += driven.restitution[driven.pairs[k, 1]] * driven.impulses[k]


@compiled
def _load(driven, motion):
    """The motion of the members of a crowd; obstacles have none."""
    for m in range(driven.whole[Whole.MEMBERS]):
        i = driven.group.members[m]
        for d in range(2):
            driven.group.motion[m, d] = motion[i, d] if i < motion.shape[0] else 0.0


@compiled
def _store(driven, motion):
    for m in range(driven.whole[Whole.MEMBERS]):
        i = driven.group.members[m]
        if i < motion.shape[0]:
            for d in range(2):
                motion[i, d] = driven.group.motion[m, d]


@compiled
def try_crowd(driven, control, account):
    """Take the step with the forces that are to be tried."""
    clear_support(driven)
    n = driven.support.shape[0]
    for c in range(driven.whole[Whole.CHOSEN]):
        k = driven.touching[c]
        i, j = driven.pairs[k, 0], driven.pairs[k, 1]
        for d in range(2):
            push = 0.001 * driven.pushes[k] * driven.normal[k, d]
            driven.support[i, d] -= push
            if j < n:
                driven.support[j, d] += push
    raise_scale(driven, driven.real[Real.CROWD_LENGTH], control, account)
    driven.whole[Whole.PUSHED] = 1
    driven.whole[Whole.PHASE] = Phase.TRIED
    return Order.TAKE


@compiled
def judge_crowd(driven, control, account, place, speed):
    """See whether no particle sinks into another, and none is pushed away from another; if not, choose the next forces."""
    whole, real = driven.whole, driven.real
    h = control[Control.TIME] - real[Real.START]
    if h == 0.0 or whole[Whole.REASON] == StopReason.DIVERGED:
        if _drop_forces(driven):
            take_back(driven, control, account, place, speed)
            whole[Whole.PHASE] = Phase.TRYING
            return Order.GO_ON
        reason = whole[Whole.REASON]  # put back the state before the impacts
        take_back(driven, control, account, place, speed)
        account[Account.DISSIPATED_IMPACT] -= real[Real.CROWD_LOSS]
        copy_motion(driven.ahead_speed, speed, speed.shape[0])
        whole[Whole.FRESH], whole[Whole.REASON] = 0, reason
        whole[Whole.PHASE], whole[Whole.NEED] = Phase.BETWEEN, Need.NOTHING
        return Order.LEAVE
    whole[Whole.TURN] += 1
    overlap = CLOSED_GAP if whole[Whole.TURN] < MOST_FORCE_TRIES - 1 else DEEPEST_OVERLAP
    wrong = _not_closed(driven, place)
    if wrong > overlap and whole[Whole.TURN] < MOST_FORCE_TRIES:
        if real[Real.END] == math.inf:
            real[Real.END] = control[Control.TIME]
        _improve(driven, h, place)
        take_back(driven, control, account, place, speed)
        whole[Whole.PHASE] = Phase.TRYING
        return Order.GO_ON
    if wrong > TOLD_OVERLAP:
        note_unclosed(driven, wrong)
    _keep(driven, control, account, place)
    whole[Whole.CROWDS] += 1
    whole[Whole.PHASE] = Phase.BETWEEN
    return Order.GO_ON


@compiled
def _drop_forces(driven):
    """Try none; False if none were tried."""
    dropped = False
    for c in range(driven.whole[Whole.CHOSEN]):
        k = driven.touching[c]
        dropped = dropped or driven.pushes[k] > 0.0
        driven.pushes[k] = 0.0
    return dropped


@compiled
def _closed(driven, k, place):
    """The gap (m) along the line of centres at the start, after the particles moved."""
    i, j = driven.pairs[k, 0], driven.pairs[k, 1]
    apart = driven.room[k]
    for d in range(2):
        moved = driven.before[i, d] - place[i, d]
        if j < place.shape[0]:
            moved += place[j, d] - driven.before[j, d]
        apart += driven.normal[k, d] * moved
    return apart


@compiled
def _not_closed(driven, place):
    """How far pairs that push are apart, or any in one another, at most: a share of the smaller radius."""
    wrong = 0.0
    for c in range(driven.whole[Whole.CHOSEN]):
        k = driven.touching[c]
        left = _closed(driven, k, place)
        wrong = max(wrong, (abs(left) if driven.pushes[k] > 0.0 else -left) / _size(driven, k))
    return wrong


@compiled
def _improve(driven, h, place):
    """The next forces after some with which particles are here after h seconds."""
    group, free, count = driven.group, 0.5 * h * h, driven.whole[Whole.CHOSEN]
    for m in range(driven.whole[Whole.MEMBERS]):
        i = group.members[m]
        for d in range(2):
            group.motion[m, d] = place[i, d] - driven.before[i, d] if i < place.shape[0] else 0.0
    for c in range(count):
        k = driven.touching[c]
        push_apart(c, -free * driven.pushes[k], group)
        group.contacts[c, Contact.BIAS] = driven.room[k]
        group.contacts[c, Contact.IMPULSE] = free * driven.pushes[k]
    separate_motion(driven.whole[Whole.MEMBERS], count, driven.real[Real.CROWD_TOLERANCE], group)
    for c in range(count):
        driven.pushes[driven.touching[c]] = group.contacts[c, Contact.IMPULSE] / free


@compiled
def _keep(driven, control, account, place):
    """Enter what the forces did, report the impacts, and note which contacts persist."""
    for k in range(driven.whole[Whole.LISTED]):
        driven.lasting[k] = 0
    total, work = 0.0, 0.0
    for c in range(driven.whole[Whole.CHOSEN]):
        k = driven.touching[c]
        i, j, force = driven.pairs[k, 0], driven.pairs[k, 1], driven.pushes[k]
        work += force * (_closed(driven, k, place) - driven.room[k])
        gap, _, _ = gap_of(i, j, driven.position, place, driven.radius, driven.span)
        persists = force > 0.0 or gap <= SETTLING_HEIGHT * _size(driven, k)
        driven.lasting[k] = 1 if persists else 0
        driven.forces[k] = force if persists else 0.0
        total += driven.impulses[k]
    enter_work(driven, work, control, account)
    driven.real[Real.LONGEST] = math.inf
    for c in range(driven.whole[Whole.CHOSEN]):
        k = driven.touching[c]
        if driven.impulses[k] > 0.0:
            loss = driven.real[Real.CROWD_LOSS] * driven.impulses[k] / total
            report_impact(driven, k, driven.real[Real.START], driven.impulses[k], loss, driven.before)
