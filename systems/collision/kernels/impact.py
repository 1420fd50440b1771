"""Impacts of one or many contacts at the same instant, by generalized reflections.

Smith, Kaufman, Vouga, Tamstorf, Grinspun, "Reflections on simultaneous impact", ACM Trans. Graph. 31 (2012):
project the velocities onto those at which no approaching contact approaches any more; reflect about that
projection; repeat with the contacts that approach now until none does. Energy, momentum and symmetry are kept.
Restitution e blends this with the plastic answer, the projection onto all contacts at once:
v = e v_elastic + (1 − e) v_plastic. For a single contact it is Newton's law.
"""

from pinjoint.systems.collision.columns import Contact
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.projection import (
    MOST_SWEEPS,
    begin,
    copy_motion,
    opening_rate,
    project,
    push_apart,
)

# after which, and after twice as many, …, a test shows whether they can ever end
REFLECTIONS_BEFORE_JAM_TEST = 256
# of contacts; after these, which is counted, or where they never end, the rest is plastic
MOST_REFLECTIONS = 1000000


@compiled
def respond(members, count, restitution, group):
    """Carry out the impact of a group of `count` contacts whose normals, openings and biases are set.

    `motion` goes from the velocities before the impact to those after it; `initial` keeps the former. Sets TOTAL_IMPULSE.
    """
    begin(members, group)
    for c in range(count):
        group.contacts[c, Contact.TOTAL_IMPULSE] = 0.0
    if count == 1:
        _respond_alone(restitution, group)
        return
    if restitution > 0.0:
        _reflect(members, count, group)
    if restitution < 1.0:
        copy_motion(group.motion, group.other, members)
        copy_motion(group.initial, group.motion, members)
        _make_plastic(members, count, group)
        _blend(members, count, restitution, group)


@compiled
def _respond_alone(restitution, group):
    """Newton's law: the speed of approach is reversed and multiplied by the restitution."""
    speed = opening_rate(0, group.motion, group)
    if speed < 0.0 and group.contacts[0, Contact.COMPLIANCE] > 0.0:
        impulse = -(1.0 + restitution) * speed / group.contacts[0, Contact.COMPLIANCE]
        group.contacts[0, Contact.TOTAL_IMPULSE] = impulse
        push_apart(0, impulse, group)


@compiled
def _reflect(members, count, group):
    """The elastic impact."""
    contacts, motion, start = group.contacts, group.motion, group.start
    test, jammed = REFLECTIONS_BEFORE_JAM_TEST, False
    for turn in range(MOST_REFLECTIONS // count):
        if turn == test:
            test = 2 * turn
            jammed = _is_jammed(members, count, group)
            if jammed:
                break
        approaching = 0
        for c in range(count):
            contacts[c, Contact.IMPULSE] = 0.0
            speed = opening_rate(c, motion, group)
            if speed < -group.noise[0] and contacts[c, Contact.COMPLIANCE] > 0.0:
                group.active[approaching] = c
                approaching += 1
        if approaching == 0:
            return
        project(members, approaching, 0.0, MOST_SWEEPS, group)
        for m in range(members):
            for d in range(2):
                motion[m, d] += motion[m, d] - start[m, d]
        for k in range(approaching):
            c = group.active[k]
            contacts[c, Contact.TOTAL_IMPULSE] += 2.0 * contacts[c, Contact.IMPULSE]
    if not jammed:
        group.cut_short[0] += 1
    _make_plastic(members, count, group)
    for c in range(count):
        contacts[c, Contact.TOTAL_IMPULSE] += contacts[c, Contact.IMPULSE]


@compiled
def _is_jammed(members, count, group):
    """True if no motion opens all contacts that pushed so far: some of them will approach for ever.

    An example is a row of discs between two walls. (Gordan's alternative: impulses that cancel each other
    everywhere.) The least motion that opens all at the same speed is sought as a projection.
    """
    speed, active = 0.0, 0
    for m in range(members):
        speed = max(speed, abs(group.motion[m, 0]), abs(group.motion[m, 1]))
    copy_motion(group.motion, group.other, members)
    for m in range(members):
        group.motion[m, 0], group.motion[m, 1] = 0.0, 0.0
    for c in range(count):
        if group.contacts[c, Contact.TOTAL_IMPULSE] > 0.0:
            group.contacts[c, Contact.BIAS], group.contacts[c, Contact.IMPULSE] = -speed, 0.0
            group.active[active] = c
            active += 1
    project(members, active, 0.0, MOST_SWEEPS, group)
    jammed = False
    for k in range(active):
        c = group.active[k]
        jammed = jammed or opening_rate(c, group.motion, group) < -0.5 * speed
        group.contacts[c, Contact.BIAS] = 0.0
    copy_motion(group.other, group.motion, members)
    return jammed


@compiled
def _make_plastic(members, count, group):
    """The plastic impact of all contacts; impulses in column IMPULSE."""
    active = 0
    for c in range(count):
        group.contacts[c, Contact.IMPULSE] = 0.0
        if group.contacts[c, Contact.COMPLIANCE] > 0.0:
            group.active[active] = c
            active += 1
    project(members, active, 0.0, MOST_SWEEPS, group)


@compiled
def _blend(members, count, restitution, group):
    """The plastic answer is in `motion`, the elastic one in `other`."""
    for m in range(members):
        for d in range(2):
            elastic, plastic = group.other[m, d], group.motion[m, d]
            group.motion[m, d] = restitution * elastic + (1.0 - restitution) * plastic
    for c in range(count):
        elastic, plastic = group.contacts[c, Contact.TOTAL_IMPULSE], group.contacts[c, Contact.IMPULSE]
        group.contacts[c, Contact.TOTAL_IMPULSE] = restitution * elastic + (1.0 - restitution) * plastic
