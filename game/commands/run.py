"""`pinjoint run`: compute a model without a window and print what came of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from pinjoint.commands.arguments import Parser
from pinjoint.commands.options import (
    ANSWERED,
    NOT_ANSWERED,
    STOPPED,
    add_analysis,
    add_model,
    analysis_of,
    session_of,
)
from pinjoint.commands.output import Row, add_output, aligned, as_written, writable, write, write_result
from pinjoint.commands.report import FOUND, INTERRUPTED, Run, State
from pinjoint.components.language import marked, several, tr
from pinjoint.components.particle import Particle
from pinjoint.components.table import fields_of
from pinjoint.documents.format import SECTIONS
from pinjoint.paths import ENERGIES

_ERRORS = {
    "relative": marked("displacements"),
    "relative_velocity": marked("velocities"),
    "relative_axial_force": marked("axial forces"),
    "relative_rotation": marked("rotations"),
    "relative_bending_moment": marked("bending moments"),
}
STATUSES = (  # that runs end with, beside those of commands/report.py
    marked("mechanism"),
    marked("collapse"),
    marked("neutral equilibrium"),
    marked("unstable equilibrium"),
    marked("equilibrium without mods"),
)
_GROUPS = ("particles", "rods")
_IN_TABLES = {Particle.displacement.name: ("mm", 1000.0)}  # else units as in files


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(
        prog="pinjoint run", description=tr("Compute a model without a window, and print the result.")
    )
    add_model(parser)
    add_analysis(parser)
    add_output(parser)
    parser.add_argument(
        "--events", type=writable, metavar="FILE", help=tr("write all impacts to this file, as CSV")
    )
    parser.add_argument(
        "--measure-error",
        action="store_true",
        help=tr("measure the error by a second run with finer steps, even if that takes long"),
    )
    options = parser.parse_args(words)
    session = session_of(options)
    run = replace(analysis_of(options), measures_error=options.measure_error).run_in(session, options.model)
    write_result(options, run, run_rows, run_lines)
    if options.events is not None:
        write(session.simulation.impacts.as_csv(), options.events)
    if run["status"] == INTERRUPTED:
        return STOPPED
    return ANSWERED if run["status"] in FOUND else NOT_ANSWERED


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
    for group in _GROUPS:
        kind = SECTIONS[group]
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
    for group in _GROUPS:
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
    fields = {field.name: field for field in fields_of(SECTIONS[group])}
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
    yield tr(SECTIONS[group].noun), *titles
    yield "", *(unit for _, _, unit, _ in columns)
    for name, values in elements.items():
        cells = [name]
        for field, axis, _, factor in columns:
            value = values[field.name] if axis is None else values[field.name][axis]
            unscaled = value is None or isinstance(value, bool)
            cells.append(value if unscaled else value * factor)
        yield cells
