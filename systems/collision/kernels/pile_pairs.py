"""The pairs of a pile: which discs are near each other, and which of the pairs are contacts in a step.

Without contacts a disc would go through the step with its velocity and the pull of its weight; contacts shift it from
that path. Contacts are all pairs that such shifts, of the size allowed for each disc, can bring together; if a disc is
shifted farther, the step is taken anew with more. They are found in a list of pairs that lasts until a disc may leave
its box; which contacts there are, and in which order, does not depend on when the list was made.
"""

import math

from pinjoint.systems.collision.columns import NONE, SHORTEST_SHARE, Count, Disc, Number, PilePair, Reason
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.grid import emptied, enclose, enter, neighbours, set_layers, sort
from pinjoint.systems.collision.kernels.persistent_contact import (
    enter_persistent,
    find_persistent,
    forget_persistent,
    is_held,
)
from pinjoint.systems.collision.kernels.time_of_impact import nearest, relative_motion, smaller_radius

TRAVEL = 0.45  # of two discs relative to one another in a longer step than the shortest: radii of the smaller
# Shift that impacts may pass on to a disc in a step, as a share of the travel of the fastest disc, or of a radius.
PASSED_ON = 0.7
STEPS_AHEAD, ROOM_AHEAD = 4.0, 0.5  # steps, and radii, that discs may travel until pairs are listed anew


@compiled
def velocity_after(i, pile):
    """Velocity of a disc in the step, from its scaled velocity."""
    return pile.speed[2 * i] * pile.root[2 * i], pile.speed[2 * i + 1] * pile.root[2 * i + 1]


@compiled
def allow_shifts(h, discs, pile):
    """Set the farthest shift of discs in a step by what bears their weight."""
    for i in range(discs.shape[0]):
        pull = math.sqrt(discs[i, Disc.GX] ** 2 + discs[i, Disc.GY] ** 2)
        pile.pull[i] = pull
        pile.shift[i] = 2.0 * h * h * pull
        pile.fastest[i] = pile.law[i] = 0.0


@compiled
def allow_more_shift(h, fastest, discs, pile):
    """Set the farthest shift of discs that near discs may strike, directly or through others."""
    for i in range(discs.shape[0]):
        if not is_held(i, discs):
            speed, pull = pile.fastest[i], pile.pull[i]
            through = PASSED_ON * min(h * fastest, discs[i, Disc.RADIUS])
            pile.shift[i] = h * (speed + 2.0 * h * pull) + through


@compiled
def stays_within_reach(h, discs, pile):
    """False if contacts shift a disc farther than allowed; twice that shift is then allowed."""
    within = True
    for i in range(discs.shape[0]):
        vx, vy = velocity_after(i, pile)
        vx, vy = vx - discs[i, Disc.VX] - h * discs[i, Disc.GX], vy - discs[i, Disc.VY] - h * discs[i, Disc.GY]
        shift = h * h * (vx * vx + vy * vy)
        if shift > pile.shift[i] ** 2:
            pile.shift[i] = 2.0 * math.sqrt(shift)
            within = False
    return within


@compiled
def find_pairs(h, measured, discs, grid, constraints, pile, numbers, counts):
    """Ensure that all pairs are listed whose discs can meet in a step, and measured. Returns a Reason.

    measured: those that are listed are.
    """
    if not _are_listed(h, discs, grid, pile, counts):
        reason = _list_pairs(h, discs, grid, constraints, pile, numbers, counts)
        if reason != Reason.DONE:
            return reason
        measured = False
    if not measured:
        _measure_pairs(discs, pile, numbers, counts)
    return Reason.DONE


@compiled
def _list_pairs(h, discs, grid, constraints, pile, numbers, counts):
    """List all pairs whose boxes around the next few steps overlap. Returns a Reason."""
    enter_pushing_pairs(discs, constraints, pile, counts)
    counts[Count.LISTED] = NONE
    for i in range(discs.shape[0]):
        enclose(i, discs, grid, numbers[Number.NOW], numbers[Number.NOW] + STEPS_AHEAD * h)
        room = 2.0 * pile.shift[i] + ROOM_AHEAD * discs[i, Disc.RADIUS]
        grid.boxes[i, 0] -= room
        grid.boxes[i, 1] -= room
        grid.boxes[i, 2] += room
        grid.boxes[i, 3] += room
    set_layers(grid, numbers, counts)
    layers = counts[Count.LAYERS]
    if not emptied(grid, layers):
        return Reason.GRID_FULL
    pairs = 0
    for i in range(discs.shape[0]):
        near = neighbours(i, grid, layers, 0)
        sort(grid.found, near)
        for k in range(near):
            j = grid.found[k]
            if is_held(i, discs) and is_held(j, discs):
                continue
            if pairs < pile.forces.shape[0]:
                entry = find_persistent(j, i, constraints)
                pile.pairs[pairs, 0], pile.pairs[pairs, 1] = j, i
                pile.forces[pairs] = 0.0 if entry == NONE else constraints.forces[entry]
            pairs += 1
        enter(i, grid, layers)
    if pairs > pile.forces.shape[0] or 2 * pairs > counts[Count.SPARES]:
        return Reason.GROUP_FULL
    counts[Count.LISTED] = pairs
    return Reason.DONE


