"""Grid: a drawing aid that particles snap to; at most one is shown."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import CM, Field, Vector
from pinjoint.components.handle import Handle
from pinjoint.components.table import Table


class Grid(Handle):
    """Equally spaced vertical and horizontal lines through the origin."""

    __slots__ = ()
    table, noun = "grids", "grid"

    name: Field[str] = Field(doc="Its name; no two grids have the same.", dtype=str)
    spacing: Field[Vector] = Field(
        "m", shape=(2,), default=0.5, above=0.0, doc="Distance between lines along x, along y.", shown=CM
    )
    shown: Field[bool] = Field(dtype=bool, default=True, doc="Whether it is drawn; at most one grid is.")

    @classmethod
    def after_change(cls, table: Table[Any], rows: NDArray[np.intp], changed: Collection[str]) -> None:
        """A grid that is shown hides the others; of several shown at once, the last remains."""
        shown = rows[table.shown[rows]]
        if "shown" in changed and len(shown):
            others = [grid for grid in table if grid.shown and grid.row != shown[-1]]
            table.world.assign(others, "shown", False)
