"""Integrators with fixed steps.

Such an integrator says what becomes of each particle `i` as a step begins (`…_begins`), and as it ends (`…_ends`), once
the forces at the new displacement and the predicted velocity are known. In between, `velocity` holds its mean over the
step: with it the work of loads, mean force times displacement, makes the energy that Verlet conserves exact. Any other
integrator is a function in place of `integrate`.
"""

# ruff: noqa: F821, F841
# mypy: ignore-errors


def total_force():
    """ax, ay: the force on a particle with dampers and drag (kN)."""
    ax = force[i, 0]
    ay = force[i, 1]
    if RATES:
        ax += resisting[i, 0]
        ay += resisting[i, 1]


def verlet_begins(i, dt, state, predicted, *columns):
    """x₊ = x + h v + h²/2 a; v* = v + h a; half of the way to v₊."""
    insert(total_force)
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


def verlet_ends(i, dt, state, predicted, *columns):
    """v₊ = v + h/2 (a + a*), a* = a(x₊, v*); dampers and drag are then evaluated at v₊."""
    insert(total_force)
    velocity[i, 0] += 0.5 * dt * (ax * particles_mobility[i, 0])
    velocity[i, 1] += 0.5 * dt * (ay * particles_mobility[i, 1])


def taylor2_begins(i, dt, state, predicted, *columns):
    """The thesis' x₊ = x + v h + a h²/2; v₊ = v + a h."""
    insert(total_force)
    gain_x = 0.5 * dt * (ax * particles_mobility[i, 0])
    gain_y = 0.5 * dt * (ay * particles_mobility[i, 1])
    velocity[i, 0] += gain_x
    velocity[i, 1] += gain_y
    displacement[i, 0] += dt * velocity[i, 0]
    displacement[i, 1] += dt * velocity[i, 1]
    predicted[i, 0] = velocity[i, 0] + gain_x
    predicted[i, 1] = velocity[i, 1] + gain_y


def taylor2_ends(i, dt, state, predicted, *columns):
    """v₊ as predicted; until now v was the mean of the step."""
    velocity[i, 0] = predicted[i, 0]
    velocity[i, 1] = predicted[i, 1]


def euler_begins(i, dt, state, predicted, *columns):
    """v₊ = v + h a(x, v); x₊ = x + h v₊."""
    insert(total_force)
    velocity[i, 0] += dt * (ax * particles_mobility[i, 0])
    velocity[i, 1] += dt * (ay * particles_mobility[i, 1])
    displacement[i, 0] += dt * velocity[i, 0]
    displacement[i, 1] += dt * velocity[i, 1]
    if RATES:
        predicted[i, 0] = velocity[i, 0]
        predicted[i, 1] = velocity[i, 1]


def euler_ends(i, dt, state, predicted, *columns):
    """The step is complete."""


def integrate(steps, first, origin, dt, state, scratch, account, *columns):
    """Take so many steps of length dt (s), the first of which begins `first` steps after the time `origin`."""
    for step in range(1, steps + 1):
        time = origin + (first + step) * dt
        insert(displacement)
        insert(work)
        insert(velocity)
    insert(rest)


def work():
    """The work of varying loads in a step: their mean force times the displacement."""
    began = origin + (first + step - 1) * dt
    before = load_power(began, *moving, *columns)
    after = load_power(time, *moving, *columns)
    account[Account.WORK] += 500.0 * dt * (before + after)


def powers():
    """What each account gains in the step that ends here, by the trapezoidal rule."""
    for k in range(insert(accounts)):
        account[k] += 500.0 * dt * (power[k] + gained[k])
        power[k] = gained[k]


def push(dt, velocity, force, resisting, predicted, particles_mobility):
    """predicted ← the velocities to which the present forces lead in a step."""
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
    steps, fresh, total, first, origin, dt, breaks, loads_end, state, scratch, account, measures, *columns
):
    """Take up to `steps` steps; returns (steps taken, StopReason).

    fresh: the forces are still those of the present state. total: all steps so far. first: steps since
    the time origin. breaks: times at which loads change abruptly, ascending, the last one infinite; a step
    that would pass one is taken in pieces. loads_end: when loads stop to vary (s). The state is checked 1, 2, 4, …
    steps after the origin, because a step that is much too long makes garbage at once, and whenever the total is
    a multiple of CHECK_INTERVAL: at counts that do not depend on how the steps are divided into calls.
    """
    time = origin + first * dt
    if not fresh:
        forces(time, dt, *state, *columns)
        if POWERS:
            resist(time, dt, *placed, *moving, *resisted, direction, power, *columns)
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
            while since - size < time:  # rounded, the piece would seem to begin before a load that jumps
                size -= 2.3e-16 * size
            done = 1 if since == end else 0
        else:
            now, after, since, size = min(steps - taken, steps_to_check(total + taken, age)), age, origin, dt
            if STOPS:
                now = 1
            while now > 1 and origin + (age + now) * dt > breaks[coming]:
                now //= 2
            done = now
        integrate(now, after, since, size, *state, *scratch, account, *columns)
        time = since + (after + now) * size
        if done == 0:
            continue
        taken += done
        age += done
        happening = STOPS and happened(*placed, *moving, *scratch, *columns)
        # The early checks guard whole steps: the energy that Euler conserves is another one in a piece.
        if is_check_due(total + taken, age if after >= 0 else CHECK_INTERVAL):
            measure(*placed, *moving, *pulled, *resisted, measures, *columns)
            ahead = 0.0
            if LOADS:
                push(dt, velocity, force, resisting, predicted, particles_mobility)
                insert(push_turns)
                ahead = 1000.0 * dt * abs(load_power(time, *foreseen, *columns))
            reason = judge(measures, account, dt, SHADOW, ahead, time >= loads_end)
            if reason != StopReason.DONE:
                return taken, reason.value
        if (total + taken) % REVIEW_INTERVAL == 0:
            return taken, StopReason.REVIEW.value
        if happening:
            return taken, StopReason.EVENT.value
    return taken, StopReason.DONE.value
