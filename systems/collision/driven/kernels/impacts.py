"""Impacts of driven particles: what happens at the instant at which a step ends."""

import math

from pinjoint.systems.collision.columns import NONE, REST_HEIGHT, Contact, Detail
from pinjoint.systems.collision.driven.columns import Need, Real, Whole
from pinjoint.systems.collision.driven.kernels.contacts import SETTLING_CONTACTS, SETTLING_HEIGHT
from pinjoint.systems.collision.driven.kernels.pairs import chain_groups, end_groups, gap_of, opening, root_of
from pinjoint.systems.collision.driven.kernels.paths import TOUCHING_GAP, is_left_alone, touching_gap
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.impact import respond
from pinjoint.systems.collision.kernels.projection import compliance
from pinjoint.systems.program.entries import Account, Control

SHORT_BOUNCE = 1.0 / 32.0  # of a step: half of how long a bounce lasts
ROUND_OFF = 1e-14  # of the fastest speed: slower approaches are none; and of an energy


@compiled
def set_rest_speeds(driven, h, later, step):
    """The speed of approach below which each pair stays in contact: √(2 a · height), a being the larger acceleration.

    h: length (s) of the step that led to the velocities `later`. step: of the next whole one (s). Where impacts are
    elastic, but dampers calm the motion, bounces on a structure become ever shorter without end: those that would be
    over in a small part of a step end, too, if they would rise no more than SETTLING_HEIGHT.
    """
    lasting, calmed = 0, driven.whole[Whole.BOUNCY] == 0 and driven.whole[Whole.DAMPED] == 1
    for k in range(driven.whole[Whole.LISTED]):
        lasting += driven.lasting[k]
    share = SETTLING_HEIGHT if lasting >= SETTLING_CONTACTS else REST_HEIGHT
    for k in range(driven.whole[Whole.LISTED]):
        i, j = driven.pairs[k, 0], driven.pairs[k, 1]
        height = TOUCHING_GAP * (driven.radius[i] + driven.radius[j])
        if driven.whole[Whole.BOUNCY]:
            height = max(height, share * min(driven.size[i], driven.size[j]))
        pull = _acceleration(driven, i, h, later)
        if j < later.shape[0]:
            pull = max(pull, _acceleration(driven, j, h, later))
        slow = math.sqrt(2.0 * pull * height)
        if calmed:
            risen = SETTLING_HEIGHT * min(driven.size[i], driven.size[j])
            slow = max(slow, min(math.sqrt(2.0 * pull * risen), SHORT_BOUNCE * pull * step))
        driven.slow[k] = slow


@compiled
def _acceleration(driven, i, h, later):
    """Of a particle, by constant forces or in the step, whichever is larger (m/s²)."""
    if h <= 0.0:
        return driven.pull[i]
    x, y = later[i, 0] - driven.velocity[i, 0], later[i, 1] - driven.velocity[i, 1]
    return max(driven.pull[i], math.sqrt(x * x + y * y) / h)


@compiled
def resolve_touching(driven, control, account, place, speed, soon):
    """Resolve the impacts of all pairs that touch now, or approach so that they do `soon` (s); False if none does.

    Contacts of pairs that part no faster than at rest begin to persist.
    """
    count, fastest = 0, 0.0
    for k in range(driven.whole[Whole.LISTED]):
        i, j = driven.pairs[k, 0], driven.pairs[k, 1]
        gap, nx, ny = gap_of(i, j, driven.position, place, driven.radius, driven.span)
        touches = gap <= 4.0 * touching_gap(driven, i, j, place)
        touches = touches or (soon > 0.0 and gap <= -soon * opening(i, j, nx, ny, speed))
        if not touches or (driven.lasting[k] == 0 and is_left_alone(driven, k)):
            continue
        driven.touching[count] = k
        count += 1
        driven.normal[k, 0], driven.normal[k, 1] = nx, ny
        driven.rate[k] = opening(i, j, nx, ny, speed)
        if driven.lasting[k]:
            driven.slow[k] = math.inf
        fastest = max(fastest, speed[i, 0] * speed[i, 0] + speed[i, 1] * speed[i, 1])
        if j < speed.shape[0]:
            fastest = max(fastest, speed[j, 0] * speed[j, 0] + speed[j, 1] * speed[j, 1])
    noise, acts = ROUND_OFF * math.sqrt(fastest), False
    for t in range(count):
        k = driven.touching[t]
        acts = acts or driven.lasting[k] == 0 or driven.rate[k] < -noise
    if not acts:
        return False
    chain_groups(driven, count, speed.shape[0])
    for t in range(count):
        if driven.group.place[root_of(driven, driven.touching[t], speed.shape[0])] == t:
            _resolve_group(driven, t, control, account, place, speed)
    end_groups(driven, count, speed.shape[0])
    _begin_contacts(driven, count, control, speed)
    driven.whole[Whole.FRESH] = 0
    return True


