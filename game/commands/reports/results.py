"""Results of a run as plain data, as rows for CSV and as tables to read; see output.py."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from pinjoint.commands.output import ResultError, Row, aligned, as_written, plain
from pinjoint.components.field import Column, Field
from pinjoint.components.handle import Handle
from pinjoint.components.language import joined, marked, several, tr
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod, bends
from pinjoint.components.table import fields_of
from pinjoint.paths import ENERGIES

State = dict[str, Any]
Run = Mapping[str, Any]
Read = Callable[..., State]  # takes what `state` takes


def _facts(kind: type[Handle], *names: str) -> tuple[Field[Any], ...]:
    fields = {field.name: field for field in fields_of(kind)}
    return tuple(fields[name] for name in names)


# Reported facts of every element, by key in a state, under their names and in their units.
_OWN: Mapping[str, tuple[Field[Any], ...]] = {
    "particles": _facts(Particle, "position", "displacement", "velocity", "reaction", "mass"),
    "rods": _facts(Rod, "axial_force", "length", "strain", "plastic_strain", "yielding"),
}
# Further ones of models that bend, or bear distributed forces.
_OF_BENDING: Mapping[str, tuple[Field[Any], ...]] = {
    "particles": _facts(Particle, "rotation", "angular_velocity", "reaction_moment", "inertia"),
    "rods": _facts(Rod, "end_axial_force", "shear", "bending_moment", "end_rotation", "largest_moment"),
}
_KINDS: Mapping[str, type[Handle]] = {"particles": Particle, "rods": Rod}
_ERRORS = {
    "relative": marked("displacements"),
    "relative_velocity": marked("velocities"),
    "relative_axial_force": marked("axial forces"),
    "relative_rotation": marked("rotations"),
    "relative_bending_moment": marked("bending moments"),
}
STATUSES = (  # that runs end with, beside those of report.py
    marked("mechanism"),
    marked("collapse"),
    marked("neutral equilibrium"),
    marked("unstable equilibrium"),
    marked("equilibrium without mods"),
)
_IN_TABLES = {Particle.displacement.name: ("mm", 1000.0)}  # else units as in files


def reported(model: Model, group: str) -> tuple[Field[Any], ...]:
    """The fields of a table that results report: Pinjoint's own, then those of mods' components."""
    bent = bends(model) or model.rods.distributed_force.any()
    fields = model.tables[group].fields.values()
    of_mods = (field for field in fields if field.component and field.dtype in (float, int, bool))
    return (*_OWN[group], *(_OF_BENDING[group] if bent else ()), *of_mods)


# --- one state -----------------------------------------------------------------------------------------


def state(
    model: Model,
    energy: Mapping[str, float],
    load_factor: float | None = None,
    residual: float | None = None,
    columns: Mapping[str, Column] | None = None,
) -> State:
    """The present state of a model as plain data: SI units with kN, vectors as [x, y].

    energy: J, with the keys of ENERGIES. load_factor: of statics. residual: the largest
    force out of balance, relative to the largest force. columns: by "table.field", columns that are reported
    in place of the model's own. `position` is the original one. Raises ResultError.
    """
    made = facts(model, energy, load_factor, residual, columns)
    for group in _KINDS:
        keys, rows = made[group], zip(*(column.tolist() for column in made[group].values()), strict=True)
        made[group] = {
            name: {key: None if value != value else value for key, value in zip(keys, row, strict=True)}
            for name, row in zip(model.tables[group].names, rows, strict=True)
        }
    return made


def facts(
    model: Model,
    energy: Mapping[str, float],
    load_factor: float | None = None,
    residual: float | None = None,
    columns: Mapping[str, Column] | None = None,
) -> State:
    """As `state`, but of particles and of rods whole columns by name, in which NaN stands for no value."""
    made = {
        "time": model.clock.time,
        "load_factor": load_factor,
        **{group: _columns(model, group, columns or {}) for group in _KINDS},
        "energy": {name: energy[name] for name in ENERGIES},
        "residual": residual,
        "collisions": model.clock.collisions,
    }
    return made | {key: plain(made[key], key) for key in ("time", "load_factor", "energy", "residual")}


def _columns(model: Model, group: str, given: Mapping[str, Column]) -> dict[str, Column]:
    table, columns = model.tables[group], {}
    for field in reported(model, group):
        key = f"{group}.{field.name}"
        columns[field.name] = column = given[key] if key in given else table.column(field.name)
        finite = np.isfinite(column) | np.isnan(column) if field.nullable else np.isfinite(column)
        if not finite.all():
            row = int(np.argwhere(~finite)[0, 0])
            element, value = model.describe(table[row]), field.loaded(column, row)
            raise ResultError(
                "{where} is {value}, not a finite number; report an earlier state.",
                where=joined([element, field.named()], ": "),
                value=str(value),
            )
    return columns


# --- as text -------------------------------------------------------------------------------------------


def run_rows(run: Run) -> Iterator[Row]:
    """A run as tidy rows, one number each, headings first.

    Columns: time (s), load_factor (None in dynamics), element ("particle", "rod", "energy" or "run"),
    name, quantity (vectors as two: "velocity_x", "velocity_y"), value (yielding: 1 or 0), unit.
    """
    yield "time", "load_factor", "element", "name", "quantity", "value", "unit"
    for made in run["states"]:
        yield from ((made["time"], made["load_factor"], *row) for row in _quantities(made))


def _quantities(made: State) -> Iterator[tuple[Any, ...]]:
    """(element, name, quantity, value, unit) of every number in a state."""
    for group, kind in _KINDS.items():
        fields = {field.name: field for field in fields_of(kind)}
        for name, values in made[group].items():
            for fact, value in values.items():
                field = fields[fact]
                if field.shape:
                    for axis, part in zip(field.axes, value, strict=True):
                        yield kind.noun, name, f"{fact}_{axis}", part, field.unit_of(axis)
                else:
                    yield kind.noun, name, field.name, value, field.unit
    for name, value in made["energy"].items():
        yield "energy", "", name, value, "J"
    for name in ("residual", "collisions"):
        yield "run", "", name, made[name], ""


def run_lines(run: Run) -> Iterator[str]:
    """A run as aligned tables to read: displacements in mm, all else in the units of files."""
    yield f"{run['model']}: {tr(run['status'])}"
    if run["message"]:
        yield run["message"]
    if run["integrator"] is None:
        yield tr("static equilibrium with large displacements")
    else:
        how = {name: as_written(run[name]) for name in ("time", "steps", "time_step", "integrator")}
        if run["time_step"]:
            yield tr("time {time} s, {steps} steps of {time_step} s, integrator {integrator}", **how)
        else:
            yield tr("time {time} s, {steps} steps, integrator {integrator}", **how)
    if error := run.get("error_estimate"):
        known = {tr(title): as_written(error[key]) for key, title in _ERRORS.items() if key in error}
        yield tr("errors as shares of the largest value, measured by a run with finer steps:")
        yield several(f"{title} {value}" for title, value in known.items())
    yield tr(
        "computed in {computing} s, compiled in {compiling} s",
        computing=as_written(run["wall_seconds"]),
        compiling=as_written(run["compile_seconds"]),
    )
    for made in run["states"]:
        yield ""
        yield from _state_lines(made)


def _state_lines(made: State) -> Iterator[str]:
    factor = made["load_factor"]
    if factor is None:
        yield tr("At time {time} s", time=as_written(made["time"]))
    else:
        yield tr("At load factor {factor}", factor=as_written(factor))
    for group in _KINDS:
        if made[group]:
            yield ""
            yield from aligned(_element_rows(group, made[group]))
    yield ""
    energies = [[tr(ENERGIES[name]), value] for name, value in made["energy"].items()]
    yield from aligned([[tr("energy"), "J"], *energies])
    yield ""
    counts = {"residual": as_written(made["residual"]), "collisions": made["collisions"]}
    if made["residual"] is None:
        yield tr("impacts: {collisions}", **counts)
    else:
        yield tr("unbalanced forces: {residual} of the largest force; impacts: {collisions}", **counts)


def _element_rows(group: str, elements: Mapping[str, Mapping[str, Any]]) -> Iterator[Row]:
    """Two rows of headings, then one row per element."""
    fields = {field.name: field for field in fields_of(_KINDS[group])}
    columns = [
        (
            field,
            axis,
            *_IN_TABLES.get(field.name, (field.unit_of("" if axis is None else field.axes[axis]), 1.0)),
        )
        for field in map(fields.__getitem__, next(iter(elements.values())))
        for axis in (range(2) if field.shape else (None,))
    ]
    titles = [
        tr(field.title) + ("" if axis is None else f" {tr(field.axes[axis])}") for field, axis, _, _ in columns
    ]
    yield tr(_KINDS[group].noun), *titles
    yield "", *(unit for _, _, unit, _ in columns)
    for name, values in elements.items():
        cells = [name]
        for field, axis, _, factor in columns:
            value = values[field.name] if axis is None else values[field.name][axis]
            unscaled = value is None or isinstance(value, bool)
            cells.append(value if unscaled else value * factor)
        yield cells
