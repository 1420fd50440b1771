"""Paths: texts such as particles.B.force.x that name facts, on the command line, in sweeps, scripts and plots.

`locate` reads the path of a fact of elements; `apply_override` sets such facts, `quantity` reads numbers of a session,
its time and its energies among them.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from decimal import DecimalException
from typing import Any

import msgspec

from pinjoint.components.field import ENDS, SAVED, VALUE, Field, FieldError, Role
from pinjoint.components.handle import Handle
from pinjoint.components.language import joined, marked, tr
from pinjoint.components.mistake import Mistake
from pinjoint.components.model import Model
from pinjoint.components.table import Table
from pinjoint.components.units import inside
from pinjoint.components.wording import cut, missing, remedy

EVERY = "*"  # in place of a name: all elements of the table
TIME = "time"  # the path of the simulated time
FACTOR = "load_factor"  # the path of that of what statics shows
ENERGIES = {  # that are reported, in this order, and what people call them
    "kinetic": marked("kinetic"),
    "elastic": marked("elastic"),
    "dissipated_damping": marked("dissipated by damping"),
    "dissipated_plastic": marked("dissipated by yielding"),
    "dissipated_impact": marked("dissipated by impacts"),
    "work": marked("work of loads"),
    "imbalance": marked("imbalance"),
}


class PathError(Mistake, LookupError):
    """A path that names nothing or cannot have a value; the message gives the reason and the remedy."""


@dataclass(frozen=True)
class Target:
    """The target of a path: one fact of elements of a table, or its component along an axis.

    handles: the elements; element: their name in the path, "*" for all, "" in a table with a single element.
    key: the name of the fact in the path. axis: the part of it that is meant, such as "x", or "" for the whole.
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

    @property
    def shown(self) -> tuple[str, float]:
        """The unit in which the fact is shown, and the factor to it from its own."""
        unit, factor = self.field.on_screen
        return self.field.unit_of(self.axis) if unit == self.field.unit else unit, factor

    def part(self, value: Any) -> Any:
        """The component of a value that the path names; the whole value if the path has no axis."""
        return value[self.field.axes.index(self.axis)] if self.axis else value

    def give(self, new: Any) -> None:
        """Give every element this value, or this part of its value, as one undoable command. Raises FieldError."""
        self.give_each([new] * len(self.handles))

    def give_each(self, values: Sequence[Any]) -> None:
        """The same with a value for each element."""
        if self.axis:
            place = self.field.axes.index(self.axis)
            old = (getattr(handle, self.field.name) for handle in self.handles)
            values = [(*o[:place], new, *o[place + 1 :]) for o, new in zip(old, values, strict=True)]
        self.table.world.assign(self.handles, self.field.name, values)


Keys = Callable[[Table[Any]], Mapping[str, Field[Any]]]  # the facts of a table that may be named, by key


def settable(table: Table[Any]) -> Mapping[str, Field[Any]]:
    """The facts that a person can set, by the keys of model files."""
    fields = () if table.name in ("clock",) else table.fields_in(*SAVED)  # set by time
    return {field.name if field.component else field.key: field for field in fields if field.references is None}


def readable(table: Table[Any]) -> Mapping[str, Field[Any]]:
    """All facts, by the names of the attributes of elements."""
    return table.fields


def locate(model: Model, text: str, keys: Keys) -> tuple[Target, str]:
    """The target of the path with which a text begins, and the rest of the text: from "=" or "~" on, or "".

    Names of elements may contain dots, spaces and "=". Raises PathError.
    """
    section, _, rest = text.partition(".")
    tables = {name: known for name, table in model.tables.items() if (known := keys(table))}
    name = _known(section.strip(), tables, marked("there is no table '{name}'; {remedy}"))
    table, known = model.tables[name], tables[name]
    element, rest = _element(table, rest, known)
    handles = list(table) if element in ("", EVERY) else [table[element]]
    path = _before_value(rest)
    key, _, axis = path.strip().partition(".")
    if keys is settable:
        _refuse_unsettable(table, key, known)
    field = known[_known(key, known, marked("there is no key '{name}'; {remedy}"))]
    if axis and (not field.shape or axis not in field.axes):
        told = {"field": field.title, "part": cut(axis), "key": key}
        if field.shape:
            parts = _parts(key, field)
            raise PathError("{field} has no part '{part}'; write one of {parts}.", parts=parts, **told)
        raise PathError("{field} has no parts, such as '{part}'; write {key}.", **told)
    return Target(table, handles, element, field, key, axis), rest[len(path) :]


