"""External forces of statics: what load factors multiply, and what acts in full from the first one on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from components.load import static_factor
from components.model import Model
from systems.statics.equations import Array


@dataclass(frozen=True)
class External:
    """scaled: forces and loads at factor 1; steady: mass × accelerations (kN, (n, 2)); notes: sentences."""

    scaled: Array
    steady: Array
    notes: tuple[str, ...]

    def at(self, factor: float) -> Array:
        """All external force at a load factor."""
        return factor * self.scaled + self.steady


def external_forces(model: Model) -> External:
    """The forces on a model; a load that varies in time counts with the factor its history has in statics."""
    particles, environment = model.particles, model.environment
    scaled = particles.force + np.array(environment.force)
    notes = []
    for load in model.loads:
        factor = static_factor(load.history)
        np.add.at(scaled, load.on, factor * np.array(load.force))
        if factor == 0.0:
            notes.append(f"The {load.history['kind']} load on {load.particle.name} counts as 0 in statics.")
    acceleration = particles.acceleration + np.array(environment.acceleration)
    return External(scaled, particles.mass[:, None] * acceleration / 1000.0, tuple(notes))
