"""Obstacles: straight pieces that never move, with which particles collide, and the kinds of elements that are some."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Array
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import Role
from pinjoint.components.language import tr
from pinjoint.components.mistake import WrongValue
from pinjoint.components.model import Model
from pinjoint.components.table import Table


@dataclass(frozen=True)
class Pieces:
    """Straight pieces, each all points within a radius of a line from one end to the other.

    ends: shape (m, 2, 2), m; equal ends make a disc. owner: rows of the elements whose pieces they are, shape
    (m,). radius: m; restitution: of impacts with them, NaN for that of the settings; shape (m,) or one for all.
    """

    ends: Array
    owner: NDArray[np.intp]
    radius: Array | float = 0.0
    restitution: Array | float = np.nan

    def check(self, table: Table[Any], source: str) -> None:
        """Raise ValueError, naming the `source` that made them, where they are none of elements of a table."""
        ends, owner, count = np.asarray(self.ends, dtype=np.float64), np.asarray(self.owner), len(self.owner)
        if ends.shape != (count, 2, 2):
            raise WrongValue(
                "{source}: `ends` has the shape {shape} for {count} pieces; give each piece two points [x, y].",
                source=source,
                shape=ends.shape,
                count=count,
            )
        radius, restitution = (np.broadcast_to(values, count) for values in (self.radius, self.restitution))
        if not np.isfinite(ends).all() or not (radius >= 0.0).all() or not np.isfinite(radius).all():
            raise WrongValue(
                "{source}: an end or a radius is not finite, or a radius is below 0; correct it.", source=source
            )
        if ((restitution < 0.0) | (restitution > 1.0)).any():
            raise WrongValue(
                "{source}: a restitution is not between 0 and 1; give such a number, or NaN for that of the settings.",
                source=source,
            )
        for row in owner[(owner < 0) | (owner >= table.count)][:1].tolist():
            raise WrongValue(
                "{source}: a piece belongs to row {row}, but there are only {count} {table}; rows count from 0.",
                source=source,
                row=row,
                count=table.count,
                table=tr(table.name),
            )


@dataclass(frozen=True)
class Obstacles:
    """All pieces of a model. start, span: their first ends and the way to the others, shape (m, 2), m.

    radius, restitution: shape (m,). names: of what a person calls them, one each.
    """

    start: Array
    span: Array
    radius: Array
    restitution: Array
    names: list[str]

    def __len__(self) -> int:
        return len(self.radius)


NO_OBSTACLES = Obstacles(np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0), np.zeros(0), [])

Shape = Callable[[Table[Any]], Pieces]


_known: WeakKeyDictionary[Model, tuple[tuple[Any, ...], Obstacles]] = WeakKeyDictionary()  # with their versions


def obstacles(model: Model) -> Obstacles:
    """The pieces of all elements with which particles collide, with the restitution of the settings where none is given."""
    if not any_obstacles(model):
        return NO_OBSTACLES
    versions = model.newest(Role.DOCUMENT), *EXTENSIONS.obstacles.values()
    known = _known.get(model)
    if known is None or known[0] != versions:
        known = _known[model] = versions, _found(model)
    return known[1]


def _found(model: Model) -> Obstacles:
    parts = [
        (model.tables[kind.table], shape)
        for kind, shape in EXTENSIONS.obstacles.items()
        if kind.table in model.tables
    ]
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


def _joined(found: list[tuple[Table[Any], Pieces]], name: str) -> Array:
    parts = [np.broadcast_to(getattr(pieces, name), len(pieces.ends)) for _, pieces in found]
    return np.concatenate([np.zeros(0), *parts])


def any_obstacles(model: Model) -> bool:
    """True if there is anything of a kind with which particles collide."""
    return any(model.tables[kind.table].count for kind in EXTENSIONS.obstacles if kind.table in model.tables)
