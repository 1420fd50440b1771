"""Pairs of driven particles, or of a particle and an obstacle: the gaps between them.

The numbers of obstacles follow those of the particles; obstacles have no displacement.
"""

import math

from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.time_of_impact import nearest_of_piece


@compiled
def gap_of(i, j, position, displacement, radius, span):
    """Distance between the rims of two, and the unit vector from the first centre to the second."""
    dx, dy = position[j, 0] - position[i, 0], position[j, 1] - position[i, 1]
    if j < displacement.shape[0]:
        dx += displacement[j, 0] - displacement[i, 0]
        dy += displacement[j, 1] - displacement[i, 1]
    else:
        dx -= displacement[i, 0]
        dy -= displacement[i, 1]
    dx, dy, _ = nearest_of_piece(dx, dy, span[j, 0], span[j, 1])
    distance = math.hypot(dx, dy)
    unit = distance if distance > 0.0 else 1.0
    return distance - (radius[i] + radius[j]), dx / unit, dy / unit
