"""The step systems of collisions: what they contribute to a plan, and when they are needed."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Array
from pinjoint.components.clock import PersistentContacts
from pinjoint.components.language import marked
from pinjoint.components.model import Model
from pinjoint.components.obstacles import any_obstacles, obstacles
from pinjoint.systems.base import Integrator, StepSystem


class Collision(StepSystem):
    """Impacts between discs, detected at their exact times.

    It declares that it acts at instants (`impulsive`), between the steps of an integrator, which then end at impacts
    (run/program_steps.py); a plan whose systems all leave flight exact needs no integrator (free/flight.py).
    """

    name = "collision.discs"
    unneeded = marked("no particle can meet another or an obstacle; or settings.collisions is off")
    reads = ("particles.radius", "particles.mobility", "settings.restitution")
    writes = ("particles.velocity", "clock.collisions", "clock.dissipated_impact")
    impulsive = True

    def needs(self, model: Model) -> bool:
        """True if there are two particles that a rod does not join, or one and an obstacle, of which one can move."""
        if not model.settings.collisions:
            return False
        mobility = model.particles.mobility
        movable: NDArray[np.bool_] = (mobility[:, 0] > 0.0) | (mobility[:, 1] > 0.0)
        count, moving = len(movable), int(movable.sum())
        if any_obstacles(model) and moving:
            return True
        pairs = count * (count - 1) // 2 - (count - moving) * (count - moving - 1) // 2
        return pairs > model.rods.count or pairs > int(movable[model.rods.between].any(axis=1).sum())

    def leaves_flight_exact(self, model: Model) -> bool:
        return True


def persistent_contacts(model: Model) -> PersistentContacts | None:
    """The persistent contacts of driven particles, if there are any."""
    contacts = model.clock.collision_state
    if type(contacts) is not PersistentContacts or not len(contacts.pairs):  # isinstance of a Mapping is slow
        return None
    return contacts if contacts.pairs.max() < model.particles.count + len(obstacles(model)) else None


def fall_time(radius: Array, pull: Array) -> float:
    """Median time (s) in which discs of these radii (m) fall through their diameters under pulls (m/s²); ∞ without any."""
    radius, pull = radius[pull > 0.0], pull[pull > 0.0]
    with np.errstate(over="ignore"):  # what is hardly pulled falls for ever
        return float(np.median(np.sqrt(4.0 * radius / pull))) if len(pull) else math.inf


class FreeFlight(Integrator):
    """Exact: particles fly on parabolas from impact to impact, whatever the step."""

    name = "collision.free_flight"
    controlled = True
    exact = True

    @staticmethod
    def stable_step(frequency: float, decay: float) -> float:
        """Infinite."""
        return math.inf
