"""Whether the next step is one of a crowd: of driven particles, no nodes, of which so many touch that single impacts
no longer pay.
"""

import math

from systems.collision.columns import SHORTEST_SHARE, TRAVEL
from systems.collision.driven.columns import Need, Real
from systems.collision.driven.kernels.paths import opening
from systems.collision.kernels import compiled
from systems.collision.kernels.pairs import gap_of
from systems.entries import Control

CROWD_CONTACTS = 24  # persistent contacts and impacts in the next step, from which on particles are a crowd
CROWD_PARTICLES = 8  # particles that are no nodes, below which they are no crowd


@compiled
def is_crowd(driven, control, place, speed):
    """The Need for a step of a crowd, or for a list of the pairs that it would hold; NOTHING: it is no crowd.

    It is none where nodes of a structure are near, since a structure answers to forces in its own way.
    """
    real, pairs = driven.real, driven.pairs
    if driven.loose.shape[0] < CROWD_PARTICLES:
        return Need.NOTHING
    longest = min(control[Control.STEP_SIZE], real[Real.CROWD_STEP])
    fastest = 0.0
    for p in range(driven.loose.shape[0]):
        i = driven.loose[p]
        fastest = max(fastest, speed[i, 0] * speed[i, 0] + speed[i, 1] * speed[i, 1])
    travel = longest * (2.0 * math.sqrt(fastest) + longest * real[Real.STRONGEST])
    for p in range(driven.loose.shape[0]):
        i = driven.loose[p]
        x, y = place[i, 0] - driven.listed[i, 0], place[i, 1] - driven.listed[i, 1]
        if math.sqrt(x * x + y * y) + 2.0 * travel > driven.margin[i]:
            real[Real.SPAN] = 2.0 * travel
            return Need.LIST
    if pairs.shape[0] < CROWD_CONTACTS:
        return Need.NOTHING
    h = longest
    for k in range(pairs.shape[0]):
        i, j = pairs[k, 0], pairs[k, 1]
        gap, nx, ny = gap_of(i, j, driven.position, place, driven.radius, driven.span)
        driven.slow[k] = gap
        if gap > 2.0 * travel:
            continue
        if driven.node[i] or (j < place.shape[0] and driven.node[j]):
            return Need.NOTHING
        driven.rate[k] = opening(i, j, nx, ny, speed)
        far = TRAVEL * min(driven.size[i], driven.size[j])
        if -driven.rate[k] * longest > max(far, gap):
            h = min(h, far / -driven.rate[k])
    h = max(h, SHORTEST_SHARE * longest)
    number = 0
    for k in range(pairs.shape[0]):
        meets = driven.slow[k] <= 2.0 * travel and max(driven.slow[k], 0.0) + h * driven.rate[k] < 0.0
        number += driven.lasting[k]
        if meets and driven.restitution[pairs[k, 1]] < 1.0:
            number += 1
    return Need.CROWD if number >= CROWD_CONTACTS else Need.NOTHING
