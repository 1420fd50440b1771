"""Meetings within one step of an integrator, and the joint impact of discs that touch."""

import math

from systems.collision.columns import ACTIVE, BIAS, EPSILON, GIVEN, LASTING, LEFT_ALONE, OPENING, WATCHED
from systems.collision.kernels import compiled
from systems.collision.kernels.impact import respond
from systems.collision.kernels.pairs import gap_of
from systems.collision.kernels.projection import begin, compliance, opening_rate, project
from systems.collision.kernels.time_of_impact import NEVER, first_touch

DOUBT = 1e-3  # of a radius, by which a path may differ from a parabola where particles meet
SWAY = 0.15  # times h |Δv|: by how much a cubic path differs from the parabola through its ends (4/27)
DOUBTFUL = -1.0
FEW_SWEEPS = 200  # over the contacts of a crowd; its next step goes on from there
NOISE = 16.0 * EPSILON  # of speeds and accelerations: slower approaches are round-off


@compiled
def bend(h, before, velocity, after, later, listed, margin, sway):
    """How far paths in a step of h seconds can be from the parabolas that `first_meeting` takes them for.

    before, after, velocity, later: displacements and velocities of the particles at both ends of the step. sway: room
    for how far each can be (m). Returns how far pairs are to be listed (m); 0 where the list holds, which is that of
    particles less than their margins away from the displacements `listed`.
    """
    turn, most, travel = 0.0, 0.0, 0.0
    for i in range(before.shape[0]):
        x, y = after[i, 0] - before[i, 0], after[i, 1] - before[i, 1]
        bx = h * (later[i, 0] + velocity[i, 0]) - 2.0 * x
        by = h * (later[i, 1] + velocity[i, 1]) - 2.0 * y
        sway[i] = SWAY * math.hypot(bx, by)
        most = max(most, sway[i])
        turn = max(turn, h * math.hypot(later[i, 0] - velocity[i, 0], later[i, 1] - velocity[i, 1]))
        travel = max(travel, math.hypot(x, y))
    swing = turn + 4.0 * most
    for i in range(before.shape[0]):
        if math.hypot(after[i, 0] - listed[i, 0], after[i, 1] - listed[i, 1]) + swing > margin[i]:
            return travel + swing
    return 0.0


@compiled
def first_meeting(h, pairs, kinds, position, before, velocity, after, radius, span, size, sway):
    """When in a step of h seconds two first touch while they approach; NEVER if none do; DOUBTFUL if it is doubtful.

    Their paths are the parabolas through the displacements before and after that begin with the velocity: those
    of velocity Verlet exactly, of others nearly, and by `sway` at most. It is doubtful if any of the watched come so
    near that this could hide a meeting, and is more than a small share of their `size`.
    """
    earliest, count = NEVER, before.shape[0]
    for k in range(pairs.shape[0]):
        if kinds[k] == LASTING:
            continue
        i, j = pairs[k, 0], pairs[k, 1]
        alone = j >= count
        if kinds[k] == WATCHED:
            doubt = sway[i] if alone else sway[i] + sway[j]
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
        overlapping = kinds[k] == LEFT_ALONE
        s = first_touch(dx, dy, vx, vy, ax, ay, tx, ty, 0.0, reach, NOISE * moving, growth, h, overlapping)
        earliest = min(earliest, s)
    return earliest if earliest <= h else NEVER


@compiled
def strike(members, count, restitution, group):
    """The impact of a group whose links, normals and velocities are set; see kernels/impact.py."""
    for c in range(count):
        group.contacts[c, BIAS] = 0.0
        group.contacts[c, OPENING] = compliance(c, c, group)
    respond(members, count, restitution, group)


@compiled
def hold_apart(members, count, tolerance, group):
    """Change the motion of a group as little as possible so that no contact closes faster than its bias; see projection.py.

    Links, normals, biases and impulses to begin with are set; GIVEN then holds the impulses. Where sweeps are too few to
    find them, they are less: what pushes does no work, all in all.
    """
    active = 0
    for c in range(count):
        opening = compliance(c, c, group)
        group.contacts[c, OPENING] = opening
        if opening > 0.0:
            group.marks[ACTIVE, active] = c
            active += 1
    begin(members, group)
    project(members, active, tolerance, FEW_SWEEPS, group)
    _take_no_work(members, active, group)


@compiled
def _take_no_work(members, active, group):
    """Lessen all impulses p alike if contacts that they push open: p · (N m + b) ≤ 0 for the motion m after them."""
    before, after = 0.0, 0.0
    for k in range(active):
        c = group.marks[ACTIVE, k]
        group.contacts[c, GIVEN] = max(group.contacts[c, GIVEN], 0.0)
        before += group.contacts[c, GIVEN] * opening_rate(c, group.initial, group)
        after += group.contacts[c, GIVEN] * opening_rate(c, group.motion, group)
    if after <= 0.0:
        return
    share = -before / (after - before) if before < 0.0 else 0.0
    for k in range(active):
        group.contacts[group.marks[ACTIVE, k], GIVEN] *= share
    for m in range(members):
        for d in range(2):
            group.motion[m, d] = group.initial[m, d] + share * (group.motion[m, d] - group.initial[m, d])
