"""Relaxing to the next stable equilibrium at constant load, as a strongly damped structure would.

The motion is that of W u' = force − internal force, W being the rods' stiffness at each particle, by implicit
Euler steps: each minimises the energy plus a penalty on moving, so that no step climbs, none leaps over an
equilibrium, and rods yield in their order. The last steps are Newton's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from systems.statics.equations import Array
from systems.statics.factor import lowest_mode, regular
from systems.statics.follow import LARGEST_MOVE, SMALLEST_SHARE, Path, Point

STEPS = 4000  # until relaxing is given up
NEWTON_ITERATIONS = 20  # within a step
STEP_CONVERGED = 1e-7  # of the force at its start
LARGEST_PENALTY = 1e9
NUDGE = 1e-3  # of a rod's length: how far to push off an unstable equilibrium
BALANCED = 1e-9  # of the largest force: an equilibrium, if only an unstable one
LARGEST_PLASTIC_STRAIN = 0.2  # on the way; no structural metal follows further
RUNAWAY = 100.0  # times the structure's extent: it will not come back


@dataclass(frozen=True)
class Relaxed:
    """Where relaxing ended; `outcome` is "equilibrium", "strained apart", "ran away" or "gave up"."""

    point: Point
    outcome: str


def relax(path: Path, start: Point, nudge: Array | None = None, steps: int = STEPS) -> Relaxed:
    """Let a structure move under the load at start.t until it rests; nudge: the direction to start in."""
    structure, point = path.structure, start
    if nudge is not None:
        point = _moved(path, point, nudge, NUDGE)
    penalty = 0.0
    for _ in range(steps):
        residual = structure.gather(path.load(point.t) - structure.internal(point.response))
        scale = max(path.scale, float(np.abs(point.response.axial_force).max(initial=0.0)))
        stable = regular(structure.tangent(point.response, point.response.soft), structure.weight).definite
        if stable:
            rested = path.correct(point, point.displacement, point.t, None)
            if rested is not None and _is_stable(path, rested):
                return Relaxed(rested, "equilibrium")
        elif np.abs(residual).max(initial=0.0) <= BALANCED * scale:
            point = _moved(path, point, _way_down(path, point), NUDGE)
            continue
        if penalty == 0.0:
            penalty = (
                max(structure.move(residual / structure.weight, point.response.reach), 1e-9) / LARGEST_MOVE
            )
        crept = _creep(path, point, residual, penalty)
        if crept is None:
            break
        point, penalty = crept
        if np.abs(point.plastic_strain - start.plastic_strain).max(initial=0.0) > LARGEST_PLASTIC_STRAIN:
            return Relaxed(point, "strained apart")
        if np.abs(point.displacement).max() > RUNAWAY * structure.extent:
            return Relaxed(point, "ran away")
    return Relaxed(point, "gave up")


def _is_stable(path: Path, point: Point) -> bool:
    matrix = path.structure.tangent(point.response, point.response.soft)
    return regular(matrix, path.structure.weight).definite


def _way_down(path: Path, point: Point) -> Array:
    matrix = path.structure.tangent(point.response, point.response.soft)
    return lowest_mode(matrix, path.structure.weight)[1]


def _moved(path: Path, point: Point, direction: Array, size: float) -> Point:
    structure = path.structure
    share = size / structure.move(direction, point.response.reach)
    displacement = point.displacement + structure.spread(share * direction)
    return path.after(point, displacement, point.t)


def _creep(path: Path, point: Point, residual: Array, penalty: float) -> tuple[Point, float] | None:
    """One implicit Euler step of length 1/penalty, and the penalty for the next; shorter if it fails."""
    structure, reach = path.structure, point.response.reach
    while penalty < LARGEST_PENALTY:
        displacement = implicit_step(path, point, residual, penalty)
        if displacement is not None:
            move = structure.move(structure.gather(displacement - point.displacement), reach)
            if move <= LARGEST_MOVE:
                shorter = 4.0 if move < 0.25 * LARGEST_MOVE else 1.0 if move > 0.5 * LARGEST_MOVE else 2.0
                return path.after(point, displacement, point.t), penalty / shorter
        penalty *= 3.0
    return None


def implicit_step(path: Path, point: Point, residual: Array, penalty: float) -> Array | None:
    """Displacements u with force − internal(u) = penalty × W (u − u₀), or None if Newton's method fails."""
    structure = path.structure
    wanted = STEP_CONVERGED * float(np.abs(residual).max(initial=0.0))
    moved, step = np.zeros(structure.size), np.zeros(structure.size)
    before, share, soft = np.inf, 1.0, point.response.soft
    for _ in range(NEWTON_ITERATIONS):
        displacement = point.displacement + structure.spread(moved)
        response = structure.respond(displacement, point.plastic_strain)
        pull = structure.gather(path.load(point.t) - structure.internal(response))
        pull -= penalty * structure.weight * moved
        size = float(np.abs(pull).max(initial=0.0))
        if size <= max(wanted, structure.round_off(displacement)):
            return displacement
        if size >= before and share > SMALLEST_SHARE and not np.array_equal(response.soft, soft):
            share *= 0.5  # other rods are soft than the step reckoned with: take less of it
            moved = moved - share * step
            continue
        factor = regular(structure.tangent(response, response.soft), structure.weight, penalty)
        if not factor.definite:
            return None
        step = factor.solve(pull)
        before, share, soft = size, 1.0, response.soft
        moved = moved + step
        if not structure.move(moved, point.response.reach) <= 4.0 * LARGEST_MOVE:
            return None
    return None
