"""Clipboard: a part of a model as the text of a document, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import SAVED, Vector
from pinjoint.components.handle import Handle
from pinjoint.components.language import marked
from pinjoint.components.load import Load
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.table import fields_of
from pinjoint.components.tags import Selected
from pinjoint.documents.document import parse
from pinjoint.documents.facts import document_of
from pinjoint.documents.format import ModelError
from pinjoint.documents.models import laid_out
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.placing import moving_rows

# particles first, then rods and loads, then kinds of mods
RowsByKind = Mapping[type[Handle], NDArray[np.int64]]
REFERENCES = {"between", "on"}  # Fields that refer to particles


def selected_rows(model: Model) -> RowsByKind:
    """Rows of the selected particles and rods, of the ends of those rods, and of the loads on them.

    And of the selected elements of mods. Raises Refusal if there are none.
    """
    rows = model.rows_tagged(Selected)
    particles = moving_rows(model, rows)
    others = {kind: rows[kind.table] for kind in _added() if len(rows[kind.table])}
    if not len(particles) and not others:
        raise Refusal("Nothing that can be copied is selected; click a particle or a rod first.")
    loads = np.flatnonzero(np.isin(model.loads.on, particles))
    return {Particle: particles, Rod: rows["rods"], Load: loads, **others}


def as_text(model: Model, rows: RowsByKind) -> str:
    """Rows of a model as the text of a document. Raises Refusal if they cannot be written."""
    try:
        return laid_out(document_of(model, rows), depth=2, spaced=False)
    except ModelError as error:
        raise Refusal("This cannot be copied: {error}", error=error) from None


def source_in(text: str) -> tuple[Model, RowsByKind]:
    """The model that the text of a document describes, and the rows of all that is in it. Raises Refusal if it is none."""
    try:
        source = parse(msgspec.json.decode(text))
    except (ModelError, ValueError, RecursionError):
        source = Model()
    kinds: list[type[Handle]] = [Particle, Rod, Load, *_added()]
    rows = {kind: np.arange(source.tables[kind.table].count) for kind in kinds}
    if not len(places(source, rows)):
        raise Refusal("The clipboard holds no particles or rods; select some and copy them with Ctrl+C.")
    return source, rows


def places(model: Model, rows: RowsByKind) -> NDArray[np.float64]:
    """Original positions of particles in some rows, and the points of other elements (m), shape (n, 2)."""
    points = [(kind, point) for kind in rows for point in _points(kind)]
    return np.concatenate([model.tables[kind.table].column(point)[rows[kind]] for kind, point in points])


def paste(
    model: Model, source: Model, rows: RowsByKind, offset: Vector, title: str = marked("paste")
) -> list[Handle]:
    """Create elements like those in rows of a model, moved by an offset (m), as one edit; returns all but the loads.

    title: what undo calls it. Names that are taken are replaced by free ones.
    """
    place = np.zeros(source.particles.count, dtype=np.int64)
    place[rows[Particle]] = model.particles.count + np.arange(len(rows[Particle]))
    made: list[Handle] = []
    with model.transaction(title):
        for kind, those in rows.items():
            table = source.tables[kind.table]
            columns: dict[str, Any] = {
                field.name: table.column(field.name)[those] for field in table.fields_in(*SAVED)
            }
            for point in _points(kind):
                columns[point] = columns[point] + offset
            for reference in columns.keys() & REFERENCES:
                columns[reference] = place[columns[reference]]
            columns["name"] = _free_names(model, kind, columns["name"].tolist())
            entities = table.entities[those].tolist()
            new = model.create(kind, len(those), **columns)
            for handle, entity in zip(new, entities, strict=True) if source.foreign else ():
                if entity in source.foreign:
                    model.foreign[handle.entity] = source.foreign[entity]
            made += new if kind is not Load else []
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
