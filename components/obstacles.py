"""Obstacles: straight pieces that never move, with which particles collide, and the kinds of elements that are some."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from components.table import Table
from components.world import Handle

if TYPE_CHECKING:
    from components.model import Model

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Pieces:
    """Straight pieces, each all points within a radius of a line from one end to the other.

    ends: shape (m, 2, 2), m; equal ends make a disc. owner: rows of the elements whose pieces they are, shape
    (m,). radius: m; restitution: of impacts with them, NaN for that of the settings; shape (m,) or one for all.
    """

    ends: Floats
    owner: NDArray[np.intp]
    radius: Floats | float = 0.0
    restitution: Floats | float = np.nan


@dataclass(frozen=True)
class Obstacles:
    """All pieces of a model. start, span: their first ends and the way to the others, shape (m, 2), m.

    radius, restitution: shape (m,). names: of what a person calls them, one each.
    """

    start: Floats
    span: Floats
    radius: Floats
    restitution: Floats
    names: list[str]

    def __len__(self) -> int:
        return len(self.radius)


NO_OBSTACLES = Obstacles(np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0), np.zeros(0), [])

Shape = Callable[[Table[Any]], Pieces]

SHAPES: dict[type[Handle], Shape] = {}  # the kinds of elements with which particles collide


def obstacles(model: Model) -> Obstacles:
    """The pieces of all elements of the kinds in SHAPES, with the restitution of the settings where none is given."""
    if not any_obstacles(model):
        return NO_OBSTACLES
    parts = [(model.tables[kind.table], shape) for kind, shape in SHAPES.items() if kind.table in model.tables]
    found = [(table, shape(table)) for table, shape in parts if table.count]
    ends = np.concatenate([np.zeros((0, 2, 2)), *(pieces.ends for _, pieces in found)])
    restitution = _joined(found, "restitution")
    return Obstacles(
        start=ends[:, 0],
        span=ends[:, 1] - ends[:, 0],
        radius=_joined(found, "radius"),
        restitution=np.where(np.isnan(restitution), model.settings.restitution, restitution),
        names=[table.names[row] for table, pieces in found for row in pieces.owner.tolist()],
    )


def _joined(found: list[tuple[Table[Any], Pieces]], name: str) -> Floats:
    parts = [np.broadcast_to(getattr(pieces, name), len(pieces.ends)) for _, pieces in found]
    return np.concatenate([np.zeros(0), *parts])


def any_obstacles(model: Model) -> bool:
    """True if there is anything of a kind with which particles collide."""
    return any(model.tables[kind.table].count for kind in SHAPES if kind.table in model.tables)
