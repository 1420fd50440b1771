"""Snapshot: all state of a model at one moment. The document is not part of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import Column, Role
from pinjoint.components.world import Layout, World


@dataclass(frozen=True)
class Snapshot:
    """Copies of all state as it is stored, and which entities its rows belong to, by table.

    layout: the table and the columns that each array holds; several are numbers of a table with a single row.
    """

    layout: Layout
    arrays: tuple[Column, ...]
    entities: dict[str, NDArray[np.int64]]

    @classmethod
    def take(cls, world: World, *tables: str) -> Snapshot:
        """Copy the state of these tables; none given: of all."""
        layout = world.layout(Role.STATE, tables)
        arrays = [world.tables[table].storage(*group).copy() for table, group in layout]
        return cls(layout, tuple(arrays), world.orders)

    @classmethod
    def initial(cls, world: World) -> Snapshot:
        """The state in which nothing has moved and no time has passed."""
        layout = world.layout(Role.STATE, ())
        arrays = [
            fields[group[0]].allocate(world.tables[table].count)
            if len(group) == 1
            else np.array([fields[name].stored(fields[name].default) for name in group], dtype=np.float64)
            for table, group in layout
            for fields in (world.tables[table].fields,)
        ]
        return cls(layout, tuple(arrays), world.orders)

    @cached_property
    def columns(self) -> dict[str, Column]:
        """The columns, by "table.field"."""
        return {
            f"{table}.{name}": array if len(group) == 1 else array[place : place + 1]
            for (table, group), array in zip(self.layout, self.arrays, strict=True)
            for place, name in enumerate(group)
        }

    @property
    def size(self) -> int:
        """Bytes that it takes."""
        objects = (entry for array in self.arrays if array.dtype.hasobject for entry in array)
        return sum([array.nbytes for array in self.arrays]) + sum(
            getattr(entry, "nbytes", 0) for entry in objects
        )

    def column(self, world: World, name: str) -> Column:
        """A state column, "table.field", by the rows of now; entities that did not exist then get its default."""
        table_name, _, field = name.partition(".")
        if self._has_rows_of_now(world, table_name):
            return self.columns[name]
        table, rows = world.tables[table_name], world.row_of_entity[self.entities[table_name]]
        column = table.fields[field].allocate(table.count)
        column[rows[rows >= 0]] = self.columns[name][rows >= 0]
        return column

    def restore(self, world: World) -> None:
        """Put the state back, bit for bit; entities that did not exist then get their defaults."""
        for (name, group), array in zip(self.layout, self.arrays, strict=True):
            table = world.tables[name]
            as_now = len(group) > 1 or self._has_rows_of_now(world, name)
            table.storage(*group)[...] = array if as_now else self.column(world, f"{name}.{group[0]}")
            table.mark(group[:1], Role.STATE)

    def _has_rows_of_now(self, world: World, table: str) -> bool:
        """True if the rows of a table belong to the same entities as then."""
        now = world.orders
        return self.entities is now or np.array_equal(self.entities[table], now[table])
