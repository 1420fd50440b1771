"""World: one esper context and its tables; no other code creates, deletes or switches esper's entities and worlds."""

from __future__ import annotations

import itertools
import weakref
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from typing import Any, NoReturn, Protocol, TypeVar, overload

import esper
import numpy as np
from numpy.typing import NDArray

from pinjoint.components.commands import Assign, Command, Create, Custom, Delete, Group, Removed, Restore
from pinjoint.components.field import MADE, Column, Field, FieldError, Role, same
from pinjoint.components.handle import Handle, set_entity
from pinjoint.components.language import joined, tr
from pinjoint.components.latest import Latest
from pinjoint.components.mistake import NotFound, WrongValue
from pinjoint.components.table import Table, flags, grown, table_of
from pinjoint.components.wording import as_said, cut, missing, quoted

H = TypeVar("H", bound=Handle)

_world_numbers = itertools.count(1)


@dataclass(frozen=True, eq=False)
class Derivation:
    """How derived columns follow from others: `compute` writes `targets` once any of `sources` changed."""

    targets: tuple[str, ...]
    sources: tuple[str, ...]
    compute: Callable[[World], object]


class Solution(Protocol):
    """What columns show in place of the state: an equilibrium that is found when it is asked for.

    columns: by "table.field", of as many rows as the tables have now. revision: at which they changed last.
    first_order: forces act on the original geometry. share: of the forces distributed along rods that acts.
    """

    @property
    def columns(self) -> Mapping[str, Column]: ...
    @property
    def revision(self) -> int: ...
    @property
    def first_order(self) -> bool: ...
    @property
    def share(self) -> float: ...


@dataclass(frozen=True)
class Shown:
    """A solution that was found already, or a state on the way to one; see Solution."""

    columns: Mapping[str, Column]
    revision: int
    first_order: bool
    share: float


