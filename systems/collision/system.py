"""The step systems of collisions: what they contribute to a plan, and when they are needed."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.clock import PersistentContacts
from pinjoint.components.language import marked
from pinjoint.components.model import Model
from pinjoint.components.obstacles import any_obstacles, obstacles
from pinjoint.systems.base import Integrator, StepSystem
from pinjoint.systems.broad_phase import nearest

REST_HEIGHT = 1e-9  # of the smaller radius; bounces that would rise less end in contact


class Collision(StepSystem):
    """Impacts between discs, detected at their exact times.

    It declares that it acts at instants (`impulsive`), between the steps of an integrator, which then end at impacts
    (driven/stepper.py); a plan whose systems all leave flight exact needs no integrator (free/flight.py).
    """

    name = "collision.discs"
    unneeded = marked("no particle can meet another or an obstacle; or settings.collisions is off")
    reads = ("particles.radius", "particles.mobility", "settings.restitution")
    writes = ("particles.velocity", "clock.collisions", "clock.dissipated_impact")
    impulsive = True
    between = "pinjoint.systems.collision.driven.compiled:BETWEEN"

    def needs(self, model: Model) -> bool:
        return model.settings.collisions and can_touch(model)

    def leaves_flight_exact(self, model: Model) -> bool:
        return True


def can_touch(model: Model) -> bool:
    """True if there are two particles that a rod does not join, or one and an obstacle, of which one can move."""
    mobility = model.particles.mobility
    movable: NDArray[np.bool_] = (mobility[:, 0] > 0.0) | (mobility[:, 1] > 0.0)
    if any_obstacles(model) and movable.any():
        return True
    count, moving = len(movable), int(movable.sum())
    held = count - moving
    pairs = count * (count - 1) // 2 - held * (held - 1) // 2
    if pairs > model.rods.count:
        return True
    between = model.rods.between
    joined = movable[between[:, 0]] | movable[between[:, 1]]
    return pairs > int(joined.sum())


def persistent_contacts(model: Model) -> PersistentContacts | None:
    """The persistent contacts of driven particles, if there are any."""
    contacts = model.clock.collision_state
    if type(contacts) is not PersistentContacts or not len(contacts.pairs):  # isinstance of a Mapping is slow
        return None
    return contacts if contacts.pairs.max() < model.particles.count + len(obstacles(model)) else None


def normals(model: Model, pairs: NDArray[np.int64]) -> NDArray[np.float64]:
    """Unit vectors from the first of pairs to the second, which may be obstacles, shape (k, 2)."""
    place, others = model.particles.position + model.particles.displacement, obstacles(model)
    start, span = np.concatenate([place, others.start]), np.concatenate([np.zeros_like(place), others.span])
    line = nearest(start[pairs[:, 1]] - place[pairs[:, 0]], span[pairs[:, 1]])
    return line / np.hypot(line[:, 0], line[:, 1])[:, None]


def support_forces(
    normal: NDArray[np.float64], pairs: NDArray[np.int64], forces: NDArray[np.float64], count: int
) -> NDArray[np.float64]:
    """Force on each of `count` particles (kN), shape (count, 2), by the forces (N) that keep pairs apart."""
    push = normal * (0.001 * forces)[:, None]
    total = np.zeros((count, 2))
    for d in range(2):
        total[:, d] = np.bincount(pairs[:, 1], push[:, d], count)[:count]  # obstacles come after them
        total[:, d] -= np.bincount(pairs[:, 0], push[:, d], count)
    return total


class FreeFlight(Integrator):
    """Exact: particles fly on parabolas from impact to impact, whatever the step."""

    name = "collision.free_flight"
    controlled = True
    exact = True

    @staticmethod
    def stable_step(frequency: float, decay: float) -> float:
        """Infinite."""
        return math.inf
