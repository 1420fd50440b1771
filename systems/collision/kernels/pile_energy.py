"""The energy of a pile's step: neither bounces nor forces may supply any.

Newton's law of restitution supplies energy where discs bounce that are jammed: a row that nearly fits between two walls
must part at both ends, and bends upwards as fast as that takes. So the energy of every part of the pile, the discs that
push one another, is compared with that before the step. Velocities v₁ that hold during the whole step change it by
    p·N v₁ − ½ |v₁ − v₀|²_M.
A part that gains by its bounces is solved anew without. Then p·(N v₁ + gap/h) ≤ 0, which impulses that are not exact are
reduced to, leaves it as gain only what undoes overlaps, which gave as much when the discs sank in; and all parts together
never gain more than the run has lost so far, but for what lifts everything by a thousandth of a radius.
"""

from pinjoint.systems.collision.columns import Disc, Number, PileContact, PilePair
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.pile_solver import KEPT, PLASTIC, opening, without_contacts

ROUND_OFF = 1e-12  # of the energy of a part
SAME = 0.999  # of a bias that is a gap by the length of a step, in spite of round-off
MISLED = 0.5  # share of impulses that may be kept, below which those of the step before misled, as in a row come loose
LIFT = 1e-3  # of the smallest radius, by which a run may lift all discs above where they began


@compiled
def supplies_energy(active, h, discs, pile, numbers):
    """True if a part would gain energy: its discs are now bound by a stricter law, and the step must be solved anew."""
    _find_parts(active, discs, pile)
    _measure_discs(h, discs, pile)
    _measure_contacts(active, h, pile)
    spare = numbers[Number.LOSS] + _lifting(LIFT * numbers[Number.SMALLEST], discs)
    for i in range(discs.shape[0]):
        spare -= max(pile.gain[i], 0.0)
    anew, reduced = False, False
    for i in range(discs.shape[0]):
        law = _law_of_gain(pile.part[i], spare, pile)
        if law > pile.law[i]:
            pile.law[i] = law
            anew = True
        reduced |= pile.share[pile.part[i]] < 1.0
    if reduced and not anew:
        _reduce(active, h, discs, pile)
    return anew


@compiled
def _find_parts(active, discs, pile):
    """Set `part` of each disc to the first of the discs that push one another, with it among them."""
    part = pile.part
    for i in range(discs.shape[0]):
        part[i] = i
    for c in range(active):
        if pile.contacts[c, PileContact.IMPULSE] > 0.0:
            a, b = _first(pile.ends[c, 0], part), _first(pile.ends[c, 1], part)
            part[max(a, b)] = min(a, b)
    for i in range(discs.shape[0]):
        part[i] = part[part[i]]


@compiled
def _first(i, part):
    while part[i] != i:
        part[i] = part[part[i]]
        i = part[i]
    return i


@compiled
def _measure_discs(h, discs, pile):
    """Sum up the energy of the parts, what they gain, and how far the impulses change their motion."""
    speed, root = pile.speed, pile.root
    for i in range(discs.shape[0]):
        pile.gain[i] = pile.energy[i] = pile.change[i] = 0.0
        pile.pushed_out[i] = pile.bounced[i] = pile.work[i] = 0.0
    for i in range(discs.shape[0]):
        p = pile.part[i]
        for d in range(2):
            w = root[2 * i + d]
            if w > 0.0:
                before, after, pull = discs[i, Disc.VX + d] / w, speed[2 * i + d], discs[i, Disc.GX + d] / w
                change = after - before - h * pull
                pile.gain[p] += 0.5 * (after - before) * (after + before) - h * pull * after
                pile.energy[p] += 0.5 * (before * before + after * after) + abs(h * pull * after)
                pile.change[p] += change * change


@compiled
def _lifting(height, discs):
    """Energy that lifts all discs by a height."""
    energy = 0.0
    for i in range(discs.shape[0]):
        for d in range(2):
            if discs[i, Disc.WX + d] > 0.0:
                energy += height * abs(discs[i, Disc.GX + d]) / discs[i, Disc.WX + d]
    return energy


@compiled
def _measure_contacts(active, h, pile):
    """Sum up what pushing discs out of one another takes, and the work of impulses beyond what the biases demand."""
    for c in range(active):
        impulse = pile.contacts[c, PileContact.IMPULSE]
        if impulse > 0.0:
            p, bias = pile.part[pile.ends[c, 0]], pile.contacts[c, PileContact.BIAS]
            if bias < 0.0:
                if SAME * bias * pile.scale[c] * h < min(pile.near[pile.order[c], PilePair.GAP], 0.0):
                    pile.bounced[p] = 1.0
                else:
                    before = pile.forces[pile.order[c]] * h * pile.scale[c]
                    pile.pushed_out[p] -= min(impulse, before) * bias
            pile.work[p] += impulse * opening(c, pile)


@compiled
def _law_of_gain(p, spare, pile):
    """The law that the discs of a part must obey from now on; sets the share of the impulses that they may keep.

    spare: energy lost so far that the parts do not demand back.
    """
    gain = pile.gain[p]
    pile.share[p] = 1.0
    if gain <= ROUND_OFF * pile.energy[p]:
        return 0.0
    if pile.bounced[p] == 0.0 and pile.work[p] > 0.0:
        pile.share[p] = max(1.0 - pile.work[p] / pile.change[p], 0.0)
    if spare < 0.0:
        return KEPT
    if pile.bounced[p] > 0.0:
        return PLASTIC if gain > pile.pushed_out[p] else 0.0
    return PLASTIC if pile.share[p] < MISLED else 0.0


@compiled
def _reduce(active, h, discs, pile):
    """Keep a share of the impulses of each part."""
    for c in range(active):
        pile.contacts[c, PileContact.IMPULSE] *= pile.share[pile.part[pile.ends[c, 0]]]
    for i in range(discs.shape[0]):
        for d in range(2):
            free = without_contacts(i, d, h, discs, pile)
            change = pile.speed[2 * i + d] - free
            pile.speed[2 * i + d] = free + pile.share[pile.part[i]] * change
