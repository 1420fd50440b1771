"""Piles: crowds in lasting contact, by time steps.

Where so many contacts last or begin that single events no longer pay, all discs take steps h of Moreau and Jean
(Jean, Comput. Methods Appl. Mech. Eng. 177, 1999): the velocities at the end,
    v₁ = v₀ + h g + W N p,   n·Δv₁ + max(gap/h, e n·Δv₀ where that is an impact) ≥ 0 ⟂ p ≥ 0,
carry the discs through the step in a straight line. The distance of two discs is a convex function of their
places, so that what satisfies this with the normals at the start does not sink in. Discs without a contact in the
step stay on their parabolas. A pile in which nothing moves fast any more is left to repose.py.
"""

import math

from systems.collision.arrays import (
    ACTIVE,
    AX,
    AY,
    BIAS,
    BOUNCE,
    CALM,
    CELL,
    CHANGES,
    DISCS,
    EPOCH,
    FORCE,
    GIVEN,
    GX,
    GY,
    IMPACTS,
    IMPULSE,
    LAYERS,
    LOSS,
    NOISE,
    NONE,
    NOW,
    NX,
    NY,
    OPENING,
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
from systems.collision.contact.kernels import find_lasting, forget_lasting, is_held, note_lasting
from systems.collision.gap.kernels import NEVER, nearest, pull_on, relative_motion, rest_speed
from systems.collision.grid.kernels import enclose, enter, neighbours
from systems.collision.kernels import compiled
from systems.collision.projection.kernels import compliance, opening_rate, push_apart, sweep
from systems.collision.window.kernels import is_joined, set_layers

DONE, SETTLE = int(Reason.DONE), int(Reason.SETTLE)
GROUP_FULL, REPORT_FULL, GRID_FULL = int(Reason.GROUP_FULL), int(Reason.REPORT_FULL), int(Reason.GRID_FULL)

STEP_SHARE = 0.02  # of the time in which a disc falls through its diameter
SHORTEST_SHARE = 1.0 / 16.0  # of a step, where discs are fast
TRAVEL = 0.25  # of the smallest radius, in a step that is not the shortest; also the room around boxes
MOST_SWEEPS = 60  # of the contacts in a step; the next goes on from there
TOLERANCE = 1e-8  # of the smallest radius: by how much discs sink in a step whose sweeps have settled
CALM_TRAVEL = 0.01  # of the smallest radius, in a step: what travels less is calm
CALM_SPEEDS = 2.0  # of those that free fall gives in a step: what is slower is calm
LEAST_PATIENCE = 8  # calm steps before a pile seeks its equilibrium
BEFORE, DIRECTION = FORCE, IMPULSE  # columns of contacts that mean this here
LARGE = 256  # contacts at one instant that are left to steps where weights press on them
WORK_PER_DISC, LEAST_WORK = 10, 1000  # contacts dealt with in WORK_STEPS steps before events give way to steps
WORK_STEPS = 10.0


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
    counts[STEPPING] = 1
    counts[CALM], counts[PATIENCE] = 0, LEAST_PATIENCE
    numbers[STEP_END] = numbers[NOW]


@compiled
def step(discs, grid, ties, group, report, numbers, counts):
    """Take the step that begins now. Returns a Reason; unless it is DONE, nothing has happened yet."""
    _note_motion(discs, group, numbers)
    if counts[CALM] >= counts[PATIENCE]:
        if _pushes(discs, ties):
            return SETTLE
        end_steps(numbers, counts)
        return DONE
    reason, pairs = _list_pairs(discs, grid, ties, group, numbers, counts)
    if reason != DONE:
        return reason
    if counts[REPORTED] + pairs > report.pairs.shape[0]:
        return REPORT_FULL
    h = _length(pairs, discs, group, numbers)
    numbers[STEP_END] = numbers[NOW] + h
    _pull(h, discs, group)
    active = _constrain(pairs, h, discs, group, numbers)
    _find_impulses(active, TOLERANCE * numbers[SMALLEST] / h, group)
    _report_impacts(active, h, discs, group, report, numbers, counts)
    calm = _set_off(h, discs, group, numbers)
    pushing = _make_pushes_last(active, h, discs, ties, group, counts)
    counts[CALM] = counts[CALM] + 1 if calm or pushing == 0 else 0
    return DONE


@compiled
def _pushes(discs, ties):
    """True if any contact pushes; if none does, the pile has dissolved."""
    i = 0
    while i < discs.shape[0] and ties.first_lasting[i] == NONE:
        i += 1
    return i < discs.shape[0]


@compiled
def _note_motion(discs, group, numbers):
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
        group.initial[i, 0], group.initial[i, 1] = discs[i, VX], discs[i, VY]
        group.mobility[i, 0], group.mobility[i, 1] = discs[i, WX], discs[i, WY]


@compiled
def _length(pairs, discs, group, numbers):
    """Length of a step (s), in which no two discs that might meet travel far relative to one another."""
    h = numbers[STEP_LENGTH]
    fastest = 0.0
    for c in range(pairs):
        i, j = group.links[c, 0], group.links[c, 1]
        dx, dy, vx, vy, _, _ = relative_motion(discs, i, j, numbers[NOW])
        dx, dy, _ = nearest(dx, dy, j, discs)
        speed = math.sqrt(vx * vx + vy * vy)
        reach = discs[i, RADIUS] + discs[j, RADIUS] + h * speed
        if speed > fastest and dx * dx + dy * dy < reach * reach:
            fastest = speed
    if fastest * h > TRAVEL * numbers[SMALLEST]:
        return max(TRAVEL * numbers[SMALLEST] / fastest, SHORTEST_SHARE * h)
    return h


@compiled
def end_steps(numbers, counts):
    """Go back to events."""
    counts[STEPPING], counts[RENEW], counts[WORK] = 0, 1, 0
    numbers[WORK_SINCE] = numbers[NOW]


# --- pairs --------------------------------------------------------------------------------------------------


@compiled
def _list_pairs(discs, grid, ties, group, numbers, counts):
    """List the pairs that may touch in the step, with the forces in the one before.

    Returns a Reason and how many pairs there are.
    """
    room, h = TRAVEL * numbers[SMALLEST], numbers[STEP_LENGTH]
    for i in range(discs.shape[0]):
        enclose(i, discs, grid, numbers[NOW], numbers[NOW] + h)
        grid.boxes[i, 0] -= room
        grid.boxes[i, 1] -= room
        grid.boxes[i, 2] += room
        grid.boxes[i, 3] += room
    set_layers(grid, numbers, counts)
    layers, cell = counts[LAYERS], numbers[CELL]
    if 8 * discs.shape[0] * layers > grid.after.shape[0]:
        return GRID_FULL, 0
    grid.heads[:] = NONE
    pairs = 0
    for i in range(discs.shape[0]):
        left, bottom, right, top = grid.boxes[i]
        near = neighbours(i, left, bottom, right, top, grid, layers, cell)
        for k in range(near):
            j = grid.found[k]
            if (is_held(i, discs) and is_held(j, discs)) or is_joined(i, j, ties):
                continue
            if pairs < group.links.shape[0]:
                group.links[pairs, 0], group.links[pairs, 1] = j, i
                entry = find_lasting(i, j, ties)
                group.contacts[pairs, GIVEN] = 0.0 if entry == NONE else ties.forces[entry]
            pairs += 1
        enter(i, grid, layers, cell)
    if pairs > group.links.shape[0] or 2 * pairs > counts[SPARES]:
        return GROUP_FULL, 0
    return DONE, pairs


# --- a step -------------------------------------------------------------------------------------------------


@compiled
def _pull(h, discs, group):
    """The velocities at the end of the step without contacts, in `motion`, and their noise."""
    largest = 0.0
    for i in range(discs.shape[0]):
        group.motion[i, 0] = discs[i, VX] + h * discs[i, GX]
        group.motion[i, 1] = discs[i, VY] + h * discs[i, GY]
        largest = max(largest, abs(group.motion[i, 0]) + abs(group.motion[i, 1]))
    group.noise[0] = SPEED_NOISE * largest


@compiled
def _constrain(pairs, h, discs, group, numbers):
    """List the pairs as contacts, with the impulses of the step before; returns how many there are.

    Column 0 of `other` becomes 1 for the discs of pairs that are near.
    """
    contacts = group.contacts
    group.other[:, 0] = 0.0
    active = 0
    for c in range(pairs):
        i, j = group.links[c, 0], group.links[c, 1]
        dx, dy, vx, vy, _, _ = relative_motion(discs, i, j, numbers[NOW])
        dx, dy, _ = nearest(dx, dy, j, discs)
        distance = math.sqrt(dx * dx + dy * dy)
        contacts[c, NX] = dx / distance if distance > 0.0 else 1.0
        contacts[c, NY] = dy / distance if distance > 0.0 else 0.0
        contacts[c, OPENING] = compliance(c, c, group)
        gap = distance - (discs[i, RADIUS] + discs[j, RADIUS])
        if contacts[c, OPENING] == 0.0:
            contacts[c, GIVEN] = 0.0
            continue
        contacts[c, BIAS] = gap / h
        speed = contacts[c, NX] * vx + contacts[c, NY] * vy
        if speed < -_bounce(i, j, h, discs, numbers) and opening_rate(c, group.motion, group) < 0.0:
            contacts[c, BIAS] = min(gap / h, discs[j, BOUNCE] * speed)
        contacts[c, GIVEN] *= h
        push_apart(c, contacts[c, GIVEN], group)
        group.other[i, 0], group.other[j, 0] = 1.0, 1.0
        group.marks[ACTIVE, active] = c
        active += 1
    return active


@compiled
def _find_impulses(active, tolerance, group):
    """Impulses after which hardly a contact closes faster than the tolerance, in column GIVEN.

    Sweeps to and fro, accelerated by conjugate directions: Silcowitz, Niebe, Erleben, "A nonsmooth nonlinear
    conjugate gradient method for interactive contact force problems", Vis. Comput. 26 (2010).
    """
    contacts = group.contacts
    size = 0.0
    for turn in range(MOST_SWEEPS):
        for k in range(active):
            c = group.marks[ACTIVE, k]
            contacts[c, BEFORE] = contacts[c, GIVEN]
        sweep(active, 2, 0.0, group)
        previous, size, fastest = size, 0.0, 0.0
        for k in range(active):
            c = group.marks[ACTIVE, k]
            change = contacts[c, GIVEN] - contacts[c, BEFORE]
            size += change * change * contacts[c, OPENING]
            fastest = max(fastest, abs(change) * contacts[c, OPENING])
        if fastest <= tolerance:
            return
        share = size / previous if turn > 0 and size <= previous else 0.0
        for k in range(active):
            c = group.marks[ACTIVE, k]
            change = contacts[c, GIVEN] - contacts[c, BEFORE]
            more = share * contacts[c, DIRECTION] if share > 0.0 else 0.0
            contacts[c, DIRECTION] = more + change if turn == 0 or share > 0.0 else 0.0
            if more != 0.0:
                contacts[c, GIVEN] += more
                push_apart(c, more, group)


@compiled
def _bounce(i, j, h, discs, numbers):
    """Speed of approach (m/s) below which discs of a pile do not bounce: what free fall gives in two steps."""
    speed = rest_speed(i, j, discs, numbers[REST_HEIGHT], numbers[NOW])
    return max(speed, 2.0 * h * pull_on(discs, i, j))


@compiled
def _report_impacts(active, h, discs, group, report, numbers, counts):
    """Report the contacts in which discs struck each other."""
    for k in range(active):
        c = group.marks[ACTIVE, k]
        impulse = group.contacts[c, GIVEN]
        if impulse > 0.0:
            i, j = group.links[c, 0], group.links[c, 1]
            before = opening_rate(c, group.initial, group) - group.contacts[c, BIAS]
            if before < -_bounce(i, j, h, discs, numbers):
                after = opening_rate(c, group.motion, group) - group.contacts[c, BIAS]
                r = counts[REPORTED]
                report.pairs[r, 0], report.pairs[r, 1] = min(i, j), max(i, j)
                report.details[r, 0] = numbers[NOW]
                report.details[r, 1] = impulse
                report.details[r, 2] = -0.5 * impulse * (before + after)
                report.details[r, 3] = discs[i, OX] + discs[i, UX] + discs[i, RADIUS] * group.contacts[c, NX]
                report.details[r, 4] = discs[i, OY] + discs[i, UY] + discs[i, RADIUS] * group.contacts[c, NY]
                counts[REPORTED] += 1
                counts[IMPACTS] += 1


@compiled
def _set_off(h, discs, group, numbers):
    """Send the discs that others are near to on straight lines; the rest stay on their parabolas.

    Adds the energy that they lose in the step. Returns True if they are calm.
    """
    calm = True
    for i in range(discs.shape[0]):
        vx, vy = group.motion[i, 0], group.motion[i, 1]
        if group.other[i, 0] == 1.0:
            for d in range(2):
                if discs[i, WX + d] > 0.0:
                    before, after = discs[i, VX + d], group.motion[i, d]
                    gained = 0.5 * (after + before) * (after - before) - h * after * discs[i, GX + d]
                    numbers[LOSS] -= gained / discs[i, WX + d]
            discs[i, VX], discs[i, VY] = vx, vy
            discs[i, AX], discs[i, AY] = 0.0, 0.0
            slow = CALM_SPEEDS * h * math.hypot(discs[i, GX], discs[i, GY])
            calm = calm and math.hypot(vx, vy) <= max(slow, CALM_TRAVEL * numbers[SMALLEST] / h)
        pull = abs(discs[i, GX]) + abs(discs[i, GY])
        discs[i, NOISE] = SPEED_NOISE * (abs(vx) + abs(vy) + h * pull)
    return calm


@compiled
def _make_pushes_last(active, h, discs, ties, group, counts):
    """Enter the contacts that push into the table of lasting ones, instead of all there are; returns how many."""
    for i in range(discs.shape[0]):
        forget_lasting(i, ties, counts)
    pushing = 0
    for k in range(active):
        c = group.marks[ACTIVE, k]
        force = group.contacts[c, GIVEN] / h
        if force > 0.0:
            i, j = group.links[c, 0], group.links[c, 1]
            note_lasting(i, j, force, discs, ties, counts)
            note_lasting(j, i, force, discs, ties, counts)
            pushing += 1
    return pushing
