"""The horizon: up to which time impacts are computed in advance, and of which pairs of discs.

When a horizon opens, every disc gets a box around its path until the horizon's end, and the impacts of discs whose
boxes overlap are computed and queued. The impact of two discs follows from their paths alone, so that horizon, boxes,
grid and queue can be discarded and made anew at any time without changing a bit of the results.
"""

import math

from pinjoint.systems.collision.columns import NONE, Count, Disc, Number, Reason
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.grid import emptied, enclose, enter, neighbours, set_layers
from pinjoint.systems.collision.kernels.heap import queue_impact
from pinjoint.systems.collision.kernels.persistent_contact import find_persistent, is_held
from pinjoint.systems.collision.kernels.time_of_impact import (
    INFINITY,
    first_approach,
    first_touch,
    is_straight,
    nearest,
    pull_noise,
    relative_motion,
    relative_state,
    speed_noise,
)

LONGEST_HORIZON, SHORTEST_HORIZON = 2.0**20, 2.0**-200  # s
BOX_COST = 0.9  # of renewing a disc's box, relative to that of looking at one neighbour (measured)
MOST_NEIGHBOURS = 64  # per disc; with more, a shorter horizon is opened
MOST_CORRECTIONS = 3  # of a time of impact, each of which squares its error
LARGEST_CORRECTION = 1e-3  # of the step of persistent contact


@compiled
def impact_on(path, i, j, start, discs, constraints, end):
    """Time at which two discs next touch while they approach, up to `end`; INFINITY if they do not.

    path: relative motion of i and j, i < j, at `start`, when both are on their paths.
    """
    straight = is_straight(j, discs)
    reach = discs[i, Disc.RADIUS] + discs[j, Disc.RADIUS]
    noise, growth = speed_noise(discs, i, j, start), pull_noise(discs, i, j)
    if straight:
        tx, ty, shared = discs[j, Disc.TX], discs[j, Disc.TY], discs[j, Disc.SHARED]
        time = start + first_touch(path, tx, ty, shared, reach, noise, growth, end - start, False)
    else:
        time = start + first_approach(path, reach, noise, growth, end - start, False)
    if time > end or find_persistent(i, j, constraints) != NONE:
        return INFINITY
    if discs[i, Disc.STEP] < INFINITY or discs[j, Disc.STEP] < INFINITY:
        return _on_bent_paths(time, i, j, start, reach, discs)
    return time


@compiled
def _on_bent_paths(time, i, j, start, reach, discs):
    """The impact on the paths of two discs, one of them in a step of persistent contact, given that on their parabolas.

    By Newton's method. Discs that hardly approach are looked at when their parabolas meet.
    """
    most = LARGEST_CORRECTION * (min(discs[i, Disc.STEP], discs[j, Disc.STEP]) - start)
    for _ in range(MOST_CORRECTIONS):
        dx, dy, vx, vy = relative_state(discs, i, j, time)
        dx, dy, _ = nearest(dx, dy, j, discs)
        distance = math.sqrt(dx * dx + dy * dy)
        rate = (dx * vx + dy * vy) / distance if distance > 0.0 else 0.0
        if abs(distance - reach) > -rate * most:
            return time
        time = max(time - (distance - reach) / rate, start)
    return time


@compiled
def schedule_impact(i, j, discs, constraints, queue, numbers, counts):
    """Compute the next impact of two discs and queue it if it is within the horizon. False if the queue is full.

    For i = j: when the forces in the disc's persistent contacts are due again.
    """
    i, j, end = min(i, j), max(i, j), numbers[Number.HORIZON_END]
    time = discs[i, Disc.STEP]
    if i != j:
        start = max(discs[i, Disc.EPOCH], discs[j, Disc.EPOCH])
        time = impact_on(relative_motion(discs, i, j, start), i, j, start, discs, constraints, end)
    return time > end or queue_impact(time, i, j, discs, queue, counts)


@compiled
def open_horizon(discs, grid, constraints, queue, numbers, counts):
    """Choose a horizon from now on, box all discs and queue all impacts within it. Returns a Reason."""
    counts[Count.RENEW] = 1
    _choose_length(discs, numbers)
    while True:
        area, _, count = _survey(discs, numbers, numbers[Number.HORIZON])
        resting, _, _ = _survey(discs, numbers, 0.0)
        most = INFINITY if area <= 2.0 * resting else MOST_NEIGHBOURS * count
        reason, pairs = _fill(most, discs, grid, constraints, queue, numbers, counts)
        if reason != Reason.DONE:
            return reason
        if pairs <= most:
            break
        numbers[Number.HORIZON] = max(0.25 * numbers[Number.HORIZON], SHORTEST_HORIZON)
    if area > 0.0:
        numbers[Number.CROWDING] = max(pairs, 0.05 * count) / area
    counts[Count.RENEW] = 0
    return Reason.DONE


