"""Properties: boxes generated from the Fields of elements."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.field import SAVED, Field
from pinjoint.components.form import NAME, NUMBER, TEXT, WORD, Box, Form
from pinjoint.components.handle import Handle
from pinjoint.components.language import joined, marked, plural, tr
from pinjoint.components.load import HISTORIES, Load
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod, rigid_joints
from pinjoint.components.settings import Settings
from pinjoint.systems.forms.typing import YES_NO, Typing

MIXED = marked("mixed")
KIND = "kind"  # the part of a history that is its kind
EXACT, DIGITS = 12, 9  # significant digits: numbers with so few are shown in full, others rounded
# Settings that concern rods; the others particles.
_OF_RODS = ("diagram_scale", "original_diagrams", "diagrams", "theory", "opens_in", "plasticity", "sleeping")
_DECIDED = (Particle.asleep, Rod.yielded_at)  # by the run
# Fields of one kind with a heading of their own, in the order in which these follow.
_APART: Mapping[str, tuple[Field[Any], ...]] = {
    marked("Cross-section"): (Rod.section, Rod.material, Rod.youngs_modulus, Rod.area, Rod.second_moment),
    marked("Bending"): (
        *(Rod.prescribed_bending_stiffness, Rod.hinged, Rod.end_springs, Rod.distributed_force),
        *(Rod.temperature_gradient, Rod.bending_damping),
    ),
    marked("Rotation"): (
        *(Particle.rotation, Particle.angular_velocity, Particle.fixed_rotation),
        *(Particle.moment, Particle.prescribed_inertia),
    ),
}
# That mean nothing to others.
_OF_BENT_RODS = (Rod.hinged, Rod.end_springs, Rod.temperature_gradient, Rod.bending_damping)
_NUMBERS = (float, int)
_EDITABLE = (*_NUMBERS, bool, str)


@dataclass(frozen=True)
class Subject:
    """Elements of one kind whose Fields stand together under a heading."""

    section: str
    elements: tuple[Handle, ...]
    rows: NDArray[np.intp]
    fields: tuple[Field[Any], ...]


# --- whose properties --------------------------------------------------------------------------------


def heading(model: Model, selected: Sequence[Handle]) -> str:
    """The name of some elements, such as "rod AB" or "2 particles, 1 rod"; without any, the environment."""
    if not selected:
        return tr("Environment")
    if len(selected) == 1:
        return model.describe(selected[0])
    counts = Counter(handle.noun for handle in selected)
    return joined((counted(noun, count) for noun, count in counts.items()), ", ")


def counted(noun: str, count: int) -> str:
    """So many elements of a kind: "2 particles"."""
    if noun == Particle.noun:
        return plural("{count} particle", "{count} particles", count)
    if noun == Rod.noun:
        return plural("{count} rod", "{count} rods", count)
    return plural("{count} {kind}", "{count} {kind}s", count, kind=tr(noun))


def _subjects(model: Model, selected: Sequence[Handle]) -> list[Subject]:
    """The selected elements by kind, the loads on a single particle, and the settings of all of a kind.

    Without any, the environment and the shown grid.
    """
    kinds = dict.fromkeys(map(type, selected))
    groups: list[list[Handle]] = [[h for h in selected if type(h) is kind] for kind in kinds]
    found = [_subject(model, heading(model, group), group) for group in groups]
    if not selected:
        found = [_subject(model, heading(model, []), [model.environment])]
        found += [_subject(model, model.describe(grid), [grid]) for grid in model.grids if grid.shown]
    found += [part for subject in found for part in _parts(model, subject)]
    if len(selected) == 1 and isinstance(selected[0], Particle):
        loads = [load for load in model.loads if load.on == selected[0].row]
        found += [_subject(model, model.describe(load), [load]) for load in loads]
    for section, kind, of_rods in ((tr("All particles"), Particle, False), (tr("All rods"), Rod, True)):
        if not selected or kind in kinds:
            fields = model.tables[Settings.table].fields_in(*SAVED)
            chosen = tuple(f for f in fields if (f.name in _OF_RODS) is of_rods and f.dtype is not object)
            found.append(Subject(section, (model.settings,), np.zeros(1, dtype=np.intp), chosen))
    return found


def _parts(model: Model, subject: Subject) -> Iterator[Subject]:
    """The Fields of elements that have a heading of their own, as far as they mean something to these."""
    kind, turns = type(subject.elements[0]), _turn(model, subject)
    for heading, fields in _APART.items():
        chosen = tuple(f for f in fields if vars(kind).get(f.name) is f and (turns or f not in _OF_BENT_RODS))
        if chosen and (turns or kind is Rod):
            yield replace(subject, section=tr(heading), fields=chosen)


def _turn(model: Model, subject: Subject) -> bool:
    """True if some of these rods bend, some of these particles turn, or are held or moved as if they did."""
    kind, rows = type(subject.elements[0]), subject.rows
    if kind is Rod:
        return bool((model.rods.bending_stiffness[rows] > 0.0).any())
    if kind is Load:
        return bool(rigid_joints(model)[model.loads.on[rows]].any() or model.loads.moment[rows].any())
    particles = model.particles
    given = particles.fixed_rotation | (particles.moment != 0.0) | ~np.isnan(particles.prescribed_inertia)
    return kind is Particle and bool((rigid_joints(model) | given)[rows].any())


def _subject(model: Model, section: str, elements: Sequence[Handle]) -> Subject:
    kind = type(elements[0])
    fields = model.tables[kind.table].fields_in(*SAVED)
    wanted = [field for field in fields if field.dtype in _EDITABLE or field is Load.history]
    apart = [field for fields in _APART.values() for field in fields]
    wanted = [field for field in wanted if field not in (*_DECIDED, *apart)]
    if len(elements) > 1:
        wanted = [field for field in wanted if field.name != "name"]
    rows = model.row_of_entity[[element.entity for element in elements]].astype(np.intp)
    subject = Subject(section, tuple(elements), rows, tuple(wanted))
    if kind is Load and not _turn(model, subject):
        wanted.remove(Load.moment)
    return replace(subject, fields=tuple(wanted))


# --- boxes -------------------------------------------------------------------------------------------


def boxes_of(model: Model, selected: Sequence[Handle]) -> list[Box]:
    """Their boxes: in each section alphabetical by title in English, so that Tab goes on alike; vectors as two, x and y."""
    found: list[Box] = []
    for subject in _subjects(model, selected):
        boxes = (box for field in subject.fields for box in _boxes(model, subject, field))
        found += sorted(boxes, key=lambda box: box.title.casefold())
    return found


def refresh(form: Form, model: Model, selected: Sequence[Handle]) -> None:
    """Let the boxes say what the model has now, except what is typed into them and what was refused."""
    wanted, before = boxes_of(model, selected), form.selected
    if [box.target for box in wanted] != [box.target for box in form.boxes]:  # such as of another history
        form.boxes = wanted
        if before is not None:
            Typing(form).select(next((box for box in wanted if box.target == before.target), None))
        return
    for box, now in zip(form.boxes, wanted, strict=True):
        box.opened, box.note, box.section = now.opened, now.note, now.section
        if box is not form.selected and not box.problem:
            box.text = now.text
            box.caret = len(box.text)


def _boxes(model: Model, subject: Subject, field: Field[Any]) -> Iterator[Box]:
    """The boxes for one Field of the elements."""
    if field.dtype is object:
        yield from _history_boxes(model, subject, field)
        return
    words = _words(field)
    for axis in field.axes if field.shape else ("",):
        content = _content(model, subject, field, axis)
        accepts = NUMBER if field.dtype in _NUMBERS else TEXT if not words else NAME if field.checker else WORD
        yield _box(subject, field, axis, content, accepts, words)


def _history_boxes(model: Model, subject: Subject, field: Field[Any]) -> Iterator[Box]:
    """The kind of a load's history, and each of its numbers."""
    history = model.loads.history[subject.rows[0]]
    yield replace(_box(subject, field, KIND, (history[KIND], ""), WORD, tuple(HISTORIES)), title=field.title)
    for name, value in history.items():
        if isinstance(value, float):
            yield _box(subject, field, name, (_written_number(value, 1.0), ""), NUMBER)


