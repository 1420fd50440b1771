"""Contact forces of driven particles: of pairs that stay in contact during a step.

Forces F ≥ 0, constant in the step and along the lines of centres at its start, are such that the particles that they
push apart are no farther apart at its end, and no particle is deeper in another. As distances are convex, such forces
do no work, whichever they are: of contacts that depend on one another, many are possible. Where the end of a step is not
foreseen it is taken again with other forces, always to the same end: where the error is controlled, other forces would
choose another step, and gaps would jump with it. A step for which no forces are found is cut, and the next ones are short.

Newton's method finds them. Its slope is h²/2 N₁ᵀ M⁻¹ N₀, that of free particles, with the lines of centres N₀ at the
start and N₁ at the end of the step, plus what Broyden's method learns of the rods. Where no forces result, it is
h²/2 N₀ᵀ M⁻¹ N₀ from then on, for which forces always exist.
"""

import math

from pinjoint.systems.base import StopReason
from pinjoint.systems.collision.columns import NONE
from pinjoint.systems.collision.driven.columns import Order, Phase, Real, Tried, Whole
from pinjoint.systems.collision.driven.kernels.complementarity import complementary
from pinjoint.systems.collision.driven.kernels.pairs import chain_groups, end_groups, gap_of, opening, root_of
from pinjoint.systems.collision.driven.kernels.paths import foresee, take_back
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.projection import coupling
from pinjoint.systems.program.entries import Account, Control

CLOSED_GAP = 1e-13  # of the smaller radius: contacts with a smaller gap are closed
LOOSELY_CLOSED_GAP = 1e-11  # instead, after STRICT_TRIES: gaps in a row between walls hardly follow forces
# of how far forces move particles: a gap that small is closed; see FIRM in complementarity.py
COMPLIANCE_GAP = 2e-11
STRICT_TRIES, MOST_FORCE_TRIES = 3, 8  # tries of the forces in a step
STEP_CUT = 0.25  # of a step whose forces are not found: the length of the step taken instead
MOST_STEP_CUTS = 12  # after which forces no longer matter, and those of the step before are good enough
SETTLING_CONTACTS = 4  # persistent contacts, from which on bounces would go on and on
SETTLING_HEIGHT = 1e-3  # replaces REST_HEIGHT from then on: of the smaller radius


@compiled
def choose_contacts(driven, place):
    """Note the persistent contacts, their gaps and lines of centres as a step begins; False if there is no room.

    They are noted block by block.
    """
    count, number, n = 0, 0, place.shape[0]
    for k in range(driven.whole[Whole.LISTED]):
        if driven.lasting[k]:
            driven.touching[count] = k
            count += 1
    if count > driven.chosen.shape[0]:
        return False
    chain_groups(driven, count, n)
    for t in range(count):
        root = root_of(driven, driven.touching[t], n)
        if driven.group.place[root] != t:
            continue
        first, u = number, t
        while u != NONE:
            k = driven.touching[u]
            i, j = driven.pairs[k, 0], driven.pairs[k, 1]
            gap, nx, ny = gap_of(i, j, driven.position, place, driven.radius, driven.span)
            driven.chosen[number], driven.search[Tried.LEAST, number] = k, min(gap, 0.0)
            driven.start[number, 0], driven.start[number, 1] = nx, ny
            number += 1
            u = driven.chain[u]
        for c in range(first, number):
            driven.block[0, c], driven.block[1, c] = first, number
    end_groups(driven, count, n)
    driven.whole[Whole.CHOSEN] = number
    return True


@compiled
def begin_search(driven):
    """Begin to look for the forces of a step with those of the step before."""
    whole, number = driven.whole, driven.whole[Whole.CHOSEN]
    whole[Whole.TURN], whole[Whole.REGULAR] = 0, 1
    for c in range(number):
        driven.search[Tried.FORCES, c] = driven.forces[driven.chosen[c]]
        for d in range(driven.block[0, c], driven.block[1, c]):
            driven.learnt[c, d] = 0.0
            driven.slope[c, d] = 0.0


@compiled
def resume_search(driven, end):
    """Look for the forces up to another end (s) of a step: from those that were found, and with what was learnt.

    How far forces move particles grows with the square of the time.
    """
    whole, real = driven.whole, driven.real
    if not whole[Whole.REGULAR] or real[Real.NOW] == real[Real.START]:
        begin_search(driven)
        return
    whole[Whole.TURN] = 0
    share = ((end - real[Real.START]) / (real[Real.NOW] - real[Real.START])) ** 2
    for c in range(whole[Whole.CHOSEN]):
        for d in range(driven.block[0, c], driven.block[1, c]):
            driven.learnt[c, d] *= share
            driven.slope[c, d] *= share


