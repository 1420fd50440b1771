"""Piles: crowds in lasting contact, by time steps.

Where so many contacts last or begin that single events no longer pay, all discs take steps h of Moreau and Jean
(Jean, Comput. Methods Appl. Mech. Eng. 177, 1999): the velocities at the end,
    v₁ = v₀ + h g + W N p,   n·Δv₁ + max(gap/h, e n·Δv₀ where that is an impact) ≥ 0 ⟂ p ≥ 0,
carry the discs through the step in a straight line. The distance of two discs is a convex function of their
places, so that what satisfies this with the normals at the start does not sink in. Discs that are not near others
stay on their parabolas. A pile in which nothing moves fast any more is left to repose.py.

Contacts in a step are all pairs whose gap is within what the two may travel; if one then travels farther, the step is
taken anew with more. They are found in a list of pairs that lasts until a disc may leave its box; which contacts there
are, and in which order, does not depend on when the list was made.
"""

import math

from systems.collision.columns import (
    AX,
    AY,
    BOUNCE,
    CALM,
    CELL,
    CHANGES,
    DISCS,
    EPOCH,
    GX,
    GY,
    IMPACTS,
    LAYERS,
    LISTED,
    LOSS,
    NOISE,
    NONE,
    NOW,
    OX,
    OY,
    PATIENCE,
    RADIUS,
    RENEW,
    REPORTED,
    REST_HEIGHT,
    RESTITUTION,
    SMALLEST,
    SPARES,
    SPEED_NOISE,
    STEP,
    STEP_END,
    STEP_LENGTH,
    STEPPING,
    UX,
    UY,
    VX,
    VY,
    WORK,
    WORK_SINCE,
    WX,
    WY,
    Reason,
)
from systems.collision.kernels import compiled
from systems.collision.kernels.grid import enclose, enter, neighbours, place_box, sort
from systems.collision.kernels.horizon import is_joined, set_layers
from systems.collision.kernels.persistent_contact import find_lasting, forget_lasting, is_held, note_lasting
from systems.collision.kernels.time_of_impact import NEVER, is_straight, nearest, relative_motion, rest_speed

DONE, SETTLE = int(Reason.DONE), int(Reason.SETTLE)
GROUP_FULL, REPORT_FULL, GRID_FULL = int(Reason.GROUP_FULL), int(Reason.REPORT_FULL), int(Reason.GRID_FULL)

STEP_SHARE = 0.04  # of the time in which a disc falls through its diameter
SHORTEST_SHARE = 1.0 / 16.0  # of a step, where discs are fast
TRAVEL = 0.35  # of the smaller radius of two discs, relative to one another, in a step that is not the shortest
THROUGH = 0.25  # of the way of the fastest disc, or of its radius: how far others may pass that on to a disc in a step
AHEAD, ROOM = 4.0, 0.1  # steps, and radii, by which discs may go on until pairs are listed anew
MOST_SWEEPS = 80  # to and fro over the contacts in a step; the next goes on from there
SLIGHT = 1e-9  # of the energy of motion: what rounding may feign
TOLERANCE = 1e-8  # of the smallest radius: by how much discs sink in a step whose sweeps have settled
MANY, ROUGHNESS = 1000, 4e-3  # of more contacts than that: or of the way of the fastest disc, if that is more
NEARBY = 0.2  # of the radius of the smaller of two discs: nearer than this they fly on straight lines
LANES = 8  # contacts side by side in the order of sweeps are far apart: the processor deals with them at once
CALM_TRAVEL = 0.004  # of the smallest radius, in a step: what travels less is calm
CALM_SPEEDS = 1.0  # of those that free fall gives in a step: what is slower is calm
LEAST_PATIENCE = 16  # calm steps before a pile first seeks its equilibrium
LARGE = 256  # contacts at one instant that are left to steps where weights press on them
WORK_PER_DISC, LEAST_WORK = 2, 3000  # contacts dealt with in WORK_STEPS steps before events give way to steps
WORK_STEPS = 10.0

