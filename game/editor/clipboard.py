"""Clipboard: a part of a model as data, as the text of a document, and back."""

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
from pinjoint.components.load import Load
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.table import Table, fields_of
from pinjoint.components.tags import Selected
from pinjoint.documents.document import parse
from pinjoint.documents.facts import document_of
from pinjoint.documents.format import ModelError
from pinjoint.documents.models import laid_out
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.moving import moving_rows

Rows = NDArray[np.int64]
Kind = type[Handle]
RowsByKind = Mapping[Kind, Rows]  # particles first, then rods and loads, then kinds of mods

PASTE = marked("paste")  # the title of what is undone
REFERENCES = {"between", "on"}  # Fields that refer to particles


@dataclass(frozen=True)
class Part:
    """Particles, the rods between and the loads on them, and elements of mods, apart from any model.

    columns: by kind, values by Field; references are places among the particles of the part.
    foreign: by kind and place, the data of mods that are not loaded.
    """

    columns: Mapping[Kind, Mapping[str, Any]]
    foreign: Mapping[tuple[Kind, int], dict[str, Any]]

    @property
    def position(self) -> NDArray[np.float64]:
        """Original positions of the particles, and the points of other elements (m), shape (n, 2)."""
        return np.concatenate([held[point] for kind, held in self.columns.items() for point in _points(kind)])


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


def part_in(text: str) -> Part:
    """The part that the text of a document describes. Raises Refusal if it describes none."""
    try:
        source = parse(msgspec.json.decode(text))
    except (ModelError, ValueError, RecursionError):
        source = Model()
    kinds: list[Kind] = [Particle, Rod, Load, *_added()]
    rows = {kind: np.arange(source.tables[kind.table].count) for kind in kinds}
    part = part_of(source, rows)
    if not len(part.position):
        raise Refusal("The clipboard holds no particles or rods; select some and copy them with Ctrl+C.")
    return part


def part_of(model: Model, rows: RowsByKind) -> Part:
    """The part of a model in these rows."""
    place = np.zeros(model.particles.count, dtype=np.int64)
    place[rows[Particle]] = np.arange(len(rows[Particle]))
    foreign: dict[tuple[Kind, int], dict[str, Any]] = {}
    for kind in rows if model.foreign else ():
        entities = enumerate(model.tables[kind.table].entities[rows[kind]].tolist())
        foreign |= {(kind, n): model.foreign[entity] for n, entity in entities if entity in model.foreign}
    return Part({kind: _columns(model, kind, rows[kind], place) for kind in rows}, foreign)


def paste(model: Model, part: Part, offset: Vector, title: str = PASTE) -> list[Handle]:
    """Create elements like those of a part, moved by an offset (m), as one edit of a title; returns all but the loads.

    Names that are taken are replaced by free ones.
    """
    first = model.particles.count
    made: dict[Kind, list[Handle]] = {}
    with model.transaction(title):
        for kind, held in part.columns.items():
            columns = {**held, "name": _free_names(model.tables[kind.table], held["name"])}
            for point in _points(kind):
                columns[point] = columns[point] + offset
            for reference in columns.keys() & REFERENCES:
                columns[reference] = first + columns[reference]
            made[kind] = model.create(kind, len(held["name"]), **columns)
        for (kind, place), kept in part.foreign.items():
            model.foreign[made[kind][place].entity] = kept
    return [handle for kind, handles in made.items() if kind is not Load for handle in handles]


def _points(kind: Kind) -> tuple[str, ...]:
    """The Fields of a kind that are places in the plane."""
    return ("position",) if kind is Particle else kind.points


def _added() -> list[Kind]:
    """The kinds of mods that can be copied: they have points, and refer to no other elements."""
    return [
        kind
        for kind in EXTENSIONS.kinds.values()
        if kind.points and not any(f.references for f in fields_of(kind))
    ]


def _columns(model: Model, kind: Kind, rows: Rows, place: Rows) -> dict[str, Any]:
    """Values of some rows by Field; references by the new places of particles."""
    table = model.tables[kind.table]
    columns: dict[str, Any] = {field.name: table.column(field.name)[rows] for field in table.fields_in(*SAVED)}
    for reference in columns.keys() & REFERENCES:
        columns[reference] = place[columns[reference]]
    columns["name"] = columns["name"].tolist()
    return columns


def _free_names(table: Table[Any], names: list[str]) -> list[str] | None:
    """The names, those that are taken replaced by new ones; None: all are new."""
    taken = table.taken(names)
    if len(taken) == len(names):
        return None
    fresh = iter(table.free_names(len(taken), besides=set(names) - taken))
    return [next(fresh) if name in taken else name for name in names]
