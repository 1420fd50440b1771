"""Quantities: any number of a session that can be read, by a path such as rods.AB.axial_force."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from components.field import Field
from components.model import Model
from components.table import Table
from components.world import Handle
from game.reports.results import ENERGIES

if TYPE_CHECKING:
    from game.session import Session

FORM = "write it like rods.AB.axial_force, particles.B.displacement.y, energy.kinetic or time"
TIME = "time"


class QuantityError(ValueError):
    """A path that leads to no number; the message says why and what to write."""


@dataclass(frozen=True)
class Quantity:
    """A number that can be read at any moment.

    path: what a person writes. name: what it is of what. unit: on screen. read: its value in that unit; NaN
    while its element is deleted.
    """

    path: str
    name: str
    unit: str
    read: Callable[[Session], float]

    @property
    def title(self) -> str:
        """Name and unit."""
        return f"{self.name} ({self.unit})" if self.unit else self.name


def quantity(model: Model, path: str) -> Quantity:
    """The quantity that a path leads to. Raises QuantityError."""
    if path == TIME:
        return Quantity(path, "t", "s", lambda session: session.time)
    table, _, rest = path.partition(".")
    if table == "energy":
        return _energy(path, rest)
    if table not in model.tables or not rest:
        raise QuantityError(f"There is no quantity '{path}'; {FORM}.")
    handle, facts = _element(model.tables[table], rest, path)
    name, _, axis = facts.partition(".")
    field = model.tables[table].fields.get(name)
    if field is None or field.dtype not in (float, int, bool):
        numbers = [f.name for f in model.tables[table].fields.values() if f.dtype in (float, int, bool)]
        raise QuantityError(f"{path}: there is no number '{name}'; there are {', '.join(numbers)}.")
    if bool(field.shape) != (axis in ("x", "y")):
        raise QuantityError(f"{path}: write {name}{'.x or ' + name + '.y' if field.shape else ' only'}.")
    return _of_element(path, handle, field, axis)


def _energy(path: str, name: str) -> Quantity:
    if name not in ENERGIES:
        raise QuantityError(f"{path}: there is no energy '{name}'; there are {', '.join(ENERGIES)}.")
    return Quantity(path, name.replace("_", " "), "J", lambda session: float(session.energy.as_dict()[name]))


def _element(table: Table[Handle], rest: str, path: str) -> tuple[Handle, str]:
    """The element that a path names (names may hold dots) and what follows."""
    if table.kind.single:
        return table[0], rest
    cuts = [index for index, character in enumerate(rest) if character == "." and rest[:index] in table]
    if not cuts:
        raise QuantityError(f"{path}: {table.world.missing(table.name, rest.partition('.')[0], table.names)}")
    return table[rest[: cuts[-1]]], rest[cuts[-1] + 1 :]


def _of_element(path: str, handle: Handle, field: Field[object], axis: str) -> Quantity:
    unit, factor = field.shown
    of = handle.world.describe(handle)
    name = f"{field.title}{f' {axis}' if axis else ''} of {of}"

    def read(session: Session) -> float:
        if not handle.exists or handle.world is not session.model:
            return math.nan
        value = session.model.column(f"{handle.table}.{field.name}")[handle.row]
        return float(value["xy".index(axis)] if axis else value) * factor

    return Quantity(path, name, unit, read)
