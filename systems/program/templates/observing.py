"""Reading a state: its energies, residual and scales, and the derived columns."""

# ruff: noqa: F821
# mypy: ignore-errors


def measure(displacement, velocity, force, resisting, measures, *columns):
    """Energies, residual and scales of an accepted state, for judge(); what is asleep is included."""
    kinetic = 0.0
    power_norm = 0.0
    power = 0.0
    potential = 0.0
    residual = 0.0
    largest = 0.0
    moved = 0.0
    if BENDS:
        rolled = 0.0
        firmest = 0.0
    for i in range(displacement.shape[0]):
        for d in range(D):
            kinetic += insert(mass) * velocity[i, d] * velocity[i, d]
            potential += particles_constant_force[i, d] * displacement[i, d]
            total = force[i, d] + resisting[i, d] if RATES else force[i, d]
            power_norm += total * particles_mobility[i, d] * total
            pull = abs(force[i, d])
            load = abs(particles_constant_force[i, d])
            if BENDS:
                pull *= lever[i, d]
                load *= lever[i, d]
            if particles_mobility[i, d] > 0.0:
                power += total * velocity[i, d]
                residual = max(residual, pull)
            largest = max(largest, load)
        for d in range(2):
            moved = max(moved, abs(displacement[i, d]))
        if BENDS:
            rolled = max(rolled, abs(displacement[i, 2] * per_arm[0]))
    elastic = 0.0
    stiffest = 0.0
    if SPRUNG:
        for i in range(displacement.shape[0]):
            for d in range(D):
                elastic += particles_support_springs[i, d] * displacement[i, d] * displacement[i, d]
                stiffest = max(stiffest, particles_support_springs[i, d])
    insert(rods)
    insert(pairs)
    round_off = EPSILON * stiffest * moved
    if BENDS:
        round_off += EPSILON * firmest * rolled
    measures[Measure.KINETIC] = measures[Measure.ASLEEP_KINETIC] + 0.5 * kinetic
    measures[Measure.POWER_NORM] = measures[Measure.ASLEEP_POWER_NORM] + 1000.0 * power_norm
    measures[Measure.ELASTIC] = measures[Measure.ASLEEP_ELASTIC] + 500.0 * elastic
    measures[Measure.POTENTIAL] = measures[Measure.ASLEEP_POTENTIAL] + 1000.0 * potential
    measures[Measure.RESIDUAL] = max(measures[Measure.ASLEEP_RESIDUAL], residual)
    measures[Measure.LARGEST_FORCE] = max(measures[Measure.ASLEEP_LARGEST_FORCE], largest)
    measures[Measure.ROUND_OFF] = max(measures[Measure.ASLEEP_ROUND_OFF], round_off)
    measures[Measure.POWER] = measures[Measure.ASLEEP_POWER] + 1000.0 * power


def observe(time, dt, displacement, velocity, applied, reaction, forces, power, measures, observed, *columns):
    """The derived columns of rods and particles, and the measures, of a state.

    applied: what acts on each particle from outside, contact forces included (kN); reaction: of its support. yielding: which
    rods yield. tension, compression: their strengths (kN). yields: whether the model has plasticity.
    """
    external(time, dt, displacement, velocity, applied, resisting, *columns)
    if MEETS:
        for i in range(displacement.shape[0]):
            for d in range(2):
                applied[i, d] += support[i, d]
    if ALIKE:
        forces(time, dt, *state, *columns)
    else:
        evaluate(time, dt, *state, power, *columns)
    measure(displacement, velocity, force, resisting, measures, *columns)
    for i in range(displacement.shape[0]):
        for d in range(D):
            reaction[i, d] = 0.0 - (force[i, d] + resisting[i, d]) if fixed[i, d] else 0.0
            if SPRUNG:
                applied[i, d] += particles_support_springs[i, d] * displacement[i, d]
                reaction[i, d] -= particles_support_springs[i, d] * displacement[i, d]
    insert(rods)
