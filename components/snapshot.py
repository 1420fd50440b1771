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

    def restore(self, world: World) -> None:
        """Put the state back, bit for bit; entities that did not exist then get their defaults."""
        for name, column in self.columns.items():
            table = world.tables[name.partition(".")[0]]
            target = world.writable(name)
            then = self.entities[table.name]
            if np.array_equal(then, table.entities):
                target[...] = column
                continue
            rows = world.row_of_entity[then]
            target[...] = table.fields[name.partition(".")[2]].allocate(table.count)
            target[rows[rows >= 0]] = column[rows >= 0]