@compiled
def clear_support(driven):
    """Let no contact force act."""
    if driven.whole[Whole.PUSHED]:
        for p in range(driven.whole[Whole.NEAR]):
            driven.support[driven.near[p], 0], driven.support[driven.near[p], 1] = 0.0, 0.0


@compiled
def try_forces(driven, control, account):
    """Take, or foresee, the step with the forces that are to be tried."""
    whole = driven.whole
    clear_support(driven)
    for c in range(whole[Whole.CHOSEN]):
        push, k = 0.001 * driven.search[Tried.FORCES, c], driven.chosen[c]
        i, j = driven.pairs[k, 0], driven.pairs[k, 1]
        for d in range(2):
            driven.support[i, d] -= driven.start[c, d] * push
            if j < driven.support.shape[0]:
                driven.support[j, d] += driven.start[c, d] * push
    if whole[Whole.CHOSEN] > 0:
        raise_scale(driven, driven.real[Real.END] - driven.real[Real.START], control, account)
        whole[Whole.PUSHED] = 1
    whole[Whole.PHASE] = Phase.TRIED
    if whole[Whole.FORESEEN]:
        foresee(driven, control)
        return Order.GO_ON
    return Order.TAKE


@compiled
def raise_scale(driven, length, control, account):
    """Raise the scale of energies to at least what contact forces carry in the step to be tried, along radii.

    A model that begins in contact is supplied no energy otherwise, would never be found at rest, and any round-off would
    count as divergence. Forces of a jam that cancel carry nothing. length: of the step (s): of a part of a whole one the
    mean over all of it counts, since in microseconds a jam pushes a thousand times harder.
    """
    energy = 0.0
    for p in range(driven.whole[Whole.NEAR]):
        i = driven.near[p]
        carried = 1000.0 * (abs(driven.support[i, 0]) + abs(driven.support[i, 1]))
        energy += carried * driven.size[i]
    energy *= min(length / control[Control.STEP_SIZE], 1.0)
    account[Account.ENERGY_SCALE] = max(driven.kept[control.shape[0] + Account.ENERGY_SCALE], energy)


@compiled
def judge_forces(driven, control, account, place, speed):
    """See whether the contacts are closed at the end of the step; if not, choose the next forces, or a shorter step."""
    whole, real = driven.whole, driven.real
    if not whole[Whole.FORESEEN]:
        real[Real.NOW] = control[Control.TIME]
    h = real[Real.NOW] - real[Real.START]
    whole[Whole.PHASE] = Phase.HELD
    lost = h == 0.0 or whole[Whole.REASON] == StopReason.DIVERGED
    if whole[Whole.CHOSEN] == 0:
        return Order.GO_ON
    if lost and whole[Whole.TURN] == 0:
        if not _drop_forces(driven):
            return Order.GO_ON  # no contact force is to blame
        take_back(driven, control, account, place, speed)
        whole[Whole.PHASE] = Phase.TRYING
        return Order.GO_ON
    after = driven.ahead if whole[Whole.FORESEEN] else place
    closed = not lost and _measure(driven, after)
    if not lost and not closed and whole[Whole.CUTS] == MOST_STEP_CUTS:
        note_unclosed(driven, _not_closed(driven))
        closed = True
    if closed:
        if h > 0.5 * real[Real.CUT]:  # the next step may be longer than one that was cut
            real[Real.CUT] *= 2.0
        return Order.GO_ON
    if not whole[Whole.FORESEEN] and not lost:
        real[Real.END] = real[Real.NOW]
    whole[Whole.TURN] += 1
    changed = not lost and _improve(driven, h)
    take_back(driven, control, account, place, speed)
    if not changed or whole[Whole.TURN] == MOST_FORCE_TRIES:
        whole[Whole.CUTS] += 1
        real[Real.CUT] = STEP_CUT * h
        real[Real.END] = real[Real.START] + real[Real.CUT]
        begin_search(driven)
    whole[Whole.PHASE] = Phase.TRYING
    return Order.GO_ON


