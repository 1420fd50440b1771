"""The energy of a pile's step: neither bounces nor forces may supply any.

Newton's law of restitution supplies energy where discs bounce that are jammed: a row that nearly fits between two walls
must part at both ends, and bends upwards as fast as that takes. So the energy of every part of the pile, the discs that
push one another, is compared with that before the step. Velocities v₁ that hold during the whole step change it by
    p·N v₁ − ½ |v₁ − v₀|²_M.
Without bounces, this is no more than what pushing discs out of one another takes if p·(N v₁ + gap/h) ≤ 0, which exact
impulses satisfy; others are reduced until they do.
"""

from systems.collision.columns import Count, Disc, Motion, Number, Part, PileContact, PilePair
from systems.collision.kernels import compiled
from systems.collision.kernels.pile_solver import KEPT, PLASTIC, opening, without_contacts

ROUND_OFF = 1e-12  # of the energy of a part
SAME = 0.999  # of a bias that is a gap by the length of a step, in spite of round-off
MISLED = 0.99  # share of impulses that may be kept, below which they are sought anew, from none


@compiled
def supplies_energy(active, h, discs, pile, numbers, counts):
    """True if a part would gain energy: its discs are now bound by a stricter law, and the step must be solved anew."""
    _find_parts(active, discs, pile)
    _measure_discs(h, discs, pile)
    _measure_contacts(active, h, pile)
    spare = numbers[Number.LOSS]
    for i in range(discs.shape[0]):
        spare -= max(pile.parts[Part.GAIN, i], 0.0)
    anew, reduced = False, False
    for i in range(discs.shape[0]):
        law = _law_of_gain(pile.part[i], spare, pile.parts)
        if law > pile.parts[Part.LAW, i]:
            pile.parts[Part.LAW, i] = law
            anew = True
        reduced |= pile.parts[Part.SHARE, pile.part[i]] < 1.0
    if anew:
        _forget_forces(pile, counts)
    elif reduced:
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
    """Sum up the energy of the parts, what they gain, and what they may if discs are pushed out of one another."""
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
def _measure_contacts(active, h, pile):
    """Find what may supply energy to the parts, and the work that their impulses do beyond what the biases demand."""
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
    if spare < 0.0 and parts[Part.PUSHED_OUT, p] > 0.0:
        return KEPT
    if gain <= parts[Part.PUSHED_OUT, p]:
        return 0.0
    if parts[Part.BOUNCED, p] > 0.0:
        return PLASTIC
    if parts[Part.WORK, p] > 0.0:
        parts[Part.SHARE, p] = max(1.0 - parts[Part.WORK, p] / parts[Part.CHANGE, p], 0.0)
    return PLASTIC if parts[Part.SHARE, p] < MISLED else 0.0


@compiled
def _forget_forces(pile, counts):
    """Forget the forces of the step before in contacts that may not bounce: they may mislead, as in a row come loose."""
    for k in range(counts[Count.LISTED]):
        if max(pile.parts[Part.LAW, pile.pairs[k, 0]], pile.parts[Part.LAW, pile.pairs[k, 1]]) > 0.0:
            pile.forces[k] = 0.0


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
