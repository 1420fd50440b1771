"""Weight of rods as a force along them, which bends them, in place of forces at their ends."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pinjoint.components.language import begun, plural, tr
from pinjoint.components.model import Model
from pinjoint.components.rod import Rod
from pinjoint.systems.edit import Refusal

GRAVITY = (0.0, -9.81)  # m/s², where the environment has no acceleration


def weigh_along(model: Model, rods: Sequence[Rod]) -> str:
    """Let rods bear their weight all along, as one edit; returns a sentence. Raises Refusal if they have none.

    Where the environment accelerates everything, all rods do, and particles keep as accelerations of their own what is
    left of it, so that each joint bears what it bore before.
    """
    everywhere = np.array(model.environment.acceleration)
    chosen = list(model.rods) if everywhere.any() else list(rods)
    rows = np.array([rod.row for rod in chosen], dtype=np.intp)
    if not (model.rods.density[rows] > 0.0).any():
        raise Refusal(
            "These rods have no density, so they weigh nothing; give them a density or a section first."
        )
    pull = everywhere if everywhere.any() else np.array(GRAVITY)
    weight = model.rods.density[rows][:, None] * pull / 1000.0
    particles = model.particles
    with model.transaction(tr("weight as distributed force")):
        if everywhere.any():
            half = 0.5 * model.rods.density * model.rods.rest_length
            lumped = np.bincount(model.rods.between.ravel(), np.repeat(half, 2), particles.count)
            left = 1.0 - lumped / particles.mass
            left[np.abs(left) < 1e-12] = 0.0
            model.assign(list(particles), "acceleration", particles.acceleration + left[:, None] * pull)
            model.environment.acceleration = (0.0, 0.0)
        model.assign(chosen, "distributed_force", model.rods.distributed_force[rows] + weight)
    if everywhere.any():
        return tr(
            "The weight of all rods acts along them now, as distributed forces; these replace the acceleration of the"
            " environment."
        )
    return plural(
        "{rod}: its weight acts along it now, as a distributed force (9.81 m/s² downwards)",
        "{count} rods: their weight acts along them now, as distributed forces (9.81 m/s² downwards)",
        len(chosen),
        rod=begun(model.describe(chosen[0])),
    )
