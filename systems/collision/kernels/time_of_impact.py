"""The first time at which two discs, or a disc and an obstacle, touch while they approach.

Paths have constant acceleration. The gap of a disc and a straight piece is, by turns, that to one of its ends, to
its flat side or to the other end, as the foot of the perpendicular from the disc's centre goes past the ends.

With d, v, a the relative position, velocity and acceleration, half the squared gap is
    f(s) = (|d + v s + a s²/2|² − R²)/2,   f' = d(s)·v(s),   f'' = v(s)·v(s) + d(s)·a.
All are evaluated along the path, which keeps the digits that expanded coefficients lose.
"""

import math

from pinjoint.systems.collision.columns import EPSILON, REST_HEIGHT, SHARED_END, SHARED_START, SPEED_NOISE, Disc
from pinjoint.systems.collision.kernels import compiled

INFINITY = math.inf
# of a distance: more than that of the sums that tell which discs stay apart, or move far in a step
ROUND_OFF = 1e-9
PLACE_NOISE = 64.0 * EPSILON  # of both positions and paths: discs this near touch
TURN_PRECISION = 1e-10
MOST_ROOT_ITERATIONS = 2200  # what bisection alone needs across all exponents and bits of a double; others: 5


@compiled
def bend(i, discs, time):
    """How place and velocity of a disc in a step of persistent contact differ from those on its parabola; 0 in flight."""
    if discs[i, Disc.STEP] == INFINITY:
        return 0.0, 0.0, 0.0, 0.0
    s = time - discs[i, Disc.EPOCH]
    left = time - discs[i, Disc.STEP]
    x, y = discs[i, Disc.BX] + s * discs[i, Disc.CX], discs[i, Disc.BY] + s * discs[i, Disc.CY]
    place, rate, last = s * s * left, s * (2.0 * left + s), s * s * left
    return place * x, place * y, rate * x + last * discs[i, Disc.CX], rate * y + last * discs[i, Disc.CY]


@compiled
def velocity_at(i, discs, time):
    """Velocity of a disc."""
    s = time - discs[i, Disc.EPOCH]
    vx, vy = discs[i, Disc.VX] + s * discs[i, Disc.AX], discs[i, Disc.VY] + s * discs[i, Disc.AY]
    if discs[i, Disc.STEP] == INFINITY:
        return vx, vy
    _, _, x, y = bend(i, discs, time)
    return vx + x, vy + y


@compiled
def displacement_at(i, discs, time):
    """Displacement of a disc from its original position."""
    s = time - discs[i, Disc.EPOCH]
    ux = discs[i, Disc.UX] + s * (discs[i, Disc.VX] + 0.5 * s * discs[i, Disc.AX])
    uy = discs[i, Disc.UY] + s * (discs[i, Disc.VY] + 0.5 * s * discs[i, Disc.AY])
    if discs[i, Disc.STEP] == INFINITY:
        return ux, uy
    x, y, _, _ = bend(i, discs, time)
    return ux + x, uy + y


@compiled
def rim(i, nx, ny, discs, time):
    """The point of a disc's rim in a direction from its centre."""
    ux, uy = displacement_at(i, discs, time)
    x, y = discs[i, Disc.OX] + ux, discs[i, Disc.OY] + uy
    return x + discs[i, Disc.RADIUS] * nx, y + discs[i, Disc.RADIUS] * ny


@compiled
def relative_motion(discs, i, j, time):
    """Position, velocity and acceleration of disc j relative to disc i at a time, on their parabolas."""
    s = time - discs[i, Disc.EPOCH]
    t = time - discs[j, Disc.EPOCH]
    iax, iay, jax, jay = discs[i, Disc.AX], discs[i, Disc.AY], discs[j, Disc.AX], discs[j, Disc.AY]
    ivx, ivy, jvx, jvy = discs[i, Disc.VX], discs[i, Disc.VY], discs[j, Disc.VX], discs[j, Disc.VY]
    ux = discs[j, Disc.UX] + t * (jvx + 0.5 * t * jax) - (discs[i, Disc.UX] + s * (ivx + 0.5 * s * iax))
    uy = discs[j, Disc.UY] + t * (jvy + 0.5 * t * jay) - (discs[i, Disc.UY] + s * (ivy + 0.5 * s * iay))
    dx = (discs[j, Disc.OX] - discs[i, Disc.OX]) + ux
    dy = (discs[j, Disc.OY] - discs[i, Disc.OY]) + uy
    vx = (jvx + t * jax) - (ivx + s * iax)
    vy = (jvy + t * jay) - (ivy + s * iay)
    return dx, dy, vx, vy, difference(iax, jax), difference(iay, jay)


