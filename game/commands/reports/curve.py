"""`pinjoint curve`: the load–displacement curve of a model, through limit points, as numbers to plot."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from components.model import Model
from components.spelling import missing
from game.commands.output import Row

if TYPE_CHECKING:
    from systems.statics.path import Curve, Goal


def goal_of(model: Model, factor: float = 1.0, until: str | None = None) -> Goal:
    """The end of a curve: a load factor, or a displacement in m such as "B.y=-2.5". Raises ValueError."""
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
    """Why a curve ends where it begins: the motion of a mechanism in words; "" if the structure is none."""
    from systems.statics.explain import describe_motion
    from systems.statics.theory import mechanisms

    moving = mechanisms(model)
    if not len(moving):
        return ""
    return (
        f" The structure is a mechanism: {describe_motion(model, moving)} can move. Add rods or supports there."
    )


def curve_data(model: Model, curve: Curve) -> dict[str, Any]:
    """A curve as plain data, each list with one entry for every equilibrium.

    displacement (m): by free direction, such as "B.y"; axial_force (kN): by rod. complete: as in `Curve`.
    """
    names = model.particles.names
    free = np.argwhere(~model.particles.fixed).tolist()
    return {
        "complete": curve.complete,
        "load_factor": curve.load_factor,
        "stable": curve.stable,
        "displacement": {f"{names[row]}.{'xy'[axis]}": curve.displacement[:, row, axis] for row, axis in free},
        "axial_force": dict(zip(model.rods.names, curve.axial_force.T, strict=True)),
    }


def curve_rows(found: Mapping[str, Any]) -> Iterator[Row]:
    """The data of a curve as rows, one for every equilibrium, headings first."""
    moved, forces = found["displacement"], found["axial_force"]
    yield "load factor", "stable", *(f"{name} (m)" for name in moved), *(f"{name} (kN)" for name in forces)
    yield from zip(found["load_factor"], found["stable"], *moved.values(), *forces.values(), strict=True)
