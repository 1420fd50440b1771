"""Step systems of perfect plasticity."""

from __future__ import annotations

from pinjoint.components.language import marked
from pinjoint.components.model import Model
from pinjoint.components.rod import can_hinge, can_yield
from pinjoint.systems.base import Commit, Law


class Strength(Law):
    """No axial force passes a rod's strength."""

    name = "plasticity.strength"
    elastic = True
    unneeded = marked("no rod can yield: strengths are unlimited, or settings.plasticity is off")
    kernel = "pinjoint.systems.plasticity.kernels:limited"
    after = ("physics.elasticity_after_yielding",)
    reads = ("rods.tension_limit", "rods.compression_limit")
    adds = ("rods.axial_force",)

    def needs(self, model: Model) -> bool:
        return can_yield(model)


class Yielding(Commit):
    """Plastic strain takes up what exceeds the elastic range."""

    name = "plasticity.yielding"
    unneeded = marked("no rod can yield: strengths are unlimited, or settings.plasticity is off")
    kernel = "pinjoint.systems.plasticity.kernels:yielded"
    branch = "pinjoint.systems.plasticity.kernels:branch"
    margin = "pinjoint.systems.plasticity.kernels:margin"
    reads = ("rods.stiffness", "rods.rest_length", "rods.tension_limit", "rods.compression_limit")
    writes = ("rods.plastic_strain",)

    def needs(self, model: Model) -> bool:
        return can_yield(model)


class FirstYield(Commit):
    """Notes when each rod first comes to a strength."""

    name = "plasticity.first_yield"
    unneeded = Yielding.unneeded
    kernel = "pinjoint.systems.plasticity.kernels:first_yield"
    notes = True
    reads = ("rods.tension_limit", "rods.compression_limit")
    writes = ("rods.yielded_at",)

    def needs(self, model: Model) -> bool:
        return can_yield(model)


class Hinges(Law):
    """No moment on the end of a rod passes its plastic moment: the end turns in a plastic hinge."""

    name = "plasticity.hinges"
    each = "ends"
    unneeded = marked("no rod has a plastic moment, or settings.plasticity is off")
    kernel = "pinjoint.systems.plasticity.hinges:slips"
    reads = ("rods.end_stiffness", "rods.bowing", "rods.moment_limit")
    adds = ("rods.end_moment",)

    def needs(self, model: Model) -> bool:
        return can_hinge(model)


class Turning(Commit):
    """Plastic rotations take up what ends of rods slip."""

    name = "plasticity.turning"
    unneeded = Hinges.unneeded
    kernel = "pinjoint.systems.plasticity.hinges:turned"
    branch = "pinjoint.systems.plasticity.hinges:branch"
    margin = "pinjoint.systems.plasticity.hinges:margin"
    reads = ("rods.moment_limit", "rods.end_stiffness", "rods.bowing")
    writes = ("rods.plastic_rotation",)

    def needs(self, model: Model) -> bool:
        return can_hinge(model)


class FirstHinges(Commit):
    """Notes when plastic hinges first form at the ends of each rod."""

    name = "plasticity.first_hinges"
    unneeded = Hinges.unneeded
    kernel = "pinjoint.systems.plasticity.hinges:first_hinges"
    notes = True
    reads = ("rods.moment_limit",)
    writes = ("rods.hinge_formed_at",)

    def needs(self, model: Model) -> bool:
        return can_hinge(model)
