"""Snapshot: all state of a model at one moment. The document is not part of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from components.field import Column, Role
from components.world import World


@dataclass(frozen=True)
class Snapshot:
    """Copies of every state column, by "table.field", and of which entities their rows belong to."""

    columns: dict[str, Column]
    entities: dict[str, NDArray[np.int64]]

    @classmethod
    def take(cls, world: World, *tables: str) -> Snapshot:
        """Copy the state of these tables; none given: of all."""
        chosen = [world.tables[name] for name in tables or world.tables]
        columns = {
            f"{table.name}.{field.name}": table.column(field.name).copy()
            for table in chosen
            for field in table.fields_in(Role.STATE)
        }
        return cls(columns, {table.name: table.entities.copy() for table in chosen})

    def column(self, world: World, name: str) -> Column:
        """A state column, "table.field", by the rows of now; entities that did not exist then get its default."""
        table = world.tables[name.partition(".")[0]]
        then = self.entities[table.name]
        if np.array_equal(then, table.entities):
            return self.columns[name]
        rows = world.row_of_entity[then]
        column = table.fields[name.partition(".")[2]].allocate(table.count)
        column[rows[rows >= 0]] = self.columns[name][rows >= 0]
        return column

    def restore(self, world: World) -> None:
        """Put the state back, bit for bit; entities that did not exist then get their defaults."""
        for name in self.columns:
            world.writable(name)[...] = self.column(world, name)
