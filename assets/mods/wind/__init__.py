"""Wind: air resistance ½ ρ A |u − v| (u − v) on every particle with a sail area A."""

from __future__ import annotations

import math

from pinjoint.api import (
    App,
    Component,
    Context,
    Environment,
    Field,
    Law,
    Model,
    Particle,
    Readout,
    compiled,
    tr,
)

DENSITY = 1.2  # kg/m³, of air


class Air(Component):
    of = Environment
    velocity: Field[tuple[float, float]] = Field(
        "m/s", shape=(2,), title="wind velocity", doc="Of the air, everywhere."
    )


class Sail(Component):
    of = Particle
    area: Field[float] = Field("m²", minimum=0.0, title="sail area", doc="Drag coefficient × area in the wind.")


@compiled
def push(environment_wind_velocity, particles_wind_area, particles_velocity):
    x = environment_wind_velocity[0] - particles_velocity[0]
    y = environment_wind_velocity[1] - particles_velocity[1]
    factor = 0.0005 * DENSITY * particles_wind_area * (x * x + y * y) ** 0.5  # N → kN
    return factor * x, factor * y


class Push(Law):
    name = "wind.push"
    each = "particles"
    kernel = push
    reads = ("environment.wind_velocity", "particles.wind_area", "particles.velocity")
    adds = ("particles.force",)

    def needs(self, model: Model) -> bool:
        return bool(model.particles.wind_area.any())


def panel(session: Context) -> Readout:
    speed = math.hypot(*session.environment.wind_velocity)
    return Readout(tr("Wind"), ((tr("speed"), tr("{speed:.3g} m/s", speed=speed)),))


def plugin(app: App) -> None:
    app.component(Air)
    app.component(Sail)
    app.system(Push)
    app.panel(panel)
