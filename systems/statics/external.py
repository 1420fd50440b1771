"""External forces of statics: those that load factors multiply, and those of accelerations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from components.load import static_factor
from components.model import Model
from systems.statics.equations import Array


@dataclass(frozen=True)
class External:
    """Forces (n, 2) in kN. scaled: forces and loads at factor 1; steady: mass × acceleration; notes: sentences."""

    scaled: Array
    steady: Array
    notes: tuple[str, ...]

    def at(self, factor: float) -> Array:
        """The whole external force at a load factor."""
        return factor * self.scaled + self.steady


def external_forces(model: Model) -> External:
    """The external forces on a model; a varying load counts with the factor of its history in statics."""
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
