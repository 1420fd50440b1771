"""Load–displacement curves: the path of equilibria through limit points, the load falling where it must."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from components.model import Model
from systems.statics.equations import Array, Structure
from systems.statics.external import external_forces
from systems.statics.follow import Path
from systems.statics.settle import settle

DETAIL = 0.02  # of a rod's length between points; smaller: a smoother curve
FIRST = 1e-3  # of the same, for the first increment


@dataclass(frozen=True)
class Curve:
    """Equilibria in order along a path. load_factor: (k,). displacement: (k, n, 2) in m, axial_force:
    (k, rods) in kN, stable: (k,), False where the structure would snap or collapse under a dead load.
    complete: False if the path was lost before its end."""

    load_factor: Array
    displacement: Array
    axial_force: Array
    stable: NDArray[np.bool_]
    complete: bool


def load_path(
    model: Model,
    *,
    until_factor: float | None = None,
    until_displacement: tuple[int, int, float] | None = None,
    points: int = 500,
    detail: float = DETAIL,
) -> Curve:
    """The curve from the load factor 0 on, by arc-length continuation with exact geometry and yielding.

    It ends when the load factor first reaches `until_factor`, when `until_displacement` = (particle row,
    axis, displacement in m) is reached from either side, or after so many points. Accelerations act in full
    from the start. It goes straight on through bifurcations. Raises ValueError if nothing is to be scaled,
    or if there is no equilibrium at the factor 0.
    """
    structure, external = Structure.of(model), external_forces(model)
    unloaded = settle(model, (0.0,)).final
    if unloaded.status != "equilibrium":
        raise ValueError(f"There is no equilibrium to start from. {unloaded.message}")
    path = Path(structure, external.at(0.0), external.scaled, passes_limits=True)
    if not path.push.any():
        raise ValueError("No force or load acts on a free direction; apply one that the factor can scale.")
    point = path.start(unloaded.displacement, unloaded.plastic_strain)
    tangent = path.tangent(point)
    path.reference = float(np.linalg.norm(tangent.rate))
    found, increment, complete = [(point, tangent)], FIRST, False
    sign = _side(point.displacement, until_displacement)
    while len(found) < points and not complete:
        largest = detail / structure.move(tangent.rate, point.response.length) * path.stretch(tangent)
        step = path.advance(point, tangent, min(largest, increment * largest))
        if step is None:
            break
        point, tangent = step.point, step.tangent
        increment = min(1.0, 2.0 * increment)
        found.append((point, tangent))
        complete = until_factor is not None and abs(point.t) >= abs(until_factor)
        complete |= until_displacement is not None and _side(point.displacement, until_displacement) != sign
    return Curve(
        load_factor=np.array([p.t for p, _ in found]),
        displacement=np.array([p.displacement for p, _ in found]),
        axial_force=np.array([p.response.axial_force for p, _ in found]),
        stable=np.array([t.stable for _, t in found]),
        complete=complete,
    )


def _side(displacement: Array, goal: tuple[int, int, float] | None) -> bool:
    """Whether a displacement is beyond the one that is to be reached."""
    return goal is not None and bool(displacement[goal[0], goal[1]] > goal[2])
