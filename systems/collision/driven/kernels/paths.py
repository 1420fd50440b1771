"""Paths in a step: foreseen ones, which pairs must be listed for them, and the first impact on them."""

import math

from pinjoint.systems.base import StopReason
from pinjoint.systems.collision.columns import EPSILON, SPEED_NOISE, TINY
from pinjoint.systems.collision.driven.columns import Real, Whole
from pinjoint.systems.collision.driven.kernels.pairs import gap_of, opening
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.projection import copy_motion
from pinjoint.systems.collision.kernels.time_of_impact import INFINITY, ROUND_OFF, first_touch
from pinjoint.systems.program.entries import Control

TOUCHING_GAP = 1e-12  # of the reach of two particles, below which they touch
DOUBT = 1e-3  # of a radius, by which a path may differ from a parabola where particles collide
CUBIC_DEVIATION = 0.15  # of h |Δv|: distance of a cubic path from the parabola through its ends (4/27)
DOUBTFUL = -1.0  # instead of a time of impact
SQUARE = 0.7  # of a radius: half the side of a square that fits into a circle
AHEAD = 4.0  # times the speeds of now that those of the next step, if it is foreseen, may reach
SAFE = 8.0  # times the speeds and accelerations of now that those of clear steps may reach
FEWEST_CLEAR, MOST_CLEAR = 4, 256  # clear steps at once
OVERLAP = 1e-9  # of the reach of two nodes; a larger overlap at the start of a step is older than the run


@compiled
def keep_state(driven, control, account, place, speed, near_alone):
    """Keep the state in which a step begins. near_alone: of the particles only those that are near others."""
    if near_alone:
        for p in range(driven.whole[Whole.NEAR]):
            i = driven.near[p]
            for d in range(2):
                driven.before[i, d] = place[i, d]
                driven.velocity[i, d] = speed[i, d]
    else:
        copy_motion(place, driven.before, place.shape[0])
        copy_motion(speed, driven.velocity, place.shape[0])
    for k in range(control.shape[0]):
        driven.kept[k] = control[k]
    for k in range(account.shape[0]):
        driven.kept[control.shape[0] + k] = account[k]
    driven.whole[Whole.KEPT_TOTAL] = driven.whole[Whole.TOTAL]
    driven.whole[Whole.KEPT_SINCE] = driven.whole[Whole.SINCE]
    driven.real[Real.KEPT_ORIGIN] = driven.real[Real.ORIGIN]


@compiled
def take_back(driven, control, account, place, speed):
    """Put back the state in which the step begins, if the step was taken."""
    whole = driven.whole
    if whole[Whole.FORESEEN]:
        return
    copy_motion(driven.before, place, place.shape[0])
    copy_motion(driven.velocity, speed, place.shape[0])
    for k in range(control.shape[0]):
        control[k] = driven.kept[k]
    for k in range(account.shape[0]):
        account[k] = driven.kept[control.shape[0] + k]
    whole[Whole.TOTAL], whole[Whole.SINCE] = whole[Whole.KEPT_TOTAL], whole[Whole.KEPT_SINCE]
    driven.real[Real.ORIGIN] = driven.real[Real.KEPT_ORIGIN]
    whole[Whole.REASON] = StopReason.DONE
    whole[Whole.BACK] = 1
    whole[Whole.PUSHED] = 1
    whole[Whole.FRESH] = 1


@compiled
def foresee(driven, control):
    """Fill in where a step leads from the accelerations at its start and the contact forces; see Integrator.push."""
    real = driven.real
    start = real[Real.START]
    h = control[Control.STEP_SIZE] if real[Real.END] == math.inf else real[Real.END] - start
    real[Real.NOW] = start + h
    push = real[Real.PUSH] * h
    before, velocity, ahead, ahead_speed = driven.before, driven.velocity, driven.ahead, driven.ahead_speed
    acceleration, weight, support = driven.acceleration, driven.weight, driven.support
    for p in range(driven.whole[Whole.NEAR]):
        i = driven.near[p]
        for d in range(2):
            a = acceleration[i, d] + 1000.0 * weight[i, d] * support[i, d]
            ahead[i, d] = before[i, d] + h * (velocity[i, d] + push * a)
            ahead_speed[i, d] = velocity[i, d] + h * a


