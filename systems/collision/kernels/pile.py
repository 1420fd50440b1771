"""Piles: many discs in contact, by time steps.

Where so many contacts persist or begin that single events no longer pay, all discs take steps h of Moreau and Jean
(see pile_solver.py): the velocities at the end of the step carry the discs through it on straight lines. The distance
of two discs is a convex function of their places, so that discs do not sink in if the velocities satisfy the
condition with the normals at the start. Discs that are not near others stay on their parabolas. A pile in which no
disc moves fast any more is put into its equilibrium (free/pile_equilibrium.py).
"""

import math

from pinjoint.systems.collision.columns import (
    NONE,
    SPEED_NOISE,
    Count,
    Detail,
    Disc,
    Number,
    PileContact,
    PilePair,
    Reason,
)
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.pile_energy import supplies_energy
from pinjoint.systems.collision.kernels.pile_pairs import (
    allow_more_shift,
    allow_shifts,
    choose_contacts,
    choose_length,
    enter_pushing_pairs,
    find_pairs,
    stays_within_reach,
    velocity_after,
)
from pinjoint.systems.collision.kernels.pile_solver import (
    bounces,
    find_impulses,
    make_contacts,
    start_without_contacts,
)
from pinjoint.systems.collision.kernels.time_of_impact import (
    INFINITY,
    displacement_at,
    rim,
    smaller_radius,
    velocity_at,
)

TOLERANCE = 1e-8  # of the smallest radius: depth by which discs may sink into others in a step
SMALL_PILE = 50  # contacts; with more of them, these are enough:
DEPTH = 9.5e-4  # of the smallest radius
ROUGHNESS = 0.05  # of the fastest travel in the step
NEARBY = 0.2  # of the radius of the smaller of two discs: gap below which they move on straight lines
# of the smallest radius, in a step: a disc that travels less, or than free fall gives, is calm
CALM_TRAVEL = 0.004
LEAST_PATIENCE = 16  # calm steps before a pile first seeks its equilibrium
LARGE_GROUP = 256  # contacts at one instant, above which weights that press on them make steps cheaper
# contacts, and one for each disc, dealt with in WORK_STEPS steps before events give way to steps
LEAST_WORK = 300
WORK_STEPS = 10.0


