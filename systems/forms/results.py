"""Results: what elements do now, as readings beside the boxes of their properties, and where something is pointed at."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from components import written
from components.field import Field, Role
from components.form import Form, Reading
from components.handle import Handle
from components.load import CONSTANT, Load, factor_at
from components.model import Model
from components.particle import Particle
from components.rod import Rod

SECTION = "Results"
RESIDUAL = 1e-12  # of a length (m), force (kN) or speed (m/s): nothing, where all of them are as small
_AXES = "xy"


class Result(NamedTuple):
    """The Fields of a reading, see components/form.py."""

    section: str
    title: str
    text: str
    explanation: str


def fill(form: Form, model: Model, selected: Sequence[Handle]) -> None:
    """Let a form show the results of some elements."""
    found = [*results(model, selected)]
    form.delete(list(form.readings))
    if found:
        columns = map(list, zip(*found, strict=True))
        form.create(Reading, len(found), **dict(zip(Result._fields, columns, strict=True)))


def results(model: Model, selected: Sequence[Handle]) -> Iterator[Result]:
    """What one element does now, or the extremes of several of a kind."""
    rows = model.rows_of(selected)
    if len(rows["rods"]):
        yield from _of_rods(model, rows["rods"])
    if len(rows["particles"]):
        yield from _of_particles(model, rows["particles"])


def told(model: Model, handle: Handle, *, forces_known: bool) -> list[tuple[str, str]]:
    """What is said of an element that is pointed at: its results, the loads on it, what a mod's element was given.

    Results only once forces are known.
    """
    found = [*results(model, [handle])] if forces_known else []
    if isinstance(handle, Particle):
        found += _of_loads(model, handle.row)
    elif handle.points:
        found += _of_others(model, handle)
    return [(result.title, result.text) for result in found]


# --- rods ---------------------------------------------------------------------------------------------


def _of_rods(model: Model, rows: NDArray[np.intp]) -> Iterator[Result]:
    rods, names = model.rods, model.rods.column("name")
    force = rods.axial_force
    if len(rows) == 1:
        yield _result("axial force", _number(force[rows[0]], force, "kN"), Rod.axial_force)
    else:
        for title, pick, seen in (("tension", np.argmax, force > 0.0), ("compression", np.argmin, force < 0.0)):
            row = rows[pick(force[rows])]
            text = f"{_number(force[row], force, 'kN')} ({names[row]})" if seen[row] else "none"
            yield _result(f"largest {title}", text, Rod.axial_force)
    yield from _utilisation(model, rows)
    if len(rows) == 1:
        (row,) = rows
        yield _result("strain", _number(1000.0 * rods.strain[row], 1000.0 * rods.strain, "‰"), Rod.strain)
        if not math.isnan(rods.area[row]):
            stress = 1e-3 * rods.axial_force / np.where(np.isnan(rods.area), np.inf, rods.area)
            text = _number(stress[row], stress, "MPa")
            yield Result(
                SECTION, "stress", text, "Axial force per area of the cross-section; tension positive."
            )
        yield _result("length", _number(rods.length[row], rods.length, "m"), Rod.length)
        if rods.plastic_strain[row]:
            plastic = 1000.0 * rods.plastic_strain
            yield _result("plastic strain", _number(plastic[row], plastic, "‰"), Rod.plastic_strain)


def _utilisation(model: Model, rows: NDArray[np.intp]) -> Iterator[Result]:
    """The share of its strength that a rod bears; of several the largest."""
    used = utilisation(model)[rows]
    if np.isfinite(used).any():
        most = int(np.nanargmax(used))
        whose = f" ({model.rods.column('name')[rows[most]]})" if len(rows) > 1 else ""
        title = "largest utilisation" if len(rows) > 1 else "utilisation"
        text = f"{written.share(used[most])}{whose}"
        yield Result(SECTION, title, text, "Axial force, as a share of the strength in its direction.")


def utilisation(model: Model) -> NDArray[np.float64]:
    """|axial force| / strength in its direction, of every rod (m,); NaN where that is unlimited."""
    rods = model.rods
    limit = np.where(rods.axial_force < 0.0, rods.compression_limit, rods.tension_limit)
    share: NDArray[np.float64] = np.where(np.isfinite(limit), np.abs(rods.axial_force) / limit, np.nan)
    return share


# --- particles ----------------------------------------------------------------------------------------


def _of_particles(model: Model, rows: NDArray[np.intp]) -> Iterator[Result]:
    particles, one = model.particles, len(rows) == 1
    moved = 1000.0 * particles.displacement
    if one:
        (row,) = rows
        yield _vector("displacement", moved[row], moved, "mm", Particle.displacement)
        held = particles.fixed[row]
        if held.any():
            reaction = [r if h else math.nan for r, h in zip(particles.reaction[row], held, strict=True)]
            yield _vector("reaction", reaction, particles.reaction, "kN", Particle.reaction)
        force = particles.applied_force
        yield _vector("external force", force[row], force, "kN", Particle.applied_force)
        speed = np.hypot(*particles.velocity.T)
        yield _result("speed", _number(speed[row], speed, "m/s"), Particle.velocity)
        return
    distance = np.hypot(*moved.T)
    most = rows[np.argmax(distance[rows])]
    text = f"{_number(distance[most], distance, 'mm')} ({particles.column('name')[most]})"
    yield _result("largest displacement", text, Particle.displacement)
    if particles.fixed[rows].any():
        total = particles.reaction[rows].sum(axis=0)
        yield _vector("sum of reactions", total, particles.reaction, "kN", Particle.reaction)


# --- loads, and elements of mods -----------------------------------------------------------------------


def _of_loads(model: Model, particle: int) -> Iterator[Result]:
    """What the loads on a particle are now, of those that vary beside their force at factor 1."""
    for row in np.flatnonzero(model.loads.on == particle).tolist():
        load = model.loads[row]
        text = f"{written.vector(load.force)} kN"
        if load.history["kind"] != CONSTANT["kind"]:
            now = factor_at(load.history, model.clock.time) * model.loads.force[row]
            text = f"{written.vector(now, written.DIGITS)} of {text}"
        yield _result(model.describe(load), text, Load.force)


def _of_others(model: Model, handle: Handle) -> Iterator[Result]:
    """The numbers that a person gave an element of a mod's kind."""
    table = model.tables[handle.table]
    for field in table.fields_in(Role.DOCUMENT):
        value = getattr(handle, field.name)
        unit, factor = field.shown
        if field.dtype is float and value is not None:
            parts = np.multiply(value, factor)
            text = written.vector(parts) if field.shape else written.given(float(parts))
            yield _result(field.title, f"{text} {unit}".rstrip(), field)


# --- as text ------------------------------------------------------------------------------------------


def _result(title: str, text: str, field: Field[Any]) -> Result:
    return Result(SECTION, title, text, field.doc)


def _vector(title: str, values: Sequence[float], column: Any, unit: str, field: Field[Any]) -> Result:
    """Both components; NaN: there is none."""
    parts = [
        f"{axis} {_number(value, column)}"
        for axis, value in zip(_AXES, values, strict=True)
        if not math.isnan(value)
    ]
    return _result(title, f"{'   '.join(parts)} {unit}" if parts else "—", field)


def _number(value: float, column: Any, unit: str = "") -> str:
    """A value with its unit; 0 where it is nothing beside the largest in the model."""
    largest = np.abs(column).max(initial=0.0)
    nothing = max(written.ROUNDING * largest, RESIDUAL)
    return f"{written.number(float(value), nothing=nothing)} {unit}".rstrip()
