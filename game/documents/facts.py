"""Facts: a document by facts instead of by elements, which is how a model holds them; and the elements of such a one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

import msgspec
import numpy as np
from numpy.typing import NDArray

from pinjoint.components.clock import Clock
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import MADE, Column, Field
from pinjoint.components.handle import Handle
from pinjoint.components.model import Model
from pinjoint.components.table import Table
from pinjoint.documents.format import (
    BY_COLUMNS,
    FORMAT,
    SECTIONS,
    VERSION,
    ModelError,
    copied,
    required,
    saved_fields,
)
from pinjoint.documents.mod_data import DATA as FOREIGN
from pinjoint.documents.mod_data import MODS, known_versions, versions_in
from pinjoint.documents.sliders import KEY as SLIDERS
from pinjoint.documents.sliders import slider_entries


class Numbers(msgspec.Struct, frozen=True):
    """Numbers of some elements as they lie in memory, which takes no time. absent: NaN stands for None."""

    kind: Literal["<f8", "<i8", "|b1"]
    pairs: bool
    absent: bool
    data: bytes

    def tolist(self) -> list[Any]:
        """One value, or pair of them, for each element."""
        values: list[Any] = np.frombuffer(self.data, self.kind).reshape((-1, 2) if self.pairs else -1).tolist()
        return [None if value != value else value for value in values] if self.absent else values


Count = Annotated[int, msgspec.Meta(ge=0, le=10_000_000)]  # of elements: a damaged number asks for no more


class Part(msgspec.Struct, frozen=True, array_like=True):
    """One fact of some elements: what they hold under a key, or under that of a mod's component. rows: None for all."""

    key: str
    component: str
    rows: list[int] | None
    values: Numbers | list[Any]


class Gathered(msgspec.Struct, frozen=True, tag_field="format", tag=BY_COLUMNS):
    """A document by facts instead of by elements, which is many times as fast to make of a model and to write.

    sections, added: the number of elements of a kind and what they hold, by the key in documents.
    versions: of mods, by name. sliders: as in documents.
    """

    version: int
    title: str
    description: str
    sections: dict[str, tuple[Count, list[Part]]]
    added: dict[str, tuple[Count, list[Part]]]
    foreign_kinds: dict[str, Any]
    versions: dict[str, str]
    sliders: list[Any] = []


def gathered(model: Model, sliders: list[Any] | None = None) -> Gathered:
    """The same document by facts, which `parse` takes, too. Raises ModelError. sliders: as the document holds them."""
    sections = {name: _parts(model, kind) for name, kind in SECTIONS.items()}
    added = {name: _parts(model, kind) for name, kind in EXTENSIONS.kinds.items() if kind.table in model.tables}
    versions = known_versions(model.foreign_versions)
    sliders = slider_entries(model) if sliders is None else sliders
    title, description = model.title, model.description
    return Gathered(VERSION, title, description, sections, added, model.foreign_kinds, versions, sliders)


def document_of(model: Model, parts: Mapping[type[Handle], NDArray[np.int64]]) -> dict[str, Any]:
    """The document of some rows alone, by kind, among them those that they refer to. Raises ModelError."""
    made: dict[str, Any] = {"format": FORMAT, "version": VERSION}
    elements = {kind: _elements(*_parts(model, kind, rows)) for kind, rows in parts.items() if len(rows)}
    added = {name: elements.pop(kind) for name, kind in EXTENSIONS.kinds.items() if kind in elements}
    made |= {kind.table: found for kind, found in elements.items()}
    return _with_versions(made | ({FOREIGN: added} if added else {}), known_versions(model.foreign_versions))


def spread(facts: Gathered) -> dict[str, Any]:
    made: dict[str, Any] = {"format": FORMAT, "version": facts.version}
    made |= {key: text for key in ("title", "description") if (text := getattr(facts, key))}
    for name, counted in facts.sections.items():
        elements, kind = _elements(*counted), SECTIONS.get(name)
        if kind is None or not kind.single:
            made |= {name: elements} if elements else {}
        elif elements[0] or kind is not Clock:
            made[name] = elements[0]
    made |= {SLIDERS: facts.sliders} if facts.sliders else {}
    added = {name: elements for name, counted in facts.added.items() if (elements := _elements(*counted))}
    added |= facts.foreign_kinds
    made |= {FOREIGN: dict(sorted(added.items()))} if added else {}
    return _with_versions(made, facts.versions)


