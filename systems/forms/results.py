"""Results: what elements do now, as readings beside the boxes of their properties, and where something is pointed at."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.components import written
from pinjoint.components.bent import AXIAL, MOMENT, SHEAR, Station, farthest
from pinjoint.components.field import CM, MOVED, Field, Role, on_screen
from pinjoint.components.form import Reading
from pinjoint.components.handle import Handle
from pinjoint.components.language import joined, marked, tr, tr_in
from pinjoint.components.load import CONSTANT, Load, SpanLoad, factor_now
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle, in_support_axes, supported, turned_supports
from pinjoint.components.rod import Rod, bearing, bends_unchecked, rigid_joints, utilisation
from pinjoint.components.view import Readout

_SECTION = marked("Results")
RESIDUAL = 1e-12  # of a length (m), force (kN) or speed (m/s): nothing, where all of them are as small
_MRAD = "mrad", 1000.0  # rotations of structures are small
SHORT = 4  # characters of names by which the ends of a rod are called


def results(model: Model, selected: Sequence[Handle], *, known: bool = True) -> Iterator[Reading]:
    """What one element does now, or the extremes of several of a kind.

    Which there are depends on the model only, not on what is known, since boxes stand below them.
    """
    rows, columns = model.rows_of(selected), _Columns(model, known)
    if len(rows["rods"]):
        yield from _of_rods(columns, rows["rods"])
    yield from _largest_displacement(model, rows["rods"], rows["particles"])
    if len(rows["particles"]):
        yield from _of_particles(columns, rows["particles"])


class _Columns:
    """The columns of a model; those that need its forces are not computed before these are known, but NaN."""

    def __init__(self, model: Model, known: bool) -> None:
        self.model, self.known = model, known

    def __call__(self, name: str) -> Any:
        """A computed column, such as "rods.axial_force"."""
        if self.known:
            return self.model.column(name)
        table, field = name.split(".")
        rows = self.model.tables[table]
        return np.full((rows.count, *rows.fields[field].shape), np.nan)


def told(model: Model, handle: Handle, *, forces_known: bool) -> list[tuple[str, str]]:
    """What is said of an element that is pointed at: its results, the loads on it, what a mod's element was given.

    Results only once forces are known.
    """
    found = [*results(model, [handle])] if forces_known else []
    if isinstance(handle, Particle):
        found += _of_loads(model, handle.row)
    elif isinstance(handle, Rod):
        found += _of_span_loads(model, handle)
    elif handle.points:
        found += _of_others(model, handle)
    return [(result.title, result.text) for result in found]


def along(model: Model, rod: Rod, distance: float, envelope: Any = None) -> Readout:
    """The forces in a rod so far from its start (m), and how far it has moved and turned there.

    envelope: of whose forces the least and the most are told instead, and which combinations govern.
    """
    rods, there = model.rods, Station.of(model, rod.row, distance)
    scales = (rods.end_axial_force, "kN"), (rods.shear, "kN"), (rods.largest_moment[:, 0], "kN·m")
    of = dict(zip((AXIAL, SHEAR, MOMENT), scales, strict=True))
    title = f"{model.describe(rod)}, x = {written.length(there.distance, written.DIGITS)}"
    if envelope is not None:
        bounds = [
            (name, envelope.at(name, rod.row, there.distance), envelope.forces[name].values) for name in of
        ]
        found = [
            (f"{name} {side}", joined([_number(value, scale, of[name][1]), f"({governs})" * bool(governs)]))
            for name, both, scale in bounds
            for side, (value, governs) in zip(("min", "max"), both, strict=True)
        ]
        return Readout(title, tuple(found))
    rows = [(name, _number(there.forces[name], *of[name])) for name in of]
    moved, turned = MOVED[1] * there.moved, _MRAD[1] * rods.end_rotation
    column = np.append(MOVED[1] * model.particles.displacement, moved)
    moved_so_far = _vector("", moved.tolist(), column, MOVED[0], Particle.displacement).text
    rows.append((tr("displacement"), moved_so_far))
    rows.append((tr("rotation"), _number(_MRAD[1] * there.rotation, turned, _MRAD[0])))
    return Readout(title, tuple(rows))


# --- rods ---------------------------------------------------------------------------------------------


def _of_rods(columns: _Columns, rows: NDArray[np.intp]) -> Iterator[Reading]:
    rods = columns.model.rods
    force = columns("rods.axial_force")
    if len(rows) == 1:
        yield _result(tr("axial force"), _number(force[rows[0]], force, "kN"), Rod.axial_force)
    else:
        for title, pick, seen in (
            (tr("largest tension"), np.argmax, force > 0.0),
            (tr("largest compression"), np.argmin, force < 0.0),
        ):
            row = rows[pick(force[rows])]
            text = (
                f"{_number(force[row], force, 'kN')} ({rods[int(row)].said})"
                if seen[row]
                else tr_in("force", "none")
            )
            yield _result(title, text, Rod.axial_force)
        moment = np.abs(columns("rods.bending_moment")).max(axis=1)
        if (rods.bending_stiffness[rows] > 0.0).any():
            row = rows[np.argmax(moment[rows])]
            text = f"{_number(moment[row], moment, 'kN·m')} ({rods[int(row)].said})"
            yield _result(tr("largest end moment"), text, Rod.bending_moment)
    yield from _utilisation(columns, rows)
    if len(rows) == 1:
        (row,) = rows
        if rods.bending_stiffness[row]:
            yield _largest_moment(columns, int(row))
        if np.isfinite(limit := rods.moment_limit.min(axis=1))[row]:
            yield _result(
                tr("plastic moment"), _number(limit[row], limit[row : row + 1], "kN·m"), Rod.plastic_moment
            )
        strain, length = 1000.0 * columns("rods.strain"), columns("rods.length") * CM[1]
        yield _result(tr("strain"), _number(strain[row], strain, "‰"), Rod.strain)
        if not math.isnan(rods.area[row]):
            stress = 1e-3 * force / np.where(np.isnan(rods.area), np.inf, rods.area)
            told = marked("Axial force divided by the area of the cross-section; positive in tension.")
            title = tr("axial stress") if rods.bending_stiffness[row] else tr("stress")
            yield Reading(_SECTION, title, _number(stress[row], stress, "MPa"), told)
        yield _result(tr("length"), _number(length[row], length, CM[0]), Rod.length)
        yield from _at_ends(columns, row)
        if np.isfinite(rods.buckling_load[row]):
            load, aside = rods.buckling_load, columns("rods.lateral_deflection") * CM[1]
            yield _result(tr("buckling load"), _number(load[row], load[row : row + 1], "kN"), Rod.buckling_load)
            yield _result(tr("lateral deflection"), _number(aside[row], aside, CM[0]), Rod.lateral_deflection)
        if rods.plastic_strain[row]:
            plastic = 1000.0 * rods.plastic_strain
            yield _result(tr("plastic strain"), _number(plastic[row], plastic, "‰"), Rod.plastic_strain)


def _largest_moment(columns: _Columns, row: int) -> Reading:
    """The largest moment along a rod and where it is."""
    moments = columns("rods.largest_moment")
    value, distance = moments[row]
    text = _number(value, moments[:, 0], "kN·m")
    if not math.isnan(distance):
        text = tr("{moment} at {place}", moment=text, place=written.length(distance, written.DIGITS))
    return _result(tr("largest moment"), text, Rod.largest_moment)


def _at_ends(columns: _Columns, row: np.intp) -> Iterator[Reading]:
    """Forces, moment and rotation at both ends of a rod that bends, or bears a force along it."""
    rods = columns.model.rods
    bends = rods.bending_stiffness[row] > 0.0
    if not (bends or bearing(columns.model)[row]):
        return
    ends = [particle.said for particle in columns.model.rods[int(row)].ends]
    ends = (
        ends if max(map(len, ends)) <= SHORT else [tr_in("end of a rod", "start"), tr_in("end of a rod", "end")]
    )
    for title, field, unit, factor in (
        (tr("N at its ends"), Rod.end_axial_force, "kN", 1.0),
        (tr("V at its ends"), Rod.shear, "kN", 1.0),
        (tr("M at its ends"), Rod.bending_moment, "kN·m", 1.0),
        (tr("rotation of its ends"), Rod.end_rotation, *_MRAD),
        (tr("plastic rotation of its ends"), Rod.plastic_rotation, *_MRAD),
    )[: 2 if not bends else 5 if rods.plastic_rotation[row].any() else 4]:
        values = factor * columns(f"rods.{field.name}")
        yield _vector(title, values[row], values, unit, field, axes=ends)


def _utilisation(columns: _Columns, rows: NDArray[np.intp]) -> Iterator[Reading]:
    """The share of its strength that a rod bears, where it has one; of several the largest."""
    rods = columns.model.rods
    limits = [rods.tension_limit, rods.compression_limit, rods.buckling_load]
    if not np.isfinite(np.min(limits, axis=0)[rows]).any():
        return
    used, text = utilisation(columns.model)[rows] if columns.known else np.full(len(rows), np.nan), "—"
    if not np.isnan(used).all():
        most = int(np.nanargmax(used))
        whose = f" ({columns.model.rods[int(rows[most])].said})" if len(rows) > 1 else ""
        text = f"{written.share(used[most])}{whose}"
    several = len(rows) > 1
    told = marked("The largest stress, |N|/A + |M|/W, divided by the yield stress.")
    title = tr("largest utilisation") if several else tr("utilisation")
    if bends_unchecked(columns.model)[rows].any():
        told = marked(
            "Axial force divided by the strength; for bending, choose a section, whose depth is known."
        )
        title = tr("largest axial utilisation") if several else tr("axial utilisation")
    yield Reading(_SECTION, title, text, told)


# --- particles ----------------------------------------------------------------------------------------


def _of_particles(columns: _Columns, rows: NDArray[np.intp]) -> Iterator[Reading]:
    particles = columns.model.particles
    moved, reactions = MOVED[1] * particles.displacement, columns("particles.reaction")
    if len(rows) == 1:
        (row,) = rows
        yield _vector(tr("displacement"), moved[row], moved, MOVED[0], Particle.displacement)
        turns = rigid_joints(columns.model)[row]
        if turns:
            angle = _MRAD[1] * particles.rotation
            yield _result(tr("rotation"), _number(angle[row], angle, _MRAD[0]), Particle.rotation)
        *held, clamped = supported(columns.model)[row].tolist()
        if any(held):
            if slanted := turned_supports(columns.model)[row]:
                along = in_support_axes(columns.model, reactions)[row]
                yield _vector(tr("along its axes"), along, reactions, "kN", Particle.reaction, held)
            either = [True, True] if slanted else held
            yield _vector(tr("reaction"), reactions[row], reactions, "kN", Particle.reaction, either)
        if turns and clamped:
            moment = columns("particles.reaction_moment")
            yield _result(tr("reaction moment"), _number(moment[row], moment, "kN·m"), Particle.reaction_moment)
        force = columns("particles.applied_force")
        yield _vector(tr("sum of loads"), force[row], force, "kN", Particle.applied_force)
        speed = np.hypot(*particles.velocity.T)
        yield _result(tr("speed"), _number(speed[row], speed, "m/s"), Particle.velocity)
        return
    if supported(columns.model)[rows, :2].any():
        total = reactions[rows].sum(axis=0)
        yield _vector(tr("sum of reactions"), total, reactions, "kN", Particle.reaction)


def _largest_displacement(
    model: Model, rods: NDArray[np.intp], particles: NDArray[np.intp]
) -> Iterator[Reading]:
    """The largest displacement of several particles and of points along rods that bend, and whose it is."""
    rods = rods[model.rods.bending_stiffness[rods] > 0.0]
    if not len(rods) and len(particles) < 2:
        return
    moved = MOVED[1] * np.hypot(*model.particles.displacement.T)
    joints = np.concatenate([particles, model.rods.between[rods].ravel()]).astype(np.intp)
    most = joints[np.argmax(moved[joints])]
    largest, whose = moved[most], model.particles[int(most)].said
    inside = MOVED[1] * farthest(model, rods)[0]
    if len(rods) and inside.max() > largest * (1.0 + written.ROUNDING):
        largest, whose = inside.max(), model.rods[int(rods[np.argmax(inside)])].said
    text = f"{_number(largest, np.append(moved, inside), MOVED[0])} ({whose})"
    yield _result(tr("largest displacement"), text, Particle.displacement)


# --- loads, and elements of mods -----------------------------------------------------------------------


def _of_loads(model: Model, particle: int) -> Iterator[Reading]:
    """What the loads on a particle are now, of those that vary beside their force at factor 1."""
    for row in np.flatnonzero(model.loads.on == particle).tolist():
        load = model.loads[row]
        text = written.stated(load.force, "kN")
        if load.moment:
            text += f", {written.stated(load.moment, 'kN·m')}"
        if load.history["kind"] != CONSTANT["kind"] or factor_now(model, load) != 1.0:
            now = factor_now(model, load) * model.loads.force[row]
            text = tr(
                "{now} of {whole}", now=written.vector(on_screen("kN")[1] * now, written.DIGITS), whole=text
            )
        yield _result(model.describe(load), text, Load.force)


def _of_span_loads(model: Model, rod: Rod) -> Iterator[Reading]:
    """What acts between the ends of a rod, and where."""
    for load in model.span_loads:
        if load.rod == rod.row:
            start, end = (written.length(x) for x in (load.start, load.end or rod.original_length))
            parts = [written.stated(load.force, "kN")] if any(load.force) else []
            parts += [written.stated(load.moment, "kN·m")] if load.moment else []
            parts = [tr("{load} at {place}", load=", ".join(parts), place=start)] if parts else []
            spread = [written.stated(value, "kN/m") for value in (load.start_intensity, load.end_intensity)]
            if any(load.start_intensity) or any(load.end_intensity):
                parts.append(f"{' … '.join(dict.fromkeys(spread))}, {start} … {end}")
            yield _result(model.describe(load), "; ".join(parts), SpanLoad.force)


def _of_others(model: Model, handle: Handle) -> Iterator[Reading]:
    """The numbers that a person gave an element of a mod's kind."""
    table = model.tables[handle.table]
    for field in table.fields_in(Role.DOCUMENT):
        value = getattr(handle, field.name)
        unit, factor = field.on_screen
        if field.dtype is float and value is not None:
            parts = np.multiply(value, factor)
            text = written.vector(parts) if field.shape else written.given(float(parts))
            yield _result(tr(field.title), f"{text} {unit}".rstrip(), field)


# --- as text ------------------------------------------------------------------------------------------


def _result(title: str, text: str, field: Field[Any]) -> Reading:
    return Reading(_SECTION, title, text, field.doc)


def _vector(
    title: str,
    values: Sequence[float],
    column: Any,
    unit: str,
    field: Field[Any],
    shown: Sequence[bool] = (True, True),
    axes: Sequence[str] = "xy",
) -> Reading:
    """The components that are to be shown."""
    parts = [
        f"{axis} {_number(value, column, unit, bare=True)}"
        for axis, value, wanted in zip(axes, values, shown, strict=True)
        if wanted
    ]
    return _result(title, f"{'   '.join(parts)} {on_screen(unit)[0]}", field)


def _number(value: float, column: Any, usual: str, *, bare: bool = False) -> str:
    """A value in a usual unit, with that on screen; 0 where it is nothing beside the largest in the model."""
    if math.isnan(value):
        return "—"
    largest = np.abs(column).max(initial=0.0)
    nothing = max(written.ROUNDING * largest, RESIDUAL)
    return written.amount(float(value), usual, nothing=nothing, bare=bare)
