"""Times of impact within one step of an integrator, and the joint impact of discs that touch."""

import math

from systems.collision.columns import EPSILON, Contact, Mark, PairKind
from systems.collision.kernels import compiled
from systems.collision.kernels.impact import respond
from systems.collision.kernels.pairs import gap_of
from systems.collision.kernels.projection import begin, compliance, opening_rate, project, push_apart
from systems.collision.kernels.time_of_impact import INFINITY, first_touch

DOUBT = 1e-3  # of a radius, by which a path may differ from a parabola where particles collide
CUBIC_DEVIATION = 0.15  # of h |Δv|: distance of a cubic path from the parabola through its ends (4/27)
DOUBTFUL = -1.0  # instead of a time of impact
MOST_CROWD_SWEEPS = 200  # over the contacts of a crowd; its next step continues from the impulses reached
NOISE = 16.0 * EPSILON  # of speeds and accelerations: slower approaches are round-off


@compiled
def path_errors(h, before, velocity, after, later, listed, margin, path_error):
    """Bounds of the distance of paths in a step of h seconds from the parabolas that `first_impact` assumes.

    before, after, velocity, later: displacements and velocities of the particles at both ends of the step. path_error:
    receives the bounds (m). Returns the margin within which pairs must be listed (m), or 0 where the list is complete:
    where all particles are less than their margins away from the displacements `listed`.
    """
    turn, most, travel = 0.0, 0.0, 0.0
    for i in range(before.shape[0]):
        x, y = after[i, 0] - before[i, 0], after[i, 1] - before[i, 1]
        bx = h * (later[i, 0] + velocity[i, 0]) - 2.0 * x
        by = h * (later[i, 1] + velocity[i, 1]) - 2.0 * y
        path_error[i] = CUBIC_DEVIATION * math.hypot(bx, by)
        most = max(most, path_error[i])
        turn = max(turn, h * math.hypot(later[i, 0] - velocity[i, 0], later[i, 1] - velocity[i, 1]))
        travel = max(travel, math.hypot(x, y))
    swing = turn + 4.0 * most
    for i in range(before.shape[0]):
        if math.hypot(after[i, 0] - listed[i, 0], after[i, 1] - listed[i, 1]) + swing > margin[i]:
            return travel + swing
    return 0.0


@compiled
def first_impact(h, pairs, kinds, position, before, velocity, after, radius, span, size, path_error):
    """Time in a step of h seconds at which a pair first touches while it approaches; INFINITY for none, or DOUBTFUL.

    Paths are the parabolas through the displacements before and after that begin with the velocity: exact for
    velocity Verlet, with an error of at most `path_error` (m) for other integrators. The time is doubtful if a watched
    pair comes so near that this error could hide an impact, and the error exceeds DOUBT of its `size`.
    """
    earliest, count = INFINITY, before.shape[0]
    for k in range(pairs.shape[0]):
        if kinds[k] == PairKind.PERSISTENT:
            continue
        i, j = pairs[k, 0], pairs[k, 1]
        alone = j >= count
        if kinds[k] == PairKind.WATCHED:
            doubt = path_error[i] if alone else path_error[i] + path_error[j]
            if doubt > DOUBT * min(size[i], size[j]):
                first, _, _ = gap_of(i, j, position, before, radius, span)
                last, _, _ = gap_of(i, j, position, after, radius, span)
                if min(first, last) < 2.0 * doubt:
                    return DOUBTFUL
        sx, sy = -before[i, 0], -before[i, 1]
        vx, vy = -velocity[i, 0], -velocity[i, 1]
        ux, uy = -after[i, 0], -after[i, 1]
        moving = abs(velocity[i, 0]) + abs(velocity[i, 1])
        away = abs(before[i, 0]) + abs(before[i, 1])
        if not alone:
            sx, sy = before[j, 0] + sx, before[j, 1] + sy
            vx, vy = velocity[j, 0] + vx, velocity[j, 1] + vy
            ux, uy = after[j, 0] + ux, after[j, 1] + uy
            moving += abs(velocity[j, 0]) + abs(velocity[j, 1])
            away += abs(before[j, 0]) + abs(before[j, 1])
        dx, dy = (position[j, 0] - position[i, 0]) + sx, (position[j, 1] - position[i, 1]) + sy
        ax, ay = 2.0 * ((ux - sx) / h - vx) / h, 2.0 * ((uy - sy) / h - vy) / h
        if abs(ax) + abs(ay) <= 64.0 * EPSILON * (away / h + moving) / h:
            ax, ay = 0.0, 0.0
        reach = radius[i] + radius[j]
        growth = NOISE * (abs(ax) + abs(ay))
        tx, ty = span[j, 0], span[j, 1]
        overlapping = kinds[k] == PairKind.LEFT_ALONE
        s = first_touch((dx, dy, vx, vy, ax, ay), tx, ty, 0.0, reach, NOISE * moving, growth, h, overlapping)
        earliest = min(earliest, s)
    return earliest if earliest <= h else INFINITY


@compiled
def resolve(members, count, restitution, tolerance, group):
    """Resolve the impact of a group whose links, normals and velocities are set; see kernels/impact.py.

    Where the restitution is negative the motion is separated instead: by one kernel, so that what both share is compiled
    once.
    """
    if restitution < 0.0:
        separate_motion(members, count, tolerance, group)
        return
    for c in range(count):
        group.contacts[c, Contact.BIAS] = 0.0
        group.contacts[c, Contact.COMPLIANCE] = compliance(c, c, group)
    respond(members, count, restitution, group)


@compiled
def separate_motion(members, count, tolerance, group):
    """Change the motion of a group as little as possible so that no contact closes faster than its bias; see projection.py.

    Links, normals, biases and first impulses are set; column IMPULSE then holds the impulses. Where sweeps are too few
    to find them, all are reduced so that they do no work in sum.
    """
    active = 0
    for c in range(count):
        opening = compliance(c, c, group)
        group.contacts[c, Contact.COMPLIANCE] = opening
        if opening > 0.0:
            group.marks[Mark.ACTIVE, active] = c
            active += 1
    begin(members, group)
    project(members, active, tolerance, MOST_CROWD_SWEEPS, group)
    _limit_work(members, active, group)


@compiled
def _limit_work(members, active, group):
    """Reduce all impulses p by one factor so that p · (N m + b) ≤ 0 for the motion m after them."""
    before, after = 0.0, 0.0
    for k in range(active):
        c = group.marks[Mark.ACTIVE, k]
        if group.contacts[c, Contact.IMPULSE] < 0.0:  # the last acceleration of the sweeps went too far
            push_apart(c, -group.contacts[c, Contact.IMPULSE], group)
            group.contacts[c, Contact.IMPULSE] = 0.0
    for k in range(active):
        c = group.marks[Mark.ACTIVE, k]
        before += group.contacts[c, Contact.IMPULSE] * opening_rate(c, group.initial, group)
        after += group.contacts[c, Contact.IMPULSE] * opening_rate(c, group.motion, group)
    if after <= 0.0:
        return
    share = -before / (after - before) if before < 0.0 else 0.0
    for k in range(active):
        group.contacts[group.marks[Mark.ACTIVE, k], Contact.IMPULSE] *= share
    for m in range(members):
        for d in range(2):
            group.motion[m, d] = group.initial[m, d] + share * (group.motion[m, d] - group.initial[m, d])