@compiled
def relative_state(discs, i, j, time):
    """Position and velocity of disc j relative to disc i at a time, on their bent paths."""
    dx, dy, vx, vy, _, _ = relative_motion(discs, i, j, time)
    if discs[i, Disc.STEP] < INFINITY or discs[j, Disc.STEP] < INFINITY:
        ibx, iby, icx, icy = bend(i, discs, time)
        jbx, jby, jcx, jcy = bend(j, discs, time)
        dx, dy, vx, vy = dx + (jbx - ibx), dy + (jby - iby), vx + (jcx - icx), vy + (jcy - icy)
    return dx, dy, vx, vy


@compiled
def is_straight(i, discs):
    """True for an obstacle that has a length."""
    return discs[i, Disc.TX] != 0.0 or discs[i, Disc.TY] != 0.0


@compiled
def smaller_radius(i, j, discs):
    """Radius of the smaller of two discs, or of a disc at an obstacle."""
    return discs[i, Disc.RADIUS] if is_straight(j, discs) else min(discs[i, Disc.RADIUS], discs[j, Disc.RADIUS])


@compiled
def nearest(dx, dy, j, discs):
    """As nearest_of_piece, for disc or obstacle j."""
    return nearest_of_piece(dx, dy, discs[j, Disc.TX], discs[j, Disc.TY])


@compiled
def nearest_of_piece(dx, dy, tx, ty):
    """The vector to the nearest point of a piece from (dx, dy) to (dx + tx, dy + ty).

    And 1 if that is an end, around which the vector turns; 0 on the flat side, of which it is the normal.
    """
    along, squared = -(dx * tx + dy * ty), tx * tx + ty * ty
    if along <= 0.0:
        return dx, dy, 1.0
    if along >= squared:
        return dx + tx, dy + ty, 1.0
    across = (dx * ty - dy * tx) / squared  # the normal is that of the side, exactly
    return across * ty, -across * tx, 0.0


@compiled
def is_shared_end(dx, dy, j, discs):
    """True if the nearest point of obstacle j, with its first end at (dx, dy), is an end that an earlier obstacle shares.

    The earlier obstacle has the same gap then; with both in contact, their forces would not be determined.
    """
    shared = discs[j, Disc.SHARED]
    if shared == 0.0:
        return False
    along = -(dx * discs[j, Disc.TX] + dy * discs[j, Disc.TY])
    if along <= 0.0:
        return shared != SHARED_END
    return shared >= SHARED_END and along >= discs[j, Disc.TX] ** 2 + discs[j, Disc.TY] ** 2


@compiled
def difference(first, second):
    """second − first, and exactly 0 where only round-off distinguishes them: m (g/m) need not be g."""
    if abs(second - first) <= 4.0 * EPSILON * (abs(first) + abs(second)):
        return 0.0
    return second - first


@compiled
def speed_at(discs, i, time):
    """Sum of the components' magnitudes of a disc's velocity."""
    s = time - discs[i, Disc.EPOCH]
    return abs(discs[i, Disc.VX] + s * discs[i, Disc.AX]) + abs(discs[i, Disc.VY] + s * discs[i, Disc.AY])


@compiled
def speed_noise(discs, i, j, time):
    """Relative speed (m/s) that the round-off of the two velocities can feign."""
    present = SPEED_NOISE * (speed_at(discs, i, time) + speed_at(discs, j, time))
    return max(present, discs[i, Disc.NOISE] + discs[j, Disc.NOISE])


@compiled
def pull_noise(discs, i, j):
    """Relative acceleration (m/s²) that the round-off of the two accelerations can feign."""
    total = 0.0
    for disc in (i, j):
        path = abs(discs[disc, Disc.AX]) + abs(discs[disc, Disc.AY])
        total += path + abs(discs[disc, Disc.GX]) + abs(discs[disc, Disc.GY])
    return 2.0 * SPEED_NOISE * total


@compiled
def extent(discs, i, time):
    """Magnitude of the numbers that make up a disc's position: its coordinates and its path since t = 0."""
    place = abs(discs[i, Disc.OX]) + abs(discs[i, Disc.OY]) + abs(discs[i, Disc.UX]) + abs(discs[i, Disc.UY])
    size = discs[i, Disc.RADIUS] + abs(discs[i, Disc.TX]) + abs(discs[i, Disc.TY])
    return place + size + speed_at(discs, i, time) * abs(time)


@compiled
def place_noise(discs, i, j, time):
    """Gap (m) that the round-off of the two positions and of the time can feign."""
    return PLACE_NOISE * (extent(discs, i, time) + extent(discs, j, time))


