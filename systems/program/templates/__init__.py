"""Templates: the source of step programs as far as it is the same for all models.

A template is Python in which some words stand for others, which the writer puts in as it pastes a function into a
program. It runs only there.

    *columns    the model's columns that the program takes, one after the other: particles_mobility, …
    *state      displacement, velocity, force, resisting, direction
    *forces     force, resisting, direction
    *scratch    predicted, power, gained; of an integrator that controls its steps
                search, work, rod_work, marks, power, gained, stage_power
    *bounds     breaks, until, landing
    *limits     tolerance, limit; where steps are controlled
    *kept       what driven.py puts back
    *observed   rods_axial_force, rods_length, rods_strain, yielding; fixed, tension, compression, yields
    *placed, *moving, *pulled, *resisted, …
                displacement, velocity, force, resisting, …; of models that bend each with the array of rotations after it:
                rotation, angular_velocity, moment, twisting, … (`BOTH_BLOCKS` in names.py)
    insert(x)   the lines, or the expression, that the writer made for `x`

In the head of a function, where Python allows one star only, the same words stand without it. Arrays are handed over
one by one because a tuple of them costs twice as much a step in small models, and takes several times as long to
compile.

    displacement, velocity   of the particles (m, m/s), shape (particles, 2)
    force                    on each particle, without dampers and drag (kN)
    resisting                of dampers and drag (kN)
    direction                unit vector of each rod
    predicted                velocity at which dampers and drag act in a fixed step (m/s)
    power, gained            what each account gains per second, as a step begins and over it (kW)
    account, measures, control, search, marks
                             arrays with the entries of systems/entries.py

Constants of every program: RATES (something depends on velocity), POWERS (some account gains by the step), LOADS
(some load varies), STOPS (there are Events, at which runs stop), SHADOW (see judge() in systems/physics/kernels.py),
CHECK_INTERVAL and REVIEW_INTERVAL (steps); of one that controls its steps also EVENTS (there are Events, or some law of
rods has branches), COMMITS (something has a history) and those of its integrator.

    driven.py        steps among particles that may meet
    fixed_steps.py   integrators whose steps are all alike, and when a state is checked
    runge_kutta.py   integrators that control their steps: one loop for every tableau
    implicit.py      the stages of implicit ones
    forces.py        forces, history, and what they do per second
    pairs.py         pairs of particles that are near each other
    rods.py          what is computed of one rod
    turning.py       rotations, the second block of coordinates, of models that bend
    events.py        where rods leave the branches of their laws
    observing.py     energies and derived columns of a state
"""
