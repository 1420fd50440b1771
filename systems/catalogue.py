"""The laws and commits that Pinjoint brings along."""

from __future__ import annotations

from systems.base import StepSystem
from systems.collision.system import Collision, Support
from systems.loads.system import varying_loads
from systems.physics.system import (
    AxialDamping,
    AxialDampingOfCables,
    Drag,
    Elasticity,
    ElasticityAfterYielding,
    Slackness,
)
from systems.plasticity.system import Strength, Yielding


def step_systems() -> list[StepSystem]:
    """All of them, in order of registration."""
    return [
        Elasticity(),
        ElasticityAfterYielding(),
        AxialDamping(),
        AxialDampingOfCables(),
        Slackness(),
        Drag(),
        Strength(),
        Yielding(),
        Collision(),
        Support(),
        *varying_loads(),
    ]