@compiled
def _not_closed(driven):
    """How far contacts that push are open, or any in one another, at most: a share of the smaller radius."""
    wrong = 0.0
    for c in range(driven.whole[Whole.CHOSEN]):
        i, j = driven.pairs[driven.chosen[c]]
        gap = driven.search[Tried.GAP, c]
        gap = abs(gap) if driven.search[Tried.FORCES, c] > 0.0 else -gap
        wrong = max(wrong, gap / min(driven.size[i], driven.size[j]))
    return wrong


@compiled
def note_unclosed(driven, wrong):
    """Note that a step is accepted though contacts are open, or discs in one another, by this share of a radius."""
    driven.whole[Whole.UNCLOSED] += 1
    driven.real[Real.UNCLOSED] = max(driven.real[Real.UNCLOSED], wrong)


@compiled
def _drop_forces(driven):
    """Try none; False if none were tried. Those of the step before can be too large: of a jam in a very short one."""
    dropped = False
    for c in range(driven.whole[Whole.CHOSEN]):
        dropped = dropped or driven.search[Tried.FORCES, c] > 0.0
        driven.search[Tried.FORCES, c] = 0.0
    return dropped


@compiled
def _measure(driven, after):
    """Measure the gaps at the end of a step; True if all contacts are closed that push, and none overlaps."""
    whole, search = driven.whole, driven.search
    number, all_closed = whole[Whole.CHOSEN], True
    closed = CLOSED_GAP if whole[Whole.TURN] < STRICT_TRIES else LOOSELY_CLOSED_GAP
    for c in range(number):
        k = driven.chosen[c]
        i, j = driven.pairs[k, 0], driven.pairs[k, 1]
        gap, nx, ny = gap_of(i, j, driven.position, after, driven.radius, driven.span)
        gap -= search[Tried.LEAST, c]
        driven.end[c, 0], driven.end[c, 1] = nx, ny
        moved = 0.0
        for d in range(driven.block[0, c], driven.block[1, c]):
            moved += abs(driven.slope[c, d]) * search[Tried.FORCES, d]
        allowed = closed * min(driven.size[i], driven.size[j]) + COMPLIANCE_GAP * moved
        search[Tried.GAP, c], search[Tried.ALLOWED, c] = gap, allowed
        wrong = abs(gap) if search[Tried.FORCES, c] > 0.0 else -gap
        all_closed = all_closed and wrong <= allowed
    return all_closed


@compiled
def _improve(driven, h):
    """Choose the next forces; False if they are those that were tried."""
    whole, search = driven.whole, driven.search
    number, free = whole[Whole.CHOSEN], 0.5 * h * h
    if whole[Whole.TURN] > 1:
        _learn(driven, number)
    for c in range(number):
        search[Tried.OLD_FORCES, c], search[Tried.OLD_GAP, c] = search[Tried.FORCES, c], search[Tried.GAP, c]
    if whole[Whole.REGULAR]:
        _set_slope(driven, free, driven.end)
        for c in range(number):
            for d in range(driven.block[0, c], driven.block[1, c]):
                driven.slope[c, d] += driven.learnt[c, d]
        whole[Whole.REGULAR] = _complementary(driven, number)
    if not whole[Whole.REGULAR]:
        _set_slope(driven, free, driven.start)
        _complementary(driven, number)
    changed = False
    for c in range(number):
        changed = changed or search[Tried.FOUND, c] != search[Tried.FORCES, c]
        search[Tried.FORCES, c] = search[Tried.FOUND, c]
    return changed


@compiled
def _complementary(driven, number):
    """Find the forces block by block; False if there are none in one of them."""
    first, found = 0, True
    while first < number:
        end = driven.block[1, first]
        if not complementary(first, end, driven.slope, driven.search, driven.matrix, driven.sides):
            found = False
        first = end
    return found


@compiled
def _learn(driven, number):
    """Broyden's update: what the last change of the forces did to the gaps beyond the slope."""
    search = driven.search
    for c in range(number):
        first, end = driven.block[0, c], driven.block[1, c]
        missed, squared = search[Tried.GAP, c] - search[Tried.OLD_GAP, c], 0.0
        for d in range(first, end):
            moved = search[Tried.FORCES, d] - search[Tried.OLD_FORCES, d]
            missed -= driven.slope[c, d] * moved
            squared += moved * moved
        if squared == 0.0 or abs(missed) <= search[Tried.ALLOWED, c]:
            continue
        for d in range(first, end):
            moved = search[Tried.FORCES, d] - search[Tried.OLD_FORCES, d]
            driven.learnt[c, d] += missed * moved / squared


