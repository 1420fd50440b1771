"""The joint impact of particles that touch, and the least change of the motion of many."""

from pinjoint.systems.collision.columns import Contact, Mark
from pinjoint.systems.collision.kernels import compiled
from pinjoint.systems.collision.kernels.impact import respond
from pinjoint.systems.collision.kernels.projection import begin, compliance, opening_rate, project, push_apart

SEPARATE = -1.0  # as the restitution of contacts that are only held apart
MOST_CROWD_SWEEPS = 200  # over the contacts of a crowd; its next step continues from the impulses reached


@compiled
def resolve(members, count, restitution, tolerance, group):
    """Resolve the impact of a group whose links, normals and velocities are set; see kernels/impact.py.

    Where the restitution is negative the motion is separated instead: by one kernel, so that what both share is compiled
    once.
    """
    if restitution < 0.0:
        separate_motion(members, count, tolerance, group)
        return
    for c in range(count):
        group.contacts[c, Contact.BIAS] = 0.0
        group.contacts[c, Contact.COMPLIANCE] = compliance(c, c, group)
    respond(members, count, restitution, group)


@compiled
def separate_motion(members, count, tolerance, group):
    """Change the motion of a group as little as possible so that no contact closes faster than its bias; see projection.py.

    Links, normals, biases and first impulses are set; column IMPULSE then holds the impulses. Where sweeps are too few
    to find them, all are reduced so that they do no work in sum.
    """
    active = 0
    for c in range(count):
        opening = compliance(c, c, group)
        group.contacts[c, Contact.COMPLIANCE] = opening
        if opening > 0.0:
            group.marks[Mark.ACTIVE, active] = c
            active += 1
    begin(members, group)
    project(members, active, tolerance, MOST_CROWD_SWEEPS, group)
    _limit_work(members, active, group)


@compiled
def _limit_work(members, active, group):
    """Reduce all impulses p by one factor so that p · (N m + b) ≤ 0 for the motion m after them."""
    before, after = 0.0, 0.0
    for k in range(active):
        c = group.marks[Mark.ACTIVE, k]
        if group.contacts[c, Contact.IMPULSE] < 0.0:  # the last acceleration of the sweeps went too far
            push_apart(c, -group.contacts[c, Contact.IMPULSE], group)
            group.contacts[c, Contact.IMPULSE] = 0.0
    for k in range(active):
        c = group.marks[Mark.ACTIVE, k]
        before += group.contacts[c, Contact.IMPULSE] * opening_rate(c, group.initial, group)
        after += group.contacts[c, Contact.IMPULSE] * opening_rate(c, group.motion, group)
    if after <= 0.0:
        return
    share = -before / (after - before) if before < 0.0 else 0.0
    for k in range(active):
        group.contacts[group.marks[Mark.ACTIVE, k], Contact.IMPULSE] *= share
    for m in range(members):
        for d in range(2):
            group.motion[m, d] = group.initial[m, d] + share * (group.motion[m, d] - group.initial[m, d])
