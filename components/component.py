"""Component: facts that a mod adds to elements of one kind."""

from __future__ import annotations

from typing import ClassVar

from pinjoint.components.field import Role
from pinjoint.components.handle import Handle
from pinjoint.components.mistake import WrongValue
from pinjoint.components.table import fields_of


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
