"""`pinjoint run`: compute a model without a window and print what came of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from pinjoint.commands import envelope
from pinjoint.commands.analysis import FOUND, INTERRUPTED, Run, State
from pinjoint.commands.arguments import Parser, flag, option
from pinjoint.commands.options import (
    ANSWERED,
    NOT_ANSWERED,
    STOPPED,
    add_analysis,
    add_envelope,
    add_model,
    analysis_of,
    headless_of,
    model_of,
    path_of,
)
from pinjoint.commands.output import Row, add_output, aligned, as_written, writable, write, write_result
from pinjoint.components.cases import choose
from pinjoint.components.handle import Handle
from pinjoint.components.language import marked, several, tr
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.table import fields_of
from pinjoint.components.theory import FIRST_ORDER
from pinjoint.paths import ENERGIES
from pinjoint.systems.collision.impacts import Impacts

_KINDS: Mapping[str, type[Handle]] = {"particles": Particle, "rods": Rod}
_ERRORS = {
    "relative": marked("displacements"),
    "relative_velocity": marked("velocities"),
    "relative_axial_force": marked("axial forces"),
    "relative_rotation": marked("rotations"),
    "relative_bending_moment": marked("bending moments"),
}


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser("run", "Compute a model without a window, and print the result.")
    add_model(parser)
    add_analysis(parser)
    add_output(parser)
    option(parser, "--events FILE", "write all impacts to this file, as CSV", writable, apart=("--static",))
    flag(
        parser,
        "--measure-error",
        "measure the error by a second run with finer steps, even if that takes long",
        apart=("--static",),
    )
    option(parser, "--case NAME", "let one load case act alone", apart=("--combination",))
    add_envelope(parser, "--static")
    options = parser.parse_args(words)
    analysis = replace(analysis_of(options), measures_error=options.measure_error)
    if analysis.load_factors is not None:
        model = model_of(options)
        if options.case is not None:
            choose(model, options.case, None)
        if path_of(options, model) is not None:
            return envelope.answer(options, model, analysis)
        found, impacts = analysis.settled_in(model, options.model), Impacts(model)
    else:
        session = headless_of(options)
        if options.case is not None:
            choose(session.model, options.case, None)
        found, impacts = analysis.run_in(session, options.model), session.impacts
    write_result(options, found, rows, lines)
    if options.events is not None:
        write(impacts.as_csv(), options.events)
    if found["status"] == INTERRUPTED:
        return STOPPED
    return ANSWERED if found["status"] in FOUND else NOT_ANSWERED


# --- as text -------------------------------------------------------------------------------------------


def rows(run: Run) -> Iterator[Row]:
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
        columns = _columns(group, made[group])
        for name, values in made[group].items():
            yield from ((kind.noun, name, column.key, column.of(values), column.unit) for column in columns)
    for name, value in made["energy"].items():
        yield "energy", "", name, value, "J"
    for name in ("residual", "collisions"):
        yield "run", "", name, made[name], ""


def lines(run: Run) -> Iterator[str]:
    """A run as aligned tables to read: displacements in mm, all else in the units of files."""
    yield f"{run['model']}: {tr(run['status'])}"
    if run["message"]:
        yield run["message"]
    if run["integrator"] is None and run["theory"] == FIRST_ORDER:
        yield tr("static equilibrium by first-order theory")
    elif run["integrator"] is None:
        yield tr("static equilibrium with large displacements")
    else:
        how = {name: as_written(run[name]) for name in ("time", "steps", "time_step", "integrator")}
        if run["time_step"]:
            yield tr("time {time} s, {steps} steps of {time_step} s, integrator {integrator}", **how)
        else:
            yield tr("time {time} s, {steps} steps, integrator {integrator}", **how)
    if limit := run.get("limit_load"):
        yield limit["message"]
        if steps := run["hinge_by_hinge"]:
            yield ""
            yield from aligned([[*steps[0]], *([*step.values()] for step in steps)])
            yield ""
    if error := run.get("error_estimate"):
        known = {tr(title): as_written(error[key]) for key, title in _ERRORS.items() if key in error}
        yield tr("errors as shares of the largest value, measured by a run with finer steps:")
        yield several(f"{title} {value}" for title, value in known.items())
    yield tr(
        "computed in {computing} s, ready after {compiling} s",
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
    columns = _columns(group, elements)
    yield tr(_KINDS[group].noun), *(column.title for column in columns)
    in_mm = Particle.displacement.name
    yield "", *("mm" if column.fact == in_mm else column.unit for column in columns)
    for name, values in elements.items():
        numbers = ((column.of(values), column.fact) for column in columns)
        yield name, *(1000.0 * number if fact == in_mm else number for number, fact in numbers)


class _Column(NamedTuple):
    """One number of each element: a fact, or the part of one that is a vector."""

    fact: str
    part: int | None
    key: str
    title: str
    unit: str

    def of(self, values: Mapping[str, Any]) -> Any:
        """The number in the values of an element."""
        value = values[self.fact]
        return value if self.part is None else value[self.part]


def _columns(group: str, elements: Mapping[str, Mapping[str, Any]]) -> list[_Column]:
    """The columns of the elements of a table, which all have the same facts."""
    fields = {field.name: field for field in fields_of(_KINDS[group])}
    columns: list[_Column] = []
    for fact in next(iter(elements.values()), ()):
        field = fields[fact]
        if field.shape:
            parts = enumerate(field.axes)
            columns += (
                _Column(fact, n, f"{fact}_{axis}", field.named(axis), field.unit_of(axis)) for n, axis in parts
            )
        else:
            columns.append(_Column(fact, None, fact, field.named(), field.unit))
    return columns
