"""All systems that Pinjoint brings along, in order of registration, and those that mods add."""

from __future__ import annotations

from collections.abc import Callable

from components.settings import INTEGRATORS
from systems.base import Driver, StepSystem, System
from systems.collision.system import Collision, Support
from systems.loads.system import varying_loads
from systems.physics.integrators import (
    DormandPrince853,
    ImplicitRungeKutta4,
    RungeKutta4,
    SemiImplicitEuler,
    ThesisTaylor,
    VelocityVerlet,
)
from systems.physics.system import (
    AxialDamping,
    AxialDampingOfCables,
    Drag,
    Elasticity,
    ElasticityAfterYielding,
    Slackness,
)
from systems.plasticity.system import Strength, Yielding

DRIVERS: dict[str, Driver] = {}
SYSTEMS: list[Callable[[], System]] = []  # that mods add; made anew for every session


def register_driver(driver: Driver) -> None:
    """Make an integrator known to models, the command line and the properties."""
    key = driver.name.rpartition(".")[2]
    DRIVERS[key] = driver
    INTEGRATORS[key] = (driver.__doc__ or "").strip().partition("\n")[0]


for _driver in (
    VelocityVerlet(),
    DormandPrince853(),
    ImplicitRungeKutta4(),
    RungeKutta4(),
    SemiImplicitEuler(),
    ThesisTaylor(),
):
    register_driver(_driver)


def step_systems() -> list[StepSystem]:
    """Laws and commits."""
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


def all_systems() -> list[System]:
    """Laws and commits, then the systems of mods, frame systems among them."""
    return [*step_systems(), *(make() for make in SYSTEMS)]
