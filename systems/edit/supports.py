"""Supports: holding particles in one direction or both."""

from __future__ import annotations

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


def next_support(model: Model, particles: list[Particle]) -> str:
    """Give all these particles the support that follows on that of the first; returns what it is called."""
    following = CYCLE[(CYCLE.index(particles[0].fixed) + 1) % len(CYCLE)]
    model.assign(particles, "fixed", [following] * len(particles))
    return NAMES[following]
