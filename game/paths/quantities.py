"""Quantities: any number of a session that can be read, by a path such as rods.AB.axial_force."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from components.field import Field
from components.model import Model
from components.spelling import remedy
from components.table import Table
from game.commands.reports.results import ENERGIES
from game.paths.target import PathError, Target, locate_one

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
    try:
        target = locate_one(model, path, _numbers)
    except PathError as error:
        raise QuantityError(f"{path}: {error}") from None
    if target.field.shape and not target.axis:
        raise QuantityError(f"{path}: write {target.key}.x or {target.key}.y.")
    return _of_element(path, target)


def _numbers(table: Table[Any]) -> Mapping[str, Field[Any]]:
    return {name: field for name, field in table.fields.items() if field.dtype in (float, int, bool)}


def _energy(path: str, name: str) -> Quantity:
    if name not in ENERGIES:
        raise QuantityError(f"{path}: there is no energy '{name}'; {remedy(name, ENERGIES)}")
    return Quantity(path, name.replace("_", " "), "J", lambda session: float(session.energy.as_dict()[name]))


def _of_element(path: str, target: Target) -> Quantity:
    handle, field, axis = target.handles[0], target.field, target.axis
    unit, factor = field.shown
    of = handle.world.describe(handle)
    name = f"{field.title}{f' {axis}' if axis else ''} of {of}"

    def read(session: Session) -> float:
        if not handle.exists or handle.world is not session.model:
            return math.nan
        value = session.model.column(f"{handle.table}.{field.name}")[handle.row]
        return float(value["xy".index(axis)] if axis else value) * factor

    return Quantity(path, name, unit, read)
