"""The solver of a pile: impulses in the contacts of a step, by projected Gauss–Seidel sweeps.

The step is that of Moreau and Jean (Jean, Comput. Methods Appl. Mech. Eng. 177, 1999): the velocities at the end,
    v₁ = v₀ + h g + W N p,   n·Δv₁ + max(gap/h, e n·Δv₀ at an impact) ≥ 0 ⟂ p ≥ 0.
"""

import math

from pinjoint.systems.collision.columns import Disc, Number, PileContact, PilePair
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.persistent_contact import is_held
from pinjoint.systems.collision.kernels.time_of_impact import rest_speed

MOST_PILE_SWEEPS = 80  # to and fro over the contacts in a step; the next continues from its impulses
FEW = 0.02  # of the contacts left to correct, at which sweeps end
MOST_REST = 10  # times that each contact is then looked at, on average
MOST_RELAXED = 40000  # contacts up to which the sweeps over few are more
ALL_AGAIN = 8  # turns, after which sweeps go over idle contacts too
PLASTIC, KEPT = 1.0, 2.0  # Pile.law: the disc does not bounce; nor is it pushed out of others
SIDE_BY_SIDE = 4  # contacts next to each other in the order of sweeps are far apart: computed at once


@compiled
def start_without_contacts(h, discs, pile):
    """Set the velocities at the end of the step without contacts."""
    for i in range(discs.shape[0]):
        for d in range(2):
            pile.speed[2 * i + d] = without_contacts(i, d, h, discs, pile)
            pile.direction[2 * i + d] = 0.0
        pile.nearness[i] = 0.0


@compiled
def without_contacts(i, d, h, discs, pile):
    """u of a disc at the end of the step, without contacts; 0 where it is held."""
    root = pile.root[2 * i + d]
    return (discs[i, Disc.VX + d] + h * discs[i, Disc.GX + d]) / root if root > 0.0 else 0.0


@compiled
def make_contacts(active, h, discs, pile, numbers):
    """Make contacts of the chosen pairs, in the order of sweeps, with the impulses of the step before."""
    length = (active + SIDE_BY_SIDE - 1) // SIDE_BY_SIDE
    c = 0
    for s in range(length):
        for lane in range(SIDE_BY_SIDE):
            if lane * length + s < active:
                _make_contact(c, pile.chosen[lane * length + s], h, discs, pile, numbers)
                c += 1


@compiled
def _make_contact(c, k, h, discs, pile, numbers):
    contacts = pile.contacts
    i, j = pile.pairs[k, 0], pile.pairs[k, 1]
    pair = pile.near[k]
    nx, ny, gap, speed = pair[PilePair.NX], pair[PilePair.NY], pair[PilePair.GAP], pair[PilePair.RATE]
    pile.order[c] = k
    contacts[c, PileContact.AX] = -nx * pile.root[2 * i]
    contacts[c, PileContact.AY] = -ny * pile.root[2 * i + 1]
    contacts[c, PileContact.BX] = nx * pile.root[2 * j]
    contacts[c, PileContact.BY] = ny * pile.root[2 * j + 1]
    opening = 0.0
    for d in range(4):
        opening += contacts[c, PileContact.AX + d] ** 2
    root = math.sqrt(opening)
    pile.scale[c] = root
    contacts[c, PileContact.BIAS], contacts[c, PileContact.IMPULSE] = 0.0, 0.0
    contacts[c, PileContact.PREVIOUS], contacts[c, PileContact.DIRECTION] = 0.0, 0.0
    # a held disc takes no part: the other stands for it, so that contacts with one wall do not wait for one another
    pile.ends[c, 0] = j if is_held(i, discs) else i
    pile.ends[c, 1] = i if is_held(j, discs) else j
    if opening == 0.0:
        return
    pulled, bias = speed + h * pair[PilePair.PULL], gap / h
    law = max(pile.law[i], pile.law[j])
    if law == 0.0 and pulled + bias < 0.0 and bounces(speed, i, j, h, discs, pile, numbers):
        bias = min(bias, discs[j, Disc.BOUNCE] * speed)
    elif law == KEPT:
        bias = max(bias, 0.0)
    contacts[c, PileContact.BIAS] = bias / root
    for d in range(4):
        contacts[c, PileContact.AX + d] /= root
    first = pile.forces[k] * h * root if law == 0.0 else 0.0
    contacts[c, PileContact.IMPULSE] = contacts[c, PileContact.PREVIOUS] = first
    for d in range(2):
        pile.speed[2 * i + d] += contacts[c, PileContact.AX + d] * contacts[c, PileContact.IMPULSE]
        pile.speed[2 * j + d] += contacts[c, PileContact.BX + d] * contacts[c, PileContact.IMPULSE]
    if is_held(j, discs):  # the part of the disc that moves comes second, see _relax
        for d in range(2):
            contacts[c, PileContact.BX + d], contacts[c, PileContact.AX + d] = (
                contacts[c, PileContact.AX + d],
                0.0,
            )


