"""The pairs of a pile: which discs are near each other, and which of the pairs are contacts in a step.

Contacts in a step are all pairs whose gap is within what the two discs may travel; if one then travels farther, the
step is taken anew with more. They are found in a list of pairs that lasts until a disc may leave its box; which
contacts there are, and in which order, does not depend on when the list was made.
"""

import math

from systems.collision.columns import NONE, SHORTEST_SHARE, TRAVEL, Count, Disc, Motion, Number, Reason, Travel
from systems.collision.kernels import compiled
from systems.collision.kernels.grid import enclose, enter, neighbours, place_box, sort
from systems.collision.kernels.horizon import is_joined, set_layers
from systems.collision.kernels.persistent_contact import (
    enter_persistent,
    find_persistent,
    forget_persistent,
    is_held,
)
from systems.collision.kernels.time_of_impact import nearest, relative_motion, smaller_radius

PASSED_ON = 0.25  # of the travel of the fastest disc, or of a radius: travel that impacts may pass on to a disc in a step
STEPS_AHEAD, ROOM_AHEAD = 4.0, 0.1  # steps, and radii, that discs may travel until pairs are listed anew


@compiled
def velocity_after(i, pile):
    """Velocity of a disc in the step, from its scaled velocity."""
    speed, root = pile.motion[Motion.SPEED], pile.motion[Motion.ROOT]
    return speed[i, 0] * root[i, 0], speed[i, 1] * root[i, 1]


@compiled
def allow_travel(h, discs, pile):
    """Set the farthest travel of discs in a step without impacts."""
    for i in range(discs.shape[0]):
        pull = math.hypot(discs[i, Disc.GX], discs[i, Disc.GY])
        speed = math.hypot(discs[i, Disc.VX], discs[i, Disc.VY])
        pile.travel[Travel.PULL, i] = pull
        pile.travel[Travel.REACH, i] = h * (speed + 2.0 * h * pull)
        pile.travel[Travel.FASTEST, i] = speed


@compiled
def allow_more_travel(h, fastest, discs, pile):
    """Set the farthest travel of discs that near discs may strike, directly or through others."""
    for i in range(discs.shape[0]):
        if not is_held(i, discs):
            speed, pull = math.hypot(discs[i, Disc.VX], discs[i, Disc.VY]), pile.travel[Travel.PULL, i]
            speed += pile.travel[Travel.FASTEST, i]
            through = PASSED_ON * min(h * fastest, discs[i, Disc.RADIUS])
            pile.travel[Travel.REACH, i] = h * (speed + 2.0 * h * pull) + through


@compiled
def stays_within_reach(h, discs, pile):
    """False if a disc would travel farther than allowed; twice that travel is then allowed."""
    within = True
    for i in range(discs.shape[0]):
        vx, vy = velocity_after(i, pile)
        travel = h * math.hypot(vx, vy)
        if travel > pile.travel[Travel.REACH, i]:
            pile.travel[Travel.REACH, i] = 2.0 * travel
            within = False
    return within


