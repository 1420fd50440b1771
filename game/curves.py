"""Load–displacement curves: their columns by name, and plots of the load factor against some of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pinjoint.components.field import ENDS, Column
from pinjoint.components.language import listed, marked, tr
from pinjoint.components.mistake import NotFound, WrongValue
from pinjoint.components.model import Model
from pinjoint.components.rod import bends
from pinjoint.components.view import Plot
from pinjoint.components.wording import missing
from pinjoint.systems.statics.path import Curve

UNITS = {"displacement": "m", "rotation": "rad", "axial_force": "kN", "bending_moment": "kN·m"}


def columns(model: Model, curve: Curve) -> dict[str, dict[str, Column]]:
    """By quantity and name, such as "B.y", "B", "AB" and "AB.start"; each with a value for every equilibrium."""
    names, rods = model.particles.names, model.rods.names
    free = np.argwhere(~model.particles.fixed).tolist()
    found = {
        "displacement": {f"{names[row]}.{'xy'[axis]}": curve.displacement[:, row, axis] for row, axis in free},
        "axial_force": dict(zip(rods, curve.axial_force.T, strict=True)),
    }
    if bends(model):
        turns = np.flatnonzero(model.particles.turning > 0.0).tolist()
        rigid = np.argwhere(model.rods.turning_shares > 0.0).tolist()
        found["rotation"] = {names[row]: curve.rotation[:, row] for row in turns}
        found["bending_moment"] = {
            f"{rods[row]}.{ENDS[end]}": curve.bending_moment[:, row, end] for row, end in rigid
        }
    return found


def called(quantity: str, name: str) -> str:
    """What a person calls a column: the rotation of B is "B.rotation"."""
    return f"{name}.rotation" if quantity == "rotation" else name


def chosen(model: Model, curve: Curve, names: Sequence[str]) -> list[tuple[str, str, Column]]:
    """Name, unit and values of the columns that are named. Raises NotFound for other names."""
    found = columns(model, curve)
    known = {called(kind, name): (UNITS[kind], x) for kind, of in found.items() for name, x in of.items()}
    if unknown := [name for name in names if name not in known]:
        raise NotFound(missing(marked("quantities"), unknown[0], known))
    return [(name, *known[name]) for name in names]


def plot(model: Model, curve: Curve, names: Sequence[str] = ()) -> Plot:
    """The load factor against what is named, or the displacement that grows most, with dots at limit points, where it turns,
    and where plastic hinges form.

    Raises NotFound for other names, and WrongValue for quantities of several units.
    """
    moved, factor = columns(model, curve)["displacement"], curve.load_factor
    of = chosen(model, curve, names or [max(moved, key=lambda name: float(np.ptp(moved[name])))])
    titles, units, values = zip(*of, strict=True)
    if len({*units}) > 1:
        raise WrongValue("{names} have different units; plot them one by one.", names=listed(titles))
    hinges = [event.load_factor for event in curve.events if event.kind == "hinge"]
    turns = np.union1d(
        np.flatnonzero(np.diff(np.sign(np.diff(factor)))) + 1, np.flatnonzero(np.isin(factor, hinges))
    )
    dots = np.concatenate([np.column_stack([x, factor])[turns] for x in values])
    curves = tuple((title, x, factor) for title, x in zip(titles, values, strict=True))
    return Plot(f"{', '.join(titles)} ({units[0]})", tr("load factor"), curves, dots=dots)
