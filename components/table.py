"""Table: the columns of one kind of entity, derived from the Fields of its handle class."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from components.field import Column, Field, Role

if TYPE_CHECKING:
    from components.world import Handle, World

H = TypeVar("H", bound="Handle")

_SMALLEST_CAPACITY = 8


class Table(Generic[H]):
    """All entities of one kind: one array per Field, one row per entity, in order of creation.

    `table.velocity` is the whole column as a read-only view of shape (count, ...), brought up to date
    first if it is derived; `table["B"]` is the handle of the entity with that name.
    """

    def __init__(self, world: World, name: str, kind: type[H]) -> None:
        self.world = world
        self.name = name
        self.kind = kind
        self.fields: dict[str, Field[Any]] = {}
        self.count = 0
        self.structure = 0  # revision of the last creation or deletion
        self.entity: NDArray[np.int64] = np.empty(_SMALLEST_CAPACITY, dtype=np.int64)
        self.handles: list[H] = []
        self._columns: dict[str, Column] = {}
        self._versions: dict[str, int] = {}
        self._by_name: dict[str, H] = {}
        for field in fields_of(kind):
            self.add_column(field)

    def add_column(self, field: Field[Any]) -> None:
        """Add a column that holds the field's default in every row."""
        if field.name in self.fields:
            raise ValueError(f"Table {self.name} already has a column '{field.name}'.")
        self.fields[field.name] = field
        self._columns[field.name] = field.allocate(len(self.entity))
        self._versions[field.name] = 0

    # --- reading ---------------------------------------------------------------------------------

    def __len__(self) -> int:
        return self.count

    def __iter__(self) -> Iterator[H]:
        return iter(tuple(self.handles))

    def __contains__(self, name: object) -> bool:
        return name in self._by_name

    def __getitem__(self, key: str | int) -> H:
        if isinstance(key, str):
            if key not in self._by_name:
                raise KeyError(self.world.missing(self.name, key, self._by_name))
            return self._by_name[key]
        return self.handles[key]

    def __getattr__(self, name: str) -> Column:
        if name.startswith("_") or name not in self.fields:
            raise AttributeError(f"Table {self.name} has no column '{name}'.")
        return self.column(name)

    def column(self, name: str) -> Column:
        """The column as a read-only view, shape (count, ...), derived columns up to date."""
        view = self.current(name)[: self.count]
        view.flags.writeable = False
        return view

    def current(self, name: str) -> Column:
        """The column's storage, over its whole capacity, derived columns up to date."""
        if self.fields[name].role is Role.DERIVED:
            self.world.refresh(f"{self.name}.{name}")
        return self._columns[name]

    @property
    def entities(self) -> NDArray[np.int64]:
        """esper ids in row order, shape (count,)."""
        return self.entity[: self.count]

    @property
    def names(self) -> list[str]:
        """Names in row order."""
        return [str(name) for name in self._columns["name"][: self.count]]

    def version(self, name: str) -> int:
        """The revision at which the column last changed, creations and deletions included."""
        return max(self._versions[name], self.structure)

    def fields_in(self, *roles: Role) -> list[Field[Any]]:
        """The fields with one of these roles, in order of declaration."""
        return [field for field in self.fields.values() if field.role in roles]

    # --- writing (for World, and for systems through World.writable) --------------------------------

    def writable(self, name: str) -> Column:
        """The column as a writable view, shape (count, ...), marked as changed now."""
        self._versions[name] = self.world.next_revision()
        return self._columns[name][: self.count]

    def renamed(self, handle: H, old: str, new: str) -> None:
        """Keep the index of names in step."""
        if self._by_name.get(old) is handle:
            del self._by_name[old]
        self._by_name[new] = handle

    def append(self, handles: list[H], entities: NDArray[np.int64], columns: dict[str, Column]) -> None:
        """Add rows at the end; columns not given take their default."""
        first, last = self.count, self.count + len(handles)
        self._reserve(last)
        self.entity[first:last] = entities
        self.handles.extend(handles)
        for name, field in self.fields.items():
            self._columns[name][first:last] = columns[name] if name in columns else field.allocate(len(handles))
        self.count = last
        self.world.place(self, first)
        self._structure_changed()
        self._index(handles, self._columns["name"][first:last] if "name" in self.fields else ())

    def remove(self, rows: NDArray[np.intp]) -> tuple[list[H], dict[str, Column]]:
        """Take rows (ascending) out, keeping the order of the others; return what they held."""
        taken = {name: column[rows] for name, column in self._columns.items()}
        kept = np.ones(self.count, dtype=bool)
        kept[rows] = False
        left = int(kept.sum())
        for column in (self.entity, *self._columns.values()):
            column[:left] = column[: self.count][kept]
        gone = [self.handles[row] for row in rows.tolist()]
        self.handles = [self.handles[row] for row in np.flatnonzero(kept).tolist()]
        self.count = left
        self.world.place(self, 0)
        self._structure_changed()
        for name in taken.get("name", ()):
            del self._by_name[name]
        return gone, taken

    def insert(
        self,
        rows: NDArray[np.intp],
        handles: tuple[H, ...],
        entities: NDArray[np.int64],
        columns: Mapping[str, Column],
    ) -> None:
        """Put rows (ascending, as they are to be afterwards) back where `remove` found them."""
        total = self.count + len(rows)
        self._reserve(total)
        moved = np.ones(total, dtype=bool)
        moved[rows] = False
        stored = [(self._columns[name], columns[name]) for name in self.fields]
        for column, values in [(self.entity, entities), *stored]:
            column[:total][moved] = column[: self.count].copy()
            column[rows] = values
        for row, handle in zip(rows.tolist(), handles, strict=True):
            self.handles.insert(row, handle)
        self.count = total
        self.world.place(self, 0)
        self._structure_changed()
        self._index(handles, columns.get("name", ()))

    def _index(self, handles: Sequence[H], names: Iterable[str]) -> None:
        self._by_name.update(zip(names, handles, strict=False))

    def _structure_changed(self) -> None:
        self.structure = self.world.next_revision()

    def _reserve(self, rows: int) -> None:
        capacity = len(self.entity)
        if rows <= capacity:
            return
        capacity = max(rows, 2 * capacity)
        self.entity = _grown(self.entity, np.empty(capacity, dtype=np.int64), self.count)
        for name, field in self.fields.items():
            self._columns[name] = _grown(self._columns[name], field.allocate(capacity), self.count)


def _grown(old: Column, new: Column, count: int) -> Column:
    new[:count] = old[:count]
    return new


def fields_of(kind: type) -> list[Field[Any]]:
    """The Fields of a handle class, base classes first, in order of declaration."""
    found: dict[str, Field[Any]] = {}
    for base in reversed(kind.__mro__):
        found.update({name: value for name, value in vars(base).items() if isinstance(value, Field)})
    return list(found.values())
