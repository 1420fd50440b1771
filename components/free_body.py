"""Free bodies: joints and rods taken apart, with all forces on each, which are in equilibrium.

By d'Alembert's principle: what forces leave over accelerates a joint, m a = Σ F, and counts as the force −m a of inertia;
moments about it likewise, −J α. Rods have no mass, which is lumped to the joints: their ends pull at them with forces N that
are equal and opposite, and those that bend with shears V and moments M, too, which what acts between them balances.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.bent import borne_between, is_frame
from pinjoint.components.cases import permanent
from pinjoint.components.derived import chord_rotation, on_joints
from pinjoint.components.language import tr
from pinjoint.components.load import factor_now
from pinjoint.components.model import Model
from pinjoint.components.rod import bearing, rigid_joints
from pinjoint.components.spans import Kinks
from pinjoint.components.written import ROUNDING

Vectors = NDArray[np.float64]


class Force(NamedTuple):
    """A force (kN) and a moment (kN·m) on a body. name: what exerts it, such as "rod AB". kind: "rod", "load", "reaction"
    or "inertia".

    load: the row of the load that it is, or −1. lever: what the force adds to its moment about the start of the rod that is
    its body (kN·m); 0 on joints.
    """

    name: str
    kind: str
    x: float
    y: float
    load: int = -1
    moment: float = 0.0
    lever: float = 0.0


class Apart(NamedTuple):
    """A model taken apart.

    pull: the force in every rod, its damper's included (kN), tension positive, (m,). along: its direction from end to end
    (m, 2). on_ends: what joints exert on both ends of every rod: force x, y (kN), moment (kN·m), (m, 2, 3). left_over: the
    sum of all forces on every joint (kN), mass × acceleration, 0 where it is rounding only, (n, 2). left_over_moment:
    likewise (kN·m), inertia × angular acceleration, (n,).
    """

    pull: Vectors
    along: Vectors
    on_ends: Vectors
    left_over: Vectors
    left_over_moment: Vectors

    @classmethod
    def of(cls, model: Model) -> Apart:
        """A model taken apart as it is now."""
        pull, along = _pulls(model)
        on_ends = np.zeros((len(pull), 2, 3))
        on_ends[:, 1, :2] = pull[:, None] * along
        on_ends[:, 0, :2] = -on_ends[:, 1, :2]
        if is_frame(model) or bearing(model).any():
            on_ends += _of_bending(model, along)
        rest = _left_over(model, on_ends)
        return cls(pull, along, on_ends, rest[:, :2], rest[:, 2])


def _pulls(model: Model) -> tuple[Vectors, Vectors]:
    rods, particles = model.rods, model.particles
    first, last = rods.between.astype(np.intp).T
    along = rods.difference
    if not model.first_order:
        along = along + particles.displacement[last] - particles.displacement[first]
    along = along / np.maximum(np.hypot(*along.T), 1e-300)[:, None]
    rate = ((particles.velocity[last] - particles.velocity[first]) * along).sum(axis=1)
    force, damper = rods.axial_force, rods.damping * rate
    of_cable = np.where(force > 0.0, np.maximum(damper, -force), 0.0)  # none while slack, never compression
    total: Vectors = force + np.where(rods.tension_only, of_cable, damper)
    return total, along


def _lengths(model: Model) -> Vectors:
    """The distances (m) between ends at which forces act on rods."""
    return model.rods.original_length if model.first_order else model.rods.length


def _of_bending(model: Model, along: Vectors) -> Vectors:
    """What bending and what acts between them add on the ends of every rod, dampers included, (m, 2, 3)."""
    rods, particles = model.rods, model.particles
    first, last = rods.between.astype(np.intp).T
    left = np.stack([-along[:, 1], along[:, 0]], axis=1)
    length = np.maximum(_lengths(model), 1e-300)
    turning = ((particles.velocity[last] - particles.velocity[first]) * left).sum(axis=1) / length
    spin = particles.angular_velocity[rods.between]
    rate = np.where(rods.turning_shares > 0.0, spin - turning[:, None], 0.0)
    start, mixed, end = rods.end_damping.T
    damper = np.stack([start * rate[:, 0] + mixed * rate[:, 1], mixed * rate[:, 0] + end * rate[:, 1]], axis=1)
    shear = rods.shear + (damper.sum(axis=1) / length)[:, None]
    lengthwise = rods.end_axial_force - rods.axial_force[:, None]
    found = np.zeros((len(along), 2, 3))
    for place, sign in ((0, -1.0), (1, 1.0)):
        found[:, place, :2] = sign * (lengthwise[:, place, None] * along - shear[:, place, None] * left)
        found[:, place, 2] = sign * rods.bending_moment[:, place] + damper[:, place]
    return found


def _left_over(model: Model, on_ends: Vectors) -> Vectors:
    """Of forces x, y and moments, (n, 3)."""
    particles = model.particles
    acting = np.column_stack([particles.applied_force - borne_between(model), particles.applied_moment])
    answering = np.column_stack([particles.reaction, particles.reaction_moment])
    rest = acting + answering
    for end in (0, 1):
        for part in range(3):
            rest[:, part] -= np.bincount(model.rods.between[:, end], on_ends[:, end, part], particles.count)
    found: Vectors = np.zeros_like(rest)
    for parts in (slice(0, 2), slice(2, 3)):
        largest = max(
            float(np.abs(values[..., parts]).max(initial=0.0)) for values in (acting, answering, on_ends)
        )
        found[:, parts] = np.where(np.abs(rest[:, parts]) > ROUNDING * largest, rest[:, parts], 0.0)
    found[:, 2] *= rigid_joints(model)
    return found


def on_joint(model: Model, row: int, known: Apart | None = None) -> list[Force]:
    """All forces and moments on a joint: of its rods, its loads, its weight, its support, and of inertia.

    known: the model taken apart, if there are several joints to ask for.
    """
    particles, rods, environment = model.particles, model.rods, model.environment
    known = known or Apart.of(model)
    found = []
    for rod, end in np.argwhere(rods.between == row).tolist():
        x, y, turn = (-known.on_ends[rod, end]).tolist()
        found.append(Force(model.describe(rods[rod]), "rod", x, y, moment=turn))
    applied = np.append(particles.applied_force[row] - borne_between(model)[row], particles.applied_moment[row])
    loads, rest = model.loads, applied.copy()
    turns = bool(rigid_joints(model)[row])
    for k in np.flatnonzero(loads.on == row).tolist():
        now = factor_now(model, loads[k]) * np.append(loads.force[k], loads.moment[k])
        rest -= now
        x, y, turn = now.tolist()
        found.append(Force(model.describe(loads[k]), "load", x, y, k, turn * turns))
    weight = (
        permanent(model)
        * particles.mass[row]
        * (particles.acceleration[row] + environment.acceleration)
        / 1000.0
    )
    own = (
        model.share
        * permanent(model)
        * np.append(particles.force[row] + environment.force, particles.moment[row])
    )
    for name, part in ((tr("force"), own), (tr("weight"), np.append(weight, 0.0))):
        rest -= part
        if (part * [1.0, 1.0, turns]).any():
            x, y, turn = part.tolist()
            found.append(Force(name, "load", x, y, moment=turn * turns))
    rest[2] *= turns
    if (np.abs(rest) > ROUNDING * np.array([*[np.abs(applied[:2]).max()] * 2, abs(applied[2])])).any():
        x, y, turn = rest.tolist()
        found.append(Force(tr("other"), "load", x, y, moment=turn))  # drag, laws of mods, a hand
    for part, name in ((np.array([1.0, 0.0]), tr("reaction x")), (np.array([0.0, 1.0]), tr("reaction y"))):
        if (reaction := particles.reaction[row] * part).any():
            found.append(Force(name, "reaction", *reaction.tolist()))
    if moment := float(particles.reaction_moment[row]):
        found.append(Force(tr("reaction moment"), "reaction", 0.0, 0.0, moment=moment))
    inertia, turning = -known.left_over[row], -float(known.left_over_moment[row])
    if inertia.any():
        found.append(Force(tr("inertia −m a"), "inertia", *inertia.tolist()))
    if turning:
        found.append(Force(tr("inertia −J α"), "inertia", 0.0, 0.0, moment=turning))
    return found


def on_rod(model: Model, row: int) -> list[Force]:
    """The forces and moments of its two joints on a rod, and what acts between them."""
    known, rods = Apart.of(model), model.rods
    on_ends, along = known.on_ends[row].tolist(), known.along[row]
    names, length = model.particles.names, float(_lengths(model)[row])
    first, last = rods.between[row].tolist()
    (x, y, turn), (far_x, far_y, far_turn) = on_ends
    lever = length * float(along[0] * far_y - along[1] * far_x)
    lever *= is_frame(model) or bool(bearing(model)[row])  # of a bar's it is rounding only
    found = [
        Force(tr("at {particle}", particle=names[first]), "rod", x, y, moment=turn),
        Force(tr("at {particle}", particle=names[last]), "rod", far_x, far_y, moment=far_turn, lever=lever),
    ]
    between, left = Kinks.of(model, model.share), np.array([-along[1], along[0]])
    rigid, its_length = rods.turning_shares[row : row + 1] > 0.0, rods.rest_length[row : row + 1]
    slopes = np.where(rigid[0], model.particles.rotation[rods.between[row]] - chord_rotation(model)[row], 0.0)
    slopes *= not model.first_order
    for load in np.unique(between.load[between.row == row]).tolist():
        own = between.some((between.row == row) & (between.load == load))
        own = own._replace(row=np.zeros_like(own.row))
        work = on_joints(own.on_clamped(its_length), rods.fixity[row : row + 1])[0]
        (near, far), bowed = own.on_ends(1)[0], slopes @ work[:6].reshape(2, 3)[:, :2]
        lever = length * float(along[0] * far[1] - along[1] * far[0])
        lever += float(left[0] * bowed[1] - left[1] * bowed[0])
        name = tr("distributed force") if load < 0 else model.describe(model.span_loads[load])
        x, y = (near + far).tolist()
        found.append(Force(name, "load", x, y, moment=float(work[6]), lever=lever))
    return found
