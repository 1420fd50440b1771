"""Relaxing to the next stable equilibrium at constant load, as a strongly damped structure would.

The motion W u' = force − internal force, W the rods' stiffness at each particle, is integrated by implicit Euler
steps. Each step minimises the energy plus a penalty on moving, so that no step gains energy or leaps over an
equilibrium, and rods yield in their order. Newton's method takes the last steps.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from pinjoint.components.arrays import Array, Flags
from pinjoint.systems.statics.equations import Structure, largest
from pinjoint.systems.statics.factor import is_stable, regular, softest
from pinjoint.systems.statics.follow import LARGEST_MOVE, NEWTON_ITERATIONS, SMALLEST_SHARE, Path, Point

STEPS = 4000  # at most
STALLED = 50  # steps that together go less far than one may: it is caught where its rods turn over
_AIMED = 0.7  # of the longest step
_STEP_CONVERGED = 1e-2  # of the force at its start; smaller: slower, and the same equilibrium in the end
_LARGEST_PENALTY = 1e9
NUDGE = 1e-3  # of a rod's length: how far to push off an unstable equilibrium
BALANCED = 1e-9  # of the largest force: what is left over in an equilibrium, be it unstable
LARGEST_PLASTIC_STRAIN = 0.1  # gained on the way; what is beyond is no result: structural metal tears before
# Rad: where what yields is as long as it is deep, its edges strain by half of that.
LARGEST_PLASTIC_ROTATION = 0.25
RUNAWAY = 100.0  # times the structure's extent: a displacement without end
_ROUND_AND_ROUND = 30.0  # rad: a rotation without end


def relax(path: Path, start: Point, nudge: Array | None = None, steps: int = STEPS) -> tuple[Point, str]:
    """Let a structure move under the load at start.t until it rests; nudge: the direction to start in.

    Returns the point where it ended, and "equilibrium", "strained apart", "ran away" or "gave up".
    """
    structure, point = path.structure, start
    if nudge is not None:
        point = _nudged(path, point, nudge)
    penalty, before = 0.0, point
    for step in range(steps):
        if step % STALLED == STALLED - 1:
            if _travel(structure, before, point.displacement) < 1.0:
                break
            before = point
        residual = structure.gather(path.load(point.t) - structure.internal(point.response))
        if is_stable(structure, point.response):
            rested = path.correct(point, point.displacement, point.t, None)
            if rested is not None and is_stable(structure, rested.response):
                return rested, "equilibrium"
        elif structure.greatest(residual) <= BALANCED * path.largest_force(point.response):
            point = _nudged(path, point, softest(structure, point.response)[1])
            continue
        if penalty == 0.0:
            pace = structure.move(residual / structure.weight, point.response)
            penalty = max(pace, 1e-9) / LARGEST_MOVE
        longest = max(1.0, _travel(structure, start, point.displacement)) if structure.first_order else 1.0
        crept = creep(path, point, residual, penalty, partial(_travel, structure, point, longest=longest))
        if crept is None:
            break
        point, penalty = crept
        folded = largest(structure.folded(point.response)) if structure.first_order else 0.0
        if torn(point.plastic_strain - start.plastic_strain).any() or folded > LARGEST_PLASTIC_STRAIN:
            return point, "strained apart"
        if has_run_away(structure, point.displacement, start.displacement):
            return point, "ran away"
    return point, "gave up"


def torn(gained: Array) -> Flags:
    """Of all that can yield, what has by more than any metal bears, by the plastic strain gained; of the same shape."""
    if gained.ndim == 1:
        return np.abs(gained) > LARGEST_PLASTIC_STRAIN
    most = np.array([LARGEST_PLASTIC_STRAIN, LARGEST_PLASTIC_ROTATION, LARGEST_PLASTIC_ROTATION])
    return np.abs(gained) > most


def has_run_away(structure: Structure, displacement: Array, start: Array) -> bool:
    """True if a motion to these displacements has no end, be it that it goes far or round and round."""
    moved = displacement - start
    return largest(moved[:, :2]) > RUNAWAY * structure.extent or largest(moved[:, 2:]) > _ROUND_AND_ROUND


def _travel(structure: Structure, point: Point, displacement: Array, longest: float = 1.0) -> float:
    """The largest change of a rod from a point to these displacements, as a share of the largest in a step.

    longest: times LARGEST_MOVE, the largest; in first-order theory ways are straight, and may be the longer the farther.
    """
    change = structure.gather(displacement - point.displacement)
    return structure.move(change, point.response) / (longest * LARGEST_MOVE)


def _nudged(path: Path, point: Point, direction: Array) -> Point:
    """The point moved by NUDGE in a direction, shape (N,)."""
    structure = path.structure
    share = NUDGE / structure.move(direction, point.response)
    return path.after(point, point.displacement + structure.spread(share * direction), point.t)


def creep(
    path: Path, point: Point, residual: Array, penalty: float, travel: Callable[[Array], float]
) -> tuple[Point, float] | None:
    """One implicit Euler step of length 1/penalty, and the penalty for the next; None if no step succeeds.

    The step is shortened until its travel is at most 1: travel(displacement) is the share of the longest step.
    """
    given = penalty
    while penalty < _LARGEST_PENALTY:
        found = implicit_step(path, point, residual, penalty)
        share = math.inf if found is None else travel(found.displacement)
        if found is not None and share <= 1.0:
            least = 0.25 if penalty == given else 1.0
            return found, penalty * max(share / _AIMED, least)
        penalty *= min(share / _AIMED, 3.0)
    return None


def implicit_step(path: Path, point: Point, residual: Array, penalty: float) -> Point | None:
    """The point whose displacements u have force − internal(u) = penalty × W (u − u₀); None if Newton's method fails."""
    structure = path.structure
    wanted = _STEP_CONVERGED * structure.greatest(residual)
    found, moved, step = point, np.zeros(structure.size), np.zeros(structure.size)
    before, share, soft = np.inf, 1.0, point.response.soft
    for _ in range(NEWTON_ITERATIONS):
        if moved.any():
            found = path.after(point, point.displacement + structure.spread(moved), point.t)
        response = found.response
        pull = structure.gather(path.load(point.t) - structure.internal(response))
        pull -= penalty * structure.weight * moved
        size = structure.greatest(pull)
        if size <= max(wanted, structure.round_off(found.displacement, response)):
            return found
        if size >= before and share > SMALLEST_SHARE and not np.array_equal(response.soft, soft):
            share *= 0.5  # other rods are soft than in the tangent of the step: take less of it
            moved = moved - share * step
            continue
        soft = response.soft | response.tied  # joints between ends that all flow are held by the penalty
        factor = regular(structure.tangent(response, soft), structure.weight, penalty)
        if not factor.definite:
            return None
        step = factor.solve(pull)
        before, share, soft = size, 1.0, response.soft
        moved = moved + step
        if not (structure.first_order or structure.move(moved, point.response) <= 4.0 * LARGEST_MOVE):
            return None
    return None