@compiled
def are_touching(path, i, j, discs, time):
    """True if the gap of two discs is round-off, or none, at a time; `path`: their relative motion then."""
    dx, dy, _, _, _, _ = path
    if discs[i, Disc.STEP] < INFINITY or discs[j, Disc.STEP] < INFINITY:
        dx, dy, _, _ = relative_state(discs, i, j, time)
    dx, dy, _ = nearest(dx, dy, j, discs)
    reach = discs[i, Disc.RADIUS] + discs[j, Disc.RADIUS]
    squared = dx * dx + dy * dy
    if squared > 4.0 * reach * reach:
        return False
    reach += place_noise(discs, i, j, time)
    return squared <= reach * reach


@compiled
def pull_on(discs, i, j):
    """The larger acceleration (m/s²) of two discs without contacts."""
    first = math.hypot(discs[i, Disc.GX], discs[i, Disc.GY])
    return max(first, math.hypot(discs[j, Disc.GX], discs[j, Disc.GY]))


@compiled
def touch_speed(discs, i, j, time):
    """Speed (m/s) at which two discs that touch part by less than round-off before they are pulled back."""
    return math.sqrt(2.0 * pull_on(discs, i, j) * place_noise(discs, i, j, time))


@compiled
def rest_speed(i, j, discs, time):
    """Speed (m/s) of two discs from each other below which they stay in contact: √(2 g h).

    g is the larger acceleration of the two, h the height that is not worth a bounce, REST_HEIGHT radii.
    """
    speed = touch_speed(discs, i, j, time)
    if discs[j, Disc.BOUNCE] < 1.0:
        radius = smaller_radius(i, j, discs)
        speed = max(speed, math.sqrt(2.0 * pull_on(discs, i, j) * REST_HEIGHT * radius))
    return speed


@compiled
def first_approach(path, reach, noise, growth, horizon, overlapping):
    """The least s ≥ 0 at which the distance is at most `reach` and shrinks; INFINITY if there is none.

    path: relative position, velocity and acceleration, as of `relative_motion`. noise + growth × s: speed of
    approach below which it counts as none. horizon: INFINITY may be returned for later times; an earlier time does not
    depend on the horizon, to the last bit. overlapping: the discs overlap from the start and are left alone until they
    have separated.
    """
    dx, dy, vx, vy, ax, ay = path
    if ax == 0.0 and ay == 0.0:
        return _first_on_lines(path, reach, noise, overlapping)
    distance = math.sqrt(dx * dx + dy * dy)
    if _stays_beyond(path, reach + ROUND_OFF * (distance + reach), distance, horizon):
        return INFINITY
    pull = math.sqrt(ax * ax + ay * ay)
    speed = math.sqrt(vx * vx + vy * vy)
    last = (speed + math.sqrt(speed * speed + 2.0 * pull * (distance + reach))) / pull
    return _first_on_parabolas(path, reach, noise * reach, growth * reach, horizon, last, overlapping)


@compiled
def _stays_beyond(path, reach, distance, horizon):
    """True if a line separates two discs until the horizon: one across their line of centres now, or at the end."""
    dx, dy, vx, vy, ax, ay = path
    if _least(distance * distance, dx * vx + dy * vy, dx * ax + dy * ay, horizon) > reach * distance:
        return True
    x, y = dx + horizon * (vx + 0.5 * horizon * ax), dy + horizon * (vy + 0.5 * horizon * ay)
    along = math.sqrt(x * x + y * y)
    return _least(x * dx + y * dy, x * vx + y * vy, x * ax + y * ay, horizon) > reach * along


@compiled
def _least(x, v, a, end):
    """The least of x + v s + a s²/2 for s from 0 to `end`."""
    if v < 0.0 < v + a * end:
        return x - 0.5 * v * v / a
    return min(x, x + end * (v + 0.5 * end * a))


@compiled
def _first_on_lines(path, reach, noise, overlapping):
    """Root of the quadratic; its discriminant |v|²R² − (d×v)² does not cancel for discs far apart."""
    dx, dy, vx, vy, _, _ = path
    approach = dx * vx + dy * vy
    if approach >= -noise * reach:
        return INFINITY
    excess = dx * dx + dy * dy - reach * reach
    if excess <= 0.0:
        return INFINITY if overlapping else 0.0
    passing = dx * vy - dy * vx
    speed_reach = (vx * vx + vy * vy) * reach * reach
    if speed_reach < passing * passing:
        return INFINITY
    return excess / (math.sqrt(speed_reach - passing * passing) - approach)


