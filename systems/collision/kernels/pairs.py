"""Pairs of driven particles, or of a particle and an obstacle: gaps, kinds, compliance, and the law of contact forces.

The numbers of obstacles follow those of the particles; obstacles have no displacement.
"""

import math

from systems.collision.columns import OVERLAP, PairKind
from systems.collision.kernels import compiled
from systems.collision.kernels.projection import coupling
from systems.collision.kernels.time_of_impact import nearest_of_piece
from systems.kernels import compiled as law


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


@compiled
def measure_gaps(pairs, position, displacement, radius, span, gap, normal):
    """Fill in gap and normal of every pair."""
    for k in range(pairs.shape[0]):
        i, j = pairs[k, 0], pairs[k, 1]
        gap[k], normal[k, 0], normal[k, 1] = gap_of(i, j, position, displacement, radius, span)


@compiled
def classify_pairs(pairs, contacts, node, position, displacement, radius, span, kinds):
    """Fill in the PairKind of every pair at the start of a step."""
    for k in range(pairs.shape[0]):
        i, j = pairs[k, 0], pairs[k, 1]
        kinds[k] = PairKind.WATCHED
        if node[i] and node[j]:
            gap, _, _ = gap_of(i, j, position, displacement, radius, span)
            if gap < -OVERLAP * (radius[i] + radius[j]):
                kinds[k] = PairKind.LEFT_ALONE
        for c in range(contacts.shape[0]):
            if contacts[c, 0] == i and contacts[c, 1] == j:
                kinds[k] = PairKind.PERSISTENT
                break


@compiled
def compliance_matrix(pairs, normal, pushed, weight, slope):
    """Fill in the rates at which unit forces along `pushed` (columns) open contacts along `normal` (rows), 1/kg."""
    for c in range(pairs.shape[0]):
        for d in range(pairs.shape[0]):
            ends = pairs[c], pairs[d]
            slope[c, d] = coupling(ends, normal[c, 0], normal[c, 1], pushed[d, 0], pushed[d, 1], weight)


@law
def contact_force(collision_support_force):
    """The force of all contacts on a particle during this step, kN."""
    return collision_support_force[0], collision_support_force[1]
