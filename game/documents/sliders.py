"""Sliders in model files: {"of": "loads.wind.force.x", "from": 0, "to": 200}, checked when read."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from components.field import Field, FieldError
from components.mistake import Mistake
from components.model import Model
from components.slider import Aim, Slider
from components.suggestions import remedy
from components.wording import cut, is_broken, quoted
from game.paths import EVERY, PathError, Target, locate, settable

KEY = "sliders"
KEYS = ("of", "from", "to", "logarithmic", "title")


class SliderError(Mistake, ValueError):
    """A slider in a file that cannot be; the message says where, what is wrong and the remedy."""


def read_sliders(model: Model, entries: Any) -> tuple[Slider, ...]:
    """The sliders that a document describes, of a model that has all elements. Raises SliderError."""
    if not isinstance(entries, list | tuple):
        raise SliderError(f"$.{KEY}: it is {quoted(entries)}; it must be a list.")
    return tuple(_read(model, entry, f"$.{KEY}[{place}]") for place, entry in enumerate(entries))


def _read(model: Model, entry: Any, where: str) -> Slider:
    if not isinstance(entry, Mapping):
        raise SliderError(f'{where}: it is {quoted(entry)}; write {{"of": "PATH", "from": 0, "to": 1}}.')
    for key in entry:
        if key not in KEYS:
            raise SliderError(f"{where}: there is no key '{cut(str(key))}' here; {remedy(str(key), KEYS)}")
    for key in KEYS[:3]:
        if key not in entry:
            raise SliderError(f"{where}: its '{key}' is missing; every slider needs one.")
    paths = entry["of"] if isinstance(entry["of"], list | tuple) else [entry["of"]]
    if not paths or not all(isinstance(path, str) for path in paths):
        raise SliderError(f"{where}.of: it is {quoted(entry['of'])}; it must be a path or a list of paths.")
    logarithmic, title = entry.get("logarithmic", False), entry.get("title", "")
    if not isinstance(logarithmic, bool):
        raise SliderError(f"{where}.logarithmic: it is {quoted(logarithmic)}; it must be true or false.")
    if not isinstance(title, str) or is_broken(title):
        raise SliderError(f"{where}.title: it is {title!a:.60}; it must be a text.")
    fields, aims = zip(*(_aim(model, path, f"{where}.of") for path in paths), strict=True)
    ends = [_end(entry[key], fields, f"{where}.{key}") for key in ("from", "to")]
    if ends[0] == ends[1]:
        raise SliderError(f"{where}: it goes from {ends[0]:g} to {ends[1]:g}; its ends must differ.")
    if logarithmic and not min(ends) > 0.0:
        raise SliderError(f"{where}: a logarithmic slider has both ends above 0, not {min(ends):g}.")
    return Slider(aims, ends[0], ends[1], logarithmic, title)


def _aim(model: Model, path: str, where: str) -> tuple[Field[Any], Aim]:
    """What a path names, if a slider can move it."""
    try:
        target, rest = locate(model, path, settable)
    except (PathError, FieldError) as error:
        raise SliderError(f"{where}: {cut(path)}: {error}") from None
    if rest:
        raise SliderError(f"{where}: {cut(path)}: '{cut(rest)}' follows the path; leave it out.")
    if problem := unmovable(target.field, target.axis):
        raise SliderError(f"{where}: {cut(path)}: {problem}")
    every = target.element == EVERY
    return target.field, Aim(
        target.table.name, None if every else target.handles[0], target.field.name, target.axis
    )


def unmovable(field: Field[Any], axis: str) -> str:
    """Why no slider can move a Field, or its component along an axis; "" if one can."""
    if field.dtype is not float:
        return f"{field.title} is no number, which alone a slider moves."
    if field.shape and not axis:
        return f"{field.title} is two numbers; write {field.key}.x or {field.key}.y."
    return ""


def _end(value: Any, fields: tuple[Field[Any], ...], where: str) -> float:
    number = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    if not number:
        raise SliderError(f"{where}: it is {quoted(value)}; it must be a finite number.")
    for field in fields:
        if problem := field.limit_broken_by(float(value)):
            raise SliderError(f"{where}: {field.title} is {float(value):g}; it must be {problem}.")
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
        element = EVERY if aim.element is None else "" if table.kind.single else _name(aim.element)
        field = table.fields[aim.field]
        key = next(name for name, known in settable(table).items() if known is field)
        yield Target(table, [], element, field, key, aim.axis).path(element)


def _name(element: Any) -> str:
    return str(element.name)
