"""Drivers with fixed steps, as source: the step program is written around them and compiled as one module.

An integrator of plain steps says what becomes of each particle `i` as a step begins, and as it ends, once there
are forces at the new displacement and the predicted velocity. It leaves in `velocity` its mean over the step
until the end. Any other is a function `integrate` and what it calls.

In this source `*columns` stands for the flat list of the model's columns (particles_mobility,
particles_mass, … can therefore be used by name), which the program writer puts in: arrays in tuples cost
twice as much per step in small models. Provided by the program are

    forces(time, dt, displacement, velocity, force, resisting, direction, *columns)
        force ← loads, environment and rods without dampers (kN); resisting ← dampers and drag;
        direction ← unit vectors of the rods
    accept(time, dt, displacement, velocity, force, resisting, direction, account, *columns)
        the same at an accepted state: commits history first
    resist(time, dt, displacement, velocity, resisting, direction, power, *columns)
        resisting ← dampers and drag at another velocity; power ← what each account gains (kN·m/s)
    load_power(time, velocity, *columns)
        what the varying loads of that time do per second at a velocity (kN·m/s)

and the constants RATES (something depends on velocity), POWERS (some account gains by the step) and LOADS
(some load varies). `account` holds the accounts of systems.base.ACCOUNTS first, in J. The work of loads is
their mean force times the displacement of the step: with it the energy that Verlet conserves is exact.
"""

# ruff: noqa: F821
# mypy: ignore-errors


def verlet_begins(i, dt, displacement, velocity, force, resisting, predicted, *columns):
    """x₊ = x + h v + h²/2 a; v* = v + h a; half of the way to v₊."""
    ax = force[i, 0]
    ay = force[i, 1]
    if RATES:
        ax += resisting[i, 0]
        ay += resisting[i, 1]
    ax *= particles_mobility[i, 0]
    ay *= particles_mobility[i, 1]
    vx = velocity[i, 0]
    vy = velocity[i, 1]
    hx = vx + 0.5 * dt * ax
    hy = vy + 0.5 * dt * ay
    displacement[i, 0] += dt * hx
    displacement[i, 1] += dt * hy
    velocity[i, 0] = hx
    velocity[i, 1] = hy
    if RATES:
        predicted[i, 0] = vx + dt * ax
        predicted[i, 1] = vy + dt * ay


def verlet_ends(i, dt, displacement, velocity, force, resisting, predicted, *columns):
    """v₊ = v + h/2 (a + a*), a* = a(x₊, v*); dampers and drag are then evaluated at v₊."""
    ax = force[i, 0]
    ay = force[i, 1]
    if RATES:
        ax += resisting[i, 0]
        ay += resisting[i, 1]
    velocity[i, 0] += 0.5 * dt * (ax * particles_mobility[i, 0])
    velocity[i, 1] += 0.5 * dt * (ay * particles_mobility[i, 1])


def taylor2_begins(i, dt, displacement, velocity, force, resisting, predicted, *columns):
    """The thesis' x₊ = x + v h + a h²/2; v₊ = v + a h."""
    ax = force[i, 0]
    ay = force[i, 1]
    if RATES:
        ax += resisting[i, 0]
        ay += resisting[i, 1]
    gain_x = 0.5 * dt * (ax * particles_mobility[i, 0])
    gain_y = 0.5 * dt * (ay * particles_mobility[i, 1])
    velocity[i, 0] += gain_x
    velocity[i, 1] += gain_y
    displacement[i, 0] += dt * velocity[i, 0]
    displacement[i, 1] += dt * velocity[i, 1]
    predicted[i, 0] = velocity[i, 0] + gain_x
    predicted[i, 1] = velocity[i, 1] + gain_y


def taylor2_ends(i, dt, displacement, velocity, force, resisting, predicted, *columns):
    """v₊ as predicted; until now v was the mean of the step."""
    velocity[i, 0] = predicted[i, 0]
    velocity[i, 1] = predicted[i, 1]


