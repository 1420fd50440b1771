"""Clipboard: elements as the text of a model document, and back into a model."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import msgspec

from components.field import Role, Vector
from components.load import Load
from components.model import Model
from components.particle import Particle
from components.rod import Rod
from components.table import Table
from components.world import Handle
from game.document import FORMAT, VERSION, ModelError, document, parse
from game.models import laid_out
from systems.edit.moving import movable
from systems.edit.refusal import Refusal


def copied(model: Model, handles: Iterable[Handle]) -> str:
    """The selected particles and rods with the ends of rods and the loads on them. Raises Refusal."""
    chosen = list(handles)
    particles = movable(model, chosen)
    if not particles:
        raise Refusal("Nothing is selected that can be copied; click a particle or a rod first.")
    whole = document(model)
    names = {particle.name for particle in particles}
    rods = {handle.name for handle in chosen if isinstance(handle, Rod)}
    part = {
        "format": FORMAT,
        "version": VERSION,
        "particles": [element for element in whole["particles"] if element["name"] in names],
        "rods": [element for element in whole.get("rods", []) if element["name"] in rods],
        "loads": [element for element in whole.get("loads", []) if element["on"] in names],
    }
    return laid_out(part, depth=2)


def parsed(text: str) -> Model:
    """The elements of such a text, as a model of their own. Raises Refusal if it is none."""
    try:
        source = parse(msgspec.json.decode(text))
    except (ModelError, msgspec.DecodeError):
        source = Model()
    if not source.particles.count:
        raise Refusal("The clipboard holds no particles or rods; select some and copy them with Ctrl+C.")
    return source


def paste(model: Model, source: Model, offset: Vector) -> list[Handle]:
    """New particles, rods and loads like those of `source`, moved by an offset (m), as one edit.

    Names that are taken are replaced by free ones. Returns the particles and rods.
    """
    first = model.particles.count
    made: list[Handle] = []
    with model.transaction("paste"):
        for kind in (Particle, Rod, Load):
            columns = _columns(source, kind)
            if kind is Particle:
                columns["position"] = columns["position"] + offset
            for reference in columns.keys() & {"between", "on"}:
                columns[reference] = columns[reference] + first
            columns["name"] = _free_names(model.tables[kind.table], source.tables[kind.table].names)
            new = model.create(kind, source.tables[kind.table].count, **columns)
            _keep_foreign(model, new, source, source.tables[kind.table].handles)
            made += new if kind is not Load else []
    return made


def _columns(source: Model, kind: type[Handle]) -> dict[str, Any]:
    table = source.tables[kind.table]
    return {field.name: table.column(field.name).copy() for field in table.fields_in(Role.DOCUMENT, Role.STATE)}


def _free_names(table: Table[Any], names: list[str]) -> list[str]:
    """The names, those that are taken replaced by new ones."""
    wanted = set(names)
    fresh = (name for name in table.free_names(2 * len(names)) if name not in wanted)
    return [next(fresh) if name in table else name for name in names]


def _keep_foreign(model: Model, new: list[Any], source: Model, originals: list[Any]) -> None:
    for copy, original in zip(new, originals, strict=True):
        if original.entity in source.foreign:
            model.foreign[copy.entity] = source.foreign[original.entity]
