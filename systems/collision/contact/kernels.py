"""Lasting contacts: discs that rest on one another or slide along one another.

A contact lasts while its force pushes: forces F ≥ 0 and accelerations satisfy, at the contacts whose discs do not
separate, n·Δa + |Δv|²/d ≥ 0 and F = 0 where it is > 0. Discs that are thereby at rest stay where they are, at no
cost. Discs that slide take steps h of RATTLE (Andersen, J. Comput. Phys. 52, 1983) with one-sided constraints:
constant forces along the normals at the start such that the discs touch at the end of the step,
    u₁ = u₀ + h v₀ + h²/2 (g + W N F),   gap(u₁) ≥ 0 ⟂ F ≥ 0,
and velocities v₁ = v₀ + h/2 (g + W N F) + h/2 g + W N₁ p with n₁·Δv₁ ≥ 0 ⟂ p ≥ 0. In between they are on
parabolas like all others, so that impacts with them are found as exactly.

Table of lasting contacts: first_lasting[i] is the first entry of disc i, −1 if it has none; lasting, shape
(capacity, 2), holds the other disc and the next entry; forces the force, N. A contact is entered for each of
its discs that is not held. Unused entries are chained from counts[SPARE].
"""

import math

from systems.collision.disc import EPOCH, GX, GY, RADIUS, VX, VY, WX, WY
from systems.collision.gap.kernels import place_noise
from systems.collision.group import (
    ACTIVE,
    BIAS,
    DISTANCE,
    FORCE,
    GIVEN,
    INITIAL,
    MOTION,
    NX,
    NY,
    OPENING,
    VELOCITY,
)
from systems.collision.projection.kernels import copy_motion, opening_rate, project, rate_noise
from systems.collision.state import NOW, SPARE, SPARES
from systems.kernels import compiled

NEVER = math.inf
NONE = -1
OTHER, NEXT = 0, 1

STILL = 1e-10  # of the speed and acceleration that gravity gives; what moves less is at rest
STEP_ANGLE = 0.0156  # of a step's slide, relative to the distance of the centres; error ∝ its square
MOST_CORRECTIONS = 40  # of the forces in a step; 3 are usual


# --- the table ----------------------------------------------------------------------------------------------


@compiled
def find_lasting(i, j, first_lasting, lasting):
    """Entry of the lasting contact of two discs, in the list of either; −1 if they have none."""
    for a, b in ((i, j), (j, i)):
        entry = first_lasting[a]
        while entry != NONE:
            if lasting[entry, OTHER] == b:
                return entry
            entry = lasting[entry, NEXT]
    return NONE


@compiled
def forget_lasting(i, first_lasting, lasting, counts):
    """Strike out all entries of a disc."""
    entry = first_lasting[i]
    while entry != NONE:
        following = lasting[entry, NEXT]
        lasting[entry, NEXT] = counts[SPARE]
        counts[SPARE] = entry
        counts[SPARES] += 1
        entry = following
    first_lasting[i] = NONE


@compiled
def note_lasting(i, j, force, discs, first_lasting, lasting, forces, counts):
    """Enter a lasting contact with j for disc i, unless it is held."""
    if discs[i, WX] == 0.0 and discs[i, WY] == 0.0:
        return
    entry = counts[SPARE]
    counts[SPARE] = lasting[entry, NEXT]
    counts[SPARES] -= 1
    lasting[entry, OTHER] = j
    lasting[entry, NEXT] = first_lasting[i]
    forces[entry] = force
    first_lasting[i] = entry


# --- the end of a step --------------------------------------------------------------------------------------


@compiled
def stop_sinking(count, touching, links, contacts, mobility, motions, marks, matrix):
    """Project the velocities in MOTION for the contacts that have lasted until now."""
    active = 0
    for c in range(touching):
        contacts[c, GIVEN] = 0.0
        if contacts[c, FORCE] > 0.0 and contacts[c, OPENING] > 0.0:
            marks[ACTIVE, active] = c
            active += 1
    if active > 0:
        copy_motion(motions[MOTION], motions[INITIAL], count)
        project(count, active, 0.0, links, contacts, mobility, motions, marks, matrix)


# --- the forces from now on ------------------------------------------------------------------------------------


@compiled
def support(count, touching, discs, members, links, contacts, mobility, motions, marks, matrix, numbers):
    """Forces in the contacts of a group whose velocities are in MOTION.

    Returns for how long they hold: NEVER if nothing slides. MOTION becomes the accelerations, VELOCITY the
    velocities; sets the column FORCE.
    """
    copy_motion(motions[MOTION], motions[VELOCITY], count)
    closed = _closed(touching, links, contacts, motions, marks)
    for c in range(touching):
        contacts[c, FORCE] = 0.0
    _pull(count, discs, members, motions)
    copy_motion(motions[MOTION], motions[INITIAL], count)
    project(count, closed, 0.0, links, contacts, mobility, motions, marks, matrix)
    if _stop_where_still(closed, discs, members, links, contacts, motions, marks):
        duration = NEVER
    else:
        duration = _duration(closed, links, contacts, motions, marks)
        _meet_at_end(duration, count, closed, discs, members, links, contacts, mobility, motions, marks, matrix, numbers)
    for k in range(closed):
        c = marks[ACTIVE, k]
        contacts[c, FORCE] = contacts[c, GIVEN]
    return duration


