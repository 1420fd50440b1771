"""Table: the columns of one kind of entity, derived from the Fields of its handle class."""

from __future__ import annotations

import itertools
import weakref
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from functools import cache
from typing import Any, Generic, NoReturn, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import MADE, Column, Field, Role
from pinjoint.components.language import tr
from pinjoint.components.mistake import NotFound, WrongValue
from pinjoint.components.wording import missing


class Store(Protocol):
    """A world, as its tables and handles know it."""

    tables: dict[str, Table[Any]]
    row_of_entity: NDArray[np.int64]
    structure: int
    solution: Any
    columns_read: dict[str, Column]

    def read(self, handle: Any, field: Field[Any]) -> Any: ...
    def assign(self, handles: Sequence[Any], field_name: str, values: Any) -> None: ...
    def row(self, handle: Any) -> int: ...
    def describe(self, handle: Any, field: str = ...) -> str: ...
    def column(self, name: str) -> Column: ...
    def refresh(self, name: str) -> None: ...
    def next_revision(self, *roles: Role) -> int: ...
    def place(self, table: Table[Any], first: int) -> None: ...


H = TypeVar("H")  # the handles of a kind; see pinjoint.components.handle.Handle


class Table(Generic[H]):
    """All entities of one kind: one array per Field, one row per entity, in order of creation.

    `table.velocity` is the whole column as a read-only view of shape (count, ...), brought up to date
    first if it is derived; `table["B"]` is the handle of the entity with that name. A view follows its
    column until entities of this table are created or deleted; from then on it may show the past: take
    it again. Assigning, `table.velocity = …`, gives all entities new values, one each or the same to all,
    as one command.
    """

    name: str

    __slots__ = (
        "__weakref__",
        "_blocks",
        "_by_name",
        "_columns",
        "_first_of",
        "_lowest_number",
        "_read",
        "_shown",
        "_versions",
        "_world",
        "count",
        "entity",
        "fields",
        "handles",
        "kind",
        "name",
        "state",
        "structure",
    )

    def __init__(self, world: Store, name: str, kind: type[Any]) -> None:
        self._world = weakref.ref(world)
        object.__setattr__(self, "name", name)  # assigning to it names the entities
        self.kind = kind
        self.fields: dict[str, Field[Any]] = {}
        self.state: list[str] = []  # names of the columns that time makes
        self.count = 0
        self.structure = 0  # revision of the last creation or deletion
        self.entity: NDArray[np.int64] = np.empty(1 if kind.single else 8, dtype=np.int64)  # grows by doubling
        self.handles: list[H] = []
        self._columns: dict[str, Column] = {}
        self._read = world.columns_read
        self._shown: dict[str, Column] = {}  # columns that were read, while no rows come and go
        self._first_of: dict[str, str] = {}  # by column, the first of those that lie in one array with it
        self._versions: dict[str, int] = {}  # by the first of such columns: they change together
        self._by_name: dict[str, H] = {}
        self._lowest_number = 1  # no "rod n" below it is free
        for field in fields_of(kind):
            self.add_column(field)
        self._blocks = self._side_by_side() if kind.single else {}

    def _side_by_side(self) -> dict[tuple[str, ...], Column]:
        """Store the numbers of a single row in one array for each type and role, as step programs take them."""
        alike: dict[tuple[Any, Role], list[str]] = {}
        for name, field in self.fields.items():
            if field.dtype in (float, int) and not field.shape:
                alike.setdefault((field.dtype, field.role), []).append(name)
        blocks = {}
        for names in alike.values():
            blocks[tuple(names)] = block = np.concatenate([self._columns[name] for name in names])
            for place, name in enumerate(names):
                self._columns[name] = block[place : place + 1]
                self._first_of[name] = names[0]
        return blocks

    @property
    def world(self) -> Store:
        """The world it is part of. Raises LookupError if that is gone."""
        return self._world() or refuse_orphans(tr("these {table}", table=tr(self.name)))

    def add_column(self, field: Field[Any]) -> None:
        """Add a column that holds the field's default in every row."""
        if field.name in self.fields:
            raise WrongValue("Table {table} already has a column '{name}'.", table=self.name, name=field.name)
        earlier = itertools.takewhile(self.name.__ne__, self.world.tables)
        if field.references is not None and field.references not in earlier:
            raise WrongValue(
                "{table}.{name} must refer to a table declared before {table}.",
                table=self.name,
                name=field.name,
            )
        self.fields[field.name] = field
        self.state += [field.name] if field.role is Role.STATE else []
        self._columns[field.name] = field.allocate(len(self.entity))
        self._first_of[field.name] = field.name
        self._versions[field.name] = 0

    # --- reading ---------------------------------------------------------------------------------

    def __len__(self) -> int:
        return self.count

    def __iter__(self) -> Iterator[H]:
        return iter(tuple(self.handles))

    def __contains__(self, element: object) -> bool:
        """Whether there is an element of that name, or that element."""
        if isinstance(element, str):
            return element in self._by_name
        return isinstance(element, self.kind) and element.exists and element.world is self.world

    def __getitem__(self, key: str | int) -> H:
        if isinstance(key, str):
            if key not in self._by_name:
                raise KeyError(missing(self.name, key, self._by_name))
            return self._by_name[key]
        try:
            return self.handles[key]
        except IndexError:
            raise IndexError(
                tr(
                    "There is no row {key}; there are {count} {table}, and rows count from 0.",
                    key=key,
                    count=self.count,
                    table=tr(self.name),
                )
            ) from None

    def __getattr__(self, name: str) -> Column:
        if name in _OWN or name.startswith("_"):
            raise AttributeError(name)
        if name not in self.fields:
            raise AttributeError(missing(tr("columns of {table}", table=self.name), name, self.fields))
        return self.column(name)

    def __setattr__(self, name: str, value: Any) -> None:
        if name in _OWN and name != "name":
            object.__setattr__(self, name, value)
        elif name in self.fields:
            self.world.assign(self.handles, name, value)
        else:
            raise AttributeError(missing(tr("columns of {table}", table=self.name), name, self.fields))

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self.fields})

    def __repr__(self) -> str:
        few = ", ".join(self.names[:6]) if "name" in self.fields else ""
        return f"<{self.count} {self.name}{': ' + few if few else ''}{', …' if few and self.count > 6 else ''}>"

    def column(self, name: str) -> Column:
        """The column as a read-only view, shape (count, ...), derived columns up to date.

        Where the world shows a solution in place of the state, that of the solution.
        """
        key, made = f"{self.name}.{name}", self.fields[name].role in MADE
        if (found := (self._shown if made else self._read).get(key)) is not None:
            return found
        world = self._world()  # which may be gone
        if world is not None and world.solution is not None and not made:
            found = world.solution.columns.get(key)
        if found is None:
            storage = self.current(name)
            found = self._shown.get(key)
        if found is None:
            found = self._shown[key] = read_only(storage)[: self.count]
        if not made:
            self._read[key] = found
        return found

    def current(self, name: str) -> Column:
        """The column's storage, over its whole capacity, derived columns up to date."""
        if self.fields[name].derived:
            self.world.refresh(f"{self.name}.{name}")
        return self._columns[name]

    @property
    def entities(self) -> NDArray[np.int64]:
        """esper ids in row order, shape (count,)."""
        return read_only(self.entity[: self.count])

    @property
    def names(self) -> list[str]:
        """Names in row order."""
        return [str(name) for name in self._columns["name"][: self.count]]

    def version(self, name: str) -> int:
        """The revision at which the column, or one stored with it, last changed; creations and deletions included."""
        return max(self._versions[self._first_of[name]], self.structure)

    def fields_in(self, *roles: Role) -> list[Field[Any]]:
        """The fields with one of these roles, in order of declaration."""
        return [field for field in self.fields.values() if field.role in roles]

    # --- writing (for World, and for systems through World.writable) --------------------------------

    def writable(self, name: str) -> Column:
        """The column as a writable view, shape (count, ...), marked as changed now."""
        self._versions[self._first_of[name]] = self.world.next_revision(self.fields[name].role)
        return self._columns[name][: self.count]

    def storage(self, name: str) -> Column:
        """The column to write to, shape (count, ...), neither brought up to date nor marked as changed: the writer does."""
        return self._columns[name][: self.count]

    def together(self, names: Sequence[str]) -> Column:
        """Numbers of a single row, declared one after the other, as storage of shape (len(names),)."""
        for known, block in self._blocks.items():
            first = known.index(names[0]) if names[0] in known else len(known)
            if known[first : first + len(names)] == tuple(names):
                return block[first : first + len(names)]
        raise WrongValue(
            "{names} of {name} are not declared one after the other.", names=", ".join(names), name=self.name
        )

    def mark(self, names: Iterable[str], role: Role) -> None:
        """Mark columns, all with this role, and those stored with them as changed now."""
        versions, first_of, revision = self._versions, self._first_of, self.world.next_revision(role)
        for name in names:  # faster than an update
            versions[first_of[name]] = revision

    def arrays_of(self, names: Iterable[str]) -> list[str]:
        """One of these columns for each array that they are stored in; marking it marks all of that array."""
        return list(dict.fromkeys(self._first_of[name] for name in names))

    def free_names(self, count: int, besides: Iterable[str] = ()) -> list[str]:
        """The `count` names of the form "rod n" with the smallest n that neither are used nor among `besides`."""
        noun, used, others = self.kind.noun, self._by_name, set(besides)
        while f"{noun} {self._lowest_number}" in used:
            self._lowest_number += 1
        tried = (f"{noun} {n}" for n in itertools.count(self._lowest_number))
        return list(
            itertools.islice((name for name in tried if name not in used and name not in others), count)
        )

    def taken(self, names: Collection[str]) -> set[str]:
        """Those of these names that entities have."""
        return self._by_name.keys() & names

    def renamed(self, rows: NDArray[np.intp], old: Column) -> None:
        """Keep the index of names in step after these rows had the names `old`."""
        self._forget(set(old))
        self._index([self.handles[row] for row in rows.tolist()], self._columns["name"][rows])

    def append(self, handles: list[H], entities: NDArray[np.int64], columns: dict[str, Column]) -> None:
        """Add rows at the end; columns not given take their default."""
        first, last = self.count, self.count + len(handles)
        self._reserve(last)
        for name, field in self.fields.items():
            self._columns[name][first:last] = columns[name] if name in columns else field.allocate(len(handles))
        self.entity[first:last] = entities
        self.handles.extend(handles)
        self.count = last
        self._shown.clear()
        self.world.place(self, first)
        self._structure_changed()
        self._index(handles, self._columns["name"][first:last] if "name" in self.fields else ())

    def remove(self, rows: NDArray[np.intp]) -> tuple[list[H], dict[str, Column]]:
        """Take rows (ascending) out, keeping the order of the others; return what they held."""
        taken = {name: column[rows] for name, column in self._columns.items()}
        gone = [self.handles[row] for row in rows.tolist()]
        kept = ~flags(rows, self.count)
        self._rearrange(lambda column: column[: self.count][kept])
        self.handles = list(itertools.compress(self.handles, kept.tolist()))
        self.count = len(self.handles)
        self.world.place(self, 0)
        self._structure_changed()
        self._forget(taken.get("name", ()))
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
        old = ~flags(rows, total)
        self._rearrange(lambda column: _spread(column[: self.count], old))
        self.entity[rows] = entities
        for name, field in self.fields.items():
            self._columns[name][rows] = columns[name] if name in columns else field.allocate(len(rows))
        remaining, restored = iter(self.handles), iter(handles)
        self.handles = [next(remaining) if was_there else next(restored) for was_there in old.tolist()]
        self.count = total
        self.world.place(self, 0)
        self._structure_changed()
        self._index(handles, columns.get("name", ()))

    def _rearrange(self, arrange: Callable[[Column], Column]) -> None:
        self._shown.clear()
        self.entity = arrange(self.entity)
        for name, column in self._columns.items():
            self._columns[name] = arrange(column)

    def _forget(self, names: Iterable[str]) -> None:
        for name in names:
            del self._by_name[name]
        self._lowest_number = 1

    def _index(self, handles: Sequence[H], names: Iterable[str]) -> None:
        self._by_name.update(zip(names, handles, strict=False))

    def _structure_changed(self) -> None:
        roles = {field.role for field in self.fields.values()}
        self.structure = self.world.structure = self.world.next_revision(*roles)

    def _reserve(self, rows: int) -> None:
        capacity = len(self.entity)
        if rows <= capacity:
            return
        capacity = max(rows, 2 * capacity)
        self._shown.clear()
        self.entity = grown(self.entity, np.empty(capacity, dtype=np.int64), self.count)
        for name, field in self.fields.items():
            self._columns[name] = grown(self._columns[name], field.allocate(capacity), self.count)