@compiled
def bounces(speed, i, j, h, discs, pile, numbers):
    """True if discs bounce: `speed` (of separation, m/s) exceeds what free fall gives in two steps, in approach."""
    slow = 2.0 * h * max(pile.pull[i], pile.pull[j])
    return speed < -slow and speed < -rest_speed(i, j, discs, numbers[Number.NOW])


@compiled
def find_impulses(active, tolerance, pile):
    """Find the impulses after which no contact closes faster than the tolerance.

    Sweeps to and fro, accelerated by conjugate directions: Silcowitz, Niebe, Erleben, "A nonsmooth nonlinear
    conjugate gradient method for interactive contact force problems", Vis. Comput. 26 (2010). Each sweep goes once
    through memory: the acceleration of an impulse is added when its contact is relaxed. Once few contacts are left to
    correct, these are relaxed one by one, with those that they upset. Most sweeps leave out contacts that do not push.
    """
    size, share, keep, few, busy = 0.0, 0.0, 0.0, FEW * active, active
    for turn in range(max(MOST_PILE_SWEEPS, MOST_RELAXED // max(active, 1))):
        if turn % ALL_AGAIN == 0:
            busy = active
        _accelerate(share, keep, pile)
        for c in range(busy):
            _relax_forward(c, share, keep, pile)
        previous, size, rough = size, 0.0, 0
        for c in range(busy - 1, -1, -1):
            before = pile.contacts[c, PileContact.IMPULSE]
            impulse = _relax(c, before, pile)
            change = impulse - pile.contacts[c, PileContact.PREVIOUS]
            size += change * change
            rough += abs(impulse - before) * pile.scale[c] > tolerance
        share = size / previous if turn > 0 and size <= previous else 0.0
        keep = 1.0 if turn == 0 or share > 0.0 else 0.0
        if turn % ALL_AGAIN == 0:
            busy = _put_idle_last(active, pile)
        if rough <= few:
            if _relax_rest(active, tolerance, pile):
                return
            share, keep, few, busy = 0.0, 0.0, 0.25 * few, active


@compiled
def _put_idle_last(active, pile):
    """Put contacts last that have not pushed of late; returns the number of the others, which keep their order."""
    contacts, busy = pile.contacts, 0
    for c in range(active):
        impulse, previous = contacts[c, PileContact.IMPULSE], contacts[c, PileContact.PREVIOUS]
        if impulse > 0.0 or previous != 0.0 or contacts[c, PileContact.DIRECTION] != 0.0:
            if busy < c:
                _exchange(busy, c, pile)
            busy += 1
    return busy


@compiled
def _exchange(b, c, pile):
    """Let two contacts change places."""
    contacts, scale, order, ends = pile.contacts, pile.scale, pile.order, pile.ends
    for k in range(contacts.shape[1]):
        contacts[b, k], contacts[c, k] = contacts[c, k], contacts[b, k]
    scale[b], scale[c] = scale[c], scale[b]
    order[b], order[c] = order[c], order[b]
    for end in range(2):
        ends[b, end], ends[c, end] = ends[c, end], ends[b, end]


@compiled
def _relax_rest(active, tolerance, pile):
    """Relax contacts in a queue until none would change by more than the tolerance; a change queues all of its discs.

    False if that would take long.
    """
    first, contacts_of, queue, queued = pile.first, pile.contacts_of, pile.queue, pile.queued
    _list_contacts(active, pile)
    for c in range(active):
        queue[c], queued[c] = c, 1
    head, waiting, left = 0, active, MOST_REST * active
    while waiting > 0 and left > 0:
        c = queue[head]
        queued[c] = 0
        head = head + 1 if head + 1 < active else 0
        waiting, left = waiting - 1, left - 1
        before = pile.contacts[c, PileContact.IMPULSE]
        impulse = max(before - opening(c, pile), 0.0)
        if abs(impulse - before) * pile.scale[c] <= tolerance:
            continue
        _relax(c, before, pile)
        for end in range(2):
            i = pile.ends[c, end]
            for k in range(first[i], first[i + 1]):
                d = contacts_of[k]
                if queued[d] == 0 and d != c:
                    last = head + waiting
                    queue[last if last < active else last - active], queued[d] = d, 1
                    waiting += 1
    return waiting == 0


@compiled
def _list_contacts(active, pile):
    """List the contacts of every disc: contacts_of[first[i] : first[i + 1]]."""
    first, contacts_of = pile.first, pile.contacts_of
    n = first.shape[0] - 1
    for i in range(n + 1):
        first[i] = 0
    for c in range(active):
        for end in range(2):
            first[pile.ends[c, end]] += 1
    for i in range(n):
        first[i + 1] += first[i]
    for c in range(active):
        for end in range(2):
            i = pile.ends[c, end]
            first[i] -= 1
            contacts_of[first[i]] = c


@compiled
def _accelerate(share, keep, pile):
    """Move the velocities by a share of the direction of the sweeps so far; `keep` adds the last sweep to it."""
    speed, previous, direction = pile.speed, pile.previous, pile.direction
    for k in range(speed.shape[0]):
        more = share * direction[k]
        swept = more + speed[k] - previous[k]
        direction[k] = keep * swept
        speed[k] += more
        previous[k] = speed[k]


@compiled
def _relax_forward(c, share, keep, pile):
    """Move the impulse of a contact likewise, and relax the contact."""
    contacts = pile.contacts
    present = contacts[c, PileContact.IMPULSE]
    more = share * contacts[c, PileContact.DIRECTION]
    contacts[c, PileContact.DIRECTION] = keep * (more + present - contacts[c, PileContact.PREVIOUS])
    contacts[c, PileContact.PREVIOUS] = present + more
    _relax(c, present + more, pile)


@compiled
def opening(c, pile):
    """Rate at which a contact opens, in the scale of its impulse."""
    contacts, speed, ends = pile.contacts, pile.speed, pile.ends
    a, b = ends[c, 0], ends[c, 1]
    first = contacts[c, PileContact.AX] * speed[2 * a] + contacts[c, PileContact.AY] * speed[2 * a + 1]
    second = contacts[c, PileContact.BX] * speed[2 * b] + contacts[c, PileContact.BY] * speed[2 * b + 1]
    return (first + second) + contacts[c, PileContact.BIAS]


@compiled
def _relax(c, before, pile):
    """Change the impulse of a contact so that it neither closes nor pulls; returns the impulse.

    Where one disc is held, both ends are the other: what the second writes then counts.
    """
    contacts, speed = pile.contacts, pile.speed
    a, b = 2 * pile.ends[c, 0], 2 * pile.ends[c, 1]
    ax, ay = contacts[c, PileContact.AX], contacts[c, PileContact.AY]
    bx, by = contacts[c, PileContact.BX], contacts[c, PileContact.BY]
    ux, uy, vx, vy = speed[a], speed[a + 1], speed[b], speed[b + 1]
    rate = ((ax * ux + ay * uy) + (bx * vx + by * vy)) + contacts[c, PileContact.BIAS]
    impulse = max(before - rate, 0.0)
    change = impulse - before
    contacts[c, PileContact.IMPULSE] = impulse
    speed[a], speed[a + 1] = ux + ax * change, uy + ay * change
    speed[b], speed[b + 1] = vx + bx * change, vy + by * change
    return impulse
