"""Clipboard: a part of a model as the text of a document, and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import SAVED, Vector
from pinjoint.components.handle import Handle
from pinjoint.components.language import marked
from pinjoint.components.load import Load, SpanLoad
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.table import fields_of
from pinjoint.components.tags import Selected
from pinjoint.documents.document import parse
from pinjoint.documents.facts import Facts
from pinjoint.documents.format import ModelError
from pinjoint.documents.models import laid_out
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.placing import moving_rows


@dataclass(frozen=True)
class Part:
    """Some elements of a model: rows by kind, particles first, then rods and loads, then kinds of mods."""

    model: Model
    rows: Mapping[type[Handle], NDArray[np.int64]]

    @classmethod
    def selected(cls, model: Model) -> Part:
        """The selected particles and rods, the ends of those rods, and loads on them; and selected elements of mods.

        Raises Refusal if there are none.
        """
        rows = model.rows_tagged(Selected)
        particles = moving_rows(model, rows)
        others = {kind: rows[kind.table] for kind in _added() if len(rows[kind.table])}
        if not len(particles) and not others:
            raise Refusal("Nothing that can be copied is selected; click a particle or a rod first.")
        loads = np.flatnonzero(np.isin(model.loads.on, particles))
        spans = np.flatnonzero(np.isin(model.span_loads.rod, rows["rods"]))
        known = {Particle: particles, Rod: rows["rods"], Load: loads, SpanLoad: spans}
        return cls(model, {**known, **others})

    @classmethod
    def described(cls, text: str) -> Part:
        """All that the text of a document describes. Raises Refusal if it describes nothing."""
        try:
            source = parse(msgspec.json.decode(text))
        except (ModelError, ValueError, RecursionError):
            source = Model()
        kinds: list[type[Handle]] = [Particle, Rod, Load, SpanLoad, *_added()]
        found = cls(source, {kind: np.arange(source.tables[kind.table].count) for kind in kinds})
        if not len(found.places):
            raise Refusal("The clipboard holds no particles or rods; select some and copy them with Ctrl+C.")
        return found

    @property
    def text(self) -> str:
        """It as the text of a document. Raises Refusal if it cannot be written."""
        try:
            return laid_out(Facts(self.model, self.rows).document(), depth=2)
        except ModelError as error:
            raise Refusal("This cannot be copied: {error}", error=error) from None

    @property
    def places(self) -> NDArray[np.float64]:
        """Original positions of its particles, and the points of its other elements (m), shape (n, 2)."""
        points = [(kind, point) for kind in self.rows for point in _points(kind)]
        tables = self.model.tables
        return np.concatenate([tables[kind.table].column(point)[self.rows[kind]] for kind, point in points])

    def paste(self, model: Model, offset: Vector, title: str = marked("paste")) -> list[Handle]:
        """Create elements like these in a model, moved by an offset (m), as one edit; returns all but the loads.

        title: what undo calls it. Names that are taken are replaced by free ones.
        """
        source, rows = self.model, self.rows
        places = {kind.table: np.zeros(source.tables[kind.table].count, dtype=np.int64) for kind in rows}
        for kind, those in rows.items():
            places[kind.table][those] = model.tables[kind.table].count + np.arange(len(those))
        made: list[Handle] = []
        with model.transaction(title):
            for kind, those in rows.items():
                table, columns = source.tables[kind.table], dict[str, Any]()
                for field in table.fields_in(*SAVED):
                    column = table.column(field.name)[those]
                    columns[field.name] = places[field.references][column] if field.references else column
                for point in _points(kind):
                    columns[point] = columns[point] + offset
                columns["name"] = _free_names(model, kind, columns["name"].tolist())
                entities = table.entities[those].tolist()
                new = model.create(kind, len(those), **columns)
                for handle, entity in zip(new, entities, strict=True) if source.foreign else ():
                    if entity in source.foreign:
                        model.foreign[handle.entity] = source.foreign[entity]
                made += new if kind not in (Load, SpanLoad) else []
        return made


def _points(kind: type[Handle]) -> tuple[str, ...]:
    """The Fields of a kind that are places in the plane."""
    return ("position",) if kind is Particle else kind.points


def _added() -> list[type[Handle]]:
    """The kinds of mods that can be copied: they have points, and refer to no other elements."""
    return [
        kind
        for kind in EXTENSIONS.kinds.values()
        if kind.points and not any(f.references for f in fields_of(kind))
    ]


def _free_names(model: Model, kind: type[Handle], names: list[str]) -> list[str] | None:
    """The names, those that are taken replaced by new ones; None: all are new."""
    table = model.tables[kind.table]
    taken = table.taken(names)
    if len(taken) == len(names):
        return None
    fresh = iter(table.free_names(len(taken), besides=set(names) - taken))
    return [next(fresh) if name in taken else name for name in names]
