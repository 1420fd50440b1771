"""The step systems that Pinjoint brings along, and the systems that mods add."""

from __future__ import annotations

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.load import CONSTANT, HISTORIES
from pinjoint.components.model import Model
from pinjoint.systems.base import Law, StepSystem, System
from pinjoint.systems.collision.system import Collision
from pinjoint.systems.edit.pull import Pull
from pinjoint.systems.loads.system import VaryingLoads
from pinjoint.systems.physics.system import (
    AxialDamping,
    AxialDampingOfCables,
    Bending,
    BendingDamping,
    Buckling,
    Drag,
    Elasticity,
    ElasticityAfterYielding,
    Slackness,
    TurningDrag,
)
from pinjoint.systems.plasticity.system import FirstHinges, FirstYield, Hinges, Strength, Turning, Yielding
from pinjoint.systems.schedule import Schedule


def step_systems() -> list[StepSystem]:
    """The laws, the commits and the collisions of Pinjoint, in order of registration."""
    return [
        Elasticity(),
        ElasticityAfterYielding(),
        AxialDamping(),
        AxialDampingOfCables(),
        Slackness(),
        Buckling(),
        Bending(),
        BendingDamping(),
        Drag(),
        TurningDrag(),
        Strength(),
        Yielding(),
        FirstYield(),
        Hinges(),
        Turning(),
        FirstHinges(),
        Collision(),
        *(VaryingLoads(kind) for kind in HISTORIES.values() if kind.name != CONSTANT["kind"]),
    ]


def all_systems(pull: Pull | None = None) -> list[System]:
    """The step systems of Pinjoint, with the pull of a hand, then the systems of mods, frame systems among them."""
    return [*step_systems(), pull or Pull(), *(make() for make in EXTENSIONS.systems)]


def left_out_of_statics(model: Model) -> list[str]:
    """The laws of mods, by name, that a model needs and statics does not know."""
    if all(mod.included for mod in EXTENSIONS.mods):
        return []  # in no time: a schedule takes a third of what settling 15 rods does, and ours bring laws of loads only
    plan = Schedule(all_systems()).step_plan("simulation", model)
    laws = (law for law in plan if isinstance(law, Law) and law.mod is not None)
    return [law.name for law in laws if law.each != "loads"]
