"""Sliders in model files: {"of": "loads.wind.force.x", "from": 0, "to": 200}, checked when read."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from pinjoint.components.field import Field, FieldError
from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.components.slider import Aim, Slider
from pinjoint.components.wording import cut, is_broken, quoted, remedy
from pinjoint.documents.format import fail
from pinjoint.paths import EVERY, PathError, Target, locate, settable

KEY = "sliders"
KEYS = ("of", "from", "to", "logarithmic", "title")


def read_sliders(model: Model, entries: Any) -> tuple[Slider, ...]:
    """The sliders that a document describes, of a model that has all elements. Raises ModelError, FieldError."""
    if not isinstance(entries, list | tuple):
        fail(f"$.{KEY}", "it is {value}; it must be a list.", value=quoted(entries))
    return tuple(_read(model, entry, f"$.{KEY}[{place}]") for place, entry in enumerate(entries))


def _read(model: Model, entry: Any, where: str) -> Slider:
    if not isinstance(entry, Mapping):
        form = '{"of": "PATH", "from": 0, "to": 1}'
        fail(where, "it is {value}; write it like {form}.", value=quoted(entry), form=form)
    for key in map(str, entry):
        if key not in KEYS:
            fail(where, "there is no key '{key}' here; {remedy}", key=cut(key), remedy=remedy(key, KEYS))
    for key in KEYS[:3]:
        if key not in entry:
            fail(where, "its '{key}' is missing; every {kind} needs one.", key=key, kind=tr("slider"))
    paths = entry["of"] if isinstance(entry["of"], list | tuple) else [entry["of"]]
    if not paths or not all(isinstance(path, str) for path in paths):
        said = tr("it is {value}; it must be a path or a list of paths.", value=quoted(entry["of"]))
        fail(f"{where}.of", said)
    logarithmic, title = entry.get("logarithmic", False), entry.get("title", "")
    if not isinstance(logarithmic, bool):
        said = tr("it is {value}; it must be true or false.", value=quoted(logarithmic))
        fail(f"{where}.logarithmic", said)
    if not isinstance(title, str) or is_broken(title):
        fail(f"{where}.title", "it is {value}; it must be a text.", value=f"{title!a:.60}")
    fields, aims = zip(*(_aim(model, path, f"{where}.of") for path in paths), strict=True)
    ends = [_end(entry[key], fields, f"{where}.{key}") for key in ("from", "to")]
    if ends[0] == ends[1]:
        said = tr("it goes from {start:g} to {end:g}; its ends must differ.", start=ends[0], end=ends[1])
        fail(where, said)
    if logarithmic and not min(ends) > 0.0:
        said = tr("both ends of a logarithmic slider must be above 0, not {end:g}.", end=min(ends))
        fail(where, said)
    return Slider(aims, ends[0], ends[1], logarithmic, title)


def _aim(model: Model, path: str, where: str) -> tuple[Field[Any], Aim]:
    """What a path names, if a slider can move it."""
    where = f"{where}: {cut(path)}"
    try:
        target, rest = locate(model, path, settable)
    except (PathError, FieldError) as error:
        fail(where, str(error))
    if rest:
        fail(where, "'{rest}' does not belong to the path; leave it out.", rest=cut(rest))
    if problem := unmovable(target.field, target.axis):
        fail(where, problem)
    every = target.element == EVERY
    return target.field, Aim(
        target.table.name, None if every else target.handles[0], target.field.name, target.axis
    )


def unmovable(field: Field[Any], axis: str) -> str:
    """Why no slider can move a Field, or its component along an axis; "" if one can."""
    if field.dtype is not float:
        return tr("{field} is not a number, so a slider cannot change it.", field=field.title)
    if field.shape and not axis:
        return tr("{field} has two components; write {key}.x or {key}.y.", field=field.title, key=field.key)
    return ""


def _end(value: Any, fields: tuple[Field[Any], ...], where: str) -> float:
    number = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    if not number:
        fail(where, "it is {value}; it must be a finite number.", value=quoted(value))
    for field in fields:
        field.check_limits(float(value), where)
    return float(value)


def slider_entries(model: Model) -> list[dict[str, Any]]:
    """The sliders of a model as a document holds them; aims at deleted elements are left out."""
    return [entry for slider in model.sliders if (entry := _entry(model, slider))["of"]]


def _entry(model: Model, slider: Slider) -> dict[str, Any]:
    paths = list(_paths(model, slider))
    entry: dict[str, Any] = {
        "of": paths[0] if len(paths) == 1 else paths,
        "from": slider.first,
        "to": slider.last,
    }
    if slider.logarithmic:
        entry["logarithmic"] = True
    return entry | ({"title": slider.title} if slider.title else {})


def _paths(model: Model, slider: Slider) -> Iterator[str]:
    for aim in slider.aims:
        table = model.tables[aim.table]
        if aim.element is not None and not aim.element.exists:
            continue
        element = EVERY if aim.element is None else "" if table.kind.single else table.names[aim.element.row]
        field = table.fields[aim.field]
        key = next(name for name, known in settable(table).items() if known is field)
        yield Target(table, [], element, field, key, aim.axis).path(element)
