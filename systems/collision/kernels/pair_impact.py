"""The impact of two discs that fly, touch nothing else and part at once: what most events of a gas are.

By Newton's law, to the bits of the general way (flight.py, impact.py), which first gathers all discs that touch, then
looks for forces between them, and takes twice as long. It is tried first; where it turns out that one of the two
touches a third disc, or that they stay in contact, nothing has happened.
"""

import math

from pinjoint.systems.collision.columns import NONE, SPEED_NOISE, Count, Disc, Number, Reason
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.grid import enclose_anew, neighbours
from pinjoint.systems.collision.kernels.heap import drop_first, queue_impact
from pinjoint.systems.collision.kernels.horizon import impact_on
from pinjoint.systems.collision.kernels.persistent_contact import is_held
from pinjoint.systems.collision.kernels.pile import begin_steps, crowded, enter_impact
from pinjoint.systems.collision.kernels.time_of_impact import (
    INFINITY,
    are_touching,
    displacement_at,
    nearest,
    relative_motion,
    rest_speed,
    rim,
    speed_at,
)


@compiled
def strike(i, j, discs, grid, constraints, queue, report, numbers, counts):
    """Let the first impact of the queue, of i and j, happen if it is such a one; otherwise return GO_ON.

    Returns a Reason.
    """
    if discs[i, Disc.STEP] < INFINITY or discs[j, Disc.STEP] < INFINITY:
        return Reason.GO_ON
    if constraints.first_persistent[i] != NONE or constraints.first_persistent[j] != NONE:
        return Reason.GO_ON
    if counts[Count.REPORTED] == report.shape[0]:
        return Reason.REPORT_FULL
    now = numbers[Number.NOW]
    nx, ny, before, impulse, slow = _newton(i, j, discs, numbers)
    if impulse == 0.0:
        return Reason.GO_ON
    place, old, other = rim(i, nx, ny, discs, now), _path(i, discs), _path(j, discs)
    vx, vy = _pushed(i, -impulse, nx, ny, discs, now)
    ux, uy = _pushed(j, impulse, nx, ny, discs, now)
    after = nx * (ux - vx) + ny * (uy - vy)
    meets, all_meets = NONE, NONE
    if after > slow:
        fits = _redirect(i, vx, vy, impulse, discs, grid, numbers, counts)
        fits = _redirect(j, ux, uy, impulse, discs, grid, numbers, counts) and fits
        if fits:
            meets = _impacts_of(i, j, 0, discs, grid, constraints, numbers, counts)
        if meets != NONE:
            all_meets = _impacts_of(j, i, meets, discs, grid, constraints, numbers, counts)
        if all_meets == NONE:
            _restore(i, old, discs, grid, numbers, counts)
            _restore(j, other, discs, grid, numbers, counts)
    if all_meets == NONE:
        return Reason.GO_ON
    drop_first(queue, counts)
    counts[Count.EVENTS] += 1
    loss = -0.5 * impulse * (before + after)
    numbers[Number.LOSS] += loss
    enter_impact(i, j, now, impulse, loss, place, report, counts)
    if crowded(1, numbers, counts):
        begin_steps(numbers, counts)
    for k in range(all_meets):
        disc, met = i if k < meets else j, grid.found[k]
        if not queue_impact(grid.times[k], min(disc, met), max(disc, met), discs, queue, counts):
            counts[Count.RENEW] = 1
            return Reason.QUEUE_FULL
    return Reason.DONE


@compiled
def _newton(i, j, discs, numbers):
    """Unit vector from i to j, rate at which the gap opens, impulse (0: none worth it), and speed that counts as none."""
    now = numbers[Number.NOW]
    dx, dy, vx, vy, _, _ = relative_motion(discs, i, j, now)
    dx, dy, _ = nearest(dx, dy, j, discs)
    distance = math.sqrt(dx * dx + dy * dy)
    if distance == 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    nx, ny = dx / distance, dy / distance
    rate = nx * vx + ny * vy
    slow, bounce = rest_speed(i, j, discs, now), discs[j, Disc.BOUNCE]
    compliance = discs[i, Disc.WX] * nx * nx + discs[i, Disc.WY] * ny * ny
    compliance += discs[j, Disc.WX] * nx * nx + discs[j, Disc.WY] * ny * ny
    if rate >= -slow or compliance == 0.0:
        return nx, ny, rate, 0.0, 0.0
    noise = 2.0 * SPEED_NOISE * max(speed_at(discs, i, now), speed_at(discs, j, now))
    return nx, ny, rate, -(1.0 + bounce) * rate / compliance, max(4.0 * noise, slow)


