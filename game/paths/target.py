"""Targets: what a path such as particles.B.force.x names, wherever a person writes one."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Container, Mapping
from dataclasses import dataclass
from typing import Any

from components.field import Field, Role
from components.handle import Handle
from components.model import Model
from components.spelling import missing, remedy
from components.table import Table

EVERY = "*"  # in place of a name: all elements of the table

_SET_BY_TIME = ("clock",)  # tables


class PathError(ValueError):
    """A path that names nothing; the message says why and what to write."""


@dataclass(frozen=True)
class Target:
    """What a path names: one fact of the elements of a table, or its component along an axis.

    handles: the elements; element: their name in the path, "*" for all, "" where there is one only.
    key: the fact's, as the path has it. axis: "x", "y" or "" for the whole.
    """

    table: Table[Any]
    handles: list[Handle]
    element: str
    field: Field[Any]
    key: str
    axis: str

    def path(self, element: str) -> str:
        """The path to the same fact of another element."""
        return ".".join(part for part in (self.table.name, element, self.key, self.axis) if part)


Keys = Callable[[Table[Any]], Mapping[str, Field[Any]]]  # the facts of a table that may be named, by key


def settable(table: Table[Any]) -> Mapping[str, Field[Any]]:
    """The facts that a person can set, by the keys of model files."""
    fields = () if table.name in _SET_BY_TIME else table.fields_in(Role.DOCUMENT, Role.STATE)
    return {field.name if field.component else field.key: field for field in fields if field.references is None}


def readable(table: Table[Any]) -> Mapping[str, Field[Any]]:
    """All facts, by the names of the attributes of elements."""
    return table.fields


def locate(model: Model, text: str, keys: Keys) -> tuple[Target, str]:
    """What the path that a text begins with names, and what follows the path: from "=" or "~" on, or "".

    Names of elements may contain dots, spaces and "=". Raises PathError.
    """
    section, _, rest = text.partition(".")
    tables = {name: known for name, table in model.tables.items() if (known := keys(table))}
    name = _known(section.strip(), tables, "table")
    table, known = model.tables[name], tables[name]
    element, rest = _element(table, rest, known)
    handles = list(table) if element in ("", EVERY) else [table[element]]
    path = _before_value(rest)
    key, _, axis = path.strip().partition(".")
    if keys is settable:
        _refuse_unsettable(table, key, known)
    field = known[_known(key, known, "key")]
    if axis and (not field.shape or axis not in ("x", "y")):
        parts = f"{key}.x or {key}.y" if field.shape else f"{key} only"
        raise PathError(f"{field.title} has no part '{axis}'; write {parts}.")
    return Target(table, handles, element, field, key, axis), rest[len(path) :]


def locate_one(model: Model, path: str, keys: Keys = readable) -> Target:
    """What a path names of one element, with nothing after it. Raises PathError."""
    target, rest = locate(model, path, keys)
    if rest:
        raise PathError(f"'{rest}' follows the path; leave it out.")
    if target.element == EVERY:
        raise PathError(f"it names every {target.table.kind.noun}; write a name in place of {EVERY}.")
    return target


def _known(name: str, names: Collection[str], what: str) -> str:
    if name not in names:
        raise PathError(f"there is no {what} '{name}'; {remedy(name, names)}")
    return name


def _element(table: Table[Any], rest: str, known: Container[str]) -> tuple[str, str]:
    """The name of the element that `rest` begins with ("" where there is one only), and what follows it."""
    if table.kind.single:
        return "", rest
    cuts = [index for index, character in enumerate(rest) if character == "."]
    named = [cut for cut in cuts if rest[:cut] == EVERY or rest[:cut] in table]
    if not named:
        _refuse_name(table, rest)
    # Of the names "B" and "B.1", the longest that a key follows is meant.
    with_key = [cut for cut in named if _before_value(rest[cut + 1 :]).strip().partition(".")[0] in known]
    cut = (with_key or named)[-1]
    return rest[:cut], rest[cut + 1 :]


def _before_value(rest: str) -> str:
    return re.split("[=~]", rest, maxsplit=1)[0]  # "=" gives a value, "~" a distribution of values


def _refuse_name(table: Table[Any], rest: str) -> None:
    parts = _before_value(rest).split(".")
    name = ".".join(parts[: -2 if parts[-1] in ("x", "y") else -1])
    if not name:
        raise PathError(
            f"it names no {table.kind.noun}; write {table.name}.NAME.{rest or 'KEY'}, or {EVERY} for every name."
        )
    raise PathError(missing(table.name, name, table.names))


def _refuse_unsettable(table: Table[Any], key: str, known: Mapping[str, Any]) -> None:
    if key not in known and key in table.fields:
        made_by = "is computed" if table.fields[key].role is Role.DERIVED else "refers to other elements"
        raise PathError(f"'{key}' {made_by} and cannot be set here; choose one of {', '.join(known)}.")