@compiled
def plan_clear_steps(driven, control, place, speed):
    """Plan steps in which nothing can meet, as no pair is listed; False if they are too few to be worth it.

    Particles are taken to go SAFE times as far as their speeds and accelerations now say.
    """
    whole, real = driven.whole, driven.real
    room, fastest, strongest = math.inf, 0.0, 0.0
    for i in range(place.shape[0]):
        x, y = place[i, 0] - driven.listed[i, 0], place[i, 1] - driven.listed[i, 1]
        room = min(room, SQUARE * driven.margin[i] - math.sqrt(x * x + y * y))
        fastest = max(fastest, speed[i, 0] * speed[i, 0] + speed[i, 1] * speed[i, 1])
        ax, ay = driven.acceleration[i, 0], driven.acceleration[i, 1]
        strongest = max(strongest, ax * ax + ay * ay)
    fastest, strongest, room = SAFE * math.sqrt(fastest), SAFE * math.sqrt(strongest), 0.5 * room
    if not room > 0.0:
        return False
    start = control[Control.TIME]
    time = 2.0 * room / (fastest + math.sqrt(fastest * fastest + 2.0 * strongest * room) + TINY)
    time = min(time, real[Real.BREAK] - start, MOST_CLEAR * control[Control.STEP_SIZE])
    if time < FEWEST_CLEAR * control[Control.STEP_SIZE]:
        return False
    whole[Whole.STEPS] = min(whole[Whole.WANTED] - (whole[Whole.TOTAL] - whole[Whole.FIRST]), MOST_CLEAR)
    real[Real.END] = math.inf
    real[Real.BY] = min(real[Real.UNTIL], start + time)
    real[Real.ROOM], real[Real.FASTEST] = room, fastest + time * strongest
    return True


@compiled
def went_too_far(driven, place, speed):
    """True if in steps that were planned as clear a particle went farther, or became faster, than was allowed for."""
    room, fastest = driven.real[Real.ROOM], driven.real[Real.FASTEST]
    for i in range(place.shape[0]):
        x, y = place[i, 0] - driven.before[i, 0], place[i, 1] - driven.before[i, 1]
        vx, vy = speed[i, 0], speed[i, 1]
        if x * x + y * y > room * room or vx * vx + vy * vy > fastest * fastest:
            return True
    return False


@compiled
def span_to_list(driven, h, after, later):
    """The margin within which pairs must be listed for a step of h seconds (m), or 0 where the list is complete.

    path_error ← bounds of the distance of paths from the parabolas that `first_impact` assumes.
    """
    before, velocity = driven.before, driven.velocity
    turn, most, travel = 0.0, 0.0, 0.0
    for i in range(before.shape[0]):
        x, y = after[i, 0] - before[i, 0], after[i, 1] - before[i, 1]
        tx, ty = later[i, 0] - velocity[i, 0], later[i, 1] - velocity[i, 1]
        travel = max(travel, x * x + y * y)
        turn = max(turn, tx * tx + ty * ty)
        bx = h * (later[i, 0] + velocity[i, 0]) - 2.0 * x
        by = h * (later[i, 1] + velocity[i, 1]) - 2.0 * y
        driven.path_error[i] = CUBIC_DEVIATION * math.sqrt(bx * bx + by * by)
        most = max(most, driven.path_error[i])
    swing = (h * math.sqrt(turn) + 4.0 * most) * (1.0 + ROUND_OFF)
    outside = 0
    for i in range(before.shape[0]):
        room = SQUARE * driven.margin[i] - swing
        x, y = abs(after[i, 0] - driven.listed[i, 0]), abs(after[i, 1] - driven.listed[i, 1])
        outside += 1 if x > room or y > room else 0
    if outside == 0:
        return 0.0
    return math.sqrt(travel) * (1.0 + ROUND_OFF) + swing


@compiled
def foreseen_span(driven, h, place, speed):
    """As span_to_list(), before a step that is foreseen.

    Particles are taken to go AHEAD times as far as their speeds say.
    """
    listed, margin, outside, far = driven.listed, driven.margin, 0, AHEAD * h
    for i in range(place.shape[0]):
        room = SQUARE * margin[i]
        x = abs(place[i, 0] - listed[i, 0]) + far * abs(speed[i, 0])
        y = abs(place[i, 1] - listed[i, 1]) + far * abs(speed[i, 1])
        outside += 1 if x > room or y > room else 0
    if outside == 0:
        return 0.0
    fastest = 0.0
    for i in range(place.shape[0]):
        fastest = max(fastest, speed[i, 0] * speed[i, 0] + speed[i, 1] * speed[i, 1])
    return 2.0 * far * math.sqrt(fastest) + TINY