_OWN = frozenset(Table.__slots__)


@cache
def table_of(kind: type[Any]) -> type[Table[Any]]:
    """The class of a kind's table: its declared columns are properties, six times as fast as what `__getattr__` finds."""
    columns = {field.name: _reader(kind, field) for field in fields_of(kind) if not hasattr(Table, field.name)}
    return type("Table", (Table,), {"__slots__": (), **columns})


def _reader(kind: type[Any], field: Field[Any]) -> property:
    key, made = f"{kind.table}.{field.name}", field.role in MADE

    def read(self: Table[Any]) -> Column:
        found = (self._shown if made else self._read).get(key)
        return self.column(field.name) if found is None else found

    return property(read)


class _ToRead:
    """The memory of an array, in the protocol of numpy, to read only; no array made of it can be made writable."""

    __slots__ = ("__array_interface__", "array")

    def __init__(self, array: Column) -> None:
        interface = array.__array_interface__
        self.array = array
        self.__array_interface__ = {**interface, "data": (interface["data"][0], True)}


def read_only(array: Column) -> Column:
    """The same numbers as an array that nobody who holds it can write to, not by its flags either."""
    return np.asarray(_ToRead(array))


def grown(old: Column, new: Column, count: int) -> Column:
    """A new column that begins with the first `count` entries of an old one."""
    new[:count] = old[:count]
    return new


def flags(rows: Any, count: int) -> NDArray[np.bool_]:
    """For each of `count` rows, whether it is among these rows; shape (count,)."""
    found = np.zeros(count, dtype=bool)
    found[rows] = True
    return found


def _spread(column: Column, where: NDArray[np.bool_]) -> Column:
    """A new column with the entries of this one in the rows where `where` is true."""
    spread = np.empty((len(where), *column.shape[1:]), dtype=column.dtype)
    spread[where] = column
    return spread


def refuse_orphans(elements: str) -> NoReturn:
    """Raise LookupError, since the world of some elements, which do not keep it alive, is gone."""
    raise NotFound(
        "The model of {elements} is gone; keep the model while you use its elements.", elements=elements
    )


def fields_of(kind: type) -> list[Field[Any]]:
    """The Fields of a handle class, base classes first, in order of declaration."""
    found: dict[str, Field[Any]] = {}
    for base in reversed(kind.__mro__):
        found.update({name: value for name, value in vars(base).items() if isinstance(value, Field)})
    return list(found.values())