@compiled
def list_pairs(h, discs, grid, constraints, pile, numbers, counts):
    """Ensure that all pairs are listed whose gap is within their reach. Returns a Reason."""
    if counts[Count.LISTED] != NONE and _stays_in_boxes(discs, grid, pile, numbers):
        return Reason.DONE
    enter_pushing_pairs(discs, constraints, pile, counts)
    counts[Count.LISTED] = NONE
    for i in range(discs.shape[0]):
        enclose(i, discs, grid, numbers[Number.NOW], numbers[Number.NOW] + STEPS_AHEAD * h)
        room = 2.0 * pile.travel[Travel.REACH, i] + ROOM_AHEAD * discs[i, Disc.RADIUS]
        grid.boxes[i, 0] -= room
        grid.boxes[i, 1] -= room
        grid.boxes[i, 2] += room
        grid.boxes[i, 3] += room
    set_layers(grid, numbers, counts)
    layers = counts[Count.LAYERS]
    if 2 * discs.shape[0] * layers > grid.after.shape[0]:
        return Reason.GRID_FULL
    grid.heads[:] = NONE
    pairs = 0
    for i in range(discs.shape[0]):
        left, bottom, right, top = grid.boxes[i]
        near = neighbours(i, left, bottom, right, top, grid, layers, 0)
        sort(grid.found, near)
        for k in range(near):
            j = grid.found[k]
            if (is_held(i, discs) and is_held(j, discs)) or is_joined(i, j, constraints):
                continue
            if pairs < pile.forces.shape[0]:
                pile.pairs[pairs, 0], pile.pairs[pairs, 1] = j, i
                entry = find_persistent(i, j, constraints)
                pile.forces[pairs] = 0.0 if entry == NONE else constraints.forces[entry]
            pairs += 1
        enter(i, grid, layers)
    if pairs > pile.forces.shape[0] or 2 * pairs > counts[Count.SPARES]:
        return Reason.GROUP_FULL
    counts[Count.LISTED] = pairs
    return Reason.DONE


@compiled
def _stays_in_boxes(discs, grid, pile, numbers):
    """True if no disc can leave the box for which its pairs were listed."""
    for i in range(discs.shape[0]):
        if not is_held(i, discs):
            reach = pile.travel[Travel.REACH, i]
            left, bottom, right, top = place_box(i, discs, numbers[Number.NOW])
            if left - reach < grid.boxes[i, 0] or right + reach > grid.boxes[i, 2]:
                return False
            if bottom - reach < grid.boxes[i, 1] or top + reach > grid.boxes[i, 3]:
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
            enter_persistent(j, i, pile.forces[k], discs, constraints, counts)


@compiled
def separation(k, discs, pile, numbers):
    """Unit vector of a listed pair, their gap, and the velocity of the second relative to the first."""
    i, j = pile.pairs[k, 0], pile.pairs[k, 1]
    dx, dy, vx, vy, _, _ = relative_motion(discs, i, j, numbers[Number.NOW])
    dx, dy, _ = nearest(dx, dy, j, discs)
    distance = math.sqrt(dx * dx + dy * dy)
    gap = distance - (discs[i, Disc.RADIUS] + discs[j, Disc.RADIUS])
    if distance == 0.0:
        return 1.0, 0.0, gap, vx, vy
    return dx / distance, dy / distance, gap, vx, vy


@compiled
def choose_length(discs, pile, numbers, counts):
    """Length of a step (s) in which no two discs that might collide travel far relative to one another.

    Also returns the speed (m/s) of the fastest. Sets FASTEST of the discs that might collide.
    """
    longest = numbers[Number.STEP_LENGTH]
    h, fastest = longest, 0.0
    for k in range(counts[Count.LISTED]):
        i, j = pile.pairs[k, 0], pile.pairs[k, 1]
        _, _, gap, vx, vy = separation(k, discs, pile, numbers)
        if gap <= pile.travel[Travel.REACH, i] + pile.travel[Travel.REACH, j]:
            speed = math.sqrt(vx * vx + vy * vy)
            travel = TRAVEL * smaller_radius(i, j, discs)
            fastest = max(fastest, speed)
            if speed * h > travel:
                h = travel / speed
            pile.travel[Travel.FASTEST, i] = max(pile.travel[Travel.FASTEST, i], speed)
            pile.travel[Travel.FASTEST, j] = max(pile.travel[Travel.FASTEST, j], speed)
    return max(h, SHORTEST_SHARE * longest), fastest


@compiled
def choose_contacts(discs, pile, numbers, counts):
    """Set `chosen` to the listed pairs whose gap is within their reach; returns their number."""
    active = 0
    for k in range(counts[Count.LISTED]):
        i, j = pile.pairs[k, 0], pile.pairs[k, 1]
        _, _, gap, _, _ = separation(k, discs, pile, numbers)
        if gap <= pile.travel[Travel.REACH, i] + pile.travel[Travel.REACH, j]:
            pile.chosen[active] = k
            active += 1
    return active
