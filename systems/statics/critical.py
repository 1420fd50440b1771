"""Critical points of paths of equilibria: limit points and bifurcations, and the branches that lead away from them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from pinjoint.components.language import marked, tr
from pinjoint.components.model import Model
from pinjoint.systems.statics.equations import Array, normalised, upright
from pinjoint.systems.statics.events import Event
from pinjoint.systems.statics.explain import describe_motion
from pinjoint.systems.statics.factor import nearest_mode, regular
from pinjoint.systems.statics.follow import HALF, Path, Point, Step, Tangent

LIMIT_POINT, BIFURCATION = marked("limit point"), marked("bifurcation")
SHARPNESS = 1e-10  # of an increment, to which a critical point is found in it
MOST_TRIALS = 200
ALONG = 0.5  # of the first increment on a branch: one that goes less far along its mode fell back
SMALLEST_BRANCH = 1e-5  # of a rod's length: the least first increment on a branch


@dataclass(frozen=True)
class Critical:
    """A point where the tangent stiffness is singular. kind: "limit point", where the load turns back, or "bifurcation".

    tangent: of the path there. mode: the motion of the unknowns that nothing resists, (N,), the largest 1.
    """

    kind: str
    point: Point
    tangent: Tangent
    mode: Array

    def event(self, model: Model, path: Path, sign: float, number: int) -> Event:
        """It in words; sign: of the load factor along the path, number: that of the bifurcation."""
        factor, motion = sign * self.point.t, path.structure.spread(self.mode)
        if self.kind == LIMIT_POINT:
            if self.tangent.sense < 0.0:
                message = tr(
                    "Limit point at the load factor {factor:.6g}: from here on the load grows again.",
                    factor=factor,
                )
            else:
                message = tr(
                    "Limit point at the load factor {factor:.6g}: the structure bears no more load here, and from here on"
                    " the load falls; under a constant load the structure would jump.",
                    factor=factor,
                )
        else:
            message = tr(
                "Bifurcation at the load factor {factor:.6g}: another equilibrium path branches off here, along which"
                " {motion} can move; to follow it to one side or the other, give --branch {number} or --branch -{number}.",
                factor=factor,
                motion=describe_motion(model, motion[None]),
                number=number,
            )
        return Event(self.kind, factor, message, motion=motion)


def passed(path: Path, point: Point, tangent: Tangent, step: Step) -> list[Critical]:
    """The critical points that a step from a point passes, a limit point first."""
    following, turned = step.tangent, step.tangent.sense != tangent.sense
    if not np.array_equal(following.soft, tangent.soft):  # a corner of the path, where rods begin to yield
        return [_critical(path, LIMIT_POINT, step.point, following)] if turned else []
    if not (following.factor.exists and tangent.factor.exists):
        return []
    before, found = tangent.factor.negative, []

    def has_branched(there: Point, along: Tangent) -> bool:
        """By the tangent as it is, without what `regular` adds to it."""
        matrix = path.structure.tangent(there.response, along.soft)
        return abs(regular(matrix, path.structure.weight, 0.0).negative - before) > int(turned)

    if turned:
        found.append(_located(path, point, tangent, step, lambda _, along: along.sense != tangent.sense))
    if abs(following.factor.negative - before) > int(turned):
        found.append(_located(path, point, tangent, step, has_branched))
    kinds = [LIMIT_POINT, BIFURCATION] if turned else [BIFURCATION]
    return [_critical(path, kind, *there) for kind, there in zip(kinds, found, strict=False)]


def _located(
    path: Path, point: Point, tangent: Tangent, step: Step, beyond: Callable[[Point, Tangent], bool]
) -> tuple[Point, Tangent]:
    """The last point of a step that is not beyond, and its tangent, to rounding."""
    found, size = (point, tangent), 0.5 * step.taken
    for _ in range(MOST_TRIALS):
        if size <= SHARPNESS * step.taken:
            break
        trial = path.attempt(*found, size)
        if isinstance(trial, tuple) and not beyond(*trial):
            found = trial
        else:
            size *= HALF
    return found


def _critical(path: Path, kind: str, point: Point, tangent: Tangent) -> Critical:
    structure = path.structure
    matrix = structure.tangent(point.response, tangent.soft)
    mode = structure.spread(nearest_mode(matrix, structure.weight))
    return Critical(kind, point, tangent, structure.gather(upright(normalised(mode))))


def branch_off(path: Path, critical: Critical, side: float, first: float) -> Step | None:
    """The first step on the other branch of a bifurcation, along its mode or against it (side 1, −1); None if it is lost.

    first: the largest change of a rod, of its length. The step is corrected on a plane across the mode.
    """
    structure, start = path.structure, critical.point
    mode = critical.mode * (side / structure.move(critical.mode, start.response))
    across = replace(critical.tangent, rate=mode * (path.reference / path.size(mode)))
    size = first
    while size > SMALLEST_BRANCH:
        guess = start.displacement + structure.spread(size * mode)
        found = path.correct(start, guess, start.t, across)
        if found is not None:
            change = structure.gather(found.displacement - start.displacement)
            along = (structure.measure * change) @ (structure.measure * mode) / path.size(mode) ** 2
            if along >= ALONG * size:
                following = path.tangent(found, start, critical.tangent)
                return Step(found, following, size, size)
        size *= HALF
    return None
