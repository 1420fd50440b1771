"""What mods add to models: facts about elements, by a Component, and elements of kinds of their own."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import Role
from pinjoint.components.handle import Handle
from pinjoint.components.mistake import WrongValue
from pinjoint.components.model import KINDS, Model
from pinjoint.components.table import Table, fields_of
from pinjoint.components.wording import is_identifier


class Component:
    """Facts that a mod adds to elements of one kind; a subclass declares them as Fields.

    Every element of the kind has them, at their defaults to begin with. In Python and in kernels they go by
    `<mod>_<field>`: `particle.wind_area`, `particles_wind_area`. Files keep them at the element, under
    "components": {"<mod>.<Component>": {…}}.

    of: the kind of element, such as Particle, Rod, Environment or Settings.
    """

    of: ClassVar[type[Handle]]


def add_component(mod: str, component: type[Component]) -> list[str]:
    """Let all worlds made from now on have a mod's component, as attributes of its kind; returns their names.

    Raises ValueError if a column of that name is there, or a Field is none that a mod can add.
    """
    kind, fields = component.of, fields_of(component)
    names = [f"{mod}_{field.name.removeprefix(f'{mod}_')}" for field in fields]
    for field, name in zip(fields, names, strict=True):
        if hasattr(kind, name):
            raise WrongValue(
                "{component}: {table} have a '{name}' already; give this Field another name.",
                component=component.__name__,
                table=kind.table,
                name=name,
            )
        if field.references is not None or field.role is Role.DERIVED:
            raise WrongValue(
                "{component}.{field}: a mod cannot add references or derived columns, only Fields with values of"
                " their own (document or state).",
                component=component.__name__,
                field=field.name,
            )
        field.check_default(component.__name__)
    for field, name in zip(fields, names, strict=True):
        field.name, field.component = name, f"{mod}.{component.__name__}"
        field.key = field.key.removeprefix(f"{mod}_")
        setattr(kind, name, field)
    return names


def checked_kind(mod: str, kind: type[Handle]) -> str:
    """What files call a mod's kind of elements.

    Raises ValueError if a model has such elements already, or a Field is none that a mod can add.
    """
    others = [*KINDS, *EXTENSIONS.kinds.values()]
    fields = {field.name: field for field in fields_of(kind)}
    for part in ("table", "noun"):
        word = getattr(kind, part, "")
        if not word or word in [getattr(other, part) for other in others]:
            raise WrongValue(
                "{name}: its {part} '{word}' is missing or already used; give it another.",
                name=kind.__name__,
                part=part,
                word=word,
            )
    if not is_identifier(kind.table) or hasattr(Model, kind.table):
        raise WrongValue(
            "{name}: '{table}' cannot be the name of a table; use another word.",
            name=kind.__name__,
            table=kind.table,
        )
    if kind.single:
        raise WrongValue(
            "{name}: a mod's kind cannot be `single`. For facts about the whole model, add a component of"
            " Settings or Environment.",
            name=kind.__name__,
        )
    if "name" not in fields or fields["name"].dtype is not str:
        raise WrongValue(
            "{name} needs a Field 'name' of dtype str, by which people tell its elements apart.",
            name=kind.__name__,
        )
    for field in fields.values():
        if field.role is Role.DERIVED:
            raise WrongValue(
                "{name}.{field}: a mod cannot add derived columns.", name=kind.__name__, field=field.name
            )
        field.check_default(kind.__name__)
    for point in kind.points:
        if point not in fields or fields[point].shape != (2,) or fields[point].role is not Role.DOCUMENT:
            raise WrongValue(
                "{name}: its point '{point}' must be one of its Fields, of shape (2,) and with the role DOCUMENT.",
                name=kind.__name__,
                point=point,
            )
    return f"{mod}.{kind.__name__}"


def outlines(model: Model) -> Iterator[tuple[Table[Any], NDArray[np.float64]]]:
    """The tables of mods' kinds that have points and elements, with those points (m), shape (n, points, 2)."""
    for kind in EXTENSIONS.kinds.values():
        table = model.tables.get(kind.table)
        if table is not None and table.count and kind.points:
            yield table, np.stack([table.column(point) for point in kind.points], axis=1)
