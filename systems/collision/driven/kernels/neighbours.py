"""The neighbour list of driven particles: which pairs may collide soon.

The list is made by the grid of boxes that free discs use. It is the same whenever it is made from the same state, and
what lasts in pairs that stay goes on.
"""

import math

from pinjoint.systems.collision.columns import NONE
from pinjoint.systems.collision.driven.columns import Need, Order, Phase, Real, Whole
from pinjoint.systems.collision.driven.kernels.pairs import gap_of, moves
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.grid import list_pairs as all_pairs
from pinjoint.systems.collision.kernels.grid import set_box
from pinjoint.systems.program.entries import Control

LISTED_AROUND = 0.5  # of the radius of a particle: the least margin within which others are listed
FEWEST_STEPS = 512  # for which the list is to last, at the present speed of a particle,
FARTHEST = 4.0  # where that is no farther than so many of its radii
WIDER, MOST_WIDENED = 4.0, 4  # times the margin, as long as nothing is within it


@compiled
def list_pairs(driven, listing, control, place, speed):
    """The Order to go on, once the pairs are listed that can meet before any particle has moved by Real.SPAN.

    From where it is, or was as the step began that was taken. place, speed: displacements and velocities of the
    particles. If there is no room, the Order to leave: Whole.FOUND and LAYERS say how much is wanted, and there is no
    list; what lasts is not forgotten.
    """
    whole = driven.whole
    taken = whole[Whole.PHASE] != Phase.BETWEEN and whole[Whole.FORESEEN] == 0
    if _list(driven, listing, control[Control.STEP_SIZE], driven.before if taken else place, speed):
        return Order.GO_ON.value
    whole[Whole.NEED] = Need.ROOM
    return Order.LEAVE.value


@compiled
def _list(driven, listing, step, place, speed):
    """True if there is room. step: of the clock (s)."""
    whole, margin = driven.whole, driven.margin
    for i in range(place.shape[0]):
        radius = driven.radius[i]
        far = min(FARTHEST * radius, FEWEST_STEPS * step * math.hypot(speed[i, 0], speed[i, 1]))
        margin[i] = max(LISTED_AROUND * radius, far, 2.0 * driven.real[Real.SPAN])
    count, wider, turn = 0, 1.0, 0
    while count == 0 and turn <= MOST_WIDENED:
        count = _find(driven, listing, place, wider)
        if count == 0 and turn > 0:  # nothing is near: it will be long until something is
            for i in range(place.shape[0]):
                margin[i] *= WIDER
        elif count > 0 and turn > 0:
            count, turn = 0, MOST_WIDENED
        wider, turn = WIDER, turn + 1
    whole[Whole.FOUND] = count
    if count == NONE or count > driven.pairs.shape[0]:
        for i in range(place.shape[0]):
            margin[i] = -1.0
        return False
    for i in range(place.shape[0]):
        for d in range(2):
            driven.listed[i, d], driven.support[i, d] = place[i, d], 0.0
    whole[Whole.PUSHED] = 1
    whole[Whole.LISTS] += 1
    _put(driven, listing.found, count)
    _note_near(driven)
    return True


@compiled
def _find(driven, listing, place, wider):
    """Find the pairs that can meet before any particle has moved by so many times its margin; returns how many.

    They are at the end of `found`, in ascending order, if there is room for them. NONE: the grid has no room.
    """
    grid, found, count = listing.grid, listing.found, 0
    for i in range(grid.boxes.shape[0]):
        _enclose(driven, listing, i, place, wider)
    room = found.shape[0]
    overlapping, driven.whole[Whole.LAYERS] = all_pairs(found, grid)
    if overlapping == NONE or overlapping > room:
        return overlapping
    for k in range(room - 1, room - 1 - overlapping, -1):
        i, j = found[k, 0], found[k, 1]
        if i < place.shape[0] and _may_meet(driven, listing, i, j, place, wider):
            count += 1
            found[room - count, 0], found[room - count, 1] = i, j
    return count


@compiled
def _enclose(driven, listing, i, place, wider):
    """Set the box around where a particle may move, or around an obstacle."""
    x, y, tx, ty = driven.position[i, 0], driven.position[i, 1], driven.span[i, 0], driven.span[i, 1]
    around, away = driven.radius[i], abs(x) + abs(y) + abs(tx) + abs(ty)
    if i < place.shape[0]:
        around += wider * driven.margin[i]
        away += abs(place[i, 0]) + abs(place[i, 1])
        x, y = x + place[i, 0], y + place[i, 1]
    set_box(i, x, y, tx, ty, around, away, listing.grid)


@compiled
def _may_meet(driven, listing, i, j, place, wider):
    """True if a particle and another, or an obstacle, are within reach; not if neither moves, or a rod joins them."""
    if not (moves(driven, i) or moves(driven, j)) or _are_joined(i, j, listing):
        return False
    gap, _, _ = gap_of(i, j, driven.position, place, driven.radius, driven.span)
    reach = driven.margin[i]
    if j < place.shape[0]:
        reach += driven.margin[j]
    return gap <= wider * reach


@compiled
def _are_joined(i, j, listing):
    """True if a rod joins two particles."""
    k = listing.first[i]
    while k < listing.first[i + 1] and listing.partners[k] != j:
        k += 1
    return k < listing.first[i + 1]


@compiled
def _put(driven, found, count):
    """Put the pairs that were found in place of those listed; what lasts in those that stay goes on."""
    whole, pairs = driven.whole, driven.pairs
    lasts, forces, row_of = driven.touching, driven.pushes, driven.chain  # work space, in other phases
    ahead, r = found.shape[0] - count, 0
    for k in range(count):
        lasts[k], forces[k] = 0, 0.0
    for k in range(whole[Whole.LISTED]):
        row_of[k] = 0
        if driven.lasting[k] == 0:
            continue
        i, j = pairs[k, 0], pairs[k, 1]
        while r < count and (found[ahead + r, 0] < i or (found[ahead + r, 0] == i and found[ahead + r, 1] < j)):
            r += 1
        if r < count and found[ahead + r, 0] == i and found[ahead + r, 1] == j:
            lasts[r], forces[r], row_of[k] = 1, driven.forces[k], r
    if whole[Whole.PHASE] == Phase.HELD:  # else they are chosen anew before they are used
        for c in range(whole[Whole.CHOSEN]):
            driven.chosen[c] = row_of[driven.chosen[c]]
    for k in range(count):
        pairs[k, 0], pairs[k, 1] = found[ahead + k, 0], found[ahead + k, 1]
        driven.lasting[k], driven.forces[k] = lasts[k], forces[k]
    whole[Whole.LISTED] = count


@compiled
def _note_near(driven):
    """Note the particles in pairs."""
    whole, place = driven.whole, driven.group.place
    for k in range(whole[Whole.LISTED]):
        for e in range(2):
            place[driven.pairs[k, e]] = 0
    whole[Whole.NEAR] = 0
    for i in range(driven.radius.shape[0]):
        if place[i] != NONE and i < driven.near.shape[0]:
            driven.near[whole[Whole.NEAR]] = i
            whole[Whole.NEAR] += 1
        place[i] = NONE
