"""The energy of a pile's step: neither bounces nor forces may supply any.

Newton's law of restitution supplies energy where discs bounce that are jammed: a row that nearly fits between two walls
must part at both ends, and bends upwards as fast as that takes. So the energy of every part of the pile, the discs that
push one another, is compared with that before the step. Velocities v₁ that hold during the whole step change it by
    p·N v₁ − ½ |v₁ − v₀|²_M.
A part that gains by its bounces is solved anew without. Then p·(N v₁ + gap/h) ≤ 0, which impulses that are not exact are
reduced to, leaves it as gain only what undoes overlaps, which gave as much when the discs sank in; and all parts together
never gain more than the run has lost so far, but for what lifts everything by a thousandth of a radius.
"""

from pinjoint.systems.collision.columns import Disc, Motion, Number, Part, PileContact, PilePair
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
        spare -= max(pile.parts[Part.GAIN, i], 0.0)
    anew, reduced = False, False
    for i in range(discs.shape[0]):
        law = _law_of_gain(pile.part[i], spare, pile.parts)
        if law > pile.parts[Part.LAW, i]:
            pile.parts[Part.LAW, i] = law
            anew = True
        reduced |= pile.parts[Part.SHARE, pile.part[i]] < 1.0
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
    parts, speed, root = pile.parts, pile.motion[Motion.SPEED], pile.motion[Motion.ROOT]
    for quantity in range(Part.GAIN, parts.shape[0]):
        for i in range(discs.shape[0]):
            parts[quantity, i] = 0.0
    for i in range(discs.shape[0]):
        p = pile.part[i]
        for d in range(2):
            w = root[2 * i + d]
            if w > 0.0:
                before, after, pull = discs[i, Disc.VX + d] / w, speed[2 * i + d], discs[i, Disc.GX + d] / w
                change = after - before - h * pull
                parts[Part.GAIN, p] += 0.5 * (after - before) * (after + before) - h * pull * after
                parts[Part.ENERGY, p] += 0.5 * (before * before + after * after) + abs(h * pull * after)
                parts[Part.CHANGE, p] += change * change


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
    parts = pile.parts
    for c in range(active):
        impulse = pile.contacts[c, PileContact.IMPULSE]
        if impulse > 0.0:
            p, bias = pile.part[pile.ends[c, 0]], pile.contacts[c, PileContact.BIAS]
            if bias < 0.0:
                if SAME * bias * pile.scale[c] * h < min(pile.near[pile.order[c], PilePair.GAP], 0.0):
                    parts[Part.BOUNCED, p] = 1.0
                else:
                    before = pile.forces[pile.order[c]] * h * pile.scale[c]
                    parts[Part.PUSHED_OUT, p] -= min(impulse, before) * bias
            parts[Part.WORK, p] += impulse * opening(c, pile)


@compiled
def _law_of_gain(p, spare, parts):
    """The law that the discs of a part must obey from now on; sets the share of the impulses that they may keep.

    spare: energy lost so far that the parts do not demand back.
    """
    gain = parts[Part.GAIN, p]
    parts[Part.SHARE, p] = 1.0
    if gain <= ROUND_OFF * parts[Part.ENERGY, p]:
        return 0.0
    if parts[Part.BOUNCED, p] == 0.0 and parts[Part.WORK, p] > 0.0:
        parts[Part.SHARE, p] = max(1.0 - parts[Part.WORK, p] / parts[Part.CHANGE, p], 0.0)
    if spare < 0.0:
        return KEPT
    if parts[Part.BOUNCED, p] > 0.0:
        return PLASTIC if gain > parts[Part.PUSHED_OUT, p] else 0.0
    return PLASTIC if parts[Part.SHARE, p] < MISLED else 0.0


@compiled
def _reduce(active, h, discs, pile):
    """Keep a share of the impulses of each part."""
    for c in range(active):
        pile.contacts[c, PileContact.IMPULSE] *= pile.parts[Part.SHARE, pile.part[pile.ends[c, 0]]]
    for i in range(discs.shape[0]):
        for d in range(2):
            free = without_contacts(i, d, h, discs, pile)
            change = pile.motion[Motion.SPEED, 2 * i + d] - free
            pile.motion[Motion.SPEED, 2 * i + d] = free + pile.parts[Part.SHARE, pile.part[i]] * change