def _parts(key: str, field: Field[Any]) -> str:
    """The paths of the parts of a fact, as a choice."""
    return ", ".join(f"{key}.{axis}" for axis in field.axes)


def locate_one(model: Model, path: str, keys: Keys = readable) -> Target:
    """The target of a path of one element, with nothing after it. Raises PathError, which quotes the path."""
    with quoted(path):
        target, rest = locate(model, path, keys)
        if rest:
            raise PathError("'{rest}' does not belong to the path; leave it out.", rest=cut(rest))
        if target.element == EVERY:
            kind = tr(target.table.kind.noun)
            raise PathError("it names every {kind}; write a name in place of {star}.", kind=kind, star=EVERY)
    return target


def energy_named(name: str) -> str:
    """The name of an energy that is reported. Raises PathError."""
    return _known(name, ENERGIES, marked("there is no energy '{name}'; {remedy}"))


@contextmanager
def quoted(text: str) -> Iterator[None]:
    """Begin the message of an error with the text that a person wrote."""
    try:
        yield
    except (PathError, FieldError) as error:
        raise PathError(joined([f"{cut(text)}:", str(error)])) from None


def _known(name: str, names: Collection[str], refusal: str) -> str:
    if name not in names:
        raise PathError(refusal, name=cut(name), remedy=remedy(name, names))
    return name


def _element(table: Table[Any], rest: str, known: Collection[str]) -> tuple[str, str]:
    """The name of the element at the beginning of `rest` ("" in a table with a single one), and the text after it."""
    if table.kind.single:
        return "", rest
    cuts = [index for index, character in enumerate(rest) if character == "."]
    named = [cut for cut in cuts if rest[:cut] == EVERY or rest[:cut] in table]
    if not named:
        _refuse_name(table, rest, known)
    # Of the names "B" and "B.1", the longest that a key follows is meant.
    with_key = [cut for cut in named if _before_value(rest[cut + 1 :]).strip().partition(".")[0] in known]
    cut = (with_key or named)[-1]
    return rest[:cut], rest[cut + 1 :]


def _before_value(rest: str) -> str:
    return re.split("[=~]", rest, maxsplit=1)[0]  # "=" gives a value, "~" a distribution of values


def _refuse_name(table: Table[Any], rest: str, known: Collection[str]) -> None:
    if (whole := _before_value(rest).strip()) in table:
        raise PathError(
            "what is meant of it is missing; write {form}, with one of {keys}.",
            form=f"{table.name}.{whole}.KEY",
            keys=", ".join(known),
        )
    parts = whole.split(".")
    name = ".".join(parts[: -2 if parts[-1] in ("x", "y", *ENDS) else -1])
    if not name:
        raise PathError(
            "the name of the {kind} is missing; write {form}, or {star} for every name.",
            kind=tr(table.kind.noun),
            form=f"{table.name}.NAME.{rest or 'KEY'}",
            star=EVERY,
        )
    raise PathError(missing(table.name, name, table.names))


def _refuse_unsettable(table: Table[Any], key: str, known: Mapping[str, Any]) -> None:
    if key not in known and key in table.fields:
        keys = ", ".join(known)
        if table.fields[key].role is Role.DERIVED:
            raise PathError("'{key}' is computed and cannot be set; choose one of {keys}.", key=key, keys=keys)
        raise PathError(
            "'{key}' names other elements and cannot be set here; choose one of {keys}.", key=key, keys=keys
        )


# --- setting -------------------------------------------------------------------------------------------