# Columns of pile.contacts. Velocities u = v/√w and impulses are measured so that every contact opens by itself at the
# rate 1: A = N W Nᵀ has a diagonal of ones.
NORMAL = 0  # four columns: the rate at which it opens is this · (u of its first disc, u of its second) + BIAS
BIAS = 4
GIVEN = 5  # impulse
BEFORE = 6  # impulse before the sweep to and fro
DIRECTION = 7  # in which the sweeps so far led
# Parts of pile.motion
SPEED, ROOT = 0, 1  # u; √w
NOTED, ALONG = 2, 3  # u before the sweeps; what the direction does to u
# Rows of pile.travel
REACH = 0  # m; how far the disc may travel in the step
FAST = 1  # m/s; the speed of the fastest disc that is near
NEAR = 2  # 1: it is near another at the end of the step; 2: another pushed it
PULL = 3  # m/s²; without contacts


@compiled
def crowded(touching, numbers, counts):
    """True if a group of that many contacts, or all that happened lately, is better left to steps."""
    h = numbers[STEP_LENGTH]
    if h == NEVER or (touching < 2 and counts[WORK] == 0):
        return False
    if touching > LARGE:
        return True
    if numbers[RESTITUTION] == 1.0:
        return False
    if numbers[NOW] - numbers[WORK_SINCE] > WORK_STEPS * h:
        counts[WORK], numbers[WORK_SINCE] = 0, numbers[NOW]
    counts[WORK] += touching * (1 + touching // 8)
    return counts[WORK] > LEAST_WORK + WORK_PER_DISC * counts[DISCS]


@compiled
def begin_steps(numbers, counts):
    """From now on, discs take steps."""
    counts[STEPPING], counts[LISTED] = 1, NONE
    counts[CALM], counts[PATIENCE] = 0, LEAST_PATIENCE
    numbers[STEP_END] = numbers[NOW]


@compiled
def end_steps(numbers, counts):
    """Go back to events."""
    counts[STEPPING], counts[RENEW], counts[WORK] = 0, 1, 0
    numbers[WORK_SINCE] = numbers[NOW]


@compiled
def step(discs, grid, ties, pile, report, numbers, counts):
    """Take the step that begins now. Returns a Reason; unless it is DONE, nothing has happened yet."""
    _note_motion(discs, pile, numbers)
    if counts[CALM] >= counts[PATIENCE]:
        note_pushes(discs, ties, pile, counts)
        if _pushes(discs, ties):
            return SETTLE
        end_steps(numbers, counts)
        return DONE
    h = numbers[STEP_LENGTH]
    _allow_travel(h, discs, pile)
    reason = _list_pairs(h, discs, grid, ties, pile, numbers, counts)
    if reason != DONE:
        return reason
    h, fastest = _length(discs, pile, numbers, counts)
    _allow_more_travel(h, fastest, discs, pile)
    while True:
        reason = _list_pairs(h, discs, grid, ties, pile, numbers, counts)
        if reason != DONE:
            return reason
        active = _choose(discs, pile, numbers, counts)
        if counts[REPORTED] + active > report.pairs.shape[0]:
            return REPORT_FULL
        _pull(h, discs, pile)
        _constrain(active, h, discs, pile, numbers)
        tolerance = TOLERANCE * numbers[SMALLEST] / h
        if active > MANY:
            tolerance = max(tolerance, ROUGHNESS * fastest)
        _find_impulses(active, tolerance, pile)
        if _is_worse_than_none(active, h, discs, pile):
            pile.forces[: counts[LISTED]] = (
                0.0  # those of the step before mislead, as of a row that has come loose
            )
        elif _stays_within_reach(h, discs, pile):
            break
    numbers[STEP_END] = numbers[NOW] + h
    _report_impacts(active, h, discs, pile, report, numbers, counts)
    pushing = _keep_forces(active, h, pile, counts)
    _find_near(active, h, discs, pile, numbers)
    calm = _set_off(h, discs, pile, numbers)
    if calm or pushing == 0:
        counts[CALM] += 1
    else:
        counts[CALM], counts[PATIENCE] = 0, LEAST_PATIENCE
    return DONE


@compiled
def _pushes(discs, ties):
    """True if any contact pushes; if none does, the pile has dissolved."""
    i = 0
    while i < discs.shape[0] and ties.first_lasting[i] == NONE:
        i += 1
    return i < discs.shape[0]


@compiled
def _note_motion(discs, pile, numbers):
    """Begin new paths of all discs now."""
    for i in range(discs.shape[0]):
        s = numbers[NOW] - discs[i, EPOCH]
        discs[i, UX] += s * (discs[i, VX] + 0.5 * s * discs[i, AX])
        discs[i, UY] += s * (discs[i, VY] + 0.5 * s * discs[i, AY])
        discs[i, VX] += s * discs[i, AX]
        discs[i, VY] += s * discs[i, AY]
        discs[i, AX], discs[i, AY] = discs[i, GX], discs[i, GY]
        discs[i, EPOCH], discs[i, STEP] = numbers[NOW], NEVER
        discs[i, CHANGES] += 1.0
        pile.motion[ROOT, i, 0] = math.sqrt(discs[i, WX])
        pile.motion[ROOT, i, 1] = math.sqrt(discs[i, WY])


# --- pairs --------------------------------------------------------------------------------------------------


@compiled
def _allow_travel(h, discs, pile):
    """How far discs may go in a step without impacts."""
    for i in range(discs.shape[0]):
        pull = math.hypot(discs[i, GX], discs[i, GY])
        speed = math.hypot(discs[i, VX], discs[i, VY])
        pile.travel[PULL, i] = pull
        pile.travel[REACH, i] = h * (speed + 2.0 * h * pull)
        pile.travel[FAST, i] = speed


@compiled
def _allow_more_travel(h, fastest, discs, pile):
    """How far they may go once they have been struck by those that are near, or by others through these."""
    for i in range(discs.shape[0]):
        if not is_held(i, discs):
            speed, pull = math.hypot(discs[i, VX], discs[i, VY]), pile.travel[PULL, i]
            through = THROUGH * min(h * fastest, discs[i, RADIUS])
            pile.travel[REACH, i] = h * (speed + pile.travel[FAST, i] + 2.0 * h * pull) + through


@compiled
def _stays_within_reach(h, discs, pile):
    """False if a disc would travel farther than was allowed; it may then go twice as far."""
    within = True
    for i in range(discs.shape[0]):
        vx = pile.motion[SPEED, i, 0] * pile.motion[ROOT, i, 0]
        vy = pile.motion[SPEED, i, 1] * pile.motion[ROOT, i, 1]
        travel = h * math.hypot(vx, vy)
        if travel > pile.travel[REACH, i]:
            pile.travel[REACH, i] = 2.0 * travel
            within = False
    return within


@compiled
def _list_pairs(h, discs, grid, ties, pile, numbers, counts):
    """See to it that all pairs are listed whose gap is within their reach. Returns a Reason."""
    if counts[LISTED] != NONE and _stays_in_boxes(discs, grid, pile, numbers):
        return DONE
    note_pushes(discs, ties, pile, counts)
    counts[LISTED] = NONE
    for i in range(discs.shape[0]):
        enclose(i, discs, grid, numbers[NOW], numbers[NOW] + AHEAD * h)
        room = 2.0 * pile.travel[REACH, i] + ROOM * discs[i, RADIUS]
        grid.boxes[i, 0] -= room
        grid.boxes[i, 1] -= room
        grid.boxes[i, 2] += room
        grid.boxes[i, 3] += room
    set_layers(grid, numbers, counts)
    layers, cell = counts[LAYERS], numbers[CELL]
    if 8 * discs.shape[0] * layers > grid.after.shape[0]:
        return GRID_FULL
    grid.heads[:] = NONE
    pairs = 0
    for i in range(discs.shape[0]):
        left, bottom, right, top = grid.boxes[i]
        near = neighbours(i, left, bottom, right, top, grid, layers, cell)
        sort(grid.found, near)
        for k in range(near):
            j = grid.found[k]
            if (is_held(i, discs) and is_held(j, discs)) or is_joined(i, j, ties):
                continue
            if pairs < pile.forces.shape[0]:
                pile.pairs[pairs, 0], pile.pairs[pairs, 1] = j, i
                entry = find_lasting(i, j, ties)
                pile.forces[pairs] = 0.0 if entry == NONE else ties.forces[entry]
            pairs += 1
        enter(i, grid, layers, cell)
    if pairs > pile.forces.shape[0] or 2 * pairs > counts[SPARES]:
        return GROUP_FULL
    counts[LISTED] = pairs
    return DONE


@compiled
def _stays_in_boxes(discs, grid, pile, numbers):
    """True if no disc can get out of the box for which its pairs were listed."""
    for i in range(discs.shape[0]):
        if not is_held(i, discs):
            reach = pile.travel[REACH, i]
            left, bottom, right, top = place_box(i, discs, numbers[NOW])
            if left - reach < grid.boxes[i, 0] or right + reach > grid.boxes[i, 2]:
                return False
            if bottom - reach < grid.boxes[i, 1] or top + reach > grid.boxes[i, 3]:
                return False
    return True


@compiled
def note_pushes(discs, ties, pile, counts):
    """Enter the listed pairs that push into the table of lasting contacts, instead of all there are."""
    if counts[LISTED] == NONE:
        return
    for i in range(discs.shape[0]):
        forget_lasting(i, ties, counts)
    for k in range(counts[LISTED]):
        if pile.forces[k] > 0.0:
            i, j = pile.pairs[k, 0], pile.pairs[k, 1]
            note_lasting(i, j, pile.forces[k], discs, ties, counts)
            note_lasting(j, i, pile.forces[k], discs, ties, counts)


@compiled
def _separation(k, discs, pile, numbers):
    """Unit vector of a listed pair, their gap, and the velocity of the second relative to the first."""
    i, j = pile.pairs[k, 0], pile.pairs[k, 1]
    dx, dy, vx, vy, _, _ = relative_motion(discs, i, j, numbers[NOW])
    dx, dy, _ = nearest(dx, dy, j, discs)
    distance = math.sqrt(dx * dx + dy * dy)
    gap = distance - (discs[i, RADIUS] + discs[j, RADIUS])
    if distance == 0.0:
        return 1.0, 0.0, gap, vx, vy
    return dx / distance, dy / distance, gap, vx, vy


@compiled
def _length(discs, pile, numbers, counts):
    """Length of a step (s), in which no two discs that might meet travel far relative to one another.

    And the speed (m/s) of the fastest. Sets FAST for those that might.
    """
    longest = numbers[STEP_LENGTH]
    h, fastest = longest, 0.0
    for k in range(counts[LISTED]):
        i, j = pile.pairs[k, 0], pile.pairs[k, 1]
        _, _, gap, vx, vy = _separation(k, discs, pile, numbers)
        if gap <= pile.travel[REACH, i] + pile.travel[REACH, j]:
            speed = math.sqrt(vx * vx + vy * vy)
            travel = TRAVEL * _size(i, j, discs)
            fastest = max(fastest, speed)
            if speed * h > travel:
                h = travel / speed
            pile.travel[FAST, i] = max(pile.travel[FAST, i], speed)
            pile.travel[FAST, j] = max(pile.travel[FAST, j], speed)
    return max(h, SHORTEST_SHARE * longest), fastest


@compiled
def _size(i, j, discs):
    """Radius of the smaller of two discs, or of what meets an obstacle."""
    return discs[i, RADIUS] if is_straight(j, discs) else min(discs[i, RADIUS], discs[j, RADIUS])


@compiled
def _choose(discs, pile, numbers, counts):
    """The listed pairs whose gap is within their reach, in `chosen`; returns how many they are."""
    active = 0
    for k in range(counts[LISTED]):
        i, j = pile.pairs[k, 0], pile.pairs[k, 1]
        _, _, gap, _, _ = _separation(k, discs, pile, numbers)
        if gap <= pile.travel[REACH, i] + pile.travel[REACH, j]:
            pile.chosen[active] = k
            active += 1
    return active


# --- a step -------------------------------------------------------------------------------------------------


@compiled
def _pull(h, discs, pile):
    """The velocities at the end of the step without contacts."""
    for i in range(discs.shape[0]):
        for d in range(2):
            pile.motion[SPEED, i, d] = _free(i, d, h, discs, pile)
            pile.motion[ALONG, i, d] = 0.0
        pile.travel[NEAR, i] = 0.0


@compiled
def _free(i, d, h, discs, pile):
    """u of a disc at the end of the step, without contacts; 0 where it is held."""
    root = pile.motion[ROOT, i, d]
    return (discs[i, VX + d] + h * discs[i, GX + d]) / root if root > 0.0 else 0.0


@compiled
def _constrain(active, h, discs, pile, numbers):
    """Make contacts of the chosen pairs, with the impulses of the step before; `chosen` then is in their order."""
    length = (active + LANES - 1) // LANES
    c = 0
    for s in range(length):
        for lane in range(LANES):
            if lane * length + s < active:
                _make_contact(c, pile.chosen[lane * length + s], h, discs, pile, numbers)
                c += 1


@compiled
def _make_contact(c, k, h, discs, pile, numbers):
    contacts, motion = pile.contacts, pile.motion
    i, j = pile.pairs[k, 0], pile.pairs[k, 1]
    nx, ny, gap, vx, vy = _separation(k, discs, pile, numbers)
    pile.order[c] = k
    contacts[c, NORMAL], contacts[c, NORMAL + 1] = -nx * motion[ROOT, i, 0], -ny * motion[ROOT, i, 1]
    contacts[c, NORMAL + 2], contacts[c, NORMAL + 3] = nx * motion[ROOT, j, 0], ny * motion[ROOT, j, 1]
    opening = 0.0
    for d in range(4):
        opening += contacts[c, NORMAL + d] ** 2
    root = math.sqrt(opening)
    pile.scale[c] = root
    contacts[c, BIAS], contacts[c, GIVEN], contacts[c, BEFORE], contacts[c, DIRECTION] = 0.0, 0.0, 0.0, 0.0
    # what is held takes no part: the other one stands for it, so that contacts with one wall do not wait for another
    pile.ends[c, 0] = j if is_held(i, discs) else i
    pile.ends[c, 1] = i if is_held(j, discs) else j
    if opening == 0.0:
        return
    speed = nx * vx + ny * vy
    pulled = speed + h * (nx * (discs[j, GX] - discs[i, GX]) + ny * (discs[j, GY] - discs[i, GY]))
    bias = gap / h
    if pulled + bias < 0.0 and _bounces(speed, i, j, h, discs, pile, numbers):
        bias = min(bias, discs[j, BOUNCE] * speed)
    contacts[c, BIAS] = bias / root
    for d in range(4):
        contacts[c, NORMAL + d] /= root
    contacts[c, GIVEN] = contacts[c, BEFORE] = pile.forces[k] * h * root
    for d in range(2):
        motion[SPEED, i, d] += contacts[c, NORMAL + d] * contacts[c, GIVEN]
        motion[SPEED, j, d] += contacts[c, NORMAL + 2 + d] * contacts[c, GIVEN]


@compiled
def _find_impulses(active, tolerance, pile):
    """Impulses after which hardly a contact closes faster than the tolerance.

    Sweeps to and fro, accelerated by conjugate directions: Silcowitz, Niebe, Erleben, "A nonsmooth nonlinear
    conjugate gradient method for interactive contact force problems", Vis. Comput. 26 (2010). Each sweep goes once
    through memory: what the acceleration adds to an impulse is added when its contact is due.
    """
    size, share, keep = 0.0, 0.0, 0.0
    for turn in range(MOST_SWEEPS):
        _go_on(share, keep, pile)
        for c in range(active):
            _relax_forth(c, share, keep, pile)
        previous, size, fastest = size, 0.0, 0.0
        for c in range(active - 1, -1, -1):
            change = _relax(c, pile.contacts[c, GIVEN], pile) - pile.contacts[c, BEFORE]
            size += change * change
            fastest = max(fastest, abs(change) * pile.scale[c])
        if fastest <= tolerance:
            return
        share = size / previous if turn > 0 and size <= previous else 0.0
        keep = 1.0 if turn == 0 or share > 0.0 else 0.0


@compiled
def _go_on(share, keep, pile):
    """Go on in the direction of the sweeps so far by a share; if they are kept, it adds the last one to them."""
    motion = pile.motion
    for i in range(motion.shape[1]):
        for d in range(2):
            more = share * motion[ALONG, i, d]
            motion[ALONG, i, d] = keep * (more + motion[SPEED, i, d] - motion[NOTED, i, d])
            motion[SPEED, i, d] += more
            motion[NOTED, i, d] = motion[SPEED, i, d]


@compiled
def _relax_forth(c, share, keep, pile):
    """Go on likewise with the impulse of a contact, and relax it."""
    contacts = pile.contacts
    given = contacts[c, GIVEN]
    more = share * contacts[c, DIRECTION]
    contacts[c, DIRECTION] = keep * (more + given - contacts[c, BEFORE])
    contacts[c, BEFORE] = given + more
    _relax(c, given + more, pile)


@compiled
def _relax(c, given, pile):
    """Change the impulse of a contact so that it neither closes nor pulls; returns it."""
    contacts, motion = pile.contacts, pile.motion
    a, b = pile.ends[c, 0], pile.ends[c, 1]
    ax, ay, bx, by = contacts[c, 0], contacts[c, 1], contacts[c, 2], contacts[c, 3]
    first = ax * motion[SPEED, a, 0] + ay * motion[SPEED, a, 1]
    second = bx * motion[SPEED, b, 0] + by * motion[SPEED, b, 1]
    impulse = max(given - ((first + second) + contacts[c, BIAS]), 0.0)
    contacts[c, GIVEN] = impulse
    change = impulse - given
    motion[SPEED, a, 0] += ax * change
    motion[SPEED, a, 1] += ay * change
    motion[SPEED, b, 0] += bx * change
    motion[SPEED, b, 1] += by * change
    return impulse


@compiled
def _is_worse_than_none(active, h, discs, pile):
    """True if the impulses begin with such that sweeps have not made good: they could supply energy.

    Sweeps lessen ½ |u₁ − u₀|² + p·(N u₀ + b), u₀ being the motion without impulses, which is 0 without any.
    """
    contacts, motion = pile.contacts, pile.motion
    total, size = 0.0, 0.0
    for i in range(discs.shape[0]):
        for d in range(2):
            free = _free(i, d, h, discs, pile)
            motion[NOTED, i, d] = free
            total += 0.5 * (motion[SPEED, i, d] - free) ** 2
            size += 0.5 * free * free
    for c in range(active):
        a, b = pile.ends[c, 0], pile.ends[c, 1]
        rate = contacts[c, 0] * motion[NOTED, a, 0] + contacts[c, 1] * motion[NOTED, a, 1]
        rate += contacts[c, 2] * motion[NOTED, b, 0] + contacts[c, 3] * motion[NOTED, b, 1]
        total += contacts[c, GIVEN] * (rate + contacts[c, BIAS])
    return total > SLIGHT * size


@compiled
def _bounces(speed, i, j, h, discs, pile, numbers):
    """True if discs bounce that part at a speed (m/s): not if they approach by less than free fall gives in two steps."""
    slow = 2.0 * h * max(pile.travel[PULL, i], pile.travel[PULL, j])
    return speed < -slow and speed < -rest_speed(i, j, discs, numbers[REST_HEIGHT], numbers[NOW])


@compiled
def _report_impacts(active, h, discs, pile, report, numbers, counts):
    """Report the contacts in which discs struck each other."""
    motion = pile.motion
    for c in range(active):
        if pile.contacts[c, GIVEN] > 0.0:
            impulse = pile.contacts[c, GIVEN] / pile.scale[c]
            i, j = pile.pairs[pile.order[c], 0], pile.pairs[pile.order[c], 1]
            nx, ny, _, vx, vy = _separation(pile.order[c], discs, pile, numbers)
            before = nx * vx + ny * vy
            if _bounces(before, i, j, h, discs, pile, numbers):
                vx = motion[SPEED, j, 0] * motion[ROOT, j, 0] - motion[SPEED, i, 0] * motion[ROOT, i, 0]
                vy = motion[SPEED, j, 1] * motion[ROOT, j, 1] - motion[SPEED, i, 1] * motion[ROOT, i, 1]
                r = counts[REPORTED]
                report.pairs[r, 0], report.pairs[r, 1] = min(i, j), max(i, j)
                report.details[r, 0] = numbers[NOW]
                report.details[r, 1] = impulse
                report.details[r, 2] = -0.5 * impulse * (before + nx * vx + ny * vy)
                report.details[r, 3] = discs[i, OX] + discs[i, UX] + discs[i, RADIUS] * nx
                report.details[r, 4] = discs[i, OY] + discs[i, UY] + discs[i, RADIUS] * ny
                counts[REPORTED] += 1
                counts[IMPACTS] += 1


@compiled
def _keep_forces(active, h, pile, counts):
    """Note the forces of the step for the next; returns how many contacts push."""
    for k in range(counts[LISTED]):
        pile.forces[k] = 0.0
    pushing = 0
    for c in range(active):
        if pile.contacts[c, GIVEN] > 0.0:
            pile.forces[pile.order[c]] = pile.contacts[c, GIVEN] / (pile.scale[c] * h)
            pushing += 1
    return pushing


@compiled
def _find_near(active, h, discs, pile, numbers):
    """Mark the discs that were pushed, that end the step near another, or so near that a parabola could take them there."""
    motion = pile.motion
    for c in range(active):
        i, j = pile.pairs[pile.order[c], 0], pile.pairs[pile.order[c], 1]
        nx, ny, gap, _, _ = _separation(pile.order[c], discs, pile, numbers)
        vx = motion[SPEED, j, 0] * motion[ROOT, j, 0] - motion[SPEED, i, 0] * motion[ROOT, i, 0]
        vy = motion[SPEED, j, 1] * motion[ROOT, j, 1] - motion[SPEED, i, 1] * motion[ROOT, i, 1]
        bend = 2.0 * h * h * (pile.travel[PULL, i] + pile.travel[PULL, j])
        near = 0.0
        if pile.contacts[c, GIVEN] > 0.0:
            near = 2.0
        elif gap + h * (nx * vx + ny * vy) <= max(NEARBY * _size(i, j, discs), bend):
            near = 1.0
        pile.travel[NEAR, i], pile.travel[NEAR, j] = (
            max(pile.travel[NEAR, i], near),
            max(pile.travel[NEAR, j], near),
        )


@compiled
def _set_off(h, discs, pile, numbers):
    """Send the discs that others are near to on straight lines; the rest stay on their parabolas.

    Adds the energy that they lose in the step. Returns True if those that others push are calm.
    """
    motion = pile.motion
    calm = True
    for i in range(discs.shape[0]):
        vx, vy = motion[SPEED, i, 0] * motion[ROOT, i, 0], motion[SPEED, i, 1] * motion[ROOT, i, 1]
        pull = pile.travel[PULL, i]
        if pile.travel[NEAR, i] > 0.0:
            for d in range(2):
                if discs[i, WX + d] > 0.0:
                    before, after = discs[i, VX + d], vx if d == 0 else vy
                    gained = 0.5 * (after + before) * (after - before) - h * after * discs[i, GX + d]
                    numbers[LOSS] -= gained / discs[i, WX + d]
            discs[i, VX], discs[i, VY] = vx, vy
            discs[i, AX], discs[i, AY] = 0.0, 0.0
            slow = max(CALM_SPEEDS * h * pull, CALM_TRAVEL * numbers[SMALLEST] / h)
            calm = calm and (pile.travel[NEAR, i] < 2.0 or math.hypot(vx, vy) <= slow)
        discs[i, NOISE] = SPEED_NOISE * (abs(vx) + abs(vy) + 2.0 * h * pull)
    return calm
