"""Commands: the only way in which a document changes. Applying one yields its exact inverse."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.handle import Handle


@dataclass(frozen=True)
class Create:
    """Add `count` entities of one kind at the end of its table; columns not given take their default."""

    kind: type[Handle]
    count: int
    columns: Mapping[str, Any]


@dataclass(frozen=True)
class Delete:
    """Remove entities, and whatever refers to them (a particle's rods and loads)."""

    entities: tuple[int, ...]


@dataclass(frozen=True)
class Removed:
    """What Delete took out of one table: where each row stood and everything it held.

    rows: ascending, as they were before the deletion, shape (k,). References are kept as entities.
    """

    table: str
    rows: NDArray[np.intp]
    handles: tuple[Handle, ...]
    columns: Mapping[str, NDArray[Any]]


@dataclass(frozen=True)
class Restore:
    """Put removed entities back: same esper id, same handle, same row, same values."""

    removed: tuple[Removed, ...]


@dataclass(frozen=True)
class Assign:
    """Give one Field of some entities new values; `values` has one row per entity."""

    table: str
    field: str
    entities: tuple[int, ...]
    values: NDArray[Any]


@dataclass(frozen=True)
class Group:
    """Several commands that are one step for a person."""

    commands: tuple[Command, ...]
    title: str = ""


@runtime_checkable
class Custom(Protocol):
    """A command for data outside the tables; applying it returns its exact inverse.

    A class attribute `concerns_runs = False` says that no run depends on the data.
    """

    def apply(self, world: Any) -> Command:
        """Make the change in a World; returns the inverse."""


Command = Create | Delete | Restore | Assign | Group | Custom
