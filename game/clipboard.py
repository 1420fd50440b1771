"""Clipboard: elements as a model of their own, as the text of its document, and back."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from components.field import Role, Vector
from components.load import Load
from components.model import Model
from components.particle import Particle
from components.rod import Rod
from components.table import Table
from components.world import Handle
from game.document import ModelError, document, parse
from game.models import laid_out
from systems.edit.moving import movable, rows_of
from systems.edit.refusal import Refusal

Rows = NDArray[np.int64]


def part(model: Model, handles: Iterable[Handle]) -> Model:
    """A model of the selected particles and rods, the ends of those rods, and the loads on them.

    Raises Refusal if there are none.
    """
    chosen = list(handles)
    particles = rows_of(model, movable(model, chosen))
    if not len(particles):
        raise Refusal("Nothing is selected that can be copied; click a particle or a rod first.")
    rods = rows_of(model, [handle for handle in chosen if isinstance(handle, Rod)])
    loads = np.flatnonzero(np.isin(model.loads.on, particles))
    new_row = np.zeros(model.particles.count, dtype=np.int64)
    new_row[particles] = np.arange(len(particles))
    made = Model()
    for kind, rows in ((Particle, particles), (Rod, rods), (Load, loads)):
        made.create(kind, len(rows), **_columns(model, kind, rows, new_row))
        _keep_foreign(made, model, kind, rows)
    return made


def paste(model: Model, source: Model, offset: Vector) -> list[Handle]:
    """New particles, rods and loads like those of `source`, moved by an offset (m), as one edit.

    Names that are taken are replaced by free ones. Returns the particles and rods.
    """
    made: list[Handle] = []
    new_row = model.particles.count + np.arange(source.particles.count)
    with model.transaction("paste"):
        for kind in (Particle, Rod, Load):
            rows = np.arange(source.tables[kind.table].count)
            columns = _columns(source, kind, rows, new_row)
            columns["name"] = _free_names(model.tables[kind.table], columns["name"])
            if kind is Particle:
                columns["position"] = columns["position"] + offset
            new = model.create(kind, len(rows), **columns)
            _keep_foreign(model, source, kind, rows)
            made += new if kind is not Load else []
    return made


def written(part: Model) -> str:
    """A part as the text of a model document."""
    try:
        return laid_out(document(part), depth=2)
    except ModelError as error:
        raise Refusal(f"This cannot be copied: {error}") from None


def parsed(text: str) -> Model:
    """The part that such a text describes. Raises Refusal if it is none."""
    try:
        source = parse(msgspec.json.decode(text))
    except (ModelError, msgspec.DecodeError):
        source = Model()
    if not source.particles.count:
        raise Refusal("The clipboard holds no particles or rods; select some and copy them with Ctrl+C.")
    return source


def _columns(model: Model, kind: type[Handle], rows: Rows, new_row: Rows) -> dict[str, Any]:
    """What some rows hold, by Field; references to particles renumbered."""
    table = model.tables[kind.table]
    columns: dict[str, Any] = {
        field.name: table.column(field.name)[rows] for field in table.fields_in(Role.DOCUMENT, Role.STATE)
    }
    for reference in columns.keys() & {"between", "on"}:
        columns[reference] = new_row[columns[reference]]
    columns["name"] = columns["name"].tolist()
    return columns


def _free_names(table: Table[Any], names: list[str]) -> list[str]:
    """The names, those that are taken replaced by new ones."""
    wanted = set(names)
    fresh = (name for name in table.free_names(2 * len(names)) if name not in wanted)
    return [next(fresh) if name in table else name for name in names]


def _keep_foreign(model: Model, source: Model, kind: type[Handle], rows: Rows) -> None:
    """What belongs to mods goes along with the copies, which are the last of their table."""
    originals, copies = source.tables[kind.table].handles, model.tables[kind.table].handles
    for row, copy in zip(rows.tolist(), copies[len(copies) - len(rows) :], strict=True):
        if originals[row].entity in source.foreign:
            model.foreign[copy.entity] = source.foreign[originals[row].entity]
