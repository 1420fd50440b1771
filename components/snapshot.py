"""Snapshot: all state of a model at one moment. The document is not part of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import Column, FieldError, Role
from pinjoint.components.language import marked
from pinjoint.components.world import World

_REFUSAL = marked(
    "{where}: this is not what Pinjoint saves here. Remove it: the run then goes on within its accuracy."
)


@dataclass(frozen=True, eq=False, repr=False)
class Snapshot(Mapping[str, Any]):
    """Copies of all state, by "table.field", and which entities its rows belong to, by table.

    As a mapping it is what a model file holds: a list of values for each column.
    """

    columns: dict[str, Column]
    entities: dict[str, NDArray[np.int64]]

    @classmethod
    def take(cls, world: World, *tables: str) -> Snapshot:
        """Copy the state of these tables; none given: of all."""
        some = (world.tables[name] for name in tables or world.tables)
        columns = {f"{t.name}.{name}": t.storage(name).copy() for t in some for name in t.state}
        return cls(columns, world.orders)

    @classmethod
    def initial(cls, world: World) -> Snapshot:
        """The state in which nothing has moved and no time has passed."""
        return cls.of_file({}, world, "")

    @classmethod
    def of_file(cls, saved: Mapping[str, Any], world: World, where: str) -> Snapshot:
        """The state of which a model file holds these columns. Raises FieldError.

        Columns of mods that are not loaded are left out; others that are missing have their defaults.
        """
        columns = {}
        for table in world.tables.values():
            for field in map(table.fields.__getitem__, table.state):
                column, key = field.allocate(table.count), f"{table.name}.{field.name}"
                if key in saved:
                    values, path = saved[key], f"{where}.{key}"
                    listed = isinstance(values, list | tuple) and len(values) == table.count
                    if not listed or field.checker is check_departure:
                        raise FieldError(_REFUSAL, where=path)
                    column = field.check_column(list(values), table.count, f"{path}[{{}}]".format)
                columns[key] = column
        return cls(columns, world.orders)

    @property
    def nbytes(self) -> int:
        """Bytes that it takes."""
        columns = self.columns.values()
        objects = (entry for column in columns if column.dtype.hasobject for entry in column)
        return sum([column.nbytes for column in columns]) + sum(getattr(o, "nbytes", 0) for o in objects)

    @property
    def steps(self) -> int:
        """How many steps had been taken."""
        return int(self.columns["clock.steps"][0])

    def __iter__(self) -> Iterator[str]:
        return (name for name, column in self.columns.items() if len(column) != 1 or column[0] is not None)

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __getitem__(self, name: str) -> Any:
        column = self.columns[name]
        if column.dtype.kind == "f" and np.isnan(column).any():
            return [None if value != value else value for value in column.tolist()]
        return column.tolist()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Snapshot) and dict(self) == dict(other)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<Snapshot after {self.steps} steps>"

    def column(self, world: World, name: str) -> Column:
        """A state column, "table.field", by the rows of now; entities that did not exist then get its default."""
        table_name, _, field = name.partition(".")
        now = world.orders
        if self.entities is now or np.array_equal(self.entities[table_name], now[table_name]):
            return self.columns[name]
        table, rows = world.tables[table_name], world.row_of_entity[self.entities[table_name]]
        column = table.fields[field].allocate(table.count)
        column[rows[rows >= 0]] = self.columns[name][rows >= 0]
        return column

    def restore(self, world: World) -> None:
        """Put the state back, bit for bit; entities that did not exist then get their defaults."""
        for table in world.tables.values():
            kept = [name for name in table.state if f"{table.name}.{name}" in self.columns]
            for name in kept:
                table.storage(name)[...] = self.column(world, f"{table.name}.{name}")
            table.mark(kept, Role.STATE)


def check_departure(value: Any, where: str) -> Mapping[str, Any]:
    """A snapshot, or what a model file holds of one, until `of_file` makes it one. Raises FieldError."""
    if isinstance(value, Mapping):
        return value
    raise FieldError(_REFUSAL, where=where)