@compiled
def _are_listed(h, discs, grid, pile, counts):
    """True if no disc can leave the box for which its pairs were listed."""
    if counts[Count.LISTED] == NONE:
        return False
    for i in range(discs.shape[0]):
        if not is_held(i, discs):
            x, y = discs[i, Disc.OX] + discs[i, Disc.UX], discs[i, Disc.OY] + discs[i, Disc.UY]
            dx = h * (discs[i, Disc.VX] + h * discs[i, Disc.GX])
            dy = h * (discs[i, Disc.VY] + h * discs[i, Disc.GY])
            around = discs[i, Disc.RADIUS] + pile.shift[i]
            inside = (grid.boxes[i, 0] <= x + min(dx, 0.0) - around) & (
                x + max(dx, 0.0) + around <= grid.boxes[i, 2]
            )
            inside &= (grid.boxes[i, 1] <= y + min(dy, 0.0) - around) & (
                y + max(dy, 0.0) + around <= grid.boxes[i, 3]
            )
            if not inside:
                return False
    return True


@compiled
def enter_pushing_pairs(discs, constraints, pile, counts):
    """Enter the listed pairs that push into the table of persistent contacts, in place of all its entries."""
    if counts[Count.LISTED] == NONE:
        return
    for i in range(discs.shape[0]):
        forget_persistent(i, constraints, counts)
    for k in range(counts[Count.LISTED]):
        if pile.forces[k] > 0.0:
            i, j = pile.pairs[k, 0], pile.pairs[k, 1]
            enter_persistent(i, j, pile.forces[k], discs, constraints, counts)


@compiled
def _measure_pairs(discs, pile, numbers, counts):
    """Fill in the columns of PilePair of all listed pairs, whose discs all begin their paths now."""
    for k in range(counts[Count.LISTED]):
        i, j = pile.pairs[k, 0], pile.pairs[k, 1]
        dx, dy, vx, vy, _, _ = relative_motion(discs, i, j, numbers[Number.NOW])
        dx, dy, _ = nearest(dx, dy, j, discs)
        distance = math.sqrt(dx * dx + dy * dy)
        nx, ny = 1.0, 0.0
        if distance > 0.0:
            nx, ny = dx / distance, dy / distance
        pair = pile.near[k]
        pair[PilePair.NX], pair[PilePair.NY] = nx, ny
        pair[PilePair.GAP] = distance - (discs[i, Disc.RADIUS] + discs[j, Disc.RADIUS])
        pair[PilePair.RATE] = nx * vx + ny * vy
        gx, gy = discs[j, Disc.GX] - discs[i, Disc.GX], discs[j, Disc.GY] - discs[i, Disc.GY]
        pair[PilePair.PULL] = nx * gx + ny * gy
        pair[PilePair.SPEED] = math.sqrt(vx * vx + vy * vy)


@compiled
def _may_meet(k, h, pile):
    """True if the shifts allowed can bring a listed pair together in a step.

    The distance of two discs on straight lines is no less than its part along the first line of centres.
    """
    pair = pile.near[k]
    gap = pair[PilePair.GAP] + h * (pair[PilePair.RATE] + h * pair[PilePair.PULL])
    return gap <= pile.shift[pile.pairs[k, 0]] + pile.shift[pile.pairs[k, 1]]


@compiled
def choose_length(discs, pile, numbers, counts):
    """Length of a step (s) in which no two discs that might collide travel far relative to one another.

    Also returns the speed (m/s) of the fastest. Sets FASTEST of the discs that might collide.
    """
    longest = numbers[Number.STEP_LENGTH]
    h, fastest = longest, 0.0
    for k in range(counts[Count.LISTED]):
        if _may_meet(k, longest, pile):
            i, j, speed = pile.pairs[k, 0], pile.pairs[k, 1], pile.near[k, PilePair.SPEED]
            travel = TRAVEL * smaller_radius(i, j, discs)
            fastest = max(fastest, speed)
            if speed * h > travel:
                h = travel / speed
            pile.fastest[i] = max(pile.fastest[i], speed)
            pile.fastest[j] = max(pile.fastest[j], speed)
    return max(h, SHORTEST_SHARE * longest), fastest


@compiled
def choose_contacts(h, pile, counts):
    """Set `chosen` to the listed pairs that may meet in a step; returns their number."""
    active = 0
    for k in range(counts[Count.LISTED]):
        if _may_meet(k, h, pile):
            pile.chosen[active] = k
            active += 1
    return active