def _box(
    subject: Subject,
    field: Field[Any],
    part: str,
    content: tuple[str, str],
    accepts: str,
    words: tuple[str, ...] = (),
) -> Box:
    text, note = content
    return Box(
        title=f"{field.title} {part}".rstrip(),
        target=f"{subject.elements[0].table}.{field.name}{'.' * bool(part)}{part}",
        text=text,
        opened=text,
        section=subject.section,
        unit=field.shown[0],
        explanation=field.doc,
        elements=subject.elements,
        accepts=accepts,
        words=words,
        note=note,
        caret=len(text),
    )


def _words(field: Field[Any]) -> tuple[str, ...]:
    if field.dtype is bool:
        return YES_NO
    if field.choices is not None:
        return (*([field.absent] if field.nullable else []), *field.choices)
    return (field.absent,) if field.nullable else ()


# --- what they contain -------------------------------------------------------------------------------


def _content(model: Model, subject: Subject, field: Field[Any], axis: str) -> tuple[str, str]:
    """The text of a box for some elements, and its note: that they differ, or that the value is automatic."""
    table = model.tables[subject.elements[0].table]
    column = table.column(field.name)
    values = (column[:, field.axes.index(axis)] if axis else column)[subject.rows]
    if field.nullable and field.dtype is float and np.isnan(values).all():
        if field.overrides is None:
            return field.absent, ""
        text, note = _content(model, subject, table.fields[field.overrides], axis)
        return text, joined([note, tr(field.absent)], ", ")
    if not (values == values[0]).all():
        return "", tr(MIXED)
    if values[0] is None:
        return field.absent, ""
    return _written(field, values[0]), ""


def _written(field: Field[Any], value: Any) -> str:
    if field.dtype is bool:
        return YES_NO[int(value)]
    if field.dtype is str:
        return str(value)
    return _written_number(float(value), field.shown[1])


def _written_number(value: float, factor: float) -> str:
    """A number times the factor of its unit on screen."""
    shown = float(Decimal(repr(value)) * Decimal(repr(factor))) + 0.0
    exact = f"{shown:.{EXACT}g}"
    return exact if float(exact) == shown else f"{shown:.{DIGITS}g}"