@compiled
def _set_slope(driven, free, normal):
    """The slope of free particles: gaps along `normal`, forces along the lines of centres at the start."""
    start = driven.start
    for c in range(driven.whole[Whole.CHOSEN]):
        for d in range(driven.block[0, c], driven.block[1, c]):
            ends = driven.pairs[driven.chosen[c]], driven.pairs[driven.chosen[d]]
            along = coupling(ends, normal[c, 0], normal[c, 1], start[d, 0], start[d, 1], driven.weight)
            driven.slope[c, d] = free * along


@compiled
def keep_contacts(driven, h, control, account, place, speed):
    """At the end of a step keep the contacts that push or touch; among many, also those with a small gap now and later.

    What their forces did is entered in the account: they are constant, so that force times displacement is exact. By steps
    that are foreseen they act on the motion at its mean velocity.
    """
    whole, real = driven.whole, driven.real
    number, lasts, work = whole[Whole.CHOSEN], driven.search[Tried.FORCES], 0.0
    if whole[Whole.TURN] == 0:
        _refine(driven, h)
        lasts = driven.search[Tried.FOUND]
    for c in range(number):
        k = driven.chosen[c]
        i, j = driven.pairs[k, 0], driven.pairs[k, 1]
        size = min(driven.size[i], driven.size[j])
        gap, nx, ny = gap_of(i, j, driven.position, place, driven.radius, driven.span)
        gap -= driven.search[Tried.LEAST, c]
        force = driven.search[Tried.FORCES, c]
        for d in range(2):
            apart = _moved(driven, j, d, h, place, speed) - _moved(driven, i, d, h, place, speed)
            work += force * driven.start[c, d] * apart
        persists = force > 0.0 or gap <= CLOSED_GAP * size
        if number >= SETTLING_CONTACTS:
            later = gap + h * opening(i, j, nx, ny, speed)
            persists = persists or max(gap, later) <= SETTLING_HEIGHT * size
        driven.lasting[k] = 1 if persists else 0
        driven.forces[k] = lasts[c] if persists else 0.0
    enter_work(driven, work, control, account)
    real[Real.LONGEST] = (
        real[Real.CUT] if number > 0 and real[Real.CUT] < control[Control.STEP_SIZE] else math.inf
    )


@compiled
def enter_work(driven, work, control, account):
    """Enter what contact forces did in a step (J), also where the step was checked, which found it missing.

    They can only take energy; what their errors give is nobody's, and stays in the imbalance. Of steps that are foreseen
    it is of either sign: what the energy that the integrator conserves knows of them.
    """
    if driven.whole[Whole.FORESEEN]:
        account[Account.WORK] += work
    else:
        work = min(work, 0.0)
        account[Account.DISSIPATED_IMPACT] -= work
    before, found = (
        driven.kept[control.shape[0] + Account.LARGEST_IMBALANCE],
        account[Account.LARGEST_IMBALANCE],
    )
    if found != before:
        account[Account.LARGEST_IMBALANCE] = found + work if abs(found + work) > abs(before) else before


@compiled
def _refine(driven, h):
    """Find forces that close the contacts better than those that were tried once and good enough: one Gauss–Seidel sweep.

    They are for the next step. With the same ones in every step, what their errors move would never come to rest.
    """
    search, slope = driven.search, driven.slope
    _set_slope(driven, 0.5 * h * h, driven.end)
    for c in range(driven.whole[Whole.CHOSEN]):
        left = search[Tried.GAP, c]
        for d in range(driven.block[0, c], c):
            left += slope[c, d] * (search[Tried.FOUND, d] - search[Tried.FORCES, d])
        moved = left / slope[c, c] if slope[c, c] > 0.0 else 0.0
        search[Tried.FOUND, c] = max(search[Tried.FORCES, c] - moved, 0.0)


@compiled
def _moved(driven, i, d, h, place, speed):
    """How far a particle, or an obstacle, moved in the step, as far as the energy of its motion knows."""
    if i >= place.shape[0]:
        return 0.0
    if driven.whole[Whole.FORESEEN]:
        return 0.5 * h * (driven.velocity[i, d] + speed[i, d])
    return place[i, d] - driven.before[i, d]