@compiled
def _resolve_group(driven, first, control, account, place, speed):
    """Resolve the joint impact of a chain of pairs; it is plastic if no pair approaches faster than at rest."""
    group, n = driven.group, speed.shape[0]
    restitution, any_fast, approaches = 1.0, False, False
    members, contacts, t = 0, 0, first
    while t != NONE:
        k = driven.touching[t]
        for e in range(2):
            members, group.links[contacts, e] = _member(driven, driven.pairs[k, e], members, speed)
        group.contacts[contacts, Contact.NX] = driven.normal[k, 0]
        group.contacts[contacts, Contact.NY] = driven.normal[k, 1]
        group.contacts[contacts, Contact.BIAS] = 0.0
        group.contacts[contacts, Contact.COMPLIANCE] = compliance(contacts, contacts, group)
        approaches = approaches or driven.rate[k] < 0.0
        if driven.rate[k] < -driven.slow[k]:
            any_fast = True
            restitution = min(restitution, driven.restitution[driven.pairs[k, 1]])
        contacts += 1
        t = driven.chain[t]
    if not approaches:
        return
    respond(members, contacts, restitution if any_fast else 0.0, group)
    for m in range(members):
        if group.members[m] < n:
            for d in range(2):
                speed[group.members[m], d] = group.motion[m, d]
    loss, total, c, t = 0.0, 0.0, 0, first
    while t != NONE:
        k = driven.touching[t]
        impulse = group.contacts[c, Contact.TOTAL_IMPULSE]
        after = opening(driven.pairs[k, 0], driven.pairs[k, 1], driven.normal[k, 0], driven.normal[k, 1], speed)
        loss -= 0.5 * (impulse * (driven.rate[k] + after))
        total += impulse
        c += 1
        t = driven.chain[t]
    account[Account.DISSIPATED_IMPACT] += loss
    c, t = 0, first
    while any_fast and t != NONE:  # each has a share of the energy lost by its impulse
        impulse, k = group.contacts[c, Contact.TOTAL_IMPULSE], driven.touching[t]
        if impulse > 0.0:
            report_impact(driven, k, control[Control.TIME], impulse, loss * impulse / total, place)
        c, t = c + 1, driven.chain[t]


@compiled
def _member(driven, i, members, speed):
    """The number of members, and which of them a particle or obstacle is, which is entered if it is none yet."""
    group = driven.group
    for m in range(members):
        if group.members[m] == i:
            return members, m
    group.members[members] = i
    for d in range(2):
        group.mobility[members, d] = driven.weight[i, d]
        group.motion[members, d] = speed[i, d] if i < speed.shape[0] else 0.0
    return members + 1, members


@compiled
def report_impact(driven, k, time, impulse, loss, place):
    """Report the impact of a pair at a time (s) and these displacements, with its impulse (N·s) and energy lost (J)."""
    report, row = driven.report, driven.whole[Whole.REPORTED]
    i, j = driven.pairs[k, 0], driven.pairs[k, 1]
    report[row, Detail.TIME], report[row, Detail.FIRST], report[row, Detail.SECOND] = time, i, j
    report[row, Detail.IMPULSE], report[row, Detail.LOSS] = impulse, loss
    report[row, Detail.X] = driven.position[i, 0] + place[i, 0] + driven.normal[k, 0] * driven.radius[i]
    report[row, Detail.Y] = driven.position[i, 1] + place[i, 1] + driven.normal[k, 1] * driven.radius[i]
    driven.whole[Whole.REPORTED] += 1


@compiled
def _begin_contacts(driven, count, control, speed):
    """Let pairs that touch and part no faster than at rest stay in contact, and wake what is asleep and was struck."""
    whole = driven.whole
    for t in range(count):
        k = driven.touching[t]
        i, j = driven.pairs[k, 0], driven.pairs[k, 1]
        if driven.asleep[i] or (j < speed.shape[0] and driven.asleep[j]):
            whole[Whole.NEED] = Need.WAKE
        if driven.lasting[k]:
            continue
        slow = driven.slow[k]
        if slow > 0.0 and opening(i, j, driven.normal[k, 0], driven.normal[k, 1], speed) <= slow:
            driven.lasting[k], driven.forces[k] = 1, 0.0
            for p in range(speed.shape[0]):  # nothing sleeps while contacts persist: see systems/run/sleep.py
                if driven.asleep[p]:
                    whole[Whole.NEED] = Need.WAKE
            limit = driven.real[Real.HELD_LIMIT]
            control[Control.STEP_SIZE] = min(control[Control.STEP_SIZE], limit)