@compiled
def _first_on_parabolas(path, reach, noise, growth, horizon, last, overlapping):
    """Root of the quartic: between the roots of f'' (a quadratic) f' is monotone, between those of f' f is.

    last: the discs only move apart after it. noise, growth: of f'.
    """
    first_bend, second_bend = _inflections(path)
    start = 0.0
    for piece in range(3):
        end = first_bend if piece == 0 else second_bend if piece == 1 else last
        end = min(end, last)
        if not end > start:
            continue
        slope_start = _slope(path, start)
        slope_end = _slope(path, end)
        turn = end
        if (slope_start < 0.0) != (slope_end < 0.0):
            turn = _turn(path, start, end, slope_end < 0.0)
        if slope_start < 0.0:  # approaching until the turn
            low, high = start, turn
        else:  # approaching after it, if at all
            low, high = turn, end
        approaches = slope_start < -noise - growth * start or slope_end < -noise - growth * end
        if approaches and low < high:
            s = _touch(path, reach, noise, growth, low, high, overlapping)
            if s < INFINITY:
                return s
        start = end
        if start > horizon:
            return INFINITY
    return INFINITY


@compiled
def _inflections(path):
    """The two roots of f'', ascending, or −1 twice: (v·v + d·a) + 3 v·a s + 3/2 a·a s²."""
    dx, dy, vx, vy, ax, ay = path
    c = vx * vx + vy * vy + dx * ax + dy * ay
    b = 1.5 * (vx * ax + vy * ay)
    a = 1.5 * (ax * ax + ay * ay)
    discriminant = b * b - a * c
    if not discriminant > 0.0:
        return -1.0, -1.0
    q = -(b + math.copysign(math.sqrt(discriminant), b))
    first, second = q / a, c / q
    return min(first, second), max(first, second)


@compiled
def _half_gap(path, reach, s):
    dx, dy, vx, vy, ax, ay = path
    x = dx + s * (vx + 0.5 * s * ax)
    y = dy + s * (vy + 0.5 * s * ay)
    return 0.5 * (x * x + y * y - reach * reach)


@compiled
def _slope(path, s):
    dx, dy, vx, vy, ax, ay = path
    x = dx + s * (vx + 0.5 * s * ax)
    y = dy + s * (vy + 0.5 * s * ay)
    return x * (vx + s * ax) + y * (vy + s * ay)


@compiled
def _curvature(path, s):
    dx, dy, vx, vy, ax, ay = path
    x = dx + s * (vx + 0.5 * s * ax)
    y = dy + s * (vy + 0.5 * s * ay)
    wx = vx + s * ax
    wy = vy + s * ay
    return wx * wx + wy * wy + x * ax + y * ay


@compiled
def _turn(path, low, high, falling):
    """Root of f' between low and high, where it is monotone and changes sign: Newton kept in a bracket.

    f hardly changes there, so that a root to TURN_PRECISION of the bracket tells as much as one to the last bit.
    """
    close = TURN_PRECISION * (high - low)
    s = low - _slope(path, low) / _curvature(path, low)
    if not (low < s < high):
        s = 0.5 * (low + high)
    for _ in range(MOST_ROOT_ITERATIONS):
        value = _slope(path, s)
        if (value > 0.0) == falling:
            low = s
        else:
            high = s
        step = -value / _curvature(path, s)
        following = s + step
        if abs(step) <= close:
            return following
        if not (low < following < high):
            following = 0.5 * (low + high)
        if abs(following - s) <= close:
            return following
        s = following
    return s


@compiled
def _fall(path, noise, growth, low, high):
    """The least s from low to high at which f' is below the noise, by bisection; INFINITY if it is nowhere."""
    if _slope(path, low) < -noise - growth * low:
        return low
    if not _slope(path, high) < -noise - growth * high:
        return INFINITY
    for _ in range(MOST_ROOT_ITERATIONS):
        s = 0.5 * (low + high)
        if s in (low, high):
            break
        if _slope(path, s) < -noise - growth * s:
            high = s
        else:
            low = s
    return high


@compiled
def _touch(path, reach, noise, growth, low, high, overlapping):
    """Root of f between low and high, where it falls; if it is negative at `low`, when it falls noticeably."""
    if _half_gap(path, reach, low) <= 0.0:
        return INFINITY if overlapping else _fall(path, noise, growth, low, high)
    if _half_gap(path, reach, high) > 0.0:
        return INFINITY
    s = low
    for _ in range(MOST_ROOT_ITERATIONS):
        value = _half_gap(path, reach, s)
        if value > 0.0:
            low = s
        else:
            high = s
        step = _parabolic_step(value, _slope(path, s), _curvature(path, s))
        following = s + step
        if abs(step) <= EPSILON * abs(s):
            return following
        if not (low < following < high):
            following = 0.5 * (low + high)
        if abs(following - s) <= EPSILON * abs(s) or following in (low, high):
            return following
        s = following
    return s


