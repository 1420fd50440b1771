"""Meetings within one step of an integrator, and the joint impact of discs that touch."""

from systems.collision.arrays import BIAS, EPSILON, OPENING
from systems.collision.kernels import compiled
from systems.collision.kernels.gap import NEVER, first_touch
from systems.collision.kernels.impact import respond
from systems.collision.kernels.projection import compliance

NOISE = 16.0 * EPSILON  # of speeds and accelerations: slower approaches are round-off


@compiled
def first_meeting(h, pairs, kinds, position, before, velocity, after, radius, span):
    """When in a step of h seconds two discs first touch while they approach; NEVER if none do.

    Their paths are the parabolas through the displacements before and after that begin with the velocity: those
    of velocity Verlet exactly, of others nearly. kinds: 0 watched, 1 left alone until apart, 2 not watched.
    span: of obstacles; zero for discs.
    """
    earliest = NEVER
    for k in range(pairs.shape[0]):
        if kinds[k] == 2:
            continue
        i, j = pairs[k, 0], pairs[k, 1]
        sx, sy = before[j, 0] - before[i, 0], before[j, 1] - before[i, 1]
        dx, dy = (position[j, 0] - position[i, 0]) + sx, (position[j, 1] - position[i, 1]) + sy
        vx, vy = velocity[j, 0] - velocity[i, 0], velocity[j, 1] - velocity[i, 1]
        ax = 2.0 * (((after[j, 0] - after[i, 0]) - sx) / h - vx) / h
        ay = 2.0 * (((after[j, 1] - after[i, 1]) - sy) / h - vy) / h
        moving = abs(velocity[i, 0]) + abs(velocity[i, 1]) + abs(velocity[j, 0]) + abs(velocity[j, 1])
        away = abs(before[i, 0]) + abs(before[i, 1]) + abs(before[j, 0]) + abs(before[j, 1])
        if abs(ax) + abs(ay) <= 64.0 * EPSILON * (away / h + moving) / h:
            ax, ay = 0.0, 0.0
        reach = radius[i] + radius[j]
        growth = NOISE * (abs(ax) + abs(ay))
        tx, ty = span[j, 0], span[j, 1]
        s = first_touch(dx, dy, vx, vy, ax, ay, tx, ty, 0.0, reach, NOISE * moving, growth, h, kinds[k] == 1)
        earliest = min(earliest, s)
    return earliest if earliest <= h else NEVER


@compiled
def strike(members, count, restitution, group):
    """The impact of a group whose links, normals and velocities are set; see kernels/impact.py."""
    for c in range(count):
        group.contacts[c, BIAS] = 0.0
        group.contacts[c, OPENING] = compliance(c, c, group)
    respond(members, count, restitution, group)
