"""Load–displacement curves: paths of equilibria through limit points, with a growing or falling load.

Critical points on the way, at which the tangent stiffness is singular, are limit points, where the load turns back, and
bifurcations, from which another branch leads away.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Array
from pinjoint.components.language import joined, marked, tr
from pinjoint.components.mistake import WrongValue
from pinjoint.components.model import Model
from pinjoint.components.particle import AXES
from pinjoint.components.theory import EXACT
from pinjoint.components.wording import brief, cut, missing
from pinjoint.systems.statics.equations import SOFT, Structure, normalised, upright
from pinjoint.systems.statics.events import Event
from pinjoint.systems.statics.explain import describe_motion, rod_names
from pinjoint.systems.statics.external import External
from pinjoint.systems.statics.factor import regular, softest
from pinjoint.systems.statics.follow import HALF, Path, Point, Step, Tangent
from pinjoint.systems.statics.loading import hinges_formed
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.state import StaticState

_DETAIL = 0.02  # of a rod's length between points; smaller: a smoother curve
FIRST = 1e-3  # of the same, for the first increment
_LANDED = 1e-13  # of the goal, or of the last increment: near enough
LIMIT_POINT, BIFURCATION, COLLAPSE = marked("limit point"), marked("bifurcation"), marked("collapse")
_SHARPNESS = 1e-10  # of an increment, to which a critical point is found in it
MOST_TRIALS = 200  # to find a goal, or a critical point, within an increment
_ALONG = 0.5  # of the first increment on a branch: one that goes less far along its mode fell back
_SMALLEST_BRANCH = 1e-5  # of a rod's length: the least first increment on a branch


@dataclass(frozen=True)
class Goal:
    """The end of a curve: a load factor, or a displacement of a (particle row, axis), reached for the first time.

    In m; axis 2: a rotation in rad.
    """

    value: float
    displaced: tuple[int, int] | None = None

    @classmethod
    def of(cls, model: Model, factor: float = 1.0, until: str | None = None) -> Goal:
        """The end of a curve: a load factor, a displacement such as "B.y=-2.5" (m), or a rotation "B.rotation=1" (rad).

        Raises ValueError.
        """
        if until is None:
            if not math.isfinite(factor):
                raise WrongValue("The load factor is {factor}; give a finite number.", factor=str(factor))
            return cls(factor)
        place, _, amount = until.partition("=")
        name, _, axis = place.strip().rpartition(".")
        try:
            value = float(amount)
        except ValueError:
            value = math.nan
        if axis not in AXES or not math.isfinite(value):
            raise WrongValue(
                "'{until}' is no displacement; write it like B.y=-2.5, in m, or B.rotation=1, in rad.",
                until=cut(until),
            )
        if name not in model.particles:
            raise ValueError(missing(marked("particles"), name, model.particles.names))
        particle, direction = model.particles[name], AXES.index(axis)
        if axis == "rotation":
            if model.particles.turning[particle.row] == 0.0:
                raise WrongValue(
                    "{particle} cannot turn: it is clamped, or no rod is rigidly joined to it.", particle=name
                )
        elif particle.fixed[direction]:
            raise WrongValue(
                "{particle} is held along {axis}, so it cannot move that way; choose a free direction.",
                particle=name,
                axis=axis,
            )
        return cls(value, (particle.row, direction))


@dataclass(frozen=True, repr=False)
class Curve:
    """Equilibria in order along a path: load_factor (k,), displacement (k, n, 2) in m, axial_force (k, rods) in kN.

    Where members bend: rotation (k, n) in rad, bending_moment (k, rods, 2) in kN·m; else zeros.

    stable: (k,), False where the structure would snap or collapse under a dead load. complete: False if it
    has as many points as were asked for, or its path was lost, before the goal. events: plastic hinges, limit points and
    bifurcations on the way, in order.
    """

    __repr__ = brief

    load_factor: Array
    displacement: Array
    rotation: Array
    axial_force: Array
    bending_moment: Array
    stable: NDArray[np.bool_]
    complete: bool
    events: tuple[Event, ...] = ()

    @classmethod
    def of(
        cls,
        model: Model,
        goal: Goal,
        *,
        points: int = 500,
        detail: float = _DETAIL,
        branch: int = 0,
        theory: str = EXACT,
    ) -> Curve:
        """The curve from the load factor 0 on, by arc-length continuation with yielding; of first order, up to collapse.

        The factor first grows, or falls below 0 if that leads towards the goal. The curve ends exactly at the goal, or
        after so many points, and goes straight on through bifurcations. Accelerations act in full from the start.
        detail: of a rod's length, the largest change between points. branch: number of the bifurcation at which it goes on
        along the mode instead, or, if negative, against it. Raises ValueError without a force or load to
        scale, without an equilibrium at the factor 0, or in first order with inextensible rods.
        """
        if points < 2:
            raise WrongValue("points is {points}; a curve has at least 2.", points=points)
        unloaded = settle(model, (0.0,), theory).final
        if not unloaded.balanced:
            raise ValueError(joined([tr("There is no equilibrium to start from."), unloaded.message]))
        structure, external = Structure.of(model, theory), External.of(model, theory)
        if len(rows := structure.inextensible):
            raise WrongValue(
                "First-order curves take no rod for inextensible, as {rods} should be; let such rods have their EA, or"
                " take exact theory, in which they have it.",
                rods=rod_names(model, rows[:1]),
            )
        loaded = external.scaled + structure.carried(structure.unmoved, structure.unmoved.soft)
        if not structure.gather(loaded).any():
            raise WrongValue(
                "No force or load acts in a free direction; apply one, which the load factor multiplies."
            )
        search = _Search.towards(goal, structure, external, unloaded)
        found, complete, events = search.run(model, points, detail, branch)
        return cls(
            load_factor=search.sign * np.array([point.t for point, _ in found]),
            displacement=np.array([point.displacement[:, :2] for point, _ in found]),
            rotation=np.array([structure.rotation(point.displacement) for point, _ in found]),
            axial_force=np.array([point.response.axial_force for point, _ in found]),
            bending_moment=np.array(
                [structure.end_moments(point.response) * [-1.0, 1.0] for point, _ in found]
            ),
            stable=np.array([tangent.stable for _, tangent in found]),
            complete=complete,
            events=tuple(events),
        )


@dataclass(frozen=True)
class _Critical:
    """A point where the tangent stiffness is singular, and the tangent of the path there.

    kind: "limit point", where the load turns back, "bifurcation", or in first-order theory "collapse".
    """

    path: Path
    kind: str
    point: Point
    tangent: Tangent

    @cached_property
    def motion(self) -> Array:
        """What nothing resists, (n, …), the largest 1."""
        structure = self.path.structure
        # All that yields may leave more than one motion.
        if self.kind == COLLAPSE and self.tangent.factor.exists:
            return normalised(structure.spread(self.tangent.sense * self.tangent.rate))
        _, mode = softest(structure, self.point.response, self.tangent.soft, nearest=True)
        return upright(normalised(structure.spread(mode)))

    def event(self, model: Model, sign: float, number: int) -> Event:
        """It in words; sign: of the load factor along the path, number: that of the bifurcation."""
        factor, motion = sign * self.point.t, self.motion
        said = marked(
            "Bifurcation at the load factor {factor:.6g}: another equilibrium path branches off here, along which"
            " {motion} can move; to follow it to one side or the other, give --branch {number} or --branch -{number}."
        )
        if self.kind == COLLAPSE:
            said = marked("Collapse at the load factor {factor:.6g}: nothing resists moving {motion} any more.")
        elif self.kind == LIMIT_POINT and self.tangent.sense < 0.0:
            said = marked("Limit point at the load factor {factor:.6g}: from here on the load grows again.")
        elif self.kind == LIMIT_POINT:
            said = marked(
                "Limit point at the load factor {factor:.6g}: the structure bears no more load here, and from here on"
                " the load falls; under a constant load the structure would jump."
            )
        moving = describe_motion(model, motion[None])
        return Event(self.kind, factor, tr(said, factor=factor, motion=moving, number=number), motion=motion)

    def branch(self, side: float, first: float) -> Step | None:
        """The first step on the other branch of a bifurcation, along its mode or against it (side 1, −1), if it is found.

        first: the largest change of a rod, of its length. The step is corrected on a plane across the mode.
        """
        path, structure, start = self.path, self.path.structure, self.point
        mode = structure.gather(self.motion)
        mode = mode * (side / structure.move(mode, start.response))
        across = replace(self.tangent, rate=mode * (path.reference / path.size(mode)))
        size = first
        while size > _SMALLEST_BRANCH:
            guess = start.displacement + structure.spread(size * mode)
            found = path.correct(start, guess, start.t, across)
            if found is not None:
                change = structure.gather(found.displacement - start.displacement)
                along = (structure.measure * change) @ (structure.measure * mode) / path.size(mode) ** 2
                if along >= _ALONG * size:
                    return Step(found, path.tangent(found, start, self.tangent), size, size)
            size *= HALF
        return None


@dataclass(frozen=True)
class _Search:
    """A path on which the load factor is sign × t, followed up to a goal."""

    path: Path
    start: Point
    sign: float
    goal: Goal

    @classmethod
    def towards(cls, goal: Goal, structure: Structure, external: External, unloaded: StaticState) -> _Search:
        """The path that begins in the direction of a goal."""
        found = None
        for sign in (1.0, -1.0):
            ways = external.at(0.0), sign * external.scaled, (0.0, sign)
            path = Path(
                structure, *ways, passes_limits=not structure.first_order
            )  # first order: up to collapse
            path.end = math.inf
            place = structure.field(unloaded.displacement, unloaded.rotation)
            start = path.start(place, unloaded.permanent)
            search = cls(path, start, sign, goal)
            rate = structure.spread(path.tangent(start).rate)
            speed = sign if goal.displaced is None else float(rate[goal.displaced])
            if found is None or search.beyond(start) * speed < 0.0:
                found = search
        assert found is not None
        return found

    def beyond(self, point: Point) -> float:
        """Load factor, or displacement, of a point less that of the goal."""
        displaced = self.goal.displaced
        here = self.sign * point.t if displaced is None else float(point.displacement[displaced])
        return here - self.goal.value

    def run(
        self, model: Model, points: int, detail: float, branch: int
    ) -> tuple[list[tuple[Point, Tangent]], bool, list[Event]]:
        """Points and tangents up to the goal; whether it was reached; and what happened on the way."""
        path, point = self.path, self.start
        tangent = path.tangent(point)
        path.reference = path.size(tangent.rate)
        found, increment, side = [(point, tangent)], FIRST, self.beyond(point)
        events: list[Event] = []
        bifurcations = 0
        while side != 0.0 and len(found) < points:
            if path.structure.first_order and self._gives_way(point, tangent):
                events.append(_Critical(path, COLLAPSE, point, tangent).event(model, self.sign, 0))
                return found, False, events
            largest = detail / path.structure.move(tangent.rate, point.response) * path.stretch(tangent)
            step = path.advance(point, tangent, min(largest, increment * largest))
            if step is None:
                return found, False, events
            reached = side * self.beyond(step.point) <= 0.0
            if reached:
                step = self._landed(found[-1], step)
            flows = tangent.flowing, step.point.response.flowing, step.tangent.flowing
            events += hinges_formed(model, path.structure, flows, self.sign * step.point.t)
            for critical in () if path.structure.first_order else self._passed(point, tangent, step):
                bifurcations += critical.kind == BIFURCATION
                events.append(critical.event(model, self.sign, bifurcations))
                if critical.kind == BIFURCATION and bifurcations == abs(branch):
                    found.append((critical.point, critical.tangent))
                    switched = critical.branch(math.copysign(1.0, branch), detail)
                    if switched is None:
                        return found, False, events
                    step, reached = switched, side * self.beyond(switched.point) <= 0.0
            point, tangent = step.point, step.tangent
            found.append((point, tangent))
            if reached:
                return found, True, events
            increment = min(1.0, 2.0 * increment)
        return found, side == 0.0, events

    def _gives_way(self, point: Point, tangent: Tangent) -> bool:
        """True if only round-off resists some motion while so many rods yield or are slack."""
        matrix = self.path.structure.tangent(point.response, tangent.soft)
        return not regular(matrix, self.path.structure.weight, -SOFT).definite

    def _passed(self, point: Point, tangent: Tangent, step: Step) -> Iterator[_Critical]:
        """The critical points that a step from a point passes, a limit point first."""
        path, following, turned = self.path, step.tangent, step.tangent.sense != tangent.sense
        if not np.array_equal(following.soft, tangent.soft):  # a corner of the path, where rods begin to yield
            if turned:
                yield _Critical(path, LIMIT_POINT, step.point, replace(following, sense=tangent.sense))
            return
        if not (following.factor.exists and tangent.factor.exists):
            return
        before = tangent.factor.negative

        def has_turned(there: Point, along: Tangent) -> bool:
            return along.sense != tangent.sense

        def has_branched(there: Point, along: Tangent) -> bool:
            """By the tangent as it is, without what `regular` adds to it."""
            matrix = path.structure.tangent(there.response, along.soft)
            return abs(regular(matrix, path.structure.weight, 0.0).negative - before) > int(turned)

        def last_before(beyond: Callable[[Point, Tangent], bool]) -> tuple[Point, Tangent]:
            """The last point of the step that is not beyond, and its tangent, to rounding."""
            found, size = (point, tangent), 0.5 * step.taken
            for _ in range(MOST_TRIALS):
                if size <= _SHARPNESS * step.taken:
                    break
                trial = path.attempt(*found, size)
                if isinstance(trial, tuple) and not beyond(*trial):
                    found = trial
                else:
                    size *= HALF
            return found

        if turned:
            yield _Critical(path, LIMIT_POINT, *last_before(has_turned))
        if abs(following.factor.negative - before) > int(turned):
            yield _Critical(path, BIFURCATION, *last_before(has_branched))

    def _landed(self, last: tuple[Point, Tangent], step: Step) -> Step:
        """The last increment shortened so that it ends at the goal, by the secant method with bisection."""
        low, high = (0.0, self.beyond(last[0])), (step.taken, self.beyond(step.point))
        for trial in range(MOST_TRIALS):
            if abs(high[1]) <= _LANDED * abs(self.goal.value) or high[0] - low[0] <= _LANDED * step.taken:
                break
            share = low[1] / (low[1] - high[1]) if trial % 3 < 2 else 0.5
            increment = low[0] + share * (high[0] - low[0])
            found = self.path.attempt(*last, increment)
            if not isinstance(found, tuple):
                break
            here = self.beyond(found[0])
            if here * low[1] > 0.0:
                low = increment, here
            else:
                high, step = (increment, here), Step(*found, increment, increment)
        return step
