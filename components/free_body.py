"""Free bodies: joints and rods taken apart, with all forces on each, which are in equilibrium.

By d'Alembert's principle: what forces leave over accelerates a joint, m a = Σ F, and counts as the force −m a of inertia.
Rods have no mass, which is lumped to the joints: their ends pull at them with forces N that are equal and opposite.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from components.load import factor_at
from components.model import Model
from components.written import ROUNDING

Vectors = NDArray[np.float64]


class Force(NamedTuple):
    """A force (kN) on a body. name: what exerts it, such as "rod AB". kind: "rod", "load", "reaction" or "inertia".

    load: the row of the load that it is, or −1.
    """

    name: str
    kind: str
    x: float
    y: float
    load: int = -1


class Apart(NamedTuple):
    """A model taken apart. pull: the force in every rod, its damper's included (kN), tension positive, (m,).

    along: its direction from end to end (m, 2). left_over: the sum of all forces on every joint (kN), mass ×
    acceleration, 0 where it is rounding only, (n, 2).
    """

    pull: Vectors
    along: Vectors
    left_over: Vectors


def apart(model: Model) -> Apart:
    """A model taken apart as it is now."""
    pull, along = _pulls(model)
    return Apart(pull, along, _left_over(model, pull, along))


def _pulls(model: Model) -> tuple[Vectors, Vectors]:
    rods, particles = model.rods, model.particles
    first, last = rods.between.astype(np.intp).T
    places = particles.position + particles.displacement
    along = places[last] - places[first]
    along = along / np.maximum(np.hypot(*along.T), 1e-300)[:, None]
    rate = ((particles.velocity[last] - particles.velocity[first]) * along).sum(axis=1)
    force, damper = rods.axial_force, rods.damping * rate
    of_cable = np.where(
        force > 0.0, np.maximum(damper, -force), 0.0
    )  # none while it is slack, never compression
    total: Vectors = force + np.where(rods.tension_only, of_cable, damper)
    return total, along


def _left_over(model: Model, force: Vectors, along: Vectors) -> Vectors:
    particles = model.particles
    rest = particles.applied_force + particles.reaction
    for end, sign in ((0, 1.0), (1, -1.0)):
        for axis in (0, 1):
            rest[:, axis] += sign * np.bincount(
                model.rods.between[:, end], force * along[:, axis], particles.count
            )
    largest = max(
        float(np.abs(values).max(initial=0.0))
        for values in (particles.applied_force, particles.reaction, force)
    )
    found: Vectors = np.where(np.abs(rest) > ROUNDING * largest, rest, 0.0)
    return found


def on_joint(model: Model, row: int, known: Apart | None = None) -> list[Force]:
    """All forces on a joint: of its rods, its loads, its weight, its support, and of inertia.

    known: the model taken apart, if there are several joints to ask for.
    """
    particles, rods, environment = model.particles, model.rods, model.environment
    force, along, left_over = known or apart(model)
    found = []
    for rod in np.flatnonzero((rods.between == row).any(axis=1)).tolist():
        pull = force[rod] * along[rod] * (1.0 if rods.between[rod, 0] == row else -1.0)
        found.append(Force(model.describe(rods[rod]), "rod", *pull.tolist()))
    loads, time, rest = model.loads, model.clock.time, particles.applied_force[row].copy()
    for k in np.flatnonzero(loads.on == row).tolist():
        x, y = (factor_at(loads.history[k], time) * loads.force[k]).tolist()
        rest -= (x, y)
        found.append(Force(model.describe(loads[k]), "load", x, y, k))
    weight = particles.mass[row] * (particles.acceleration[row] + environment.acceleration) / 1000.0
    for name, own in (("force", particles.force[row] + environment.force), ("weight", weight)):
        rest -= own
        if own.any():
            found.append(Force(name, "load", *own.tolist()))
    if np.abs(rest).max() > ROUNDING * np.abs(particles.applied_force[row]).max():
        found.append(Force("other", "load", *rest.tolist()))  # drag, laws of mods, a hand
    for part, name in ((np.array([1.0, 0.0]), "reaction x"), (np.array([0.0, 1.0]), "reaction y")):
        if (reaction := particles.reaction[row] * part).any():
            found.append(Force(name, "reaction", *reaction.tolist()))
    inertia = -left_over[row]
    if inertia.any():
        found.append(Force("inertia −m a", "inertia", *inertia.tolist()))
    return found


def on_rod(model: Model, row: int) -> list[Force]:
    """The forces of its two joints on a rod."""
    force, along = _pulls(model)
    first, last = model.rods.between[row].tolist()
    pull = (force[row] * along[row]).tolist()
    names = model.particles.names
    return [
        Force(f"at {names[first]}", "rod", -pull[0], -pull[1]),
        Force(f"at {names[last]}", "rod", *pull),
    ]
