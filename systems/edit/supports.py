"""Supports: holding particles in one direction or both."""

from __future__ import annotations

import math

from components.field import Vector
from components.model import Model
from components.particle import Particle

# Supports in the order in which pressing the key goes through them, with their names.
CYCLE = ((False, False), (True, True), (False, True), (True, False))
NAMES = {
    (False, False): "free",
    (True, True): "pinned: held in x and y",
    (False, True): "on a roller: held in y",
    (True, False): "on a roller: held in x",
}


DIAGONAL = math.tan(math.pi / 8.0)  # tan 22.5°; a direction farther from an axis counts along both


def next_support(model: Model, particles: list[Particle]) -> str:
    """Give particles the support after that of the first one; returns its name."""
    return support(model, particles, CYCLE[(CYCLE.index(particles[0].fixed) + 1) % len(CYCLE)])


def support(model: Model, particles: list[Particle], fixed: tuple[bool, bool]) -> str:
    """Hold particles in x and y, or not; returns the name of the support."""
    model.assign(particles, "fixed", [fixed] * len(particles))
    return NAMES[fixed]


def support_towards(along: Vector) -> tuple[bool, bool]:
    """The directions that a ground at that side holds: y below or above, x at a side, both in between."""
    across, up = abs(along[0]), abs(along[1])
    return across > DIAGONAL * up, up > DIAGONAL * across
