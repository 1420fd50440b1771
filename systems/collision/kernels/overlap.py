"""Overlap removal: discs are moved apart along their lines of centres, in shares by inverse mass, and out of obstacles."""

import math

from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.time_of_impact import nearest_of_piece

OVERCORRECTION = 0.05  # of an overlap, by which discs are moved farther than necessary, so that sweeps end
GOLDEN_ANGLE = 2.399963229728653  # between the directions in which discs with one centre move


@compiled
def separate(first, second, position, displacement, radius, inverse_mass, span, slack, begun, last):
    """Move the discs of pairs that overlap by more than slack × reach apart, in sweeps from the one numbered `begun` on.

    Returns the number of the sweep that found none, or `last`, before which it leaves off. Held directions do not
    move, nor do obstacles, which have a span.
    """
    for sweep in range(begun, last):
        apart = True
        for k in range(first.shape[0]):
            i, j = first[k], second[k]
            reach = radius[i] + radius[j]
            x = (position[j, 0] - position[i, 0]) + (displacement[j, 0] - displacement[i, 0])
            y = (position[j, 1] - position[i, 1]) + (displacement[j, 1] - displacement[i, 1])
            x, y, _ = nearest_of_piece(x, y, span[j, 0], span[j, 1])
            distance = math.sqrt(x * x + y * y)
            overlap = reach - distance
            if overlap <= slack * reach:
                continue
            if distance > 0.0:
                x, y = x / distance, y / distance
            elif span[j, 0] != 0.0 or span[j, 1] != 0.0:
                length = math.hypot(span[j, 0], span[j, 1])
                x, y = span[j, 1] / length, -span[j, 0] / length
            else:
                x, y = math.cos(GOLDEN_ANGLE * j), math.sin(GOLDEN_ANGLE * j)
            along = (inverse_mass[i, 0] + inverse_mass[j, 0]) * x * x
            along += (inverse_mass[i, 1] + inverse_mass[j, 1]) * y * y
            if along == 0.0:
                continue
            share = (1.0 + OVERCORRECTION * (sweep > 0)) * overlap / along
            displacement[i, 0] -= share * inverse_mass[i, 0] * x
            displacement[i, 1] -= share * inverse_mass[i, 1] * y
            displacement[j, 0] += share * inverse_mass[j, 0] * x
            displacement[j, 1] += share * inverse_mass[j, 1] * y
            apart = False
        if apart:
            return sweep
    return last
