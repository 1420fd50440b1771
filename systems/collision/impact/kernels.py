"""Impacts of one or many contacts at the same instant, by generalized reflections.

Smith, Kaufman, Vouga, Tamstorf, Grinspun, "Reflections on simultaneous impact", ACM Trans. Graph. 31 (2012):
project the velocities onto those at which no approaching contact approaches any more; reflect about that
projection; repeat with the contacts that approach now until none does. Energy, momentum and symmetry are kept.
Restitution e blends this with the plastic answer, the projection onto all contacts at once:
v = e v_elastic + (1 − e) v_plastic. For a single contact it is Newton's law.

The arrays of a group are described in group.py.
"""

from systems.collision.group import ACTIVE, ELASTIC, GIVEN, IMPULSE, INITIAL, MOTION, OPENING, START
from systems.collision.projection.kernels import copy_motion, opening_rate, project, push_apart, rate_noise
from systems.kernels import compiled

MOST_REFLECTIONS = 1000000  # in one impact; after that the rest of it is taken as plastic


@compiled
def respond(members, count, restitution, links, contacts, mobility, motions, marks, matrix):
    """Carry out the impact of a group of `count` contacts whose normals, openings and biases are set.

    MOTION goes from the velocities before to those after, INITIAL keeps those before; sets the column IMPULSE.
    """
    motion, initial = motions[MOTION], motions[INITIAL]
    copy_motion(motion, initial, members)
    for c in range(count):
        contacts[c, IMPULSE] = 0.0
    if count == 1:
        _respond_alone(restitution, links, contacts, mobility, motion)
        return
    if restitution > 0.0:
        _reflect(members, count, links, contacts, mobility, motions, marks, matrix)
    if restitution < 1.0:
        copy_motion(motion, motions[ELASTIC], members)
        copy_motion(initial, motion, members)
        _make_plastic(members, count, links, contacts, mobility, motions, marks, matrix)
        _blend(members, count, restitution, contacts, motions)


@compiled
def _respond_alone(restitution, links, contacts, mobility, motion):
    """Newton's law: the speed of approach is reversed and multiplied by the restitution."""
    speed = opening_rate(0, links, contacts, motion)
    if speed < 0.0 and contacts[0, OPENING] > 0.0:
        contacts[0, IMPULSE] = -(1.0 + restitution) * speed / contacts[0, OPENING]
        push_apart(0, contacts[0, IMPULSE], links, contacts, mobility, motion)


@compiled
def _reflect(members, count, links, contacts, mobility, motions, marks, matrix):
    """The elastic impact."""
    motion, start = motions[MOTION], motions[START]
    for _ in range(MOST_REFLECTIONS):
        approaching = 0
        for c in range(count):
            contacts[c, GIVEN] = 0.0
            speed = opening_rate(c, links, contacts, motion)
            if speed < -rate_noise(c, links, motions) and contacts[c, OPENING] > 0.0:
                marks[ACTIVE, approaching] = c
                approaching += 1
        if approaching == 0:
            return
        project(members, approaching, 0.0, links, contacts, mobility, motions, marks, matrix)
        for m in range(members):
            for d in range(2):
                motion[m, d] += motion[m, d] - start[m, d]
        for k in range(approaching):
            c = marks[ACTIVE, k]
            contacts[c, IMPULSE] += 2.0 * contacts[c, GIVEN]
    _make_plastic(members, count, links, contacts, mobility, motions, marks, matrix)
    for c in range(count):
        contacts[c, IMPULSE] += contacts[c, GIVEN]


@compiled
def _make_plastic(members, count, links, contacts, mobility, motions, marks, matrix):
    """The plastic impact of all contacts; impulses in column GIVEN."""
    active = 0
    for c in range(count):
        contacts[c, GIVEN] = 0.0
        if contacts[c, OPENING] > 0.0:
            marks[ACTIVE, active] = c
            active += 1
    project(members, active, 0.0, links, contacts, mobility, motions, marks, matrix)


@compiled
def _blend(members, count, restitution, contacts, motions):
    motion, elastic = motions[MOTION], motions[ELASTIC]
    for m in range(members):
        for d in range(2):
            motion[m, d] = restitution * elastic[m, d] + (1.0 - restitution) * motion[m, d]
    for c in range(count):
        elastic_impulse = contacts[c, IMPULSE]
        contacts[c, IMPULSE] = restitution * elastic_impulse + (1.0 - restitution) * contacts[c, GIVEN]