@compiled
def crowded(touching, numbers, counts):
    """True if steps are cheaper than events for a group of `touching` contacts, or for the events of late."""
    h = numbers[Number.STEP_LENGTH]
    if h == INFINITY or (touching < 2 and counts[Count.WORK] == 0):
        return False
    if touching > LARGE_GROUP:
        return True
    if numbers[Number.RESTITUTION] == 1.0:
        return False
    if numbers[Number.NOW] - numbers[Number.WORK_SINCE] > WORK_STEPS * h:
        counts[Count.WORK], numbers[Number.WORK_SINCE] = 0, numbers[Number.NOW]
    counts[Count.WORK] += touching * (1 + touching // 8)
    return counts[Count.WORK] > LEAST_WORK + counts[Count.DISCS]


@compiled
def begin_steps(numbers, counts):
    """Let discs take steps from now on."""
    counts[Count.STEPPING], counts[Count.LISTED] = 1, NONE
    counts[Count.CALM], counts[Count.PATIENCE] = 0, LEAST_PATIENCE
    numbers[Number.STEP_END] = numbers[Number.NOW]


@compiled
def step(discs, grid, constraints, pile, report, numbers, counts):
    """Take the step that begins now. Returns a Reason; unless it is Reason.DONE, nothing has happened yet."""
    _begin_paths(discs, pile, numbers)
    if counts[Count.CALM] >= counts[Count.PATIENCE]:
        enter_pushing_pairs(discs, constraints, pile, counts)
        if counts[Count.SPARES] < constraints.forces.shape[0]:
            return Reason.SETTLE
        # without a contact that pushes the pile has dissolved: go back to events
        counts[Count.STEPPING], counts[Count.RENEW], counts[Count.WORK] = 0, 1, 0
        numbers[Number.WORK_SINCE] = numbers[Number.NOW]
        return Reason.DONE
    h = numbers[Number.STEP_LENGTH]
    allow_shifts(h, discs, pile)
    reason = find_pairs(h, False, discs, grid, constraints, pile, numbers, counts)
    if reason != Reason.DONE:
        return reason
    h, fastest = choose_length(discs, pile, numbers, counts)
    end = numbers[Number.NOW] + h
    # the pull of the whole step acts from its start on: none may be left half-way
    if end > numbers[Number.STOP]:
        end = numbers[Number.STOP]
        h = end - numbers[Number.NOW]
    allow_more_shift(h, fastest, discs, pile)
    while True:
        reason = find_pairs(h, True, discs, grid, constraints, pile, numbers, counts)
        if reason != Reason.DONE:
            return reason
        active = choose_contacts(h, pile, counts)
        if counts[Count.REPORTED] + active > report.shape[0]:
            return Reason.REPORT_FULL
        start_without_contacts(h, discs, pile)
        make_contacts(active, h, discs, pile, numbers)
        depth = TOLERANCE * numbers[Number.SMALLEST]
        if active > SMALL_PILE:
            depth = max(depth, min(DEPTH * numbers[Number.SMALLEST], ROUGHNESS * h * fastest))
        find_impulses(active, depth / h, pile)
        if supplies_energy(active, h, discs, pile, numbers):
            continue
        if stays_within_reach(h, discs, pile):
            break
    numbers[Number.STEP_END] = end
    numbers[Number.MOST_LOSS] = max(numbers[Number.MOST_LOSS], numbers[Number.LOSS])
    _report_impacts(active, h, discs, pile, report, numbers, counts)
    pushing = _keep_contacts(active, h, discs, pile, numbers, counts)
    calm = _start_paths(h, discs, pile, numbers)
    if calm or pushing == 0:
        counts[Count.CALM] += 1
    else:
        counts[Count.CALM], counts[Count.PATIENCE] = 0, LEAST_PATIENCE
    return Reason.DONE


@compiled
def _begin_paths(discs, pile, numbers):
    """Begin new paths of all discs now."""
    for i in range(discs.shape[0]):
        ux, uy = displacement_at(i, discs, numbers[Number.NOW])
        vx, vy = velocity_at(i, discs, numbers[Number.NOW])
        discs[i, Disc.UX], discs[i, Disc.UY], discs[i, Disc.VX], discs[i, Disc.VY] = ux, uy, vx, vy
        discs[i, Disc.AX], discs[i, Disc.AY] = discs[i, Disc.GX], discs[i, Disc.GY]
        discs[i, Disc.EPOCH], discs[i, Disc.STEP] = numbers[Number.NOW], INFINITY
        discs[i, Disc.CHANGES] += 1.0
        pile.root[2 * i] = math.sqrt(discs[i, Disc.WX])
        pile.root[2 * i + 1] = math.sqrt(discs[i, Disc.WY])


@compiled
def _report_impacts(active, h, discs, pile, report, numbers, counts):
    """Report the contacts in which discs bounced."""
    for c in range(active):
        if pile.contacts[c, PileContact.IMPULSE] > 0.0:
            impulse = pile.contacts[c, PileContact.IMPULSE] / pile.scale[c]
            i, j = pile.pairs[pile.order[c], 0], pile.pairs[pile.order[c], 1]
            pair = pile.near[pile.order[c]]
            nx, ny, before = pair[PilePair.NX], pair[PilePair.NY], pair[PilePair.RATE]
            if bounces(before, i, j, h, discs, pile, numbers):
                (ivx, ivy), (jvx, jvy) = velocity_after(i, pile), velocity_after(j, pile)
                vx, vy = jvx - ivx, jvy - ivy
                loss = -0.5 * impulse * (before + nx * vx + ny * vy)
                place = rim(i, nx, ny, discs, numbers[Number.NOW])
                enter_impact(i, j, numbers[Number.NOW], impulse, loss, place, report, counts)


@compiled
def enter_impact(i, j, time, impulse, loss, place, report, counts):
    """Report an impact of two discs at a time (s) and place (m)."""
    k = counts[Count.REPORTED]
    report[k, Detail.TIME], report[k, Detail.FIRST], report[k, Detail.SECOND] = time, min(i, j), max(i, j)
    report[k, Detail.IMPULSE], report[k, Detail.LOSS] = impulse, loss
    report[k, Detail.X], report[k, Detail.Y] = place
    counts[Count.REPORTED] += 1
    counts[Count.IMPACTS] += 1


@compiled
def _keep_contacts(active, h, discs, pile, numbers, counts):
    """Keep the forces of the step for the next; returns the number of contacts that push.

    Note how far discs are in one another as the step begins; mark the discs that were pushed, and those that end the step
    near another or could reach it on a parabola.
    """
    for k in range(counts[Count.LISTED]):
        pile.forces[k] = 0.0
    pushing = 0
    for c in range(active):
        k = pile.order[c]
        i, j, pair = pile.pairs[k, 0], pile.pairs[k, 1], pile.near[k]
        nx, ny, gap = pair[PilePair.NX], pair[PilePair.NY], pair[PilePair.GAP]
        size = smaller_radius(i, j, discs)
        numbers[Number.DEEPEST] = max(numbers[Number.DEEPEST], -gap / size)
        (ivx, ivy), (jvx, jvy) = velocity_after(i, pile), velocity_after(j, pile)
        vx, vy = jvx - ivx, jvy - ivy
        bend = 2.0 * h * h * (pile.pull[i] + pile.pull[j])
        near = 0.0
        if pile.contacts[c, PileContact.IMPULSE] > 0.0:
            pile.forces[k] = pile.contacts[c, PileContact.IMPULSE] / (pile.scale[c] * h)
            pushing += 1
            near = 2.0
        elif gap + h * (nx * vx + ny * vy) <= max(NEARBY * size, bend):
            near = 1.0
        pile.nearness[i] = max(pile.nearness[i], near)
        pile.nearness[j] = max(pile.nearness[j], near)
    return pushing


@compiled
def _start_paths(h, discs, pile, numbers):
    """Start straight paths of the discs that are near others; the rest stay on their parabolas.

    Counts the energy that they lose in the step. Returns True if the discs that others push are calm.
    """
    calm = True
    for i in range(discs.shape[0]):
        vx, vy = velocity_after(i, pile)
        pull = pile.pull[i]
        if pile.nearness[i] > 0.0:
            for d in range(2):
                if discs[i, Disc.WX + d] > 0.0:
                    before, after = discs[i, Disc.VX + d], vx if d == 0 else vy
                    gained = 0.5 * (after + before) * (after - before) - h * after * discs[i, Disc.GX + d]
                    numbers[Number.LOSS] -= gained / discs[i, Disc.WX + d]
            discs[i, Disc.VX], discs[i, Disc.VY] = vx, vy
            discs[i, Disc.AX], discs[i, Disc.AY] = 0.0, 0.0
            slow = max(h * pull, CALM_TRAVEL * numbers[Number.SMALLEST] / h)
            calm = calm and (pile.nearness[i] < 2.0 or vx * vx + vy * vy <= slow * slow)
        discs[i, Disc.NOISE] = SPEED_NOISE * (abs(vx) + abs(vy) + 2.0 * h * pull)
    return calm