@compiled
def _pushed(i, impulse, nx, ny, discs, now):
    """Velocity of a disc after an impulse along (nx, ny)."""
    s = now - discs[i, Disc.EPOCH]
    vx, vy = discs[i, Disc.VX] + s * discs[i, Disc.AX], discs[i, Disc.VY] + s * discs[i, Disc.AY]
    return vx + discs[i, Disc.WX] * (nx * impulse), vy + discs[i, Disc.WY] * (ny * impulse)


@compiled
def _path(i, discs):
    """What an impact changes of the path of a disc."""
    ux, uy, vx, vy = discs[i, Disc.UX], discs[i, Disc.UY], discs[i, Disc.VX], discs[i, Disc.VY]
    return ux, uy, vx, vy, discs[i, Disc.AX], discs[i, Disc.AY], discs[i, Disc.EPOCH], discs[i, Disc.NOISE]


@compiled
def _redirect(i, vx, vy, impulse, discs, grid, numbers, counts):
    """Start a new path of a disc now, unless it is held. False if its box does not fit into the grid."""
    if is_held(i, discs):
        return True
    now = numbers[Number.NOW]
    ux, uy = displacement_at(i, discs, now)
    discs[i, Disc.UX], discs[i, Disc.UY], discs[i, Disc.VX], discs[i, Disc.VY] = ux, uy, vx, vy
    discs[i, Disc.AX], discs[i, Disc.AY], discs[i, Disc.EPOCH] = discs[i, Disc.GX], discs[i, Disc.GY], now
    for d in range(2):
        discs[i, Disc.BX + d], discs[i, Disc.CX + d] = 0.0, 0.0
    change = impulse * max(discs[i, Disc.WX], discs[i, Disc.WY])
    discs[i, Disc.NOISE] = SPEED_NOISE * (abs(vx) + abs(vy)) + SPEED_NOISE * change
    discs[i, Disc.CHANGES] += 1.0
    return enclose_anew(i, discs, grid, numbers, counts)


@compiled
def _restore(i, old, discs, grid, numbers, counts):
    """Put a disc back on the path that it was on."""
    if not is_held(i, discs):
        ux, uy, vx, vy, ax, ay, epoch, noise = old
        discs[i, Disc.UX], discs[i, Disc.UY], discs[i, Disc.VX], discs[i, Disc.VY] = ux, uy, vx, vy
        discs[i, Disc.AX], discs[i, Disc.AY], discs[i, Disc.EPOCH], discs[i, Disc.NOISE] = ax, ay, epoch, noise
        discs[i, Disc.CHANGES] -= 1.0
        enclose_anew(i, discs, grid, numbers, counts)


@compiled
def _impacts_of(i, j, count, discs, grid, constraints, numbers, counts):
    """Find the next impacts of i, after the first `count` in `found` and `times`; returns how many there are then.

    NONE if i touches another disc than j. The impact of i and j is found once.
    """
    if is_held(i, discs):
        return count
    now, end = numbers[Number.NOW], numbers[Number.HORIZON_END]
    near = neighbours(i, grid, counts[Count.LAYERS], count)
    for k in range(count, near):
        met = grid.found[k]
        first, second = min(i, met), max(i, met)
        path = relative_motion(discs, first, second, now)
        if met == j and i > j and not is_held(j, discs):
            continue
        if met != j and are_touching(path, first, second, discs, now):
            return NONE
        time = impact_on(path, first, second, now, discs, constraints, end)
        if time <= end:
            grid.found[count], grid.times[count] = met, time
            count += 1
    return count
