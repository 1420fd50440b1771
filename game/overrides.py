"""Paths such as particles.B.force.x, and the overrides of the command line: `--set PATH=VALUE`."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Container, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import msgspec

from components.clock import Clock
from components.field import Field, FieldError, Role
from components.model import ADDED, Model
from components.table import Table
from components.world import Handle
from game.document import SECTIONS

EVERY = "*"  # in place of a name: all elements of the table
FORM = "write it like particles.B.force=120,-160 or settings.restitution=0.5"

_TABLES = {name: kind.table for name, kind in SECTIONS.items() if kind is not Clock}  # and those of mods
_FLAGS = {"true": True, "false": False}


class OverrideError(ValueError):
    """An override that cannot be applied; the message quotes it and says why and what to write."""


@dataclass(frozen=True)
class Target:
    """What a path names: one fact of the elements of a table, or its component along an axis.

    handles: the elements; element: their name in the path, "*" for all, "" where there is one only.
    axis: "x", "y" or "" for the whole.
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

    def read(self, text: str) -> Any:
        """The value that a text means for this fact; the text itself if none, for a check to refuse."""
        whole = self.field.shape and not self.axis
        return _vector(self.field, text) if whole else _scalar(self.field, text)


Keys = Callable[[Table[Any]], Mapping[str, Field[Any]]]


def apply_override(model: Model, override: str) -> None:
    """Give one key of one element, or of all of a table ("*"), the value that a person typed.

    override: `<table>.<name or *>.<key>=<value>`, `settings.<key>=<value>` or `environment.<key>=<value>`,
        with keys and units of model files; `<key>.x` and `<key>.y` are single components, `null` and
        `none` mean no value of its own. Names may contain dots, spaces and "=".

    One undoable command. Raises OverrideError.
    """
    try:
        target, rest = locate(model, override)
        if not rest.startswith("="):
            raise OverrideError(f"it has no value; {FORM}.")
        model.assign(target.handles, target.field.name, _values(target, rest[1:].strip()))
    except (OverrideError, FieldError) as error:
        raise OverrideError(f"{override}: {error}") from None


def locate(model: Model, text: str, keys: Keys | None = None) -> tuple[Target, str]:
    """What the path that a text begins with names, and what follows the path: from "=" or "~" on, or "".

    keys: the facts of a table that may be named, by key; None: those that can be set. Raises OverrideError.
    """
    section, _, rest = text.partition(".")
    tables = _TABLES | {kind.table: kind.table for kind in ADDED.values() if kind.table in model.tables}
    table = model.tables[tables[_known(section.strip(), tables, "table")]]
    known = (keys or _settable)(table)
    element, rest = _element(table, rest, known)
    handles = list(table) if element in ("", EVERY) else [table[element]]
    path = _before_value(rest)
    key, _, axis = path.strip().partition(".")
    if keys is None:
        _refuse_unsettable(table, key, known)
    field = known[_known(key, known, "key")]
    if axis and (not field.shape or axis not in ("x", "y")):
        remedy = f"write {field.key}.x or {field.key}.y" if field.shape else f"write {field.key} only"
        raise OverrideError(f"{field.title} has no part '{axis}'; {remedy}.")
    return Target(table, handles, element, field, key, axis), rest[len(path) :]


def _known(name: str, names: Iterable[str], what: str) -> str:
    if name in names:
        return name
    nearest = difflib.get_close_matches(name, names, n=1)
    remedy = f"did you mean '{nearest[0]}'?" if nearest else f"choose one of {', '.join(names)}."
    raise OverrideError(f"there is no {what} '{name}'; {remedy}")


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
        raise OverrideError(
            f"it names no {table.kind.noun}; write {table.name}.NAME.{rest}, or {EVERY} for every name."
        )
    raise OverrideError(table.world.missing(table.name, name, table.names))


def _settable(table: Table[Any]) -> dict[str, Field[Any]]:
    fields = table.fields_in(Role.DOCUMENT, Role.STATE)
    return {field.name if field.component else field.key: field for field in fields if field.references is None}


def _refuse_unsettable(table: Table[Any], key: str, settable: Iterable[str]) -> None:
    if key not in settable and key in table.fields:
        made_by = "is computed" if table.fields[key].role is Role.DERIVED else "refers to other elements"
        raise OverrideError(f"'{key}' {made_by} and cannot be set here; choose one of {', '.join(settable)}.")


def _values(target: Target, text: str) -> list[Any]:
    """One value per element."""
    new = target.read(text)
    if not target.axis:
        return [new] * len(target.handles)
    old = [getattr(handle, target.field.name) for handle in target.handles]
    return [(new, y) if target.axis == "x" else (x, new) for x, y in old]


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
