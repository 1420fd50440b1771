"""Environment: what acts on every particle."""

from __future__ import annotations

from pinjoint.components.field import Field, Vector
from pinjoint.components.handle import Handle


class Environment(Handle):
    """Force, acceleration and drag on all particles. There is exactly one."""

    __slots__ = ()
    table, noun, single = "environment", "environment", True

    force: Field[Vector] = Field("kN", shape=(2,), doc="Constant force on every particle.")
    acceleration: Field[Vector] = Field(
        "m/s²", shape=(2,), doc="Acceleration of every particle, such as gravity (0, -9.81)."
    )
    drag: Field[float] = Field("1/s", minimum=0.0, doc="Resistance to motion: force = −drag × mass × velocity.")