def apply_override(model: Model, override: str) -> None:
    """Give a fact of one element, or of all elements of a table ("*"), the value that a person typed.

    override: `<table>.<name or *>.<key>=<value>`, `settings.<key>=<value>` or `environment.<key>=<value>`,
        with keys and units of model files, or units that are named, as `-300 N`; `<key>.x` and `<key>.y` are single
        components, `null` and `none` mean no value of its own. Names may contain dots, spaces and "=".

    One undoable command. Raises PathError, which quotes the override.
    """
    with quoted(override):
        target, rest = locate(model, override, settable)
        if not rest.startswith("="):
            form = tr("write it like particles.B.force=120,-160 or settings.restitution=0.5")
            raise PathError("it has no value; {form}.", form=form)
        if not target.handles:
            raise PathError(
                "the model has no {table}; add some, or leave this out.", table=tr(target.table.name)
            )
        target.give(read_value(target, rest[1:].strip()))


def read_value(target: Target, text: str) -> Any:
    """The value that a text means for a target; the text itself if it means none, which the field then refuses."""
    whole = target.field.shape and not target.axis
    return _vector(target.field, text) if whole else _scalar(target.field, text)


def _vector(field: Field[Any], text: str) -> tuple[Any, ...]:
    inside = text.removeprefix("[").removesuffix("]")
    return tuple(_scalar(field, part) for part in inside.split(","))


def _scalar(field: Field[Any], text: str) -> Any:
    """The value that a text means for a field; the text itself if it means none, which the field then refuses."""
    text = text.strip()
    if field.dtype is str and not field.nullable:
        return text
    if text.lower() in ("null", "none"):
        return None
    if field.dtype is bool:
        return {"true": True, "false": False}.get(text.lower(), text)
    try:
        return msgspec.json.decode(text) if field.dtype is object else field.dtype(text)
    except (ValueError, RecursionError):
        pass
    try:
        return float(inside(text, field.unit)) if field.dtype is float else text
    except DecimalException:
        return text


# --- reading -------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Quantity:
    """A number that can be read at any moment.

    name: fact and element. unit: that on screen. read: the value in this unit; NaN while the element is deleted.
    factor: to this unit from that of paths.
    """

    path: str
    name: str
    unit: str
    read: Callable[[Any], float]  # of a session
    factor: float = 1.0

    @property
    def title(self) -> str:
        """Name and unit."""
        return joined([self.name, f"({self.unit})" if self.unit else ""])


_PART_OF = dict.fromkeys(("", VALUE), marked("{quantity} of {element}")) | {
    ENDS[0]: marked("{quantity} at the start of {element}"),
    ENDS[1]: marked("{quantity} at the end of {element}"),
}


def quantity(model: Model, path: str) -> Quantity:
    """The quantity that a path leads to. Raises PathError."""
    if path == TIME:
        return Quantity(path, "t", "s", lambda session: session.time)
    if path == FACTOR:
        return Quantity(path, tr("load factor"), "", lambda session: session.model.share)
    table, _, rest = path.partition(".")
    if table == "energy":
        with quoted(path):
            name = energy_named(rest)
        return Quantity(path, name.replace("_", " "), "J", lambda session: session.energy.as_dict()[name])
    if table not in model.tables or not rest:
        form = tr("write it like rods.AB.axial_force, particles.B.displacement.y, energy.kinetic or time")
        raise PathError("There is no quantity '{path}'; {form}.", path=cut(path), form=form)
    target = locate_one(model, path, _numbers)
    if target.field.shape and not target.axis:
        parts = _parts(target.key, target.field)
        raise PathError("{path}: write one of {parts}.", path=path, parts=parts)
    handle, field = target.handles[0], target.field
    unit, factor = target.shown
    told = {"quantity": tr(field.title), "axis": tr(target.axis), "element": handle.world.describe(handle)}
    title = _PART_OF.get(target.axis, marked("{quantity} {axis} of {element}"))

    def read(session: Any) -> float:
        if not handle.exists or handle.world is not session.model:
            return math.nan
        value = session.model.column(f"{handle.table}.{field.name}")[handle.row]
        return float(target.part(value)) * factor

    return Quantity(path, tr(title, **told), unit, read, factor)


def _numbers(table: Table[Any]) -> Mapping[str, Field[Any]]:
    return {name: field for name, field in table.fields.items() if field.dtype in (float, int, bool)}
