"""Integrators with fixed steps.

Such an integrator says what becomes of each particle `i` as a step begins (`…_begins`), and as it ends (`…_ends`), once
the forces at the new displacement and the predicted velocity are known. In between, `velocity` holds its mean over the
step: with it the work of loads, mean force times displacement, makes the energy that Verlet conserves exact.
"""

# ruff: noqa: F821, F841
# mypy: ignore-errors


def total_force():
    """The force on a particle with dampers and drag (kN), along one of its coordinates."""
    driving = force[i, d]
    if RATES:
        driving += resisting[i, d]


def verlet_begins(i, dt, state, predicted, *columns):
    """x₊ = x + h v + h²/2 a; v* = v + h a; half of the way to v₊."""
    for d in range(D):
        insert(total_force)
        driving *= particles_mobility[i, d]
        present = velocity[i, d]
        velocity[i, d] = present + 0.5 * dt * driving
        displacement[i, d] += dt * velocity[i, d]
        if RATES:
            predicted[i, d] = present + dt * driving


def verlet_ends(i, dt, state, predicted, *columns):
    """v₊ = v + h/2 (a + a*), a* = a(x₊, v*); dampers and drag are then evaluated at v₊."""
    for d in range(D):
        insert(total_force)
        velocity[i, d] += 0.5 * dt * (driving * particles_mobility[i, d])


def taylor2_begins(i, dt, state, predicted, *columns):
    """The thesis' x₊ = x + v h + a h²/2; v₊ = v + a h."""
    for d in range(D):
        insert(total_force)
        gain = 0.5 * dt * (driving * particles_mobility[i, d])
        velocity[i, d] += gain
        displacement[i, d] += dt * velocity[i, d]
        predicted[i, d] = velocity[i, d] + gain


def taylor2_ends(i, dt, state, predicted, *columns):
    """v₊ as predicted; until now v was the mean of the step."""
    for d in range(D):
        velocity[i, d] = predicted[i, d]


def euler_begins(i, dt, state, predicted, *columns):
    """v₊ = v + h a(x, v); x₊ = x + h v₊."""
    for d in range(D):
        insert(total_force)
        velocity[i, d] += dt * (driving * particles_mobility[i, d])
        displacement[i, d] += dt * velocity[i, d]
        if RATES:
            predicted[i, d] = velocity[i, d]


def step():
    """A whole step, or the part of one that something ends or interrupts.

    An energy that steps conserve belongs to their length: that of a shorter one is compared by itself, and of what comes
    after it anew. The work of varying loads is their mean force times the displacement.
    """
    whole = end == goal and not inside
    began = time
    dt = size if whole else end - time
    time = end
    cut = time == landing and time != goal
    if cut and is_check_due(total + taken + 1, age + 1):
        measure(displacement, velocity, force, resisting, measures, *columns)
        account[Account.GUARD_ENERGY] = conserved(measures, account, dt, SHADOW)
    insert(displacement)
    if LOADS:
        before = load_power(began, velocity, *columns)
        after = load_power(time, velocity, *columns)
        account[Account.WORK] += 500.0 * dt * (before + after)
    insert(velocity)
    inside = time != goal and not cut
    counted = age + 1 if whole or cut else CHECK_INTERVAL
    compared = dt if cut else size


def powers():
    """What each account gains in the step that ends here, by the trapezoidal rule."""
    for k in range(insert(accounts)):
        account[k] += 500.0 * dt * (power[k] + gained[k])
        power[k] = gained[k]