@compiled
def is_left_alone(driven, k):
    """True for nodes that overlapped as the step began; they collide once they have separated."""
    i, j = driven.pairs[k, 0], driven.pairs[k, 1]
    if not (driven.node[i] and driven.node[j]):
        return False
    gap, _, _ = gap_of(i, j, driven.position, driven.before, driven.radius, driven.span)
    return gap < -OVERLAP * (driven.radius[i] + driven.radius[j])


@compiled
def first_impact(driven, h, after):
    """Time in a step of h seconds at which a pair first touches while it approaches; INFINITY for none, or DOUBTFUL.

    Paths are the parabolas through the displacements before and after that begin with the velocity: exact for
    velocity Verlet, with an error of at most `path_error` (m) for other integrators. The time is doubtful if a watched
    pair comes so near that this error could hide an impact, and the error exceeds DOUBT of its size.
    """
    earliest, fastest = INFINITY, 0.0
    for m in range(driven.whole[Whole.NEAR]):
        i = driven.near[m]
        fastest = max(fastest, abs(driven.velocity[i, 0]) + abs(driven.velocity[i, 1]))
    # a joint impact leaves approaches as slow as that in a row, of however slow a pair
    noise = 2.0 * SPEED_NOISE * fastest
    for k in range(driven.whole[Whole.LISTED]):
        if driven.lasting[k] == 0:
            earliest = min(earliest, _impact_of(driven, k, h, after, noise))
            if earliest == DOUBTFUL:
                break
    return earliest if earliest <= h else INFINITY


@compiled
def _impact_of(driven, k, h, after, noise):
    """As first_impact(), of one pair; noise: speed of approach (m/s) that counts as none."""
    i, j = driven.pairs[k, 0], driven.pairs[k, 1]
    position, before, velocity, size = driven.position, driven.before, driven.velocity, driven.size
    alone = j >= before.shape[0]
    overlapping = is_left_alone(driven, k)
    if driven.whole[Whole.FORESEEN] == 0 and not overlapping:
        doubt = driven.path_error[i] if alone else driven.path_error[i] + driven.path_error[j]
        if doubt > DOUBT * min(size[i], size[j]):
            first, _, _ = gap_of(i, j, position, before, driven.radius, driven.span)
            last, _, _ = gap_of(i, j, position, after, driven.radius, driven.span)
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
    reach = driven.radius[i] + driven.radius[j]
    tx, ty = driven.span[j, 0], driven.span[j, 1]
    if tx == 0.0 and ty == 0.0 and not overlapping:  # too far to meet in this step?
        mx, my = ux - sx, uy - sy
        far = reach + abs(mx) + abs(my) + abs(h * vx - mx) + abs(h * vy - my)
        if dx * dx + dy * dy > far * far * (1.0 + ROUND_OFF):
            return INFINITY
    ax, ay = 2.0 * ((ux - sx) / h - vx) / h, 2.0 * ((uy - sy) / h - vy) / h
    if abs(ax) + abs(ay) <= 64.0 * EPSILON * (away / h + moving) / h:
        ax, ay = 0.0, 0.0
    growth = SPEED_NOISE * (abs(ax) + abs(ay))
    path = (dx, dy, vx, vy, ax, ay)
    return first_touch(path, tx, ty, 0.0, reach, noise, growth, h, overlapping)


@compiled
def meeting(driven, after, later):
    """How late (s) the end of the step is for the pair that met first, or is to meet first; its gap, 0 if it touches.

    The gap, or overlap, is a share of the smaller radius.
    """
    latest, missed = -math.inf, math.inf
    for k in range(driven.whole[Whole.LISTED]):
        if driven.lasting[k] == 1 or is_left_alone(driven, k):
            continue
        i, j = driven.pairs[k, 0], driven.pairs[k, 1]
        gap, nx, ny = gap_of(i, j, driven.position, after, driven.radius, driven.span)
        rate = opening(i, j, nx, ny, later)
        late = gap / rate if rate < 0.0 else -math.inf
        if late > latest:
            latest = late
            touches = abs(gap) <= touching_gap(driven, i, j, after)
            missed = 0.0 if touches else abs(gap) / min(driven.size[i], driven.size[j])
    return latest, missed


@compiled
def touching_gap(driven, i, j, place):
    """The gap (m) below which a pair touches: more where places are so large that gaps are rounded by more."""
    far = abs(driven.position[i, 0] + place[i, 0]) + abs(driven.position[i, 1] + place[i, 1])
    return max(TOUCHING_GAP * (driven.radius[i] + driven.radius[j]), EPSILON * far)
