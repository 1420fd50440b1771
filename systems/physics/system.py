"""Step systems of the mechanics of rods and particles."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

from components.rod import has_plastic_strain
from systems.base import Driver, Law

if TYPE_CHECKING:
    from components.model import Model


class Elasticity(Law):
    """Axial force of rods that never yielded and cannot: N = EA ε."""

    name = "physics.elasticity"
    elastic = True
    kernel = "systems.physics.kernels:elastic"
    reads = ("rods.stiffness", "rods.rest_length")
    adds = ("rods.axial_force",)

    def needs(self, model: Model) -> bool:
        return bool(model.rods.count) and not has_plastic_strain(model)


class ElasticityAfterYielding(Law):
    """Axial force of rods with plastic strain: N = EA (ε − ε_p)."""

    name = "physics.elasticity_after_yielding"
    elastic = True
    kernel = "systems.physics.kernels:elastic_after_yielding"
    reads = ("rods.stiffness", "rods.rest_length", "rods.plastic_strain")
    adds = ("rods.axial_force",)

    def needs(self, model: Model) -> bool:
        return bool(model.rods.count) and has_plastic_strain(model)


class AxialDamping(Law):
    """Viscous force along the axis of the rods, on top of N."""

    name = "physics.axial_damping"
    kernel = "systems.physics.kernels:axial_damper"
    reads = ("rods.damping",)
    adds = ("rods.axial_force",)
    account = "dissipated_damping"

    def needs(self, model: Model) -> bool:
        return bool((model.rods.damping > 0.0).any())


class Drag(Law):
    """The environment's resistance to all motion."""

    name = "physics.drag"
    each = "particles"
    kernel = "systems.physics.kernels:drag"
    reads = ("particles.mass", "particles.velocity", "environment.drag")
    adds = ("particles.force",)
    account = "dissipated_damping"

    def needs(self, model: Model) -> bool:
        return model.environment.drag > 0.0


class VelocityVerlet(Driver):
    """Second order, symplectic without dampers: energy is bounded for ever.

    Dampers are evaluated at the corrected velocity, which keeps the order and most of the stable step.
    """

    name = "physics.velocity_verlet"
    kernel = "systems.physics.integrators:velocity_verlet"
    reads = ("particles.mobility",)
    writes = ("particles.displacement", "particles.velocity", "clock.time")
    order: ClassVar[int] = 2
    conserved_energy = "kinetic − (h²/8) fᵀM⁻¹f + elastic"

    @staticmethod
    def stable_step(frequency: float, decay: float) -> float:
        """(2/ω)(√(1+ζ²) − ζ), written so that no digits cancel and that ω may be 0."""
        return 2.0 / (math.hypot(frequency, decay) + decay)


class ThesisTaylor(Driver):
    """The thesis' scheme x += v h + a h²/2, v += a h: first order, and energy grows by 1 + (ωh)²/2 a step.

    For comparison only. Without damping it is unstable at any step.
    """

    name = "physics.taylor2"
    kernel = "systems.physics.integrators:taylor2"
    reads = ("particles.mobility",)
    writes = ("particles.displacement", "particles.velocity", "clock.time")
    order: ClassVar[int] = 1

    @staticmethod
    def stable_step(frequency: float, decay: float) -> float:
        """The lesser of 4ζ/ω and 1/(ζω); 0 without damping.

        For a = −ω²x − 2ζωv the amplification matrix has trace 2 − z²/2 − 2ζz and determinant
        1 − 2ζz + z²/2 (z = ωh; the ζz³ terms cancel): by Jury's conditions z ≤ 4ζ and z ≤ 1/ζ. It holds
        for one mode; in a model, a mode with less damping than its share may still grow.
        """
        if decay == 0.0:
            return 0.0
        limit = 1.0 / decay
        return limit if frequency == 0.0 else min(limit, 4.0 * decay / frequency**2)