@compiled
def _parabolic_step(value, slope, curvature):
    """The step to the nearest root of a parabola that falls; that of Newton's method where it has none."""
    discriminant = slope * slope - 2.0 * value * curvature
    if discriminant > 0.0:
        return 2.0 * value / (math.sqrt(discriminant) - slope)
    return -value / slope


# --- a disc and a straight piece ------------------------------------------------------------------------


@compiled
def first_touch(path, tx, ty, shared, reach, noise, growth, horizon, overlapping):
    """As first_approach, for a piece whose first end is on `path` relative to a disc; (tx, ty) is the way to the other.

    shared: ends that another piece accounts for, as in the column SHARED; they are left out.

    The foot of the perpendicular from the disc goes past an end at most four times; in between, the nearest point
    is always on the same end, or always on the flat side.
    """
    dx, dy, vx, vy, ax, ay = path
    if tx == 0.0 and ty == 0.0:
        if shared != 0.0:
            return INFINITY
        return first_approach(path, reach, noise, growth, horizon, overlapping)
    length = math.sqrt(tx * tx + ty * ty)
    nx, ny = ty / length, -tx / length
    foot, foot_v, foot_a = ny * dx - nx * dy, ny * vx - nx * vy, ny * ax - nx * ay
    start = 0.0
    for _ in range(5):
        end = passing(foot, foot_v, foot_a, length, start)
        x, y = dx + start * (vx + 0.5 * start * ax), dy + start * (vy + 0.5 * start * ay)
        u, v = vx + start * ax, vy + start * ay
        middle = 0.5 * (start + end) if end < INFINITY else 2.0 * start + 1.0
        between = foot + middle * (foot_v + 0.5 * middle * foot_a)
        slow = noise + growth * start
        if 0.0 <= between <= length:
            gap_x, speed, pull = nx * x + ny * y, nx * u + ny * v, nx * ax + ny * ay
            s = _first_on_side(gap_x, speed, pull, reach, slow, growth, overlapping)
        elif shared == SHARED_START + SHARED_END or shared == (SHARED_START if between < 0.0 else SHARED_END):
            s = INFINITY
        else:
            if between > length:
                x, y = x + tx, y + ty
            s = first_approach((x, y, u, v, ax, ay), reach, slow, growth, horizon - start, overlapping)
        if s <= end - start:
            return start + s
        start = end
        if start > horizon:
            break
    return INFINITY


@compiled
def passing(foot, speed, pull, length, start):
    """The first time after `start` at which the foot, on a parabola along a piece, passes one of its ends."""
    earliest = INFINITY
    for end in (0.0, length):
        first, second = _roots(foot - end, speed, pull)
        if first > start:
            earliest = min(earliest, first)
        elif second > start:
            earliest = min(earliest, second)
    return earliest


@compiled
def _roots(x, v, a):
    """Where x + v s + a s²/2 changes its sign, ascending; INFINITY for roots that do not exist."""
    if a == 0.0:
        return (-x / v if v != 0.0 else INFINITY), INFINITY
    discriminant = v * v - 2.0 * a * x
    if not discriminant > 0.0:
        return INFINITY, INFINITY
    q = -(v + math.copysign(math.sqrt(discriminant), v))
    first, second = q / a, 2.0 * x / q
    return min(first, second), max(first, second)


@compiled
def _first_on_side(x, v, a, reach, noise, growth, overlapping):
    """The least s ≥ 0 at which |x + v s + a s²/2| is at most `reach` and shrinks; INFINITY if there is none.

    Only the side that the disc is on matters: the disc cannot get to the other one.
    """
    if x < 0.0:
        x, v, a = -x, -v, -a
    gap = x - reach
    if v >= 0.0 and a >= 0.0:
        return INFINITY
    highest = gap if v <= 0.0 or a >= 0.0 else gap - 0.5 * v * v / a
    if highest <= 0.0:
        if overlapping:
            return INFINITY
        if v < -noise:
            return 0.0
        return (v + noise) / (-a - growth) * (1.0 + 8.0 * EPSILON) if a < -growth else INFINITY
    if v >= -noise and a >= -growth:
        return INFINITY
    discriminant = v * v - 2.0 * a * gap
    if discriminant < 0.0:
        return INFINITY
    root = math.sqrt(discriminant)
    return 2.0 * gap / (root - v) if v < 0.0 else (v + root) / -a