def _with_versions(made: dict[str, Any], known: Mapping[str, str]) -> dict[str, Any]:
    """The document with the versions of the mods whose data it holds, of those that are known."""
    versions = versions_in(made, known)
    return made | ({MODS: versions} if versions else {})


def _parts(model: Model, kind: type[Handle], rows: NDArray[np.int64] | None = None) -> tuple[int, list[Part]]:
    """How many rows (None: all), and what they hold but for what is as by default (settings and the like: with that)."""
    table = model.tables[kind.table]
    always = {"name", *required(kind)}
    chosen = np.arange(table.count) if rows is None else rows
    parts: list[Part] = []
    for field in saved_fields(kind):
        column = table.column(field.name)[chosen]
        _refuse_non_finite(model, table, chosen, field, column)
        held: list[int] | None = None
        if field.component or not (field.key in always or (kind.single and field.role in MADE)):
            special = np.flatnonzero(_differs_from_default(field, column))
            if len(special) < len(column):
                held, column = special.tolist(), column[special]
        if held != []:
            parts.append(Part(field.key, field.component, held, _values(model, field, column)))
    return len(chosen), [*parts, *_foreign_parts(model, table, chosen)]


def _foreign_parts(model: Model, table: Table[Any], chosen: NDArray[np.int64]) -> list[Part]:
    """What elements keep of mods that are not loaded."""
    if not model.foreign:
        return []
    handles = [table.handles[row] for row in chosen.tolist()]
    rows = [place for place, handle in enumerate(handles) if handle.entity in model.foreign]
    kept = [copied(model.foreign[handles[row].entity], model.describe(handles[row])) for row in rows]
    return [Part(FOREIGN, "", rows, kept)] if rows else []


def _elements(count: int, parts: Sequence[Part]) -> list[dict[str, Any]]:
    """One object per element."""
    elements: list[dict[str, Any]] = [{} for _ in range(count)]
    for part in parts:
        holding = elements if part.rows is None else [elements[row] for row in part.rows]
        if part.component:
            holding = [one.setdefault(FOREIGN, {}).setdefault(part.component, {}) for one in holding]
        values = part.values.tolist() if isinstance(part.values, Numbers) else part.values
        for one, value in zip(holding, values, strict=True):
            one[part.key] = (
                value if part.key != FOREIGN else dict(sorted({**one.get(FOREIGN, {}), **value}.items()))
            )
    return elements


def _differs_from_default(field: Field[Any], column: Column) -> NDArray[np.bool_]:
    """Which rows do not hold the default's very bits, so that -0.0 is not taken for 0.0; shape (n,)."""
    if field.dtype is str:
        return np.asarray(column != field.default, dtype=bool)
    if column.dtype == np.dtype(object):
        return np.array([value != field.default for value in column], dtype=bool)
    default = field.allocate(1)
    word = np.uint64 if default.nbytes % 8 == 0 else np.uint8
    default = default.view(word).ravel()
    bits = column.view(word).reshape(len(column), len(default))
    differs: NDArray[np.bool_] = (bits != default).any(axis=1)
    return differs


def _values(model: Model, field: Field[Any], column: Column) -> Numbers | list[Any]:
    """What a document holds in place of the entries of a column."""
    if field.references is not None:
        column = model.tables[field.references].column("name")[column]
    if column.dtype != np.dtype(object):
        kind: Any = column.dtype.newbyteorder("<").str
        absent = field.nullable and field.dtype is float
        return Numbers(kind, bool(field.shape), absent, column.astype(kind, copy=False).tobytes())
    values: list[Any] = column.tolist()
    return [copied(value, field.title) for value in values] if field.dtype is object else values


def _refuse_non_finite(
    model: Model, table: Table[Any], rows: NDArray[np.int64], field: Field[Any], column: Column
) -> None:
    if field.dtype is not float:
        return
    finite = np.isfinite(column) | (np.isnan(column) if field.nullable else False)
    for row in np.argwhere(~finite)[:1, 0].tolist():
        element, value = table.handles[rows[row]], field.loaded(column, row)
        raise ModelError(
            "{element}: {field} is {value}, which no file can hold; undo, or go back to the beginning.",
            element=model.describe(element),
            field=field.title,
            value=str(value),
        )
