"""Step systems of the mechanics of rods and particles."""

from __future__ import annotations

from pinjoint.components.language import marked
from pinjoint.components.model import Model
from pinjoint.components.rod import bends, can_yield, has_cables, has_struts
from pinjoint.systems.base import Law


class Elasticity(Law):
    """Axial force of rods that never yielded and cannot: N = EA ε."""

    name = "physics.elasticity"
    unneeded = marked("the model has no rods, or some have yielded or can (physics.elasticity_after_yielding)")
    elastic = True
    kernel = "pinjoint.systems.physics.kernels:elastic"
    reads = ("rods.stiffness", "rods.rest_length")
    adds = ("rods.axial_force",)

    def needs(self, model: Model) -> bool:
        return bool(model.rods.count) and not ElasticityAfterYielding().needs(model)


class ElasticityAfterYielding(Law):
    """Axial force of rods with plastic strain: N = EA (ε − ε_p)."""

    name = "physics.elasticity_after_yielding"
    unneeded = marked("no rod has yielded or can")
    elastic = True
    kernel = "pinjoint.systems.physics.kernels:elastic_after_yielding"
    reads = ("rods.stiffness", "rods.rest_length", "rods.plastic_strain")
    adds = ("rods.axial_force",)

    def needs(self, model: Model) -> bool:
        return can_yield(model) or bool(model.rods.plastic_strain.any())


class AxialDamping(Law):
    """Viscous force along the axis of the rods, on top of N."""

    name = "physics.axial_damping"
    unneeded = marked("no rod has a damper, or there are cables (physics.axial_damping_of_cables)")
    kernel = "pinjoint.systems.physics.kernels:axial_damper"
    reads = ("rods.damping",)
    adds = ("rods.axial_force",)
    account = "dissipated_damping"

    def needs(self, model: Model) -> bool:
        return bool((model.rods.damping > 0.0).any()) and not has_cables(model)


class Slackness(Law):
    """Cables do not push: N ≥ 0. Where one goes slack or taut, integrators that locate events end a step."""

    name = "physics.slackness"
    elastic = True
    unneeded = marked("the model has no cables")
    kernel = "pinjoint.systems.physics.kernels:taut"
    branch = "pinjoint.systems.physics.kernels:slack_branch"
    margin = "pinjoint.systems.physics.kernels:slack_margin"
    after = ("physics.elasticity", "physics.elasticity_after_yielding")
    reads = ("rods.tension_only", "rods.rest_length", "rods.plastic_strain")
    adds = ("rods.axial_force",)

    def needs(self, model: Model) -> bool:
        return has_cables(model)


class Buckling(Law):
    """Struts bend aside at Euler's load, and bear little more beyond; integrators that locate events end a step there."""

    name = "physics.buckling"
    elastic = True
    unneeded = marked("the model has no struts that buckle")
    kernel = "pinjoint.systems.physics.kernels:buckled"
    potential = "pinjoint.systems.physics.kernels:buckling_energy"
    branch = "pinjoint.systems.physics.kernels:buckling_branch"
    margin = "pinjoint.systems.physics.kernels:buckling_margin"
    after = (*Slackness.after, Slackness.name, "plasticity.strength")
    reads = ("rods.stiffness", "rods.rest_length", "rods.plastic_strain", "rods.buckling_load")
    adds = ("rods.axial_force",)

    def needs(self, model: Model) -> bool:
        return has_struts(model)


class AxialDampingOfCables(Law):
    """Axial damping in a model with cables: a cable's damper acts while it is taut, and never makes it push."""

    name = "physics.axial_damping_of_cables"
    unneeded = marked("the model has no cables with dampers")
    kernel = "pinjoint.systems.physics.kernels:taut_damper"
    reads = ("rods.damping", "rods.tension_only")
    adds = ("rods.axial_force",)
    account = "dissipated_damping"

    def needs(self, model: Model) -> bool:
        return bool((model.rods.damping > 0.0).any()) and has_cables(model)


class Bending(Law):
    """Moments on the ends of rods that bend, by the slopes of these to the chord; N in the bowed axis adds to them.

    Where rods are warmer on one side, slopes count from those without moments.
    """

    name = "physics.bending"
    unneeded = marked("no rod bends")
    each = "ends"
    kernel = "pinjoint.systems.physics.kernels:bending"
    potential = "pinjoint.systems.physics.kernels:bending_energy"
    reads = ("rods.end_stiffness", "rods.initial_slopes")
    adds = ("rods.end_moment",)

    def needs(self, model: Model) -> bool:
        return bends(model)


class BendingDamping(Law):
    """Viscous moments on the ends of rods that bend."""

    name = "physics.bending_damping"
    unneeded = marked("no rod that bends has a damper")
    each = "ends"
    kernel = "pinjoint.systems.physics.kernels:bending_damper"
    reads = ("rods.end_damping",)
    adds = ("rods.end_moment",)
    account = "dissipated_damping"

    def needs(self, model: Model) -> bool:
        return bool(model.rods.end_damping.any())


class TurningDrag(Law):
    """The environment's resistance to all turning."""

    name = "physics.turning_drag"
    unneeded = marked("the drag of the environment is 0, or no rod bends")
    each = "rotations"
    kernel = "pinjoint.systems.physics.kernels:turning_drag"
    reads = ("particles.inertia", "particles.angular_velocity", "environment.drag")
    adds = ("particles.applied_moment",)
    account = "dissipated_damping"

    def needs(self, model: Model) -> bool:
        return model.environment.drag > 0.0 and bends(model)


class Drag(Law):
    """The environment's resistance to all motion."""

    name = "physics.drag"
    unneeded = marked("the drag of the environment is 0")
    each = "particles"
    kernel = "pinjoint.systems.physics.kernels:drag"
    reads = ("particles.mass", "particles.velocity", "environment.drag")
    adds = ("particles.force",)
    account = "dissipated_damping"

    def needs(self, model: Model) -> bool:
        return model.environment.drag > 0.0