class World:
    """A model: tables of entities. Documents change by `execute`; state by columns that `writable` grants.

    on_command: called with the inverse of every executed command (the undo log listens here).
    before_change: called before any command is applied on which runs depend (a running simulation notes what it
        starts from).
    before_command: called before a command begins; its exceptions stop the command.
    revision: grows by one at every change of anything.
    changing: a command is being applied; code that is interrupted now would leave half of it.
    solution: what columns show in place of the state; None: the state. Storage, snapshots and files hold the state anyway.
    """

    def __init__(self, kinds: Sequence[type[Handle]], derivations: Iterable[Derivation] = ()) -> None:
        self.context = f"pinjoint {next(_world_numbers)}"
        self.revision = 0
        self.structure = 0  # of the last creation or deletion
        self._orders = Latest[dict[str, NDArray[np.int64]]]()  # by `structure`
        self._newest = dict.fromkeys(Role, 0)
        self.on_command: Callable[[Command], None] | None = None
        self.before_change: Callable[[], None] | None = None
        self.before_command: Callable[[], None] | None = None
        self.row_of_entity: NDArray[np.int64] = np.full(64, -1, dtype=np.int64)
        self.tables: dict[str, Table[Any]] = {}
        self.columns_read: dict[str, Column] = {}  # at this revision: a picture reads some 300
        self.tags_revision = 0
        self._tagged: dict[type, NDArray[np.intp]] = {}  # by tag: esper ids, ascending
        self._tagged_rows: dict[type, tuple[Any, dict[str, NDArray[np.intp]]]] = {}  # with their revisions
        self.changing = False
        self.solution: Solution | None = None
        self._shown_since = 0  # revision at which the solution took the place of the state, or gave it back
        self.bent: tuple[int, Any, Any] = -1, (), {}  # how rods are bent, found at this revision (bent.py)
        self.sound = -1  # the revision up to which all numbers can be computed with (numeric_range.py)
        self._naming: Callable[[int, str], str] | None = None
        self._open: list[Command] | None = None
        self._derivations: dict[str, Derivation] = {}
        self._derived_at: dict[Derivation, int] = {}  # revision at which it was last up to date
        self._roots: dict[Derivation, tuple[Role, ...]] = {}
        weakref.finalize(self, _delete_context, self.context)
        for kind in kinds:
            self.tables[kind.table] = table_of(kind)(self, kind.table, kind)  # type: ignore[arg-type]
        for derivation in derivations:
            self.derive(derivation)
        for kind in kinds:
            if kind.single:
                self._create(Create(kind, 1, {}))

    def __reduce_ex__(self, protocol: object) -> NoReturn:
        raise TypeError(
            tr(
                "A model cannot be copied or pickled."
                " Save it, or open its document (pinjoint.documents.models) a second time."
            )
        )

    def activate(self) -> None:
        """Make this world's esper context the current one: queries and new entities are its own from now on."""
        if esper.current_world != self.context:
            esper.switch_world(self.context)

    # --- revisions -------------------------------------------------------------------------------

    def next_revision(self, *roles: Role) -> int:
        """A new revision number, greater than all before, at which columns with these roles change."""
        self.revision += 1
        self.columns_read.clear()
        for role in roles:
            self._newest[role] = self.revision
        return self.revision

    def version(self, column: str) -> int:
        """The revision at which a column, named "table.field", last changed; derived ones up to date."""
        if self.solution is not None and column in self.solution.columns:
            return max(self.solution.revision, self._shown_since)
        self.refresh(column)
        table, field = column.split(".")
        held = self.tables[table]
        return max(held.version(field), self._shown_since if field in held.state else 0)

    # --- a solution in place of the state ----------------------------------------------------------

    def show(self, solution: Solution | None) -> None:
        """Let columns show a solution from now on; None: the state."""
        if solution is not self.solution:
            self.solution, self._shown_since = solution, self.next_revision()

    @contextmanager
    def own_state(self) -> Iterator[None]:
        """Let columns show the state inside, whatever stands in its place."""
        outer = self.solution
        self.show(None)
        try:
            yield
        finally:
            self.show(outer)

    @property
    def first_order(self) -> bool:
        """True if what columns show is an equilibrium of the original geometry."""
        return self.solution is not None and self.solution.first_order

    @property
    def share(self) -> float:
        """The share of the forces distributed along rods that acts in what columns show."""
        return 1.0 if self.solution is None else self.solution.share

    def newest(self, *roles: Role) -> int:
        """The revision of the newest change to any column with one of these roles."""
        return self._newest[roles[0]] if len(roles) == 1 else max(self._newest[role] for role in roles)

    @property
    def orders(self) -> dict[str, NDArray[np.int64]]:
        """esper ids in row order by table, which later creations and deletions leave as they are."""
        tables = self.tables.items()
        return self._orders.get(self.structure, lambda: {name: t.entities.copy() for name, t in tables})

    # --- reading and writing one value -------------------------------------------------------------

    def row(self, handle: Handle) -> int:
        """The row of a handle. Raises LookupError if its entity is deleted."""
        row: int = self.row_of_entity.item(handle.entity)
        if row < 0:
            raise NotFound("This {noun} was deleted; undo brings it back.", noun=tr(handle.noun))
        return row

    def _ids(self, handles: Collection[Handle]) -> list[int]:
        """The esper ids of entities. Raises LookupError for handles of another model, whose ids mean others here."""
        try:
            ids = [handle.entity for handle in handles if handle._world() is self]
        except AttributeError:
            wrong = next(one for one in handles if not isinstance(one, Handle))
            said = tr("{value} is no element; give one, such as rods['AB'].", value=quoted(wrong))
            raise TypeError(said) from None
        if len(ids) < len(handles):
            other = next(handle for handle in handles if handle._world() is not self)
            raise NotFound(
                "{element} belongs to another model; use the {noun} of this one.",
                element=repr(other),
                noun=tr(other.noun),
            )
        return ids

    def read(self, handle: Handle, field: Field[Any]) -> Any:
        """The value of one Field of one entity."""
        if self.solution is not None and field.role not in MADE:
            column = self.solution.columns.get(f"{handle.table}.{field.name}")
            if column is not None:
                return field.loaded(column, self.row(handle))
        if field.derived:
            self.refresh(f"{handle.table}.{field.name}")
        row = self.row_of_entity.item(handle.entity)
        column = self.tables[handle.table]._columns[field.name]
        if row < 0:
            row = self.row(handle)  # raises LookupError
        return column.item(row) if field.plain else field.loaded(column, row)

    def assign(self, handles: Sequence[Handle], field_name: str, values: Any) -> None:
        """Give one Field of several entities of one kind new values, as one command. Raises FieldError.

        values: a list or array with one for each, or one for all.
        """
        if not handles:
            return
        ids = self._ids(handles)
        table = self.tables[handles[0].table]
        first = self.describe(handles[0])
        rows = self.row_of_entity[ids]
        for row in np.flatnonzero(rows < 0)[:1].tolist():
            self.row(handles[row])  # raises LookupError
        field = self._settable(table, field_name, first)
        column = self._checked(field, values, len(handles), lambda row: self.describe(handles[row]))
        if field.name == "name":
            self._check_names(table, column.tolist(), instead_of=table._columns["name"][rows].tolist())
        if same(table.current(field.name)[rows], column):
            return
        with self._edit(tr("{title} of {element}", title=field.named(), element=first)):
            self.execute(Assign(table.name, field.name, tuple(ids), column))
            table.kind.after_change(table, rows, {field.name})

    def _settable(self, table: Table[Any], name: str, where: str) -> Field[Any]:
        """The Field that takes what is assigned to a Field. Raises FieldError."""
        if name not in table.fields:
            raise FieldError(missing(tr("fields of {table}", table=table.name), name, table.fields))
        field = table.fields[name]
        if not field.derived:
            return field
        if field.overridden_by is None:
            raise FieldError(
                "{where}: {title} is computed and cannot be set.", where=where, title=field.named()
            )
        return table.fields[field.overridden_by]

    def _checked(self, field: Field[Any], values: Any, count: int, where: Callable[[int], str]) -> Column:
        """Values as a column that the Field can take. Raises FieldError."""
        if field.references is not None:
            try:
                values = self._as_rows(self.tables[field.references], values)
            except LookupError as error:
                reason = str(error.args[0])
                raise FieldError("{where}: {reason}", where=where(0), reason=reason) from None
        column = field.check_column(values, count, where)
        if field.references is not None:
            there = self.tables[field.references].count
            for row, *_ in np.argwhere(column >= there)[:1].tolist():
                raise FieldError(
                    "{where}: {title} is row {row} of the {table}, but there are only {count}; rows count from 0.",
                    where=where(row),
                    title=field.named(),
                    row=int(column[row].max()),
                    table=tr(field.references),
                    count=there,
                )
        return column

    def _as_rows(self, table: Table[Any], values: Any) -> Any:
        """Names and handles among values as the rows of their elements in a table; rows as they are."""
        if isinstance(values, str):
            return table[values].row
        if isinstance(values, Handle):
            return self.row_of_entity.item(*self._ids([values]))
        if isinstance(values, list | tuple) and values and not isinstance(values[0], int):
            return type(values)(self._as_rows(table, value) for value in values)
        return values

    def _check_names(self, table: Table[Any], names: Sequence[str], instead_of: Sequence[str] = ()) -> None:
        """Raise FieldError unless the names are not empty and, after a renaming, unique in the table."""
        noun = table.kind.noun
        given, free = set[str](), set(instead_of)
        unique = set(names)
        if all(map(str.strip, names)) and len(unique) == len(names) and table.taken(unique) <= free:
            return
        for name in names:
            if not name.strip():
                raise FieldError("The name of a {noun} is empty; type at least one character.", noun=tr(noun))
            if name in given or (name in table and name not in free):
                raise FieldError(
                    "There is a {noun} '{name}' already; choose another name.", noun=tr(noun), name=cut(name)
                )
            given.add(name)

    @contextmanager
    def naming(self, where: Callable[[int, str], str]) -> Iterator[None]:
        """While inside, call elements, and Fields of theirs, by their rows: as their document does that is read."""
        self._naming = where
        try:
            yield
        finally:
            self._naming = None

    def describe(self, handle: Handle, field: str = "") -> str:
        """A handle, or a Field of it, as a person calls it in a message, such as "rod AB"."""
        if self._naming is not None:
            return self._naming(self.row(handle), field)
        table = self.tables[handle.table]
        if "name" not in table.fields:
            return tr(handle.noun)
        return called(handle.noun, table._columns["name"][self.row(handle)])

    # --- columns for systems -------------------------------------------------------------------------

    def column(self, name: str) -> Column:
        """A column named "table.field" as a read-only view, derived columns up to date."""
        table, field = name.split(".")
        return self.tables[table].column(field)

    def writable(self, name: str) -> Column:
        """A state or derived column as a writable view, marked as changed. Documents change by commands."""
        table, field = name.split(".")
        if self.tables[table].fields[field].role in MADE:
            raise WrongValue("Column {name} is part of the document; change it by a command.", name=name)
        return self.tables[table].writable(field)

    def derive(self, derivation: Derivation) -> None:
        """Register how columns are derived; the newest registration of a target counts."""
        replaced = {self._derivations[target] for target in derivation.targets if target in self._derivations}
        for other in replaced:
            if not set(other.targets) <= set(derivation.targets):
                raise WrongValue(
                    "Columns {targets} are derived together; derive all of them.",
                    targets=", ".join(other.targets),
                )
        for other in replaced:
            del self._derived_at[other]
        for target in derivation.targets:
            self._derivations[target] = derivation
        self._derived_at[derivation] = -1
        self.next_revision()  # what was read before is out of date
        self._roots.clear()

    def refresh(self, name: str) -> None:
        """Bring a derived column, named "table.field", up to date."""
        derivation = self._derivations.get(name)
        if derivation is None or (known := self._derived_at[derivation]) == self.revision:
            return
        roots = self._roots_of(derivation)
        if max(self.newest(*roots), self.structure, self._shown_since * (Role.STATE in roots)) > known:
            new_rows = (self.tables[target.split(".")[0]].structure for target in derivation.targets)
            sources = map(self.version, derivation.sources)
            if any(changed > known for changed in itertools.chain(sources, new_rows)):
                derivation.compute(self)
        self._derived_at[derivation] = self.revision

    def _roots_of(self, derivation: Derivation) -> tuple[Role, ...]:
        """The roles of all columns that a derivation follows from, in the end."""
        if derivation not in self._roots:
            roots = set[Role]()
            for source in derivation.sources:
                table, field = source.split(".")
                further = self._derivations.get(source)
                own = (self.tables[table].fields[field].role,)
                roots.update(own if further is None else self._roots_of(further))
            self._roots[derivation] = tuple(roots)
        return self._roots[derivation]

    # --- commands ------------------------------------------------------------------------------------

    def create(self, kind: type[H], count: int = 1, **columns: Any) -> list[H]:
        """Create `count` entities of a kind; returns their handles in row order. Raises FieldError.

        columns: by Field, a list or array with one value for each, or one for all; others take their default.
        """
        table = self.tables[kind.table]
        if kind.single:
            raise WrongValue("A model has exactly one {noun}; change that one.", noun=tr(kind.noun))
        if count == 0:
            return []
        checked: dict[str, Column] = {}

        def where(row: int) -> str:
            return called(kind.noun, checked["name"][row]) if "name" in checked else tr(kind.noun)

        for field in table.fields.values():
            if field.references is not None and field.name not in columns:
                raise FieldError(
                    "A new {noun} needs '{name}': names, handles or rows of the {table}.",
                    noun=tr(kind.noun),
                    name=field.name,
                    table=tr(field.references),
                )
        names = columns.pop("name", None) if "name" in table.fields else None
        if "name" in table.fields:
            columns = {"name": table.free_names(count) if names is None else names, **columns}
        for name, values in columns.items():
            field = self._settable(table, name, kind.noun)
            checked[field.name] = self._checked(field, values, count, where)
        if names is not None:
            self._check_names(table, checked["name"].tolist())
        with self._edit(tr("new {noun}", noun=tr(kind.noun))):
            self.execute(Create(kind, count, kind.completed(checked, count)))
            kind.after_change(table, np.arange(table.count - count, table.count), table.fields)
        return table.handles[table.count - count :]

    def give(self, name: str, values: Column) -> None:
        """Execute the command that gives a whole column, named "table.field", computed values."""
        table, _, field = name.partition(".")
        entities = tuple(self.tables[table].entities.tolist())
        title = self.tables[table].fields[field].named()
        with self._edit(tr("{title} of all {table}", title=title, table=tr(table))):
            self.execute(Assign(table, field, entities, np.asarray(values).copy()))

    def delete(self, handles: Iterable[Handle]) -> None:
        """Delete entities and whatever refers to them."""
        doomed: list[int] = []
        for name, rows in self.rows_of(handles).items():
            table = self.tables[name]
            if table.kind.single and len(rows):
                raise WrongValue(
                    "A model has exactly one {noun}; it cannot be deleted.", noun=tr(table.kind.noun)
                )
            doomed += table.entities[rows].tolist()
        if doomed:
            with self._edit(tr("delete")):
                self.execute(Delete(tuple(doomed)))
                for table in self.tables.values():
                    table.kind.after_change(table, np.zeros(0, dtype=np.intp), ())

    def execute(self, command: Command) -> None:
        """Apply a command and report its inverse to the log; of a group that raises, nothing happened."""
        if isinstance(command, Group):
            with self.transaction(command.title):
                for part in command.commands:
                    self.execute(part)
            return
        if self.before_command is not None:
            self.before_command()
        outer, self.changing = self.changing, True
        try:
            self._report(self.apply(command))
        finally:
            self.changing = outer

    def _report(self, inverse: Command) -> None:
        if self._open is not None:
            self._open.append(inverse)
        elif self.on_command is not None:
            self.on_command(inverse)

    def _edit(self, title: str) -> AbstractContextManager[None]:
        """A transaction that has no title of its own inside of another one."""
        return self.transaction(title if self._open is None else "")

    @contextmanager
    def transaction(self, title: str, *, of_mod: bool = False) -> Iterator[None]:
        """Make all commands inside one entry of the log; if one raises, none of them happened. Inside, the state is shown.

        title: said by `tr`, or marked: it is shown in the language that is present then.
        of_mod: what was shown is shown inside, too, and the only transaction inside keeps its title.
        """
        inverses: list[Command] = []
        outer, self._open = self._open, inverses
        with nullcontext() if of_mod else self.own_state():
            try:
                yield
            except BaseException:
                for inverse in reversed(inverses):
                    self.apply(inverse)
                self._open = outer
                raise
            self._open = outer
            if of_mod and len(inverses) == 1 and isinstance(inverses[0], Group) and inverses[0].title:
                self._report(inverses[0])
            elif inverses:
                self._report(Group(tuple(reversed(inverses)), title))

    def apply(self, command: Command) -> Command:
        """Apply a command without telling the log; returns its exact inverse."""
        if self.before_change is not None and self._concerns_runs(command):
            with self.own_state():
                self.before_change()
        match command:
            case Create():
                return self._create(command)
            case Delete():
                return self._delete(command)
            case Restore():
                return self._restore(command)
            case Assign():
                return self._assign(command)
            case Group(commands, title):
                return Group(tuple(reversed([self.apply(part) for part in commands])), title)
            case Custom():
                return command.apply(self)

    def _concerns_runs(self, command: Command) -> bool:
        """False for a command that only changes how the model is drawn, and for a group, whose parts are asked."""
        match command:
            case Assign(table, field):
                return self.tables[table].fields[field].role is not Role.LOOK
            case Group():
                return False
            case Custom():
                return getattr(command, "concerns_runs", True)
        return True

    def _create(self, command: Create) -> Command:
        self.activate()
        table = self.tables[command.kind.table]
        handles = command.kind.of_world(self, command.count)
        entities = list(map(esper.create_entity, handles))
        deque(map(set_entity, handles, entities), maxlen=0)
        table.append(handles, np.array(entities, dtype=np.int64), dict(command.columns))
        return Delete(tuple(entities))

    def _delete(self, command: Delete) -> Command:
        self.activate()
        doomed = self._with_dependents(np.array(command.entities, dtype=np.int64))
        removed = []
        # Referring tables first, so that what they refer to can still be named by entity.
        for table in reversed(self.tables.values()):
            if table.name not in doomed:
                continue
            rows = doomed[table.name]
            references = self._references_as_entities(table, rows)
            handles, columns = table.remove(rows)
            entities = [handle.entity for handle in handles]
            self.row_of_entity[entities] = -1
            for entity in entities:
                esper.remove_component(entity, table.kind)
            self._remap_references(table, rows, inserted=False)
            removed.append(Removed(table.name, rows, tuple(handles), columns | references))
        return Restore(tuple(reversed(removed)))

    def _restore(self, command: Restore) -> Command:
        self.activate()
        entities: list[int] = []
        for piece in command.removed:
            table = self.tables[piece.table]
            columns = dict(piece.columns)
            for field in table.fields.values():
                if field.references is not None and field.name in columns:
                    columns[field.name] = self.row_of_entity[columns[field.name]]
            ids = np.array([handle.entity for handle in piece.handles], dtype=np.int64)
            table.insert(piece.rows, piece.handles, ids, columns)
            for handle in piece.handles:
                esper.add_component(handle.entity, handle)
            self._remap_references(table, piece.rows, inserted=True)
            entities.extend(ids.tolist())
        return Delete(tuple(entities))

    def _assign(self, command: Assign) -> Command:
        table = self.tables[command.table]
        rows = self.row_of_entity[np.array(command.entities, dtype=np.int64)]
        if (rows < 0).any():
            raise NotFound(
                "A {noun} that is to be changed was deleted; undo brings it back.", noun=tr(table.kind.noun)
            )
        column = table.writable(command.field)
        old = column[rows]
        column[rows] = command.values
        if command.field == "name":
            table.renamed(rows, old)
        return Assign(command.table, command.field, command.entities, old)

    def check_entities(self) -> None:
        """Raise LookupError, and put them back, if entities were deleted through esper, past the tables."""
        self.activate()
        esper.clear_dead_entities()
        whole = (len(esper.get_component(t.kind)) == t.count for t in self.tables.values() if t.count)
        if all(whole):
            return
        handles = {handle.entity: handle for table in self.tables.values() for handle in table.handles}
        last = max(*handles, *esper.get_entities())
        _delete_context(self.context)
        self.activate()
        for entity in range(1, last + 1):  # esper numbers them in order
            esper.create_entity(*([handles[entity]] if entity in handles else []))
        self.tags_revision = self.next_revision()
        raise NotFound(
            "Elements were deleted through esper, so they were restored. Use model.delete(handles), which can be undone."
        )

    # --- tags ------------------------------------------------------------------------------------------
    #
    # A tag is an array of esper ids: esper takes a microsecond for each component, and all elements of a large model may
    # carry one.

    def tag_only(self, handles: Iterable[Handle], tag: type) -> None:
        """Let exactly these entities, those of them that exist, carry a tag, such as Selected."""
        wanted = self._flags(handles) & (self.row_of_entity >= 0)
        if (self._carriers(tag) != wanted).any():
            self._tagged[tag] = np.flatnonzero(wanted)
            self.tags_revision = self.next_revision()

    def _flags(self, handles: Iterable[Handle]) -> NDArray[np.bool_]:
        """For each esper id, whether it is that of one of these entities."""
        return flags(self._ids(list(handles)), len(self.row_of_entity))

    def _carriers(self, tag: type) -> NDArray[np.bool_]:
        """For each esper id, whether that entity, which may be deleted, carries a tag."""
        return flags(self._tagged.get(tag, []), len(self.row_of_entity))

    @overload
    def tagged(self, tag: type) -> list[Handle]: ...
    @overload
    def tagged(self, tag: type, *kinds: type[H]) -> list[H]: ...
    def tagged(self, tag: type, *kinds: type[Any]) -> list[Any]:
        """Handles of the existing entities with a tag, of these kinds if any are given, in order of creation."""
        tagged = [(self.tables[name], rows) for name, rows in self.rows_tagged(tag).items()]
        found = [table.handles[row] for table, rows in tagged for row in rows.tolist()]
        order = np.argsort(np.concatenate([table.entities[rows] for table, rows in tagged]))
        ordered = [found[place] for place in order.tolist()]
        return [handle for handle in ordered if isinstance(handle, kinds)] if kinds else ordered

    def rows_tagged(self, tag: type) -> dict[str, NDArray[np.intp]]:
        """Rows, ascending, of the existing entities with a tag, by table; found once until tags or rows change."""
        now = (self.tags_revision, self.structure)
        known = self._tagged_rows.get(tag)
        if known is None or known[0] != now:
            known = self._tagged_rows[tag] = now, self._rows(self._carriers(tag))
        return known[1]

    def any_tagged(self, tag: type) -> bool:
        """True if any existing entity carries a tag."""
        return any(map(len, self.rows_tagged(tag).values()))

    def rows_of(self, handles: Iterable[Handle]) -> dict[str, NDArray[np.intp]]:
        """Rows, ascending, of those elements that exist, by table. Raises LookupError for those of another model."""
        return self._rows(self._flags(handles))

    def _rows(self, marked: NDArray[np.bool_]) -> dict[str, NDArray[np.intp]]:
        """Rows, ascending, of the existing entities whose flags, one for each esper id, are true, by table."""
        return {table.name: np.flatnonzero(marked[table.entities]) for table in self.tables.values()}

    # --- references between tables -----------------------------------------------------------------

    def _with_dependents(self, entities: NDArray[np.int64]) -> dict[str, NDArray[np.intp]]:
        """Rows to delete by table: the entities themselves and all that refer to them."""
        wanted = flags(entities, len(self.row_of_entity))
        doomed: dict[str, NDArray[np.intp]] = {}
        for table in self.tables.values():  # a table only refers to those declared before it
            marked = wanted[table.entities]
            for field in table.fields.values():
                if field.references in doomed:
                    gone = flags(doomed[field.references], self.tables[field.references].count)
                    hit = gone[table.column(field.name)]
                    marked |= hit.any(axis=1) if field.shape else hit
            if marked.any():
                doomed[table.name] = np.flatnonzero(marked)
        return doomed

    def _references_as_entities(self, table: Table[Any], rows: NDArray[np.intp]) -> dict[str, Column]:
        return {
            field.name: self.tables[field.references].entities[table.current(field.name)[rows]]
            for field in table.fields.values()
            if field.references is not None
        }

    def _remap_references(self, table: Table[Any], rows: NDArray[np.intp], *, inserted: bool) -> None:
        """After rows of a table went or came, let those that refer to it follow."""
        kept = ~flags(rows, table.count + (0 if inserted else len(rows)))
        new_row = np.flatnonzero(kept) if inserted else np.cumsum(kept) - 1
        for other in self.tables.values():
            for field in other.fields.values():
                if field.references == table.name and other.count:
                    column = other.writable(field.name)
                    column[...] = new_row[column]

    def place(self, table: Table[Any], first: int) -> None:
        """Note in which rows the entities of a table are, from row `first` on."""
        entities = table.entities[first:]
        known = len(self.row_of_entity)
        if len(entities) and entities.max() >= known:
            self.row_of_entity = grown(self.row_of_entity, np.full(2 * entities.max(), -1), known)
        self.row_of_entity[entities] = np.arange(first, table.count)


def called(noun: str, name: Any) -> str:
    """An element as a person calls it, such as "rod AB"; a name such as "rod 7" says it all."""
    name = cut(str(name))
    return as_said(noun, name) if name.startswith(noun + " ") else joined([tr(noun), name])


@contextmanager
def esper_kept() -> Iterator[None]:
    """The esper world that is current before the `with` is current again after it."""
    before = esper.current_world
    try:
        yield
    finally:
        if esper.current_world != before:
            esper.switch_world(before)


def _delete_context(context: str) -> None:
    if esper.current_world == context:
        esper.switch_world("default")
    if context in esper.list_worlds():
        esper.delete_world(context)
