"""A model's columns as bits, to compare exactly."""

import hashlib

from pinjoint.components.field import Role
from pinjoint.components.model import Model


def columns(model: Model, *roles: Role) -> dict[str, bytes]:
    """Return every column of these roles (none given: document and state), as bytes, by "table.field"."""
    made: dict[str, bytes] = {}
    for table in model.tables.values():
        for field in table.fields_in(*(roles or (Role.DOCUMENT, Role.STATE))):
            column = table.column(field.name)
            made[f"{table.name}.{field.name}"] = (
                repr(column.tolist()).encode() if column.dtype == object else column.tobytes()
            )
    return made


def state(model: Model) -> dict[str, bytes]:
    """Return every state column, as bytes."""
    return columns(model, Role.STATE)


def different(one: dict[str, bytes], other: dict[str, bytes]) -> list[str]:
    """Return the names of the columns that are not the same in both."""
    return sorted(name for name in one.keys() | other.keys() if one.get(name) != other.get(name))


def digest(model: Model) -> str:
    """Return one hash of all state."""
    return hashlib.sha256(b"".join(state(model)[name] for name in sorted(state(model)))).hexdigest()
