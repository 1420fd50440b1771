"""Properties: boxes generated from the Fields of elements, and what was typed put back into them."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from typing import Any

import numpy as np

from components.box import NUMBER, TEXT, WORD, Box
from components.field import Column, Field, FieldError, Role
from components.form import Form
from components.load import Load
from components.model import Model
from components.particle import Particle
from components.rod import Rod
from components.settings import Settings
from components.world import Handle
from systems.forms.typing import YES_NO

MIXED = "mixed"
EXACT, DIGITS = 12, 9  # significant digits: numbers with so few are shown in full, others rounded
_OF_RODS = ("diagram_scale", "plasticity")  # settings of all rods together; the others are of all particles
_EDITABLE = (float, bool, str)


@dataclass(frozen=True)
class Subject:
    """Elements of one kind whose Fields stand together under a heading."""

    section: str
    elements: tuple[Handle, ...]
    fields: tuple[Field[Any], ...]


# --- what is shown -----------------------------------------------------------------------------------


def heading(model: Model, selected: Sequence[Handle]) -> str:
    """What a person calls these elements: "rod AB", "2 particles, 1 rod"; none: the environment."""
    if not selected:
        return "Environment"
    if len(selected) == 1:
        return model.describe(selected[0])
    counts = Counter(handle.noun for handle in selected)
    return ", ".join(f"{count} {noun}{'s' * (count > 1)}" for noun, count in counts.items())


def subjects(model: Model, selected: Sequence[Handle]) -> list[Subject]:
    """The selected elements by kind, what belongs to them, and the settings of all of that kind."""
    found = [
        _subject(model, heading(model, alike), alike)
        for kind in dict.fromkeys(map(type, selected))
        if (alike := [handle for handle in selected if type(handle) is kind])
    ]
    if not selected:
        found.append(_subject(model, "Environment", [model.environment]))
    loads = _loads_on(model, selected)
    found += [_subject(model, model.describe(load), [load]) for load in loads]
    for title, kind, of_rods in (("All particles", Particle, False), ("All rods", Rod, True)):
        if not selected or any(isinstance(handle, kind) for handle in selected):
            found.append(_together(model, title, of_rods=of_rods))
    return found


def _loads_on(model: Model, selected: Sequence[Handle]) -> list[Load]:
    """The loads on a single selected particle."""
    if len(selected) != 1 or not isinstance(selected[0], Particle):
        return []
    return [load for load in model.loads if load.on == selected[0].row]


def _subject(model: Model, section: str, elements: Sequence[Handle]) -> Subject:
    fields = model.tables[elements[0].table].fields_in(Role.DOCUMENT, Role.STATE)
    editable = [field for field in fields if field.dtype in _EDITABLE]
    if len(elements) > 1:
        editable = [field for field in editable if field.name != "name"]
    return Subject(section, tuple(elements), tuple(editable))


def _together(model: Model, title: str, *, of_rods: bool) -> Subject:
    fields = model.tables[Settings.table].fields.values()
    wanted = (field for field in fields if (field.name in _OF_RODS) is of_rods)
    return Subject(title, (model.settings,), tuple(wanted))


def fill(form: Form, model: Model, selected: Sequence[Handle]) -> None:
    """Create the boxes: in each section alphabetical by title, vectors as two, x and y."""
    form.delete(list(form.boxes))
    for subject in subjects(model, selected):
        rows = sorted(_facts(model, subject), key=lambda fact: str(fact["title"]).casefold())
        columns = {key: [row[key] for row in rows] for key in rows[0]}
        form.create(Box, len(rows), **columns)


def _facts(model: Model, subject: Subject) -> Iterator[dict[str, Any]]:
    """The Fields of one box for every number, flag and text of the elements."""
    for field in subject.fields:
        for axis in "xy" if field.shape else ("",):
            text, note = _text(model, subject.elements, field, axis)
            yield {
                "section": subject.section,
                "title": f"{field.title} {axis}".rstrip(),
                "unit": field.shown[0],
                "explanation": field.doc,
                "target": f"{subject.elements[0].table}.{field.name}{'.' * bool(axis)}{axis}",
                "elements": subject.elements,
                "accepts": NUMBER if field.dtype is float else WORD if _words(field) else TEXT,
                "words": _words(field),
                "text": text,
                "opened": text,
                "note": note,
            }


def _words(field: Field[Any]) -> tuple[str, ...] | None:
    if field.dtype is bool:
        return YES_NO
    if field.choices is not None:
        return tuple(field.choices)
    return (field.absent,) if field.nullable else None


def _text(model: Model, elements: Sequence[Handle], field: Field[Any], axis: str) -> tuple[str, str]:
    """What the box of some elements contains, and a note: that they differ, or that it is automatic."""
    column, rows = _column(model, elements, field, axis)
    values = column[rows]
    if field.nullable and field.dtype is float and np.isnan(values).all():
        if field.overrides is None:
            return field.absent, ""
        text, note = _text(model, elements, model.tables[elements[0].table].fields[field.overrides], axis)
        return text, f"{note}, {field.absent}" if note else field.absent
    first = values[0]
    if not (values == first).all():
        return "", MIXED
    return _written(field, first), ""


def _column(model: Model, elements: Sequence[Handle], field: Field[Any], axis: str) -> tuple[Column, list[int]]:
    column = model.tables[elements[0].table].column(field.name)
    return column[:, "xy".index(axis)] if axis else column, [handle.row for handle in elements]


def _written(field: Field[Any], value: Any) -> str:
    if field.dtype is bool:
        return YES_NO[int(value)]
    if field.dtype is str:
        return str(value)
    shown = float(Decimal(repr(float(value))) * Decimal(repr(field.shown[1]))) + 0.0
    exact = f"{shown:.{EXACT}g}"
    return exact if float(exact) == shown else f"{shown:.{DIGITS}g}"


# --- what was typed ----------------------------------------------------------------------------------


def problem(model: Model, box: Box) -> str:
    """Why the text of a box is refused, or ""; in the units on the screen."""
    if not box.changed:
        return ""
    field, _ = _target(model, box)
    try:
        value = _value(field, box.text)
    except InvalidOperation:
        return "must be a number"
    if isinstance(value, float) and not math.isfinite(value):
        return "must be a finite number"
    limit = field.limit_broken_by(value, shown=True) if isinstance(value, float) else None
    if limit:
        return f"must be {limit}"
    if field.name == "name":
        return _name_problem(model, box)
    try:
        if not field.shape:
            field.check(value, box.section)
    except FieldError as error:
        return str(error).removeprefix(f"{box.section}: ").removesuffix(".")
    return ""


def _name_problem(model: Model, box: Box) -> str:
    element, table = box.elements[0], model.tables[box.elements[0].table]
    if not box.text.strip():
        return "must not be empty"
    if box.text in table and table[box.text] is not element:
        return f"there is a {element.noun} '{box.text}' already"
    return ""


def apply(form: Form, model: Model) -> list[str]:
    """Put all changed boxes into the model, as one step; returns the sentences about those refused."""
    refused = []
    with model.transaction(f"properties of {form.heading.text}"):
        for box in form.boxes:
            elements = [handle for handle in box.elements if handle.exists]
            if not box.changed or not elements:
                continue
            if box.problem:
                refused.append(f"{box.section}, {box.title}: {box.problem}; the old value stays.")
                continue
            try:
                _assign(model, box, elements)
            except FieldError as error:
                refused.append(str(error))
    return refused


def _assign(model: Model, box: Box, elements: Sequence[Handle]) -> None:
    field, axis = _target(model, box)
    value = _value(field, box.text)
    values: Any = [value] * len(elements)
    if axis:
        column, rows = model.tables[elements[0].table].column(field.name), [h.row for h in elements]
        values = column[rows]
        values[:, "xy".index(axis)] = value
    model.assign(elements, field.name, values)


def _target(model: Model, box: Box) -> tuple[Field[Any], str]:
    table, name, *axis = box.target.split(".")
    return model.tables[table].fields[name], "".join(axis)


def _value(field: Field[Any], text: str) -> Any:
    """What a text means, in the units inside. Raises InvalidOperation if it should be a number."""
    if field.dtype is bool:
        return text == YES_NO[1]
    if field.dtype is str:
        return text
    if field.nullable and text == field.absent:
        return None
    return float(Decimal(text) / Decimal(repr(field.shown[1])))
