"""Settings: how a model is computed and drawn; part of the document."""

from __future__ import annotations

from typing import Any

from components.field import Field, FieldError
from components.world import Handle

AUTOMATIC = "automatic"
INTEGRATORS: dict[str, str] = {AUTOMATIC: "chosen for the model by a fixed rule"}


def check_integrator(value: Any, where: str) -> str:
    """A registered integrator's name, or FieldError."""
    if not isinstance(value, str) or value not in INTEGRATORS:
        raise FieldError(f"{where}: integrator is {value!r}; choose one of {', '.join(INTEGRATORS)}.")
    return value


class Settings(Handle):
    """Choices about computing and drawing. There is exactly one."""

    __slots__ = ()
    table, noun, single = "settings", "settings", True

    restitution: Field[float] = Field(
        default=1.0,
        minimum=0.0,
        maximum=1.0,
        title="coefficient of restitution",
        doc="Of every impact: 0 inelastic, 1 elastic.",
    )
    time_step: Field[float | None] = Field(
        "s", default=None, nullable=True, above=0.0, title="time step", doc="None: automatic."
    )
    integrator: Field[str] = Field(
        default=AUTOMATIC, dtype=str, title="integrator", doc="How time advances.", checker=check_integrator
    )
    collisions: Field[bool] = Field(dtype=bool, default=True, title="collisions", doc="Particles collide.")
    plasticity: Field[bool] = Field(
        dtype=bool, default=True, title="plasticity", doc="Rods with a strength yield."
    )
    displacement_scale: Field[float] = Field(
        default=1.0, minimum=0.0, title="displacement scale", doc="Displacements are drawn this much larger."
    )
    diagram_scale: Field[float] = Field(
        "px/kN", default=1.0, minimum=0.0, title="force diagram scale", doc="Size of the force diagrams."
    )
