"""Drivers with fixed steps, as source: the step program is written around them and compiled as one module.

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


def velocity_verlet(
    steps,
    first,
    origin,
    dt,
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
):
    """x₊ = x + h v + h²/2 a; v* = v + h a; a* = a(x₊, v*); v₊ = v + h/2 (a + a*); a₊ = a(x₊, v₊)."""
    half = 0.5 * dt
    for step in range(1, steps + 1):
        time = origin + (first + step) * dt
        for i in range(displacement.shape[0]):
            ax = force[i, 0]
            ay = force[i, 1]
            if RATES:
                ax += resisting[i, 0]
                ay += resisting[i, 1]
            ax *= particles_mobility[i, 0]
            ay *= particles_mobility[i, 1]
            vx = velocity[i, 0]
            vy = velocity[i, 1]
            hx = vx + half * ax
            hy = vy + half * ay
            displacement[i, 0] += dt * hx
            displacement[i, 1] += dt * hy
            velocity[i, 0] = hx
            velocity[i, 1] = hy
            if RATES:
                predicted[i, 0] = vx + dt * ax
                predicted[i, 1] = vy + dt * ay
        if LOADS:
            enter_loads(origin + (first + step - 1) * dt, time, dt, velocity, account, *columns)
        accept(time, dt, displacement, predicted, force, resisting, direction, account, *columns)
        for i in range(displacement.shape[0]):
            ax = force[i, 0]
            ay = force[i, 1]
            if RATES:
                ax += resisting[i, 0]
                ay += resisting[i, 1]
            velocity[i, 0] += half * (ax * particles_mobility[i, 0])
            velocity[i, 1] += half * (ay * particles_mobility[i, 1])
        if POWERS:
            enter_powers(
                time, dt, displacement, velocity, resisting, direction, power, gained, account, *columns
            )


def taylor2(
    steps,
    first,
    origin,
    dt,
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
):
    """The thesis' x += v h + a h²/2, v += a h."""
    half = 0.5 * dt
    for step in range(1, steps + 1):
        time = origin + (first + step) * dt
        for i in range(displacement.shape[0]):
            ax = force[i, 0]
            ay = force[i, 1]
            if RATES:
                ax += resisting[i, 0]
                ay += resisting[i, 1]
            ax *= particles_mobility[i, 0]
            ay *= particles_mobility[i, 1]
            velocity[i, 0] += half * ax
            velocity[i, 1] += half * ay
            displacement[i, 0] += dt * velocity[i, 0]
            displacement[i, 1] += dt * velocity[i, 1]
        if LOADS:
            enter_loads(origin + (first + step - 1) * dt, time, dt, velocity, account, *columns)
        for i in range(displacement.shape[0]):
            ax = force[i, 0]
            ay = force[i, 1]
            if RATES:
                ax += resisting[i, 0]
                ay += resisting[i, 1]
            velocity[i, 0] += half * (ax * particles_mobility[i, 0])
            velocity[i, 1] += half * (ay * particles_mobility[i, 1])
        accept(time, dt, displacement, velocity, force, resisting, direction, account, *columns)
        if POWERS:
            enter_powers(
                time, dt, displacement, velocity, resisting, direction, power, gained, account, *columns
            )


def semi_implicit_euler(
    steps,
    first,
    origin,
    dt,
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
):
    """v += h a(x, v); x += h v."""
    for step in range(1, steps + 1):
        time = origin + (first + step) * dt
        for i in range(displacement.shape[0]):
            ax = force[i, 0]
            ay = force[i, 1]
            if RATES:
                ax += resisting[i, 0]
                ay += resisting[i, 1]
            ax *= particles_mobility[i, 0]
            ay *= particles_mobility[i, 1]
            velocity[i, 0] += dt * ax
            velocity[i, 1] += dt * ay
            displacement[i, 0] += dt * velocity[i, 0]
            displacement[i, 1] += dt * velocity[i, 1]
        if LOADS:
            enter_loads(origin + (first + step - 1) * dt, time, dt, velocity, account, *columns)
        accept(time, dt, displacement, velocity, force, resisting, direction, account, *columns)
        if POWERS:
            enter_powers(
                time, dt, displacement, velocity, resisting, direction, power, gained, account, *columns
            )


def enter_loads(before, after, dt, velocity, account, *columns):
    """The work of varying loads from a time to another, `dt` later (s), at the step's mean velocity."""
    power = load_power(before, velocity, *columns)
    account[0] += 500.0 * dt * (power + load_power(after, velocity, *columns))


def enter_powers(time, dt, displacement, velocity, resisting, direction, power, gained, account, *columns):
    """What each account gains in the step that ends here, by the trapezoidal rule; dampers and drag anew."""
    resist(time, dt, displacement, velocity, resisting, direction, gained, *columns)
    for k in range(power.shape[0]):
        account[k] += 500.0 * dt * (power[k] + gained[k])
        power[k] = gained[k]


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
                ahead = 1000.0 * dt * abs(load_power(time, velocity, *columns))
            reason = judge(measures, account, dt, SHADOW, ahead, time >= loads_end)
            if reason != 0:
                return taken, reason
        if (total + taken) % REVIEW_INTERVAL == 0:
            return taken, 1
    return taken, 0
