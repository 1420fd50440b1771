"""Templates: the source of step programs as far as it is the same for all models.

A template is Python in which some words stand for others, which the writer puts in as it pastes a function into a
program. It runs only there.

    *columns    the model's columns that the program takes, one after the other: particles_mobility, …
    *state      displacement, velocity, force, resisting, direction
    *forces     force, resisting, direction
    *scratch    predicted, power, gained; of an integrator that controls its steps
                search, work, rod_work, marks, power, gained, stage_power
    *bounds     breaks, until, landing
    *kept       what driven.py puts back
    *observed   rods_axial_force, rods_length, rods_strain, yielding; fixed, tension, compression, yields
    insert(x)   the lines, or the expression, that the writer made for `x`
    if BENDS:   lines that a program has only where members bend; so with LOADED (something acts between ends), WARM
                (rods may have another rest length than the original one), MEETS (particles may meet), ALIKE (all steps
                are of one length), LOADS (some load varies), FORESEES (both), and what the writer says of one template

In the head of a function, where Python allows one star only, the same words stand without it. Arrays are handed over
one by one because a tuple of them costs twice as much a step in small models, and takes several times as long to
compile.

    displacement, velocity   of the particles (m, m/s), shape (particles, D)
    force                    on each particle, without dampers and drag (kN)
    resisting                of dampers and drag (kN)
    direction                unit vector of each rod
    predicted                velocity at which dampers and drag act in a fixed step (m/s)
    power, gained            what each account gains per second, as a step begins and over it (kW)
    account, measures, control, search, marks
                             arrays with the entries of systems/program/entries.py

D is 2, or 3 in models that bend. The third coordinate is a rotation θ as a way ℓθ (m): per_arm[0] = 1/ℓ turns it into an
angle again, and a moment into the force that belongs to it; its mass is J/ℓ². ℓ is a power of two, about the longest rod
(`arm_of` in systems/physics/bending.py), so that these products change no bits.

Constants of every program: D; EPSILON; RATES (something depends on velocity), POWERS (some account gains by the step), LOADS
(some load varies), STOPS (there are Events, at which runs stop), SHADOW (see judge() in systems/physics/kernels.py),
CHECK_INTERVAL, REVIEW_INTERVAL and MOST_PARTS (steps); of one that controls its steps also EVENTS (there are Events, or some
law of rods has branches), COMMITS (something has a history) and those of its integrator.

    driven.py        steps among particles that may meet
    steps.py         the loop over steps of every integrator, and when a state is checked
    fixed_steps.py   one step of integrators whose steps are all alike
    runge_kutta.py   one step of integrators that control their steps, by any tableau
    implicit.py      the stages of implicit ones
    forces.py        forces, also of pairs that are near each other, history, and what they do per second
    rods.py          what is computed of one rod
    events.py        where rods leave the branches of their laws
    observing.py     energies and derived columns of a state
"""
