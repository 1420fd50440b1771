"""Results: what a model's columns say now, in tables of rods, particles and sums that window, CSV and sheet show alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pinjoint.components.arrays import Array
from pinjoint.components.bent import AXIAL, MOMENT, SHEAR, deflections, inner_forces
from pinjoint.components.derived import chord_rotation, on_axis, rigid_slopes
from pinjoint.components.field import CM, ENDS, MOVED
from pinjoint.components.language import marked, tr
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle, in_support_axes, supported, turned_supports
from pinjoint.components.rod import (
    Rod,
    bearing,
    bends,
    bends_unchecked,
    has_plastic_moments,
    has_strength,
    nodes,
    reduced_plastic_moment,
    rigid_joints,
    utilisation,
)
from pinjoint.components.spans import extremes
from pinjoint.components.wording import as_said
from pinjoint.components.written import ROUNDING
from pinjoint.tables import Column, Table, Words

_KN, _KNM, _MRAD, _PERCENT = ("kN", 1.0), ("kN·m", 1.0), ("mrad", 1e3), ("%", 100.0)


@dataclass(frozen=True)
class Results:
    """Tables of the state that a model's columns show, in the units on screen.

    rods, particles: a row for each of the model's, in its order, empty where there can be no number, such as the reaction
    of what is not held. sums: of loads and of reactions, which are opposite in equilibrium.
    """

    rods: Table
    particles: Table
    sums: Table

    @classmethod
    def of(cls, model: Model) -> Results:
        """The results of a model; of first order, places and levers are those of the original shape."""
        rods, particles, first_order = model.rods, model.particles, model.first_order
        place = particles.position if first_order else particles.position + particles.displacement
        extent = float(np.ptp(place, axis=0).max()) if len(place) else 0.0
        force = _largest(rods.end_axial_force, rods.shear, particles.reaction, particles.applied_force)
        moment = _largest(rods.bending_moment, particles.reaction_moment)
        force, moment = max(force, moment / (extent or np.inf)), max(moment, force * extent)
        bowed = _between(model)
        sums = _sums(model, place, bowed, force, moment)
        length = rods.original_length if first_order else rods.length
        return cls(_of_rods(model, length, force, moment), _of_particles(model, force, moment), sums)


def envelope_of_rods(model: Model, envelope: Any) -> Table:
    """The most and the least of N, and where rods bend of V and M, in every rod, and in which combination."""
    columns = list[Column]()
    for quantity, title in ((AXIAL, "N"), *(((SHEAR, "V"), (MOMENT, "M")) if bends(model) else ())):
        bounds = [envelope.extremes(quantity, row) for row in range(model.rods.count)]
        values = np.array([[one.value for one in both] for both in bounds]).reshape(-1, 2).T
        names = [[one.combination for one in both] for both in zip(*bounds, strict=True)]
        columns += _governed(title, title, _KNM if quantity == MOMENT else _KN, values, names)
    return Table(tr("rod"), [as_said(Rod.noun, name) for name in model.rods.names], columns)


def envelope_of_reactions(model: Model, envelope: Any) -> Table:
    """The most and the least of each reaction, and in which combination."""
    bounds, columns, held = envelope.reaction, list[Column](), supported(model)
    values = np.where(held & (rigid_joints(model)[:, None] | [True, True, False]), bounds.values, np.nan)
    for axis, (title, unit) in enumerate(
        ((tr("reaction x"), _KN), (tr("reaction y"), _KN), (tr("moment"), _KNM))
    ):
        if not np.isnan(values[..., axis]).all():
            names = [
                [envelope.named(number) for number in side] for side in bounds.governing[..., axis].tolist()
            ]
            columns += _governed(f"reaction_{axis}", title, unit, values[..., axis], names)
    return Table(tr("particle"), [as_said(Particle.noun, name) for name in model.particles.names], columns)


def _governed(
    key: str, title: str, unit: tuple[str, float], values: Array, names: Sequence[Sequence[str]]
) -> list[Column]:
    """Columns of the most and the least, (2, n), each followed by that of the combinations which govern."""
    found, size = list[Column](), _largest(values)
    for side, end in ((1, marked("max")), (0, marked("min"))):
        known = [
            name * (value == value) for name, value in zip(names[side], values[side].tolist(), strict=True)
        ]
        found.append(_column(f"{key}_{end}", f"{title} {tr(end)}", unit, values[side], size))
        found.append(Words(tr("in"), known, key=f"{key}_{end}_in"))
    return found


def _of_rods(model: Model, length: Array, force: float, moment: float) -> Table:
    """N and utilisation of trusses; where rods bend, N, V and M at both ends, and the extremes between them."""
    rods, columns = model.rods, []
    if bends(model) or bearing(model).any():
        stiff = np.where(rods.bending_stiffness > 0.0, 1.0, np.nan)[:, None]  # bars have neither V nor M
        borne = np.where(bearing(model), 1.0, stiff[:, 0])[:, None]
        every = np.arange(rods.count)
        moments, places = extremes(inner_forces(model, every, MOMENT).stretches)
        moments, places = borne * moments, places * length[:, None]
        places[~(np.abs(moments) > ROUNDING * moment)] = np.nan
        bows = stiff[:, 0] * np.abs(extremes(deflections(model, every).stretches)[0]).max(axis=1, initial=0.0)
        columns += _parts("end_axial_force", "N", ENDS, _KN, rods.end_axial_force, force)
        columns += _parts("shear", "V", ENDS, _KN, borne * rods.shear, force)
        columns += _parts("bending_moment", "M", ENDS, _KNM, stiff * rods.bending_moment, moment)
        for side, key, title in ((1, "largest_moment", tr("M max")), (0, "least_moment", tr("M min"))):
            columns.append(_column(key, title, _KNM, moments[:, side], moment))
            columns.append(_column(f"{key}_at", tr("at x"), CM, places[:, side]))
        columns.append(_column("deflection", tr("deflection"), MOVED, bows))
        if has_plastic_moments(model):
            columns += _parts("plastic_rotation", "θ_p", ENDS, _MRAD, rods.plastic_rotation, 0.0)
            if has_strength(model):
                title = tr("M_p reduced by N")
                columns.append(_column("reduced_plastic_moment", title, _KNM, reduced_plastic_moment(model)))
    else:
        columns.append(_column("axial_force", "N", _KN, rods.axial_force, force))
    if has_strength(model):
        title = tr("axial utilisation") if bends_unchecked(model).any() else tr("utilisation")
        columns.append(_column("utilisation", title, _PERCENT, utilisation(model)))
    return Table(tr("rod"), [as_said(Rod.noun, name) for name in rods.names], columns)


def _of_particles(model: Model, force: float, moment: float) -> Table:
    """Displacements and reactions; where rods bend, rotations and moments of clamps, too."""
    particles, turns, held = model.particles, rigid_joints(model), supported(model)
    slanted = turned_supports(model)
    either = held[:, :2] | slanted[:, None]
    moved, reaction = particles.displacement, np.where(either, particles.reaction, np.nan)
    columns = _parts("displacement", tr("displacement"), "xy", MOVED, moved, _largest(moved))
    if turns.any():
        rotation = np.where(turns, particles.rotation, np.nan)
        columns.append(_column("rotation", tr("rotation"), _MRAD, rotation))
    columns += _parts("reaction", tr("reaction"), "xy", _KN, reaction, force)
    if slanted.any():
        along = np.where(held[:, :2] & slanted[:, None], in_support_axes(model, particles.reaction), np.nan)
        columns += _parts("turned_reaction", tr("along its axes"), "xy", _KN, along, force)
    if turns.any():
        clamped = np.where(turns & held[:, 2], particles.reaction_moment, np.nan)
        columns.append(_column("reaction_moment", tr("moment"), _KNM, clamped, moment))
    return Table(tr("particle"), [as_said(Particle.noun, name) for name in particles.names], columns)


def _sums(model: Model, place: Array, bowed: float, force: float, moment: float) -> Table:
    """Sums of the loads and of the reactions of joints, and of their moments about the first that is held.

    bowed: what the moment of the loads is more, by couples between ends and since forces act on bent axes.
    """
    particles, used, turns = model.particles, nodes(model), rigid_joints(model)
    held = np.flatnonzero(used & supported(model)[:, :2].any(axis=1))
    first = int(held[0]) if len(held) else 0
    about = as_said(Particle.noun, particles.names[first]) if particles.count else ""
    rows = []
    for forces, moments, more in (
        (particles.applied_force, particles.applied_moment, bowed),
        (particles.reaction, particles.reaction_moment, 0.0),
    ):
        (x, y), (across, up) = (place - place[first : first + 1]).T, forces.T
        turning = x * up - y * across + np.where(turns, moments, 0.0)
        rows.append(np.column_stack([forces, turning])[used].sum(axis=0) + np.array([0.0, 0.0, more]))
    x, y, turning = np.array(rows).T
    columns = [
        _column("force_x", tr("force x"), _KN, x, force, summed=True),
        _column("force_y", tr("force y"), _KN, y, force, summed=True),
        _column("moment", tr("moment about {particle}", particle=about), _KNM, turning, moment, summed=True),
    ]
    return Table(tr("sum"), [tr("loads"), tr("reactions")], columns)


def _between(model: Model) -> float:
    """The moment of what acts between ends about chords: of couples, and of forces, from which bent axes are away (kN·m)."""
    rods, rotation = model.rods, model.particles.rotation
    couples = model.share * float(rods.span_load[:, 6].sum())
    if model.first_order:
        return couples
    first, second = rods.between.astype(np.intp).T
    chord = rods.difference + model.particles.displacement[second] - model.particles.displacement[first]
    slopes = rigid_slopes(rods, rotation[rods.between], chord_rotation(model))
    along = on_axis(rods.span_load, chord / np.maximum(rods.length, 1e-300)[:, None])[0]
    return couples - model.share * float((slopes * along).sum())


def _parts(
    key: str, title: str, parts: Sequence[str], shown: tuple[str, float], values: Array, size: float
) -> list[Column]:
    """Columns of both parts of values (n, 2)."""
    return [
        _column(f"{key}_{part}", f"{title} {tr(part)}", shown, column, size)
        for part, column in zip(parts, values.T, strict=True)
    ]


def _column(
    key: str, title: str, shown: tuple[str, float], values: Array, size: float = 0.0, *, summed: bool = False
) -> Column:
    """A column; size: of the largest number of its kind, beside which others are rounding."""
    unit, factor = shown
    least = factor * max(size, _largest(values), 1e-3)  # m, kN, kN·m, rad: if all are smaller, all is rounding
    return Column(title, unit, factor * values, key=key, alike=summed, summed=summed, least=least)


def _largest(*of: Array) -> float:
    return max(float(np.nanmax(np.abs(values), initial=0.0)) for values in of)
