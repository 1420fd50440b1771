"""Overrides of the command line: `--set PATH=VALUE`, such as particles.B.force=120,-160."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Any

import msgspec

from components.clock import Clock
from components.field import Field, FieldError, Role
from components.model import Model
from components.table import Table
from components.world import Handle
from game.document import SECTIONS

EVERY = "*"  # in place of a name: all elements of the table
FORM = "write it like particles.B.force=120,-160 or settings.restitution=0.5"

_TABLES = {name: kind.table for name, kind in SECTIONS.items() if kind is not Clock}
_FLAGS = {"true": True, "false": False}


class OverrideError(ValueError):
    """An override that cannot be applied; the message quotes it and says why and what to write."""


def apply_override(model: Model, override: str) -> None:
    """Give one key of one element, or of all of a table ("*"), the value that a person typed.

    override: `<table>.<name or *>.<key>=<value>`, `settings.<key>=<value>` or `environment.<key>=<value>`,
        with keys and units of model files; `<key>.x` and `<key>.y` are single components, `null` and
        `none` mean no value of its own. Names may contain dots, spaces and "=".

    One undoable command. Raises OverrideError.
    """
    try:
        section, _, rest = override.partition(".")
        table = model.tables[_TABLES[_known(section.strip(), _TABLES, "table")]]
        handles, rest = _elements(table, rest)
        path, equals, value = rest.partition("=")
        if not equals:
            raise OverrideError(f"it has no value; {FORM}.")
        key, _, axis = path.strip().partition(".")
        field = _field(table, key)
        model.assign(handles, field.name, _values(field, axis, value.strip(), handles))
    except (OverrideError, FieldError) as error:
        raise OverrideError(f"{override}: {error}") from None


def _known(name: str, names: Iterable[str], what: str) -> str:
    if name in names:
        return name
    nearest = difflib.get_close_matches(name, names, n=1)
    remedy = f"did you mean '{nearest[0]}'?" if nearest else f"choose one of {', '.join(names)}."
    raise OverrideError(f"there is no {what} '{name}'; {remedy}")


def _elements(table: Table[Any], rest: str) -> tuple[list[Handle], str]:
    """The elements that `rest` begins with the name of, and what follows the name."""
    if table.kind.single:
        return [table[0]], rest
    cuts = [index for index, character in enumerate(rest) if character == "."]
    named = [cut for cut in cuts if rest[:cut] == EVERY or rest[:cut] in table]
    if not named:
        _refuse_name(table, rest)
    # Of the names "B" and "B.1", the longest that a key follows is meant.
    with_key = [cut for cut in named if _key_after(rest, cut) in _settable(table)]
    cut = (with_key or named)[-1]
    handles = list(table) if rest[:cut] == EVERY else [table[rest[:cut]]]
    return handles, rest[cut + 1 :]


def _key_after(rest: str, cut: int) -> str:
    return rest[cut + 1 :].partition("=")[0].strip().partition(".")[0]


def _refuse_name(table: Table[Any], rest: str) -> None:
    parts = rest.partition("=")[0].split(".")
    name = ".".join(parts[: -2 if parts[-1] in ("x", "y") else -1])
    if not name:
        raise OverrideError(
            f"it names no {table.kind.noun}; write {table.name}.NAME.{rest}, or {EVERY} for every name."
        )
    raise OverrideError(table.world.missing(table.name, name, table.names))


def _settable(table: Table[Any]) -> dict[str, Field[Any]]:
    fields = table.fields_in(Role.DOCUMENT, Role.STATE)
    return {field.key: field for field in fields if field.references is None}


def _field(table: Table[Any], key: str) -> Field[Any]:
    fields = _settable(table)
    if key not in fields and key in table.fields:
        made_by = "is computed" if table.fields[key].role is Role.DERIVED else "refers to other elements"
        raise OverrideError(f"'{key}' {made_by} and cannot be set here; choose one of {', '.join(fields)}.")
    return fields[_known(key, fields, "key")]


def _values(field: Field[Any], axis: str, text: str, handles: list[Handle]) -> list[Any]:
    """One value per element."""
    if not axis:
        return [_vector(field, text) if field.shape else _scalar(field, text)] * len(handles)
    if not field.shape or axis not in ("x", "y"):
        remedy = f"write {field.key}.x or {field.key}.y" if field.shape else f"write {field.key} only"
        raise OverrideError(f"{field.title} has no part '{axis}'; {remedy}.")
    new = _scalar(field, text)
    old = [getattr(handle, field.name) for handle in handles]
    return [(new, y) if axis == "x" else (x, new) for x, y in old]


def _vector(field: Field[Any], text: str) -> tuple[Any, ...]:
    inside = text.removeprefix("[").removesuffix("]")
    return tuple(_scalar(field, part) for part in inside.split(","))


def _scalar(field: Field[Any], text: str) -> Any:
    """What a text means for a field; the text itself if nothing, for the field's check to refuse."""
    text = text.strip()
    if field.dtype is str:
        return text
    if text.lower() in ("null", "none"):
        return None
    if field.dtype is bool:
        return _FLAGS.get(text.lower(), text)
    try:
        return msgspec.json.decode(text) if field.dtype is object else field.dtype(text)
    except (ValueError, UnicodeEncodeError):
        return text
