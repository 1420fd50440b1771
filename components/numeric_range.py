"""Numeric range: numbers that can be stored, but are too large or too small to compute with."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinjoint.components.field import LARGEST, SMALLEST, Column, Field, Role
from pinjoint.components.language import begun, decimals, joined, marked, tr
from pinjoint.components.model import Model
from pinjoint.components.obstacles import obstacles
from pinjoint.components.particle import turned_supports
from pinjoint.components.wording import cut
from pinjoint.components.written import ROUNDING

UNKNOWN_SHARE = 1e-3  # of a radius: how well places must be known for impacts

_TABLES = ("particles", "rods", "loads", "span_loads", "environment", "settings")
# What is checked besides what a person made: state that a person can type; and what follows, from positions that may be
# too near or too far, as E·A and E·I, and from bending stiffnesses.
_OTHERS = (
    *("displacement", "velocity", "rotation", "angular_velocity", "plastic_strain", "plastic_rotation"),
    *("rest_length", "mass", "stiffness", "bending_stiffness", "inertia"),
)


def incomputable(model: Model) -> str:
    """The sentence that names a number too large or too small to compute with; "" if there is none.

    Only what changed since there was none is looked at.
    """
    problem = _out_of_range(model) or _too_far(model) or beyond(model)
    model.sound = model.sound if problem else model.revision
    return problem


def immovable(model: Model) -> str:
    """The sentence that names a support that motion in time does not know; "" if there is none."""
    for row in np.flatnonzero(turned_supports(model))[:1].tolist():
        return tr(
            "{particle}: its support is turned by {angle:.4g}°, which statics knows, and motion does not yet. Find the"
            " equilibrium by statics, or set its support angle to 0.",
            particle=begun(model.describe(model.particles[row])),
            angle=float(np.degrees(model.particles.support_angle[row])),
        )
    return ""


def _out_of_range(model: Model) -> str:
    for name in _TABLES:
        table = model.tables[name]
        for field in table.fields.values():
            if field.dtype is float and (field.role is Role.DOCUMENT or field.name in _OTHERS):
                if field.derived:
                    model.refresh(f"{name}.{field.name}")  # and so its version
                column = table.storage(field.name)
                if table.version(field.name) > model.sound and (extreme := _extreme(field, column)).any():
                    row, *axis = np.argwhere(extreme)[0].tolist()
                    return _sentence(model.describe(table[row]), field, float(column[(row, *axis)]))
    return ""


def _too_far(model: Model) -> str:
    """The sentence that names an obstacle so far away that no particle can be told to touch it; "" if there is none."""
    others = obstacles(model)
    if not (model.settings.collisions and len(others) and model.particles.count):
        return ""
    far = np.maximum(np.abs(others.start), np.abs(others.start + others.span)).max(axis=1)
    least = UNKNOWN_SHARE * float(model.particles.radius.max())
    for row in np.flatnonzero(np.spacing(far) > least)[:1].tolist():
        return tr(
            "The obstacle {name}: one of its ends is {far:g} m from the origin. So far away, places are known to"
            " {spacing:.1g} m only, too coarse for the radii of the particles; place it nearer.",
            name=cut(others.names[row]),
            far=far[row],
            spacing=np.spacing(far[row]),
        )
    return ""


def beyond(model: Model) -> str:
    """The sentence that names a span load that reaches beyond its rod; "" if there is none."""
    loads, rods = model.span_loads, model.rods
    reach, length = np.fmax(loads.start, loads.end), rods.original_length[loads.rod]
    for row in np.flatnonzero(reach > length * (1.0 + ROUNDING))[:1].tolist():
        return tr(
            "{load} reaches {reach:g} m along {rod}, which is only {length:g} m long; let it end there, or move it.",
            load=begun(model.describe(loads[row])),
            rod=model.describe(rods[int(loads.rod[row])]),
            reach=reach[row],
            length=length[row],
        )
    return ""


def _extreme(field: Field[Any], column: Column) -> Column:
    """Which numbers of a column are too large or too small to compute with, in the shape of the column."""
    size = np.abs(column)
    extreme: Column = (size > LARGEST) & np.isfinite(size)
    if field.above == 0.0:
        extreme |= size < SMALLEST
    if field.name in ("inertia", "density"):
        extreme |= (size < SMALLEST) & (size > 0.0)  # 0: it does not turn, it has no weight
    return extreme


def _sentence(element: str, field: Field[float], value: float) -> str:
    def amount(number: float) -> str:
        return joined([decimals(f"{number:g}"), field.unit])

    values = {"element": begun(element), "title": field.named(), "amount": amount(value)}
    if abs(value) < SMALLEST:
        message = marked("{element}: {title} is {amount}, too small to compute with; make it at least {limit}.")
        return tr(message, **values, limit=amount(SMALLEST))
    message = marked("{element}: {title} is {amount}, too large to compute with; make it at most {limit}.")
    return tr(message, **values, limit=amount(LARGEST))