def euler_begins(i, dt, displacement, velocity, force, resisting, predicted, *columns):
    """v₊ = v + h a(x, v); x₊ = x + h v₊."""
    ax = force[i, 0]
    ay = force[i, 1]
    if RATES:
        ax += resisting[i, 0]
        ay += resisting[i, 1]
    velocity[i, 0] += dt * (ax * particles_mobility[i, 0])
    velocity[i, 1] += dt * (ay * particles_mobility[i, 1])
    displacement[i, 0] += dt * velocity[i, 0]
    displacement[i, 1] += dt * velocity[i, 1]
    if RATES:
        predicted[i, 0] = velocity[i, 0]
        predicted[i, 1] = velocity[i, 1]


def euler_ends(i, dt, displacement, velocity, force, resisting, predicted, *columns):
    """Nothing is left to do."""


def push(dt, velocity, force, resisting, predicted, *columns):
    """The velocities to which the present forces lead in a step."""
    for i in range(velocity.shape[0]):
        for d in range(2):
            total = force[i, d] + resisting[i, d] if RATES else force[i, d]
            predicted[i, d] = velocity[i, d] + dt * total * particles_mobility[i, d]


def is_check_due(total, age):
    """Whether a state is checked: at every multiple of CHECK_INTERVAL, before it at powers of 2."""
    return total % CHECK_INTERVAL == 0 or (age < CHECK_INTERVAL and age & (age - 1) == 0)


def steps_to_check(total, age):
    """Steps to the next state that is checked, at most."""
    if age >= CHECK_INTERVAL:
        return CHECK_INTERVAL - total % CHECK_INTERVAL
    doubled = 1
    while doubled <= age:
        doubled *= 2
    return min(CHECK_INTERVAL - total % CHECK_INTERVAL, doubled - age)


def advance(
    steps,
    fresh,
    total,
    first,
    origin,
    dt,
    breaks,
    loads_end,
    displacement,
    velocity,
    force,
    resisting,
    direction,
    predicted,
    power,
    gained,
    account,
    measures,
    *columns,
):
    """Take up to `steps` steps; returns (steps taken, StopReason).

    fresh: the forces are still those of the present state. total: all steps so far. first: steps since
    the time origin. breaks: times at which loads change abruptly, ascending, the last one infinite; a step
    that would pass one is taken in pieces. Checks happen 1, 2, 4, … steps after the origin, for a step that
    is much too long makes garbage at once, and whenever the total is a multiple of CHECK_INTERVAL: at counts
    that do not depend on how the steps are divided into calls.
    """
    time = origin + first * dt
    if not fresh:
        forces(time, dt, displacement, velocity, force, resisting, direction, *columns)
        if POWERS:
            resist(time, dt, displacement, velocity, resisting, direction, power, *columns)
    taken = 0
    coming = 0
    while taken < steps:
        age = first + taken
        while breaks[coming] <= time:
            coming += 1
        end = origin + (age + 1) * dt
        if breaks[coming] < end or time > origin + age * dt:  # a piece of a step, ending at `since`
            now, after, since = 1, -1, min(end, breaks[coming])
            size = since - time
            while since - size < time:  # by rounding: the piece would seem to begin before a load that jumps
                size -= 2.3e-16 * size
            done = 1 if since == end else 0
        else:
            now, after, since, size = min(steps - taken, steps_to_check(total + taken, age)), age, origin, dt
            while now > 1 and origin + (age + now) * dt > breaks[coming]:
                now //= 2
            done = now
        integrate(
            now,
            after,
            since,
            size,
            displacement,
            velocity,
            force,
            resisting,
            direction,
            predicted,
            power,
            gained,
            account,
            *columns,
        )
        time = since + (after + now) * size
        if done == 0:
            continue
        taken += done
        age += done
        # The early checks guard whole steps: the energy that Euler conserves is another one in a piece.
        if is_check_due(total + taken, age if after >= 0 else CHECK_INTERVAL):
            measure(displacement, velocity, force, resisting, measures, *columns)
            ahead = 0.0
            if LOADS:
                push(dt, velocity, force, resisting, predicted, *columns)
                ahead = 1000.0 * dt * abs(load_power(time, predicted, *columns))
            reason = judge(measures, account, dt, SHADOW, ahead, time >= loads_end)
            if reason != 0:
                return taken, reason
        if (total + taken) % REVIEW_INTERVAL == 0:
            return taken, 1
    return taken, 0
