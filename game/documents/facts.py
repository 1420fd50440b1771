"""Facts: what a document holds of a model, copied, so that its elements can be made while the model goes on changing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.clock import Clock
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import MADE, SAVED, Column, Field
from pinjoint.components.handle import Handle
from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.components.rod import Rod
from pinjoint.components.section import NAMES, given_by
from pinjoint.components.world import called
from pinjoint.documents.format import (
    FOREIGN,
    FORMAT,
    MODS,
    SECTIONS,
    VERSION,
    ModelError,
    copied,
    mods_in,
    required,
)
from pinjoint.documents.sliders import KEY as SLIDERS
from pinjoint.documents.sliders import slider_entries

Rows = NDArray[np.int64]


class Facts:
    """The facts of a model, or of some of its rows by kind, among them those that they refer to."""

    def __init__(self, model: Model, rows: Mapping[type[Handle], Rows] | None = None) -> None:
        whole = rows is None
        self._texts = {key: getattr(model, key) for key in ("title", "description")} if whole else {}
        self._sliders = slider_entries(model) if whole else []
        self._foreign_kinds = dict(model.foreign_kinds) if whole else {}
        self._versions = {**model.foreign_versions, **EXTENSIONS.versions}
        self._sections, self._added = (
            {
                name: _facts_of(model, kind, None if rows is None else rows[kind])
                for name, kind in kinds.items()
                if (kind in rows if rows is not None else kind.table in model.tables)
            }
            for kinds in (SECTIONS, EXTENSIONS.kinds)
        )

    def document(self) -> dict[str, Any]:
        """The document that holds them, for any thread to make. Raises ModelError."""
        made: dict[str, Any] = {"format": FORMAT, "version": VERSION}
        made |= {key: text for key, text in self._texts.items() if text}
        for name, facts in self._sections.items():
            elements = facts.elements()
            if not facts.kind.single:
                made |= {name: elements} if elements else {}
            elif elements[0] or facts.kind is not Clock:
                made[name] = elements[0]
        made |= {SLIDERS: self._sliders} if self._sliders else {}
        added = {name: elements for name, facts in self._added.items() if (elements := facts.elements())}
        added |= self._foreign_kinds
        made |= {FOREIGN: dict(sorted(added.items()))} if added else {}
        known = sorted(self._versions.keys() & mods_in(made)) if self._versions else []
        return made | ({MODS: {name: self._versions[name] for name in known}} if known else {})


@dataclass(frozen=True)
class _FactsOfKind:
    """The facts of elements of one kind. foreign: by row, what they keep of mods that are not loaded."""

    kind: type[Handle]
    count: int
    columns: Sequence[tuple[Field[Any], Column]]
    foreign: Mapping[int, Any]

    def elements(self) -> list[dict[str, Any]]:
        """One object for each, without what is as by default (settings and the like: with that). Raises ModelError."""
        elements: list[dict[str, Any]] = [{} for _ in range(self.count)]
        always = {"name", *required(self.kind)}
        for field, column in self.columns:
            self._refuse_non_finite(field, column)
            rows = np.arange(self.count)
            if field.component or not (field.key in always or (self.kind.single and field.role in MADE)):
                rows = np.flatnonzero(_differs_from_default(field, column))
            values = column[rows].tolist()
            if field.dtype is object:
                values = [copied(value, field.title) for value in values]
            elif field.nullable:
                values = [None if value != value else value for value in values]
            for row, value in zip(rows.tolist(), values, strict=True):
                one = elements[row]
                if field.component:
                    one = one.setdefault(FOREIGN, {}).setdefault(field.component, {})
                one[field.key] = value
        if self.kind is Rod:
            self._state_against_names(elements)
        for row, data in self.foreign.items():
            kept = elements[row].get(FOREIGN, {}) | copied(data, self._called(row))
            elements[row][FOREIGN] = dict(sorted(kept.items()))
        return elements

    def _state_against_names(self, elements: list[dict[str, Any]]) -> None:
        """State what is as by default, too, where the section and material of a rod would give another number."""
        defaults = {field.key: field.default for field, _ in self.columns}
        for one in (one for one in elements if not one.keys().isdisjoint(NAMES)):
            given = given_by(one.get("section"), one.get("material"))
            stated = {key: defaults[key] for key, value in given.items() if value != defaults[key]}
            one.update({key: value for key, value in stated.items() if key not in one})

    def _refuse_non_finite(self, field: Field[Any], column: Column) -> None:
        if field.dtype is not float:
            return
        finite = np.isfinite(column) | (np.isnan(column) if field.nullable else False)
        for row in np.argwhere(~finite)[:1, 0].tolist():
            raise ModelError(
                "{element}: {field} is {value}, which no file can hold; undo, or go back to the beginning.",
                element=self._called(row),
                field=field.title,
                value=str(field.loaded(column, row)),
            )

    def _called(self, row: int) -> str:
        """An element as a person calls it in a message."""
        names = [column[row] for field, column in self.columns if field.name == "name"]
        return called(self.kind.noun, names[0]) if names else tr(self.kind.noun)


def _facts_of(model: Model, kind: type[Handle], rows: Rows | None) -> _FactsOfKind:
    """The facts of some rows (None: of all), references by name."""
    table, columns = model.tables[kind.table], []
    rows = np.arange(table.count) if rows is None else rows
    for field in table.fields_in(*SAVED):
        column = table.storage(field.name)[rows]
        if field.references is not None:
            column = model.tables[field.references].column("name")[column]
        columns.append((field, column))
    foreign = {}
    if model.foreign:
        handles = [table.handles[row] for row in rows.tolist()]
        foreign = {
            row: model.foreign[handle.entity]
            for row, handle in enumerate(handles)
            if handle.entity in model.foreign
        }
    return _FactsOfKind(kind, len(rows), columns, foreign)


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
    found: NDArray[np.bool_] = (bits != default).any(axis=1)
    return found
