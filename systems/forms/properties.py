"""Properties: boxes generated from the Fields of elements."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.cases import PERMANENT, cases
from pinjoint.components.field import SAVED, Field
from pinjoint.components.form import NAME, NUMBER, TEXT, WORD, Box, Form
from pinjoint.components.handle import Handle
from pinjoint.components.language import joined, marked, plural, tr
from pinjoint.components.load import HISTORIES, Load, SpanLoad
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle, supported
from pinjoint.components.rod import Rod, rigid_joints
from pinjoint.components.settings import Environment, Settings
from pinjoint.systems.forms.typing import YES_NO, Typing

_MIXED = marked("mixed")
KIND = "kind"  # the part of a history that is its kind
CASE = "case"  # the part of an own load that makes it one of a case
NAMED = "name"  # the part of a combination that is its name
REMOVE = marked("remove it")  # what takes a combination away, in place of its name
COMBINATION = marked("new combination")
EXACT, DIGITS = 12, 9  # significant digits: numbers with so few are shown in full, others rounded
# By the run, or by buttons.
_DECIDED = (Particle.asleep, Rod.yielded_at, Rod.hinge_formed_at, Settings.combination)
# The groups of boxes by heading, in the order in which they follow one another, with the Fields of all kinds in each, those
# that matter first. What is in none, such as a Field of a mod, stands in the first, under the name of its element.
GROUPS: Mapping[str, tuple[Field[Any], ...]] = {
    "": (
        *(Particle.name, Particle.position, Rod.name, Rod.prescribed_rest_length, Load.name, Load.force),
        *(Load.moment, Load.case, Load.history),
        *(Environment.acceleration, Environment.force, Environment.drag),
        *(Settings.collisions, Settings.restitution, Settings.prescribed_displacement_scale),
        *(Settings.integrator, Settings.time_step, Settings.tolerance),
    ),
    marked("Load combinations"): (Settings.combinations, Settings.moving_force),
    marked("Section and material"): (
        *(Rod.section, Rod.material, Rod.youngs_modulus, Rod.area, Rod.second_moment),
        *(Rod.prescribed_stiffness, Rod.prescribed_bending_stiffness, Rod.density, Rod.thermal_expansion),
        *(Rod.tensile_strength, Rod.compressive_strength, Rod.plastic_moment),
        *(Rod.tension_only, Rod.buckles, Rod.inextensible),
    ),
    marked("Supports and joints"): (
        *(Particle.fixed, Particle.fixed_rotation, Particle.support_angle, Particle.support_springs),
        Particle.rotation_spring,
        *(Rod.hinged, Rod.end_springs),
    ),
    marked("Loads"): (
        *(Particle.force, Particle.moment, Particle.acceleration),
        *(Rod.distributed_force, Rod.temperature_change, Rod.temperature_gradient),
    ),
    marked("Motion and contact"): (
        *(Particle.displacement, Particle.rotation, Particle.velocity, Particle.angular_velocity),
        *(Particle.prescribed_mass, Particle.prescribed_inertia, Particle.radius),
        *(Rod.damping, Rod.bending_damping, Rod.plastic_strain, Rod.plastic_rotation),
    ),
    marked("All rods"): (
        *(Settings.theory, Settings.opens_in, Settings.original_diagrams, Settings.diagrams),
        *(Settings.diagram_scale, Settings.plasticity, Settings.plastic_hinges, Settings.sleeping),
    ),
}
_OF_BENDING = (  # what means nothing to rods that do not bend, and where none turns a particle
    *(Rod.hinged, Rod.end_springs, Rod.temperature_gradient, Rod.bending_damping),
    *(Rod.plastic_moment, Rod.plastic_rotation),
    *(Load.moment, Particle.moment),
    *(Particle.rotation, Particle.angular_velocity, Particle.fixed_rotation, Particle.rotation_spring),
    Particle.prescribed_inertia,
)
_NUMBERS = (float, int)


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
    """The selected elements by kind, the loads on a single particle or rod, and the settings of all of a kind.

    Without any, the environment and the shown grid.
    """
    kinds = dict.fromkeys(map(type, selected))
    groups: list[list[Handle]] = [[h for h in selected if type(h) is kind] for kind in kinds]
    named = [(heading(model, group), group) for group in groups]
    if not selected:
        named = [(heading(model, []), [model.environment])]
        named += [(model.describe(grid), [grid]) for grid in model.grids if grid.shown]
    if len(selected) == 1 and isinstance(selected[0], Particle):
        named += [(model.describe(load), [load]) for load in model.loads if load.on == selected[0].row]
    if len(selected) == 1 and isinstance(selected[0], Rod):
        named += [(model.describe(load), [load]) for load in model.span_loads if load.rod == selected[0].row]
    found = [subject for section, group in named for subject in _groups(model, section, group)]
    of = {tr("All particles"): Particle, tr("All rods"): Rod}
    settings = _groups(model, tr("All particles"), [model.settings])
    return found + [subject for subject in settings if not selected or of.get(subject.section) in kinds]


def _groups(model: Model, section: str, elements: Sequence[Handle]) -> Iterator[Subject]:
    """The groups of Fields of elements of one kind; section: the heading of the first."""
    rows = model.row_of_entity[[element.entity for element in elements]].astype(np.intp)
    turn = _turn(model, type(elements[0]), rows)
    fields = model.tables[elements[0].table].fields_in(*SAVED)
    wanted = [
        field
        for field in fields
        if (field.dtype in (*_NUMBERS, bool, str) or field in (Load.history, Settings.combinations))
        and (turn or field not in _OF_BENDING)
        and (len(elements) == 1 or field.name != "name")
        and field not in _DECIDED
    ]
    rest = [field for field in wanted if not any(field in group for group in GROUPS.values())]
    for title, group in GROUPS.items():
        chosen = [field for field in group if field in wanted] + ([] if title else rest)
        if chosen:
            yield Subject(tr(title) or section, tuple(elements), rows, tuple(chosen))


def _turn(model: Model, kind: type[Handle], rows: NDArray[np.intp]) -> bool:
    """True if some of these rods bend, some of these particles turn, or are held or moved as if they did."""
    if kind is Rod:
        return bool((model.rods.bending_stiffness[rows] > 0.0).any())
    if kind is Load:
        return bool(rigid_joints(model)[model.loads.on[rows]].any() or model.loads.moment[rows].any())
    particles = model.particles
    given = supported(model)[:, 2] | (particles.moment != 0.0) | ~np.isnan(particles.prescribed_inertia)
    return kind is Particle and bool((rigid_joints(model) | given)[rows].any())


# --- boxes -------------------------------------------------------------------------------------------


def boxes_of(model: Model, selected: Sequence[Handle]) -> list[Box]:
    """Their boxes in groups, in each those that matter first; vectors as two, x and y."""
    subjects = _subjects(model, selected)
    return [box for subject in subjects for field in subject.fields for box in _boxes(model, subject, field)]


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
        yield from (_history_boxes if field is Load.history else _combination_boxes)(model, subject, field)
        return
    words = tuple(cases(model)) if field in (Load.case, SpanLoad.case) else _words(field)
    for axis in field.axes if field.shape else ("",):
        content = _content(model, subject, field, axis)
        accepts = NUMBER if field.dtype in _NUMBERS else TEXT if not words else NAME if field.checker else WORD
        yield _box(subject, field, axis, content, accepts, words)
    own = field in (Particle.force, Rod.distributed_force)
    if own and model.tables[subject.elements[0].table].column(field.name)[subject.rows].any():
        box = _box(subject, field, CASE, (PERMANENT, ""), NAME, tuple(cases(model)))
        yield replace(box, title=Load.case.title, unit="", explanation=Load.case.doc)


def cases_named(model: Model) -> list[str]:
    """The cases of loads, and others that combinations name."""
    combinations = model.settings.combinations
    return list(
        dict.fromkeys([*cases(model), *(case for factors in combinations.values() for case in factors)])
    )


def _combination_boxes(model: Model, subject: Subject, field: Field[Any]) -> Iterator[Box]:
    """The name of each combination, and its factors in a row below; then the name of a new one."""
    known, combinations = cases_named(model), model.settings.combinations
    across = min(len(known), 4)
    for row, (name, factors) in enumerate(combinations.items()):
        box = _box(subject, field, f"{row}.{NAMED}", (name, ""), NAME, (REMOVE,))
        yield replace(box, title=marked("combination"), across=2)
        for number, case in enumerate(known):
            text = _written_number(factors.get(case, 0.0), 1.0)
            yield replace(
                _box(subject, field, f"{row}.{number}", (text, ""), NUMBER), title=case, across=across
            )
    yield replace(_box(subject, field, f"{len(combinations)}.{NAMED}", ("", ""), TEXT), title=COMBINATION)


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
        unit=field.on_screen[0],
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
        return "", tr(_MIXED)
    if values[0] is None:
        return field.absent, ""
    return _written(field, values[0]), ""


def _written(field: Field[Any], value: Any) -> str:
    if field.dtype is bool:
        return YES_NO[int(value)]
    if field.dtype is str:
        return str(value)
    return _written_number(float(value), field.on_screen[1])


def _written_number(value: float, factor: float) -> str:
    """A number times the factor of its unit on screen."""
    shown = float(Decimal(repr(value)) * Decimal(repr(factor))) + 0.0
    exact = f"{shown:.{EXACT}g}"
    return exact if float(exact) == shown else f"{shown:.{DIGITS}g}"
