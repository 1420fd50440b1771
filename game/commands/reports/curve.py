"""`pinjoint curve`: the load–displacement curve of a model, through limit points, as numbers to plot."""

from __future__ import annotations

import csv
import io
import math
from typing import TYPE_CHECKING

import numpy as np

from components.model import Model
from components.spelling import missing

if TYPE_CHECKING:
    from systems.statics.path import Curve, Goal


def goal_of(model: Model, factor: float = 1.0, until: str | None = None) -> Goal:
    """Where a curve shall end: at a load factor, or at a displacement in m such as "B.y=-2.5". Raises ValueError."""
    from systems.statics.path import Goal

    if until is None:
        if not math.isfinite(factor):
            raise ValueError(f"The load factor is {factor}; give a finite number.")
        return Goal(factor)
    place, _, amount = until.partition("=")
    name, _, axis = place.strip().rpartition(".")
    try:
        value = float(amount)
    except ValueError:
        value = np.nan
    if axis not in ("x", "y") or not np.isfinite(value):
        raise ValueError(f"'{until}' is no displacement; write it like B.y=-2.5, in m.")
    if name not in model.particles:
        raise ValueError(missing("particles", name, model.particles.names))
    particle, direction = model.particles[name], "xy".index(axis)
    if particle.fixed[direction]:
        raise ValueError(
            f"{name} is constrained along {axis}, so it cannot move there; choose a free direction."
        )
    return Goal(value, (particle.row, direction))


def why_nothing_follows(model: Model) -> str:
    """Why no equilibrium is next to that without load: what a mechanism moves; "" if it is none."""
    from systems.statics.explain import describe_motion
    from systems.statics.theory import mechanisms

    moving = mechanisms(model)
    if not len(moving):
        return ""
    return (
        f" The structure is a mechanism: {describe_motion(model, moving)} can move. Add rods or supports there."
    )


def as_csv(model: Model, curve: Curve) -> str:
    """One equilibrium a line: load factor, stable (1 or 0), displacements of free directions (m), forces (kN)."""
    free = np.argwhere(~model.particles.fixed).tolist()
    names = model.particles.names
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    moved = [f"{names[row]}.{'xy'[axis]} (m)" for row, axis in free]
    writer.writerow(["load factor", "stable", *moved, *(f"{rod} (kN)" for rod in model.rods.names)])
    for point in range(len(curve.load_factor)):
        displacement = [float(curve.displacement[point, row, axis]) for row, axis in free]
        forces = curve.axial_force[point].tolist()
        writer.writerow([float(curve.load_factor[point]), int(curve.stable[point]), *displacement, *forces])
    return text.getvalue()
