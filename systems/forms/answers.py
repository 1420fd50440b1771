"""Answers: texts typed into the boxes of properties, checked and assigned to the elements."""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import DecimalException
from typing import Any

from pinjoint.components.cases import PERMANENT, Combinations, alone, cases, check_case, rename
from pinjoint.components.field import Field, FieldError
from pinjoint.components.form import Box, Form
from pinjoint.components.handle import Handle
from pinjoint.components.language import marked, tr
from pinjoint.components.load import CONSTANT, HISTORIES, Load, SpanLoad
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.settings import Settings
from pinjoint.components.units import inside
from pinjoint.systems.forms.properties import CASE, KIND, NAMED, REMOVE, cases_named
from pinjoint.systems.forms.typing import YES_NO

_OF_LOADS = Load.force.name, Load.moment.name


def problem(model: Model, box: Box) -> str:
    """Why the text of a box is refused, or ""; in the units on the screen."""
    if not box.changed:
        return ""
    field, part = _target(model, box)
    try:
        value = _value(field, part, box.text)
    except DecimalException:
        return tr("must be a number")
    except FieldError as error:
        return str(error)
    if isinstance(value, float):
        if not math.isfinite(value):
            return tr("must be a finite number")
        limit = field.limit_broken_by(value, shown=True)
        if limit:
            return tr("must be {limit}", limit=limit)
    if field.name == "name":
        return _name_problem(model, box)
    if part and field.shape:
        return ""
    if part.endswith(f".{NAMED}") and value.strip() in {*model.settings.combinations} - {box.opened}:
        return tr("there is a combination '{name}' already", name=value)
    try:
        field.check(_with_part(box.elements[0], field, part, value), box.section)
    except FieldError as error:
        if field.choices is not None:  # too many to be named here
            return tr("unknown name")
        return str(error).removeprefix(f"{box.section}: ").removesuffix(".")
    return ""


def _name_problem(model: Model, box: Box) -> str:
    element, table = box.elements[0], model.tables[box.elements[0].table]
    if not box.text.strip():
        return tr("must not be empty")
    if box.text in table and table[box.text] is not element:
        return tr("there is a {kind} '{name}' already", kind=tr(element.noun), name=box.text)
    return ""


def apply(form: Form, model: Model, *, typing: bool = False) -> list[str]:
    """Assign all changed boxes to the model, as one edit; returns the sentences about refused ones.

    typing: also the box that is still typed into. What one box refuses because of another is tried again each time.
    """
    refused = []
    with model.transaction(tr("properties of {element}", element=form.heading)):
        for box in form.boxes:
            if not box.changed or (box is form.selected and box.words != YES_NO and not typing):
                continue
            elements = [handle for handle in box.elements if handle.exists]
            if not elements:
                continue
            box.problem = problem(model, box)
            if box.problem:
                refused.append(
                    tr(
                        "{section}, {title}: {problem}; the old value is kept.",
                        section=box.section,
                        title=box.said_title,
                        problem=box.problem,
                    )
                )
                continue
            try:
                _assign(model, box, elements)
            except FieldError as error:
                refused.append(str(error))
                box.problem = str(error).removeprefix(f"{box.section}: ")
    return refused


def draw_load(model: Model, elements: Sequence[Handle], field: str, value: Any) -> None:
    """Give elements a vector or a moment: as their own, or where one case acts alone, of a load in that."""
    case = alone(model) or PERMANENT
    if case == PERMANENT or field not in (*_OF_LOADS, Rod.distributed_force.name):
        model.assign(elements, field, [value] * len(elements))
        return
    with model.transaction(marked("load of a case")):
        for element in elements:
            if field in _OF_LOADS:
                known = (load for load in model.loads if load.particle is element and load.case == case)
                own = next((load for load in known if load.history == CONSTANT), None)
                model.assign([own or model.create(Load, on=[element.row], case=[case])[0]], field, [value])
            else:
                _all_along(model, element, value, case)


def _all_along(model: Model, rod: Handle, force: Any, case: str) -> None:
    model.create(SpanLoad, rod=[rod.row], case=[case], start_intensity=[force], end_intensity=[force])


def _to_case(model: Model, elements: Sequence[Handle], case: str) -> None:
    """Make what acts on particles and rods, as their own, loads of a case."""
    for element in elements:
        if isinstance(element, Particle):
            own: dict[str, Any] = {"force": [element.force], "moment": [element.moment]}
            model.create(Load, on=[element.row], case=[case], **own)
            element.force, element.moment = (0.0, 0.0), 0.0
        elif isinstance(element, Rod):
            _all_along(model, element, element.distributed_force, case)
            element.distributed_force = 0.0, 0.0


def _assign(model: Model, box: Box, elements: Sequence[Handle]) -> None:
    field, part = _target(model, box)
    if part == CASE:
        _to_case(model, elements, check_case(box.text, box.section))
        return
    value = _value(field, part, box.text)
    if part.endswith(f".{NAMED}") and box.opened and value != REMOVE:
        rename(model, box.opened, value)
        return
    values: Any = [_with_part(elements[0], field, part, value)] * len(elements)
    if field.shape:
        rows = model.row_of_entity[[element.entity for element in elements]]
        values = model.tables[elements[0].table].column(field.name)[rows]
        values[:, field.axes.index(part)] = value
    model.assign(elements, field.name, values)


def _with_part(element: Handle, field: Field[Any], part: str, value: Any) -> Any:
    """The value of a Field with one part of it changed: of a history, its kind or one of its numbers."""
    if field.dtype is not object:
        return value
    old = getattr(element, field.name)
    if field is Settings.combinations:
        return _with_combination(element.world, old, part, value)
    if part != KIND:
        return {**old, part: value}
    return {KIND: value} | {name: old[name] for name in HISTORIES[value].parameters if name in old}


def _with_combination(world: Any, old: Combinations, part: str, value: Any) -> Combinations:
    """Combinations of which one has another factor, or is new, or is gone."""
    row, _, what = part.partition(".")
    rows, at = list(old.items()), int(row)
    name, factors = rows[at] if at < len(rows) else ("", dict.fromkeys(cases(world), 1.0))
    if what != NAMED:
        factors = {**factors, cases_named(world)[int(what)]: value}
    else:
        name = value
    rows[at : at + 1] = [] if name == REMOVE else [(name, factors)]
    return dict(rows)


def _target(model: Model, box: Box) -> tuple[Field[Any], str]:
    table, name, *part = box.target.split(".", 2)
    return model.tables[table].fields[name], "".join(part)


def _value(field: Field[Any], part: str, text: str) -> Any:
    """The value of a text, in inside units.

    Raises DecimalException if it is no number but should be, and FieldError if it has a wrong unit.
    """
    if field.dtype is bool:
        return text == YES_NO[1]
    if field.nullable and text == field.absent:
        return None
    if field.dtype is str or part in (KIND, CASE) or part.endswith(f".{NAMED}"):
        return text
    number = inside(text, field.unit, field.on_screen[0])
    return int(number) if field.dtype is int and number == number.to_integral_value() else float(number)