@compiled
def _fill(most, discs, grid, constraints, queue, numbers, counts):
    """Fill boxes, grid and queue. Returns a Reason and the number of boxes that overlap; stops above `most`."""
    numbers[Number.HORIZON_END] = numbers[Number.NOW] + numbers[Number.HORIZON]
    for i in range(discs.shape[0]):
        enclose(i, discs, grid, numbers[Number.NOW], numbers[Number.HORIZON_END])
    set_layers(grid, numbers, counts)
    layers = counts[Count.LAYERS]
    if not emptied(grid, layers):
        return Reason.GRID_FULL, 0
    counts[Count.QUEUED] = 0
    pairs = 0
    for i in range(discs.shape[0]):  # two that are held have no impact
        if is_held(i, discs):
            enter(i, grid, layers)
    for i in range(discs.shape[0]):
        if is_held(i, discs):
            continue
        near = neighbours(i, grid, layers, 0)
        grid.found[near] = i  # and the step of its persistent contacts
        for k in range(near + 1):
            if not schedule_impact(i, grid.found[k], discs, constraints, queue, numbers, counts):
                return Reason.QUEUE_FULL, 0
        enter(i, grid, layers)
        pairs += near
        if pairs > most:
            break
    return Reason.DONE, pairs


# --- length of the horizon: the cheapest -------------------------------------------------------------


@compiled
def _survey(discs, numbers, horizon):
    """Sums over discs that may move: the areas of their boxes (m²) for a length of the horizon (s), radius × speed (m²/s).

    And how many there are, at least 1. No box counts for more than would hold half of all discs.
    """
    most = 0.5 * discs.shape[0] / numbers[Number.CROWDING]
    area, sweep, count = 0.0, 0.0, 0
    for i in range(discs.shape[0]):
        if is_held(i, discs):
            continue
        s = numbers[Number.NOW] - discs[i, Disc.EPOCH]
        ax, ay = discs[i, Disc.AX], discs[i, Disc.AY]
        speed = max(abs(discs[i, Disc.VX] + s * ax), abs(discs[i, Disc.VY] + s * ay))
        pull = max(abs(ax), abs(ay))
        side = 2.0 * discs[i, Disc.RADIUS] + horizon * (speed + 0.5 * horizon * pull)
        area += min(side * side, most)
        sweep += min(discs[i, Disc.RADIUS] * speed, most / horizon)
        count += 1
    return area, sweep, max(count, 1)


@compiled
def _cost(discs, numbers, horizon):
    """Cost per second: all boxes and pairs once a horizon, and those of two discs for every impact.

    With 2 × crowding discs per area, crowding × area pairs of boxes overlap and about crowding × sweep pairs
    of discs meet per second.
    """
    area, sweep, count = _survey(discs, numbers, horizon)
    pairs = numbers[Number.CROWDING] * area
    impacts = 2.0 * numbers[Number.CROWDING] * sweep
    return (BOX_COST * count + pairs) / horizon + impacts * (BOX_COST + 2.0 * pairs / count)


@compiled
def _choose_length(discs, numbers):
    """Adapt the length of the horizon to speeds and crowding; search for it the first time."""
    if discs.shape[0] == 0:
        numbers[Number.HORIZON] = LONGEST_HORIZON
        return
    steps = 1
    if numbers[Number.HORIZON] == 0.0:
        numbers[Number.HORIZON] = 1.0
        numbers[Number.CROWDING] = 0.5 * discs.shape[0] / _spread(discs)
        steps = 300
    for _ in range(steps):
        horizon = numbers[Number.HORIZON]
        cost = _cost(discs, numbers, horizon)
        if _cost(discs, numbers, 0.5 * horizon) < cost:
            numbers[Number.HORIZON] = max(0.5 * horizon, SHORTEST_HORIZON)
        elif _cost(discs, numbers, 2.0 * horizon) < cost:
            numbers[Number.HORIZON] = min(2.0 * horizon, LONGEST_HORIZON)
        if numbers[Number.HORIZON] == horizon:
            return


@compiled
def _spread(discs):
    """Area (m²) of a box around all discs, in the first estimate of how crowded they are."""
    left, bottom, right, top = INFINITY, INFINITY, -INFINITY, -INFINITY
    for i in range(discs.shape[0]):
        x, y = discs[i, Disc.OX] + discs[i, Disc.UX], discs[i, Disc.OY] + discs[i, Disc.UY]
        r = discs[i, Disc.RADIUS]
        left, right = min(left, x - r), max(right, x + r)
        bottom, top = min(bottom, y - r), max(top, y + r)
    return (right - left) * (top - bottom)
