"""Supports: holding particles in one direction or both."""

from __future__ import annotations

import math

from components.field import Vector
from components.model import Model
from components.particle import Particle

# What pressing the key again leads to, and what a person calls each.
CYCLE = ((False, False), (True, True), (False, True), (True, False))
NAMES = {
    (False, False): "free",
    (True, True): "pinned: held in x and y",
    (False, True): "on a roller: held in y",
    (True, False): "on a roller: held in x",
}


DIAGONAL = math.tan(math.pi / 8.0)  # what leaves an axis by more than 22.5° goes along the other one, too


def next_support(model: Model, particles: list[Particle]) -> str:
    """Give all these particles the support that follows on that of the first; returns what it is called."""
    return support(model, particles, CYCLE[(CYCLE.index(particles[0].fixed) + 1) % len(CYCLE)])


def support(model: Model, particles: list[Particle], fixed: tuple[bool, bool]) -> str:
    """Hold all these particles in x and y, or not; returns what that is called."""
    model.assign(particles, "fixed", [fixed] * len(particles))
    return NAMES[fixed]


def support_towards(along: Vector) -> tuple[bool, bool]:
    """What a ground in that direction holds: below or above y, at a side x, in between both."""
    across, up = abs(along[0]), abs(along[1])
    return across > DIAGONAL * up, up > DIAGONAL * across
