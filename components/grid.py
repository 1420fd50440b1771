"""Grid: a drawing aid that particles snap to; at most one is shown."""

from __future__ import annotations

from components.field import Field, Vector
from components.world import Handle


class Grid(Handle):
    """Equally spaced vertical and horizontal lines through the origin."""

    __slots__ = ()
    table, noun = "grids", "grid"

    name: Field[str] = Field(title="name", doc="Unique among the grids.", default="", dtype=str)
    spacing: Field[Vector] = Field(
        "m",
        shape=(2,),
        default=0.5,
        above=0.0,
        title="spacing",
        doc="Distance between lines along x, along y.",
        shown=("cm", 100.0),
    )
    shown: Field[bool] = Field(dtype=bool, default=True, title="shown", doc="Drawn now; at most one is.")
