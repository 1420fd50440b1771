"""Continuation of a path of equilibria while the load changes, increment by increment, event by event.

A path consists of the equilibria under force + t × change. An increment along the tangent is corrected by
Newton's method on a plane across the tangent, which reduces to constant t where the structure is stiff and passes
limit points where it is not. An increment that misses where the tangent pointed, since it landed on another branch,
is taken back and made smaller.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from pinjoint.components.arrays import ROUND_OFF, Array, Flags
from pinjoint.systems.statics.behind import rest
from pinjoint.systems.statics.complementarity import independent, yielding_set, yielding_sets
from pinjoint.systems.statics.equations import AT_LIMIT, Structure, largest
from pinjoint.systems.statics.factor import NO_STIFFNESS, Factor, lowest, regular
from pinjoint.systems.statics.response import Branches, Piece, Response, of_axes

LARGEST_MOVE = 0.1  # of a rod's length, in one increment; larger: fewer increments, less sure of the branch
MISS = 0.2  # share of an increment by which it may miss where the tangent pointed
TURN = 0.5  # share by which the tangent may change over an increment
NEWTON_ITERATIONS = 25
POLISHING = 4
PATIENCE = 6  # iterations after which a step that does not lessen the residual is shortened
SMALLEST_SHARE = 1 / 8
CONVERGED = 1e-11  # of the largest force: a smaller residual that falls no more is round-off
EXACT_EVENTS = 500  # rods up to which every yield ends an increment; larger: slower, answers as exact
HALF = 0.5  # share of an increment to try after it failed
RESOLUTION = 1 / 8  # of the change of load, to which yields are told apart in larger structures
# Trials after which an increment is halved each time, where round-off hides the end of a piece.
MOST_SHARES = 20
LEAST_SHARE = 0.01  # of an increment to try next where a rod leaves its piece sooner
REVERSAL = 1e-5  # increment to which the end of yielding is located; the error goes with its square
SMALLEST = 1e-12  # increment, of the change of load, below which a path is lost
NARROWINGS = 42  # halvings as closely as which a loss of stability is located
# Halvings between which what is found beyond has to be close by: before round-off counts.
CONFIRMING = 12, 28
STRIDE = 8  # halvings at most in one
FARTHER = 8.0  # times the way between two states on a path: they are on two if they are that far apart
FEW_NARROWINGS = 14  # the same in structures larger than EXACT_EVENTS
ACTIVE_SET_ROUNDS = 12
# Weight of ways beside elongations, in energy, where directions are compared: ways decide below 1e-6.
WAYS = 1e-12
TIED = 1e-8  # of the same where ends yield, of which those at one joint may change their moments by round-off alone
INDIFFERENT = 1e-11  # of the largest rate of elongation: a smaller one is round-off


@dataclass(frozen=True)
class Point:
    """A state on a path: displacement (n, 2), plastic strain (rods,), as of `Response`, t, and the rods' response.

    dissipated: energy (J) that yielding has dissipated so far.
    """

    displacement: Array
    plastic_strain: Array
    t: float
    response: Response
    dissipated: float


@dataclass(frozen=True)
class Tangent:
    """The direction of a path at a point.

    rate: du/dt of the unknowns. flowing, slack: rods that yield, or bear nothing, on the way. sense: +1 if t
    grows along the path, else −1. consistent: False if no set of soft rods agrees with the motion it leads to.
    """

    rate: Array
    flowing: Flags
    slack: Flags
    factor: Factor
    sense: float
    consistent: bool = True

    @property
    def soft(self) -> Flags:
        """Rods whose force does not change on the way."""
        return self.flowing | self.slack

    @property
    def stable(self) -> bool:
        """True if the equilibrium resists every small motion."""
        return self.consistent and self.factor.definite


@dataclass(frozen=True)
class Change:
    """From one point to the next: moved, of the unknowns (N,); deformation, as of `Response`.

    The latter is not what the former makes to first order, which takes the turning of long rods for more.
    """

    moved: Array
    deformation: Array


@dataclass(frozen=True)
class Step:
    """An accepted increment: the point it led to, the tangent there, its size, and the size to try next."""

    point: Point
    tangent: Tangent
    taken: float
    further: float


class Path:
    """The equilibria of a structure under force + t × change (fields of kN), up to t = 1.

    shares: of the distributed forces that act at t = 0 and t = 1.
    passes_limits: a path without end that goes on beyond a loss of stability, with a growing or falling load;
    False: where stability is lost, another set of yielding rods that is stable is sought.
    """

    def __init__(
        self,
        structure: Structure,
        force: Array,
        change: Array,
        shares: tuple[float, float] = (0.0, 0.0),
        *,
        passes_limits: bool = False,
    ) -> None:
        self.passes_limits = passes_limits
        self.end = math.inf if passes_limits else 1.0
        self.structure = structure
        self.force = force
        self.change = change
        self.shares = shares
        self._dead_push = structure.gather(change)
        self.is_large = len(structure.ends) > EXACT_EVENTS
        self.exact_events = structure.gives_way and not self.is_large
        self.scale = max(structure.largest(force), structure.largest(force + change))
        self.largest_move = math.inf if structure.first_order else LARGEST_MOVE
        self.reference = 0.0  # size of du/dt that counts as much as dt does; that of the first tangent

    def load(self, t: float) -> Array:
        """The external force at t."""
        return self.force + t * self.change

    def share(self, t: float) -> float:
        """The share of the distributed forces that acts at t."""
        first, last = self.shares
        return last if t == 1.0 else first + t * (last - first)

    def push(self, response: Response, soft: Flags) -> Array:
        """The change of the load on the unknowns with t; distributed forces act on the bent axes, of which ends may flow.

        soft: what flows or is slack on the way.
        """
        first, last = self.shares
        if first == last or response.bent is None:
            return self._dead_push
        return self._dead_push + (last - first) * self.structure.gather(self.structure.carried(response, soft))

    def respond(
        self, displacement: Array, plastic_strain: Array, t: float, piece: Piece | None = None
    ) -> Response:
        """The rods at these displacements, and under what acts between their ends at t; piece: as of `Structure`."""
        return self.structure.respond(displacement, plastic_strain, self.share(t), piece)

    def start(self, displacement: Array, plastic_strain: Array) -> Point:
        """The point at t = 0 in this state; rods beyond a strength yield at once."""
        rest()
        plastic_strain = self.structure.yielding_parts(plastic_strain)
        moved = displacement.any() or plastic_strain.any() or self.share(0.0)
        response = self.respond(displacement, plastic_strain, 0.0) if moved else self.structure.unmoved
        if response.flowing.any():
            response = self.respond(displacement, response.plastic_strain, 0.0)
        return Point(displacement, response.plastic_strain, 0.0, response, 0.0)

    def after(self, start: Point, displacement: Array, t: float, response: Response | None = None) -> Point:
        """The point with these displacements and t, yielding from an earlier one; response: of the rods, if it is known."""
        response = response or self.respond(displacement, start.plastic_strain, t)
        spent = np.abs(response.force * (response.plastic_strain - start.plastic_strain))
        dissipated = start.dissipated + 1000.0 * float(of_axes(spent) @ self.structure.rest_length)
        if spent.ndim > 1:
            dissipated += 1000.0 * float(spent[:, 1:].sum())
        return Point(displacement, response.plastic_strain, t, response, dissipated)

    def branches(self, response: Response) -> Branches:
        """The pieces of their laws that the rods are on."""
        return self.structure.branches(response, self.largest_force(response))

    def largest_force(self, response: Response) -> float:
        """The largest force (kN) of the load on the path or of a rod."""
        return max(self.scale, self.structure.largest_force(response))

    # --- directions --------------------------------------------------------------------------------

    def tangent(self, point: Point, last: Point | None = None, before: Tangent | None = None) -> Tangent:
        """The direction in which the path goes on from a point.

        last: the point before it; before: the tangent there. Of the rods at the end of a piece of their law, those
        give way whose elongation goes on outward.
        """
        response, branches = point.response, self.branches(point.response)
        onward = None if last is None else self._change(last, point)
        limited = branches.outward != 0.0
        kept = before.soft & limited if before is not None else np.zeros_like(limited)
        found = self._direction(response, branches, kept, onward)
        if self._agrees(response, branches, found) and (found.factor.definite or self.passes_limits):
            return found
        if self.passes_limits and onward is not None:
            return self._onward_tangent(response, branches, kept, onward)
        return self._stable_tangent(response, branches, kept, onward)

    def _change(self, last: Point, point: Point) -> Change:
        """From one point to the next."""
        moved = self.structure.gather(point.displacement - last.displacement)
        return Change(moved, point.response.deformation - last.response.deformation)

    def _onward_tangent(self, response: Response, branches: Branches, guess: Flags, onward: Change) -> Tangent:
        """Of all directions, with a growing or a falling load, the one most like the last."""
        elastic = self._direction(response, branches, np.zeros_like(guess), onward)
        limited, matrix, growth = self._limits(response, branches, elastic)
        best = replace(self._direction(response, branches, guess, onward), consistent=False)
        likeness = -math.inf
        for sense in (1.0, -1.0):
            for chosen in yielding_sets(matrix, sense * elastic.sense * growth, guess[limited]):
                giving = self._giving(limited, matrix, sense * elastic.sense * growth, chosen)
                found = replace(self._direction(response, branches, giving, onward), sense=sense)
                like = sense * self._likeness(response, branches, found.rate, onward)
                if like > likeness and self._agrees(response, branches, found):
                    best, likeness = found, like
        return best

    def _likeness(self, response: Response, branches: Branches, rate: Array, onward: Change) -> float:
        """The cosine of the angle between a direction and the last change, as measured by the forces that they cause in
        elastic rods, and where those hardly change, by the ways of particles.

        The former tells yielding from unloading, which may turn the ways back.
        """
        deformation = self.structure.deformation_rates(rate, response)
        elastic = np.where(branches.slack, 0.0, self.structure.own_stiffness).ravel()
        weight = np.concatenate([elastic, WAYS * self.structure.weight])
        one = np.concatenate([deformation.ravel(), rate])
        other = np.concatenate([onward.deformation.ravel(), onward.moved])
        size = math.sqrt(float(weight @ one**2) * float(weight @ other**2))
        return float(weight @ (one * other)) / size if size > 0.0 else 0.0

    def _stable_tangent(
        self, response: Response, branches: Branches, guess: Flags, onward: Change | None
    ) -> Tangent:
        """The direction in which t grows and the equilibria are stable, if there is one."""
        elastic = self._direction(response, branches, np.zeros_like(guess), onward)
        if not elastic.stable:
            return elastic
        growth = self._growth(response, branches, elastic)
        if not (growth > 0.0).any():
            return elastic
        if not self.exact_events:
            return self._soften_by_trial(response, branches, self._untied(growth > 0.0, growth), onward)
        limited, matrix, excess = self._limits(response, branches, elastic)
        chosen = yielding_set(matrix, excess, guess[limited])
        if chosen is not None:
            found = self._direction(response, branches, self._giving(limited, matrix, excess, chosen), onward)
            if limited.ndim > 1:  # or enough of them, or all at some joint have to
                for these in (independent(matrix, chosen, guess[limited]), chosen):
                    if not self._agrees(response, branches, found):
                        giving = np.zeros_like(limited)
                        giving[limited] = these
                        found = self._direction(response, branches, giving, onward)
            return found
        grows = self._untied(growth > 0.0, np.where(guess, np.inf, growth))
        return replace(self._direction(response, branches, grows, onward), consistent=False)

    def _direction(
        self, response: Response, branches: Branches, giving: Flags, onward: Change | None
    ) -> Tangent:
        """The direction if these of the rods at the end of a piece give way."""
        structure = self.structure
        flowing, slack = giving & ~branches.verge, branches.slack | (giving & branches.verge)
        factor = regular(structure.tangent(response, flowing | slack), structure.weight)
        push = self.push(response, flowing | slack)
        rate = factor.solve(push) if factor.exists else np.zeros(structure.size)
        forward = onward is None or self._goes_on(response, branches, factor, rate, onward)
        return Tangent(rate, flowing, slack, factor, 1.0 if forward else -1.0)

    def _goes_on(
        self, response: Response, branches: Branches, factor: Factor, rate: Array, onward: Change
    ) -> bool:
        """True if a growing load leads onward."""
        if not self.passes_limits:
            return factor.definite or float(rate @ onward.moved) >= 0.0
        like = self._likeness(response, branches, rate, onward)
        return like > 0.0 or (like == 0.0 and factor.definite)

    def _growth(self, response: Response, branches: Branches, tangent: Tangent) -> Array:
        """Rates at which rods at the end of a piece elongate outward along the path."""
        return self._rates(response, tangent) * branches.outward

    def _rates(self, response: Response, tangent: Tangent, dt: float | None = None) -> Array:
        """What `Structure.rates` tells of a direction, per t or in dt."""
        dt, (first, last) = tangent.sense if dt is None else dt, self.shares
        return self.structure.rates(dt * tangent.rate, response, tangent.soft, dt * (last - first))

    def _agrees(self, response: Response, branches: Branches, tangent: Tangent) -> bool:
        """True if exactly those rods at the end of a piece give way that go on outward."""
        rate = self._rates(response, tangent)
        growth = rate * branches.outward
        wrong = (growth > 0.0) != (tangent.soft & ~branches.slack)
        share = INDIFFERENT if rate.ndim == 1 else TIED
        return tangent.factor.exists and not (np.abs(growth[wrong]) > share * largest(rate)).any()

    def _limits(self, response: Response, branches: Branches, elastic: Tangent) -> tuple[Flags, Array, Array]:
        """The rods at the end of a piece, and the matrix and growth of their complementarity problem.

        elastic: the direction if none of them gives way.
        """
        structure = self.structure
        limited: Flags = branches.outward != 0.0
        sign = branches.outward[limited]
        stiffness = structure.own_stiffness[limited]
        growth = stiffness * self._growth(response, branches, elastic)[limited]
        left = np.zeros(limited.shape)
        of_axes(left)[...] = structure.softening * of_axes(branches.verge)
        hardened = stiffness / (1.0 - left[limited])  # of what softens, with what is left of its stiffness
        if limited.ndim > 1:
            efforts, together = structure.efforts(response, limited, elastic.soft)
            held = efforts @ elastic.factor.solve(np.ascontiguousarray(efforts.T))
            more = hardened - (1.0 - TIED) * stiffness
            matrix = sign[:, None] * (together - held) * sign + np.diag(more)
            return limited, 0.5 * (matrix + matrix.T), growth
        pull = structure.elongations(response, np.flatnonzero(limited)) * sign[:, None]
        softening = pull @ elastic.factor.solve(np.ascontiguousarray(pull.T))
        matrix = np.diag(hardened) - stiffness[:, None] * softening * stiffness
        return limited, 0.5 * (matrix + matrix.T), growth

    def _giving(self, limited: Flags, matrix: Array, growth: Array, chosen: Flags) -> Flags:
        """Of all that can yield, these of those at the end of a piece; of ends at one joint not all, if that is enough.

        matrix, growth: of the complementarity problem that `chosen` solves.
        """
        giving, turned = np.zeros_like(limited), np.zeros(limited.shape)
        giving[limited] = chosen
        if giving.ndim > 1:
            turned[giving] = np.linalg.solve(matrix[np.ix_(chosen, chosen)], growth[chosen])
        return self._untied(giving, turned)

    def _untied(self, giving: Flags, turned: Array) -> Flags:
        """What gives way, where ends yield as by `Structure.untied`; turned: by how much."""
        if giving.ndim == 1:
            return giving
        return np.column_stack([giving[:, 0], self.structure.untied(giving[:, 1:], turned[:, 1:])])

    def _soften_by_trial(
        self, response: Response, branches: Branches, soft: Flags, onward: Change | None
    ) -> Tangent:
        """The tangent by fixed-point iteration of the set of rods that give way: large structures, limit points."""
        for _ in range(ACTIVE_SET_ROUNDS):
            found = self._direction(response, branches, soft, onward)
            growth = self._growth(response, branches, found)
            grows = self._untied(growth > 0.0, growth)
            if np.array_equal(grows, soft):
                break
            soft = grows
        return found

    def stretch(self, tangent: Tangent) -> float:
        """Increment along the path for an increment of t."""
        if self.reference == 0.0:
            return 1.0
        return math.hypot(1.0, self.size(tangent.rate) / self.reference)

    def size(self, rate: Array) -> float:
        """The size (m) of a change of the unknowns, rotations counting by their measure."""
        return float(np.linalg.norm(self.structure.measure * rate))

    # --- increments ----------------------------------------------------------------------------------

    def advance(self, point: Point, tangent: Tangent, increment: float) -> Step | None:
        """Go at most one increment on; None if the path is lost.

        An increment ends where a rod begins to yield, slackens or tightens; one that fails is halved.
        """
        far = self.largest_move / max(self.structure.move(tangent.rate, point.response), 1e-300)
        nearest = min(self._until_event(point, tangent), 0.99 * far * self.stretch(tangent))
        trial, failed, shares = min(increment, nearest), False, 0
        while trial > min(SMALLEST, HALF * nearest):
            found = self.attempt(point, tangent, trial)
            if isinstance(found, tuple):
                return Step(*found, trial, increment if failed else 2.0 * increment)
            shares += 1
            trial *= found if shares < MOST_SHARES else min(found, HALF)
            if found == HALF:
                increment, failed = trial, True
        return None

    def attempt(self, point: Point, tangent: Tangent, increment: float) -> tuple[Point, Tangent] | float:
        """One increment; or, if it cannot be accepted, the share of it to try next."""
        structure = self.structure
        dt = tangent.sense * increment / self.stretch(tangent)
        last = point.t + dt >= self.end - 4.0 * ROUND_OFF
        if last:
            dt = self.end - point.t
        predicted = dt * tangent.rate
        guess = point.displacement + structure.spread(predicted)
        found = self._found(point, tangent, guess, point.t + dt, None if last else tangent)
        if found is not None and found.t > self.end:
            found = self._found(point, tangent, found.displacement, self.end, None)
        reached = self._reached(point, tangent, found, dt)
        if isinstance(reached, tuple) and self._turned_back(point, tangent, *reached):
            straight = self._found(point, tangent, guess, point.t + dt, None)
            reached = self._reached(point, tangent, straight, dt)
            if isinstance(reached, tuple) and self._is_near(point, tangent, *reached, predicted):
                return reached
            return HALF
        if found is None or not isinstance(reached, tuple):
            return reached
        change = structure.gather(found.displacement - point.displacement)
        if self._reversed(tangent, found, reached[1], increment):
            return HALF
        fine = self._went_along(point.response, tangent, reached[1], predicted, change)
        switched = not np.array_equal(found.response.soft, tangent.soft)
        coarse = not self.exact_events and switched and abs(dt) <= RESOLUTION
        if structure.ends_yield and abs(dt) <= TIED:  # to the end of a piece that counts as reached
            coarse = True
        return reached if fine or coarse else HALF

    def _found(
        self, point: Point, tangent: Tangent, guess: Array, t: float, across: Tangent | None
    ) -> Point | None:
        """The equilibrium near a guess, as by `correct`; its rods may have left the pieces that the tangent is on."""
        if not self.exact_events:
            return self.correct(point, guess, t, across)
        found = self.correct(point, guess, t, across, tangent)
        if found is None or self._new_ends(point, found).any() or self._is_on(point, tangent, found):
            return found
        return self.correct(point, found.displacement, found.t, across)

    def _reached(
        self, point: Point, tangent: Tangent, found: Point | None, dt: float
    ) -> tuple[Point, Tangent] | float:
        """A point found, with its tangent; or the share of the increment after which a rod left its piece."""
        if found is None:
            return HALF
        share = self._share(point, tangent, found, dt)
        if share < 1.0:
            return share
        return found, self.tangent(found, point, tangent)

    def _turned_back(self, point: Point, tangent: Tangent, found: Point, following: Tangent) -> bool:
        """True if the path turns back though stability is not lost.

        As where rods without force become straight: their bent shapes to either side are one path on which the
        load grows and falls; what goes on from its top is another, on which they are pulled.
        """
        if not (tangent.stable and following.stable and tangent.sense > 0.0):
            return False
        fell = not self.passes_limits and found.t < point.t - 4.0 * ROUND_OFF
        return fell or float(tangent.rate @ following.rate) < 0.0

    def _is_near(
        self, point: Point, tangent: Tangent, found: Point, following: Tangent, predicted: Array
    ) -> bool:
        """True if a stable point is not farther away than was predicted."""
        change = self.structure.gather(found.displacement - point.displacement)
        limit = (1.0 + MISS) * self.structure.move(predicted, point.response)
        return following.stable and self.structure.move(change, point.response) <= limit

    def correct(
        self, start: Point, guess: Array, t: float, across: Tangent | None, piece: Tangent | None = None
    ) -> Point | None:
        """The equilibrium near a guess: at constant t, or on the plane across a tangent; None if not found.

        piece: that in which all rods stay on the pieces of their laws that this tangent is on.
        """
        structure = self.structure
        normal = None
        if across is not None and self.reference > 0.0:
            normal = structure.measure**2 * across.rate / self.reference**2
        displacement, step, begun = guess, np.zeros_like(guess), start.displacement
        if structure.first_order:  # the way to the guess is straight, however long
            begun = guess
        before, dt, share, soft = math.inf, 0.0, 1.0, None
        for iteration in range(NEWTON_ITERATIONS):
            response = (
                self.respond(displacement, start.plastic_strain, t)
                if piece is None
                else self._on_piece(start, piece, displacement, t)
            )
            residual = structure.gather(self.load(t) - structure.internal(response))
            size, scale = structure.greatest(residual), self.largest_force(response)
            if not size <= 1e6 * scale:
                return None
            noise = structure.round_off(displacement, response) + 4.0 * ROUND_OFF * scale
            if size <= noise or (size >= 0.5 * before and size <= CONVERGED * scale + 64.0 * noise):
                return self.after(start, displacement, t, response if piece is None else None)
            switched = soft is not None and not np.array_equal(response.soft, soft)
            if (switched or iteration > PATIENCE) and size >= before and share > SMALLEST_SHARE:
                share *= HALF  # other rods are soft than in the tangent of the step: take less of it
                displacement, t = displacement - share * step, t - share * dt
                continue
            moved = self._newton_step(response, residual, normal)
            if moved is None:
                return None
            step, dt = structure.spread(moved[0]), moved[1]
            before, share, soft = size, 1.0, response.soft
            displacement, t = displacement + step, t + dt
            change = structure.gather(displacement - begun)
            if not structure.move(change, start.response) <= 2.0 * LARGEST_MOVE:
                return None
        return None

    def polished(self, point: Point) -> Point:
        """A point after a few more steps of Newton's method at its t, where members bend.

        Round-off of axial forces, at which `correct` ends, is coarse beside what shears and moments can be.
        """
        structure, before = self.structure, math.inf
        for _ in range(POLISHING if structure.bending is not None else 0):
            residual = structure.gather(self.load(point.t) - structure.internal(point.response))
            moved = self._newton_step(point.response, residual, None)
            if moved is None or not self.size(moved[0]) <= HALF * before:
                break
            found = self.after(point, point.displacement + structure.spread(moved[0]), point.t)
            if not np.array_equal(found.response.soft, point.response.soft):
                break
            point, before = found, self.size(moved[0])
        return point

    def _newton_step(
        self, response: Response, residual: Array, normal: Array | None
    ) -> tuple[Array, float] | None:
        """Changes of the unknowns and of t, the latter such that normal · du + dt = 0."""
        factor = regular(self.structure.tangent(response, response.soft), self.structure.weight)
        if not factor.exists:
            return None
        if normal is None:
            return factor.solve(residual), 0.0
        solved = factor.solve(np.column_stack([residual, self.push(response, response.soft)]))
        dt = -float(normal @ solved[:, 0]) / (float(normal @ solved[:, 1]) + 1.0)
        return solved[:, 0] + dt * solved[:, 1], dt

    def _went_along(
        self, response: Response, tangent: Tangent, following: Tangent, predicted: Array, change: Array
    ) -> bool:
        """True if the increment went where the tangent pointed and the tangent did not turn much."""
        structure = self.structure
        size = structure.move(change, response)
        if size > self.largest_move:
            return False
        if structure.move(change - predicted, response) > MISS * size + 64.0 * ROUND_OFF:
            return False
        if not np.array_equal(following.soft, tangent.soft):
            return True
        before = tangent.sense / self.stretch(tangent) * tangent.rate
        after = following.sense / self.stretch(following) * following.rate
        largest = max(structure.move(before, response), structure.move(after, response))
        return structure.move(after - before, response) <= TURN * largest

    # --- yielding, slackening, tightening ------------------------------------------------------------

    def _until_event(self, point: Point, tangent: Tangent) -> float:
        """Increment to the next end of a piece of a rod's law, judged by the tangent."""
        if not self.exact_events:
            return math.inf
        structure, branches = self.structure, self.branches(point.response)
        rate = self._rates(point.response, tangent)
        growth = rate * structure.own_stiffness
        with np.errstate(divide="ignore", invalid="ignore"):
            up = (branches.high - branches.force) / growth
            down = (branches.low - branches.force) / growth
        wait = np.where(growth > 0.0, up, np.where(growth < 0.0, down, np.inf))
        wait[branches.outward * growth > 0.0] = np.inf
        return float(wait.min(initial=np.inf)) * self.stretch(tangent)

    def _on_piece(self, start: Point, piece: Tangent, displacement: Array, t: float) -> Response:
        """The response as it were if all rods stayed on the pieces of their laws that a tangent at the start is on."""
        branches = self.branches(start.response)
        edge = np.where(branches.outward > 0.0, branches.high, branches.low)
        return self.respond(displacement, start.plastic_strain, t, Piece(piece.flowing, piece.slack, edge))

    def _is_on(self, start: Point, piece: Tangent, found: Point) -> bool:
        """True if the rods at a point are on the pieces of their laws that a tangent at the start is on."""
        response, as_if = found.response, self._on_piece(start, piece, found.displacement, found.t)
        difference = np.abs(response.force - as_if.force)
        return bool((difference <= 4.0 * ROUND_OFF * self.largest_force(response) + response.round_off).all())

    def _new_ends(self, point: Point, found: Point) -> Array:
        """1 or −1 for the rods that have gone beyond the upper or lower end of the piece that they were on, else 0."""
        branches, force = self.branches(point.response), found.response.elastic_force
        above = (force > branches.high) & (branches.outward <= 0.0)
        below = (force < branches.low) & (branches.outward >= 0.0)
        return above.astype(float) - below

    def _share(self, point: Point, tangent: Tangent, found: Point, dt: float) -> float:
        """Share of an increment after which the first rod left its piece; 1 if none did.

        Forces within the increment are quadratic, by their values at both ends and their rates at the start. The
        share ends hardly before the end of the piece, where the rod counts as at its limit.
        """
        ends = self._new_ends(point, found) if self.exact_events else np.zeros(0)
        if not ends.any():
            return 1.0
        structure, branches, new = self.structure, self.branches(point.response), ends != 0.0
        edge, sign = np.where(ends > 0.0, branches.high, branches.low)[new], ends[new]
        force = min(self.largest_force(point.response), self.largest_force(found.response))
        size = np.where(edge == 0.0, force, np.abs(edge))
        near = AT_LIMIT * size + found.response.round_off[new]
        stiffness = structure.own_stiffness[new]
        margin = np.maximum(sign * (edge - branches.force[new]) - 0.5 * near, 0.0)
        linear = sign * stiffness * self._rates(point.response, tangent, dt)[new]
        quadratic = sign * (found.response.elastic_force - branches.force)[new] - linear
        root = np.sqrt(np.maximum(linear**2 + 4.0 * quadratic * margin, 0.0))
        share = np.where(
            linear >= 0.0,
            2.0 * margin / np.maximum(linear + root, np.finfo(float).tiny),
            (root - linear) / (2.0 * np.maximum(quadratic, np.finfo(float).tiny)),
        )
        return min(max(float(share.min()), LEAST_SHARE), 1.0 - AT_LIMIT)

    def _reversed(self, tangent: Tangent, found: Point, following: Tangent, increment: float) -> bool:
        """True if a rod stopped flowing well within the increment; of two in series one may rest at its strength."""
        if not self.exact_events or increment <= REVERSAL:
            return False
        bears = found.response.flowing | self.structure.at_limit(found.response)
        return bool((tangent.flowing & ~(bears & following.flowing)).any())

    # --- loss of stability -----------------------------------------------------------------------------

    def narrow(self, point: Point, tangent: Tangent, beyond: Step) -> tuple[Point, Tangent, Tangent | None]:
        """Where stability is lost on the way to a point beyond: the last stable point, its tangent, the tangent after it.

        The last is None if the states that come nearest are farther apart than the way between them: the unstable one
        lies on another branch, and the path goes on. An increment that fails is made smaller, and says nothing.
        """
        found, following, ahead, before = beyond.point, beyond.tangent, beyond.taken, math.inf
        most = FEW_NARROWINGS if self.is_large else NARROWINGS
        for _ in range(2 * most):
            least, opposed = (lowest(one.factor, self.structure.weight) for one in (tangent, following))
            if least <= NO_STIFFNESS and np.array_equal(tangent.soft, following.soft):
                break
            size = ahead * (HALF if ahead > HALF * before else _share_to_loss(least, opposed))
            tried, before = self.attempt(point, tangent, size), ahead
            while not isinstance(tried, tuple) and size > SMALLEST * ahead:
                size *= min(tried, HALF)
                tried = self.attempt(point, tangent, size)
            if not isinstance(tried, tuple):
                break
            if tried[1].stable:
                (point, tangent), ahead = tried, ahead - size
            else:
                (found, following), ahead = tried, size
            apart, halvings = self.size(self._change(point, found).moved), math.log2(beyond.taken / ahead)
            confirming = CONFIRMING[0] < halvings <= CONFIRMING[1]
            if confirming and apart > FARTHER * ahead * self.reference > 0.0:
                return point, tangent, None
            if halvings >= most:
                break
        return point, tangent, following


def _share_to_loss(least: float, opposed: float) -> float:
    """The share of the way to a point beyond a loss of stability at which to look for it next.

    By the least that is resisted at both ends, as if it changed like a line; near an end as far beyond, so that what is left
    becomes short from both sides.
    """
    share = least / (least - opposed) if least > 0.0 > opposed else HALF
    share = 2.0 * share if share < 0.25 else 2.0 * share - 1.0 if share > 0.75 else share
    return min(max(share, HALF**STRIDE), 1.0 - HALF**STRIDE)