@compiled
def _pull(count, discs, members, motions):
    """The accelerations without contact forces, in MOTION."""
    for m in range(count):
        i = members[0, m]
        motions[MOTION, m, 0], motions[MOTION, m, 1] = discs[i, GX], discs[i, GY]


@compiled
def _closed(touching, links, contacts, motions, marks):
    """List the contacts that do not separate; their bias becomes |Δv|²/d. Returns how many there are."""
    velocity = motions[VELOCITY]
    closed = 0
    for c in range(touching):
        contacts[c, BIAS] = 0.0
        noise = 4.0 * rate_noise(c, links, motions)
        if contacts[c, OPENING] > 0.0 and opening_rate(c, links, contacts, velocity) <= noise:
            a, b = links[c, 0], links[c, 1]
            x, y = velocity[b, 0] - velocity[a, 0], velocity[b, 1] - velocity[a, 1]
            contacts[c, BIAS] = (x * x + y * y) / contacts[c, DISTANCE]
            contacts[c, GIVEN] = contacts[c, FORCE]
            marks[ACTIVE, closed] = c
            closed += 1
    return closed


@compiled
def _stop_where_still(closed, discs, members, links, contacts, motions, marks):
    """If all discs that contacts push neither move nor accelerate, bring them to rest. False if one does."""
    for k in range(closed):
        c = marks[ACTIVE, k]
        if contacts[c, GIVEN] > 0.0:
            for p in range(2):
                if not _is_still(links[c, p], discs, members, motions):
                    return False
    for k in range(closed):
        c = marks[ACTIVE, k]
        if contacts[c, GIVEN] > 0.0:
            for p in range(2):
                m = links[c, p]
                motions[VELOCITY, m, 0], motions[VELOCITY, m, 1] = 0.0, 0.0
                motions[MOTION, m, 0], motions[MOTION, m, 1] = 0.0, 0.0
    return True


@compiled
def _is_still(m, discs, members, motions):
    i = members[0, m]
    pull = abs(discs[i, GX]) + abs(discs[i, GY])
    acceleration = abs(motions[MOTION, m, 0]) + abs(motions[MOTION, m, 1])
    speed = abs(motions[VELOCITY, m, 0]) + abs(motions[VELOCITY, m, 1])
    return acceleration <= STILL * pull and speed <= STILL * math.sqrt(pull * discs[i, RADIUS])


@compiled
def _duration(closed, links, contacts, motions, marks):
    """For how long the discs that push one another turn around one another by at most STEP_ANGLE."""
    duration = NEVER
    for k in range(closed):
        c = marks[ACTIVE, k]
        if contacts[c, GIVEN] > 0.0:
            a, b = links[c, 0], links[c, 1]
            slide = STEP_ANGLE * contacts[c, DISTANCE]
            speed = math.hypot(
                motions[VELOCITY, b, 0] - motions[VELOCITY, a, 0], motions[VELOCITY, b, 1] - motions[VELOCITY, a, 1]
            )
            pull = math.hypot(
                motions[MOTION, b, 0] - motions[MOTION, a, 0], motions[MOTION, b, 1] - motions[MOTION, a, 1]
            )
            duration = min(duration, 2.0 * slide / (speed + math.sqrt(speed * speed + 2.0 * pull * slide)))
    return duration


@compiled
def _end_gap(c, h, discs, members, links, contacts, motions):
    """Gap of a contact after a time h with the accelerations in MOTION."""
    a, b = links[c, 0], links[c, 1]
    velocity, motion = motions[VELOCITY], motions[MOTION]
    d = contacts[c, DISTANCE]
    x = contacts[c, NX] * d + h * (velocity[b, 0] - velocity[a, 0] + 0.5 * h * (motion[b, 0] - motion[a, 0]))
    y = contacts[c, NY] * d + h * (velocity[b, 1] - velocity[a, 1] + 0.5 * h * (motion[b, 1] - motion[a, 1]))
    return math.sqrt(x * x + y * y) - (discs[members[0, a], RADIUS] + discs[members[0, b], RADIUS])


@compiled
def _meet_at_end(h, count, closed, discs, members, links, contacts, mobility, motions, marks, matrix, numbers):
    """Correct the forces until the closed contacts touch, or have opened, after a time h."""
    for _ in range(MOST_CORRECTIONS):
        met = True
        for k in range(closed):
            c = marks[ACTIVE, k]
            gap = _end_gap(c, h, discs, members, links, contacts, motions)
            i, j = members[0, links[c, 0]], members[0, links[c, 1]]
            noise = place_noise(discs, i, j, numbers[NOW])
            met = met and gap >= -noise and (gap <= noise or contacts[c, GIVEN] == 0.0)
            contacts[c, BIAS] += 2.0 * gap / (h * h) - opening_rate(c, links, contacts, motions[MOTION])
        if met:
            return
        _pull(count, discs, members, motions)
        project(count, closed, 0.0, links, contacts, mobility, motions, marks, matrix)
