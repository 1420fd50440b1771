"""Discs that come to rest on one another and on structures: gap ≥ 0, force ≥ 0, no friction.

A contact is a rod that bears compression only, as a cable bears tension only. Discs sink like in a thick fluid,
by implicit Euler steps short enough for all contacts to be seen coming. Contacts are stiff springs on the way; in
the end each is made longer by what its force shortens it, so that the discs just touch (the method of multipliers
[M. R. Hestenes, 1969]).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from components.model import Model
from components.obstacles import Obstacles, obstacles
from systems.broad_phase import near_pairs, nearest
from systems.statics.equations import Array, Flags, Rows, Structure
from systems.statics.factor import regular
from systems.statics.follow import Path, Point
from systems.statics.relax import BALANCED, LARGEST_PENALTY, RUNAWAY, implicit_step

CONTACT_STRAIN = 1e-3  # by which the largest load would shorten a contact that is not corrected
SHORTEST_MOVE = 0.25  # of its radius: how far a disc may move in a step, whatever is near
LONGEST_MOVE = 0.45  # of its distance from the nearest other
TOUCHING = 1e-12  # of the sum of radii: a gap, or an overlap, that is round-off
NEARLY_TOUCHING = 1e-9  # the same, where rounding leaves no less
MOST_LOOKS = 10**6  # at pairs, for how far nodes of structures are from others
AT_END = 1e-12  # of its length: where a side ends
STIFF = 1e-4  # overlap, of the sum of radii, below which contacts need not become stiffer
STIFFER = 10.0
NEAR_REST = 0.1  # of the largest force, unbalanced: an equilibrium is sought
MOST_STEPS = 1000  # until sinking is given up; the pile of 60 stones takes 280
SMALLEST_PENALTY = 1e-9  # of the stiffness: a step without end


@dataclass(frozen=True)
class Discs:
    """Who may touch whom: the discs of all n particles, and after them the straight obstacles, N in all.

    start: original positions, of obstacles their first end; span: the way to the other; (N, 2). movable: free
    directions (N, 2). is_alone: movable and without rods (N,). apart: keys of the pairs that never touch, sorted:
    those that a rod joins, and nodes of structures that overlap another or an obstacle at the beginning.
    """

    start: Array
    obstacles: Obstacles
    radius: Array
    movable: Flags
    is_alone: Flags
    apart: Rows

    @classmethod
    def of(cls, model: Model, displacement: Array) -> Discs:
        """The discs of a model, first at these displacements (n, 2)."""
        particles, others = model.particles, obstacles(model)
        ends, still = np.sort(model.rods.between.astype(np.intp), axis=1), np.zeros(len(others), dtype=bool)
        is_node = np.concatenate([np.zeros(particles.count, dtype=bool), ~still])
        is_node[ends] = True
        fixed = np.concatenate([particles.fixed, np.ones((len(others), 2), dtype=bool)])
        discs = cls(
            start=np.concatenate([particles.position, others.start]),
            obstacles=others,
            radius=np.concatenate([particles.radius, others.radius]),
            movable=~fixed,
            is_alone=~fixed.all(axis=1) & ~is_node,
            apart=np.unique(ends[:, 0] * len(fixed) + ends[:, 1]),
        )
        overlapping = discs.touching(displacement)
        nodes = overlapping[is_node[overlapping].all(axis=1)]
        return replace(discs, apart=np.union1d(discs.apart, discs.keys(nodes)))

    @property
    def smallest(self) -> float:
        """The least radius of a particle (m)."""
        return float(self.radius[: self._count].min(initial=np.inf))

    @property
    def _count(self) -> int:
        return len(self.radius) - len(self.obstacles)

    def beside(self, structure: Structure) -> Structure:
        """A structure of the particles with the obstacles as particles that are held."""
        still = np.zeros((len(self.obstacles), 2))
        return replace(
            structure,
            position=self.start,
            fixed=np.concatenate([structure.fixed, still == 0.0]),
            unknown=np.concatenate([structure.unknown, still != 0.0]),
            body=np.concatenate([structure.body, structure.body.max() + 1 + np.arange(len(still))]),
            own_weight=np.concatenate([structure.own_weight, still[:, 0]]),
        )

    def pulled(self, load: Array) -> Flags:
        """Discs without rods (k,) that a load (k, 2) on the first k moves."""
        pulled: Flags = self.is_alone[: len(load)] & (self.movable[: len(load)] & (load != 0.0)).any(axis=1)
        return pulled

    def keys(self, pairs: Rows) -> Rows:
        """A number (k,) for each of some pairs (k, 2), the lower row first."""
        return pairs[:, 0] * len(self.radius) + pairs[:, 1]

    # --- distances -----------------------------------------------------------------------------------

    def _place(self, displacement: Array) -> Array:
        place = self.start.copy()
        place[: len(displacement)] += displacement
        return place

    def _span(self, rows: Rows) -> Array:
        """The way from the first end to the other (k, 2), 0 of discs."""
        spans = np.concatenate([np.zeros((self._count, 2)), self.obstacles.span])
        return spans[rows]

    def lines(self, displacement: Array, pairs: Rows) -> Array:
        """Vectors (k, 2) from the centres of the first of some pairs to the nearest points of the second."""
        place = self._place(displacement)
        return nearest(place[pairs[:, 1]] - place[pairs[:, 0]], self._span(pairs[:, 1]))

    def gap(self, displacement: Array, pairs: Rows) -> Array:
        """Distances (k,) between the rims of pairs (k, 2), negative where they overlap."""
        gap: Array = np.hypot(*self.lines(displacement, pairs).T) - self.radius[pairs].sum(axis=1)
        return gap

    def touching(self, displacement: Array) -> Rows:
        """Pairs (k, 2) that overlap by more than round-off."""
        pairs = self.near(displacement, np.zeros(len(self.radius)))
        overlapping: Rows = pairs[self.gap(displacement, pairs) < -TOUCHING * self.radius[pairs].sum(axis=1)]
        return overlapping

    def moves(self, displacement: Array) -> Array:
        """How far (m) each may move (N,) before contacts must be looked for again."""
        moves, total = SHORTEST_MOVE * self.radius, len(self.radius)
        free = np.flatnonzero(self.movable.any(axis=1))
        free = free if len(free) * total <= MOST_LOOKS else np.flatnonzero(self.is_alone)
        pairs = np.column_stack([np.repeat(free, total), np.tile(np.arange(total), len(free))])
        gaps = self.gap(displacement, pairs).reshape(len(free), total)
        gaps[np.arange(len(free)), free] = np.inf
        moves[free] = np.maximum(moves[free], LONGEST_MOVE * gaps.min(axis=1, initial=np.inf))
        moves[self._count :] = np.inf
        return moves

    def near(self, displacement: Array, moves: Array) -> Rows:
        """Pairs (k, 2) that touch, or may while each moves that far; obstacles second."""
        count = self._count
        reach = (self.radius + moves)[:count]
        pairs = near_pairs(self._place(displacement)[:count], reach, self.obstacles).astype(np.intp)
        may_touch = self.movable[pairs].any(axis=(1, 2)) & ~np.isin(self.keys(pairs), self.apart)
        return pairs[may_touch]

    # --- contacts as rods ----------------------------------------------------------------------------

    def axes(self, displacement: Array, pairs: Rows) -> tuple[Array, Array, Flags]:
        """How contacts of pairs (k, 2) act: from where to where, if nothing were displaced, and along what.

        Returns the ways (k, 2) from the first centre, when undisplaced, to the second, or of obstacles to the end
        or the side that is nearest now; the axis (k, 2) now; and whether it keeps its direction, as at a side.
        """
        line, span = self.lines(displacement, pairs), self._span(pairs[:, 1])
        way = self.start[pairs[:, 1]] - self.start[pairs[:, 0]]
        place = self._place(displacement)
        along = ((place[pairs[:, 0]] + line - self.start[pairs[:, 1]]) * span).sum(axis=1)
        squared = (span * span).sum(axis=1)
        beyond, side = along >= squared * (1.0 - AT_END), (along > AT_END * squared) & (squared > 0.0)
        way = way + np.where(beyond & (squared > 0.0), 1.0, 0.0)[:, None] * span
        flat = side & ~beyond
        length = np.hypot(*line.T)
        turned = np.column_stack([-span[:, 1], span[:, 0]])
        line = np.where((length > 0.0)[:, None], line, turned)
        return way, line / np.where(length > 0.0, length, np.hypot(*turned.T) + (squared == 0.0))[:, None], flat


class Sinking:
    """A structure and discs on the way to where they rest under a load (n, 2), from a point without contacts.

    pairs (k, 2): which discs are in contact or near it; way, axis and flat say how, as Discs.axes has it.
    lengthened (k,): by which share contacts are longer than the radii of their discs.
    """

    def __init__(self, structure: Structure, discs: Discs, load: Array, start: Point) -> None:
        scale = float(np.abs(load).max(initial=0.0)) or 1.0
        own = scale / CONTACT_STRAIN * discs.is_alone / np.where(discs.is_alone, discs.radius, 1.0)
        self.bare = replace(structure, unknown=discs.movable, own_weight=own)
        self.discs, self.load, self.stiffness = discs, load, scale / CONTACT_STRAIN
        self.pairs, self.lengthened = np.zeros((0, 2), dtype=np.intp), np.zeros(0)
        self.way, self.axis, self.flat = discs.axes(start.displacement, self.pairs)
        self.path = Path(self.bare, load, np.zeros_like(load))
        self.point, self.rods = start, slice(len(structure.ends))

    def run(self) -> str:
        """Move until everything rests.

        Returns "equilibrium", "unstable" (a balance that the least push ends), "falls" or "gave up".
        """
        penalty, worst = 0.0, np.inf
        for _ in range(MOST_STEPS):
            moves = self.discs.moves(self.point.displacement)
            self._look_around(moves)
            rested = self._rested(moves)
            if rested:
                gap = self._gap()
                if gap <= TOUCHING or (gap >= 0.5 * worst and gap <= NEARLY_TOUCHING):
                    return rested
                if gap > STIFF:
                    self.stiffness *= STIFFER
                    self._use(self.lengthened)
                else:
                    worst = min(gap, worst)
                    self._lengthen()
                penalty = 0.0
                continue
            crept = self._creep(moves, penalty)
            if not crept:
                return "gave up"
            penalty = crept
            if np.abs(self.point.displacement).max() > RUNAWAY * self.bare.extent:
                return "falls"
        return "gave up"

    # --- contacts ----------------------------------------------------------------------------------

    def _look_around(self, moves: Array) -> None:
        """Find the pairs that may touch before the next look, and how."""
        near = self.discs.near(self.point.displacement, moves)
        way, axis, flat = self.discs.axes(self.point.displacement, near)
        same = np.array_equal(near, self.pairs) and np.array_equal(flat, self.flat)
        if same and np.array_equal(way, self.way):
            return
        _, old, new = np.intersect1d(self.discs.keys(self.pairs), self.discs.keys(near), return_indices=True)
        lengthened = np.zeros(len(near))
        lengthened[new] = self.lengthened[old]
        self.pairs, self.way, self.axis, self.flat = near, way, axis, flat
        self._use(lengthened)

    def _lengthen(self) -> None:
        """Make contacts longer by what their forces shorten them."""
        self._use(-self.point.response.axial_force[self.rods.stop :] / self.stiffness)

    def _use(self, lengthened: Array) -> None:
        """Go on with contacts so much longer; they do not yield."""
        self.lengthened = lengthened
        plastic_strain = np.zeros(self.rods.stop + len(lengthened))
        plastic_strain[self.rods] = self.point.plastic_strain[self.rods]
        self.path = Path(self._with_contacts(), self.load, np.zeros_like(self.load))
        start = self.path.start(self.point.displacement, plastic_strain)
        self.point = replace(start, dissipated=self.point.dissipated)

    def _with_contacts(self) -> Structure:
        """The structure with a rod that only pushes between the discs of each pair."""
        bare, flat = self.bare, self.flat[:, None]
        reach = self.discs.radius[self.pairs].sum(axis=1)
        distance = np.where(self.flat, (self.way * self.axis).sum(axis=1), np.hypot(*self.way.T))
        unlimited = np.full(len(reach), np.inf)
        return replace(
            bare,
            ends=np.concatenate([bare.ends, self.pairs]),
            difference=np.concatenate([bare.difference, np.where(flat, reach[:, None] * self.axis, self.way)]),
            original_length=np.concatenate([bare.original_length, np.where(self.flat, reach, distance)]),
            rest_length=np.concatenate([bare.rest_length, reach]),
            misfit=np.concatenate([bare.misfit, distance - reach * (1.0 + self.lengthened)]),
            stiffness=np.concatenate([bare.stiffness, np.full(len(reach), self.stiffness)]),
            tension_limit=np.concatenate([bare.tension_limit, unlimited]),
            compression_limit=np.concatenate([bare.compression_limit, unlimited]),
            sense=np.concatenate([bare.sense, np.full(len(reach), -1.0)]),
            flat=np.concatenate([bare.flat, self.flat]),
        )

    def _pressed(self) -> Flags:
        return self.point.response.axial_force[self.rods.stop :] < 0.0

    def _gap(self) -> float:
        """The largest gap or overlap of pressed contacts, as a share of their length."""
        gap = self.point.response.strain[self.rods.stop :] + self.lengthened
        return float(np.abs(gap[self._pressed()]).max(initial=0.0))

    # --- moving --------------------------------------------------------------------------------------

    def _rested(self, moves: Array) -> str:
        """Go to the equilibrium nearby, if there is one: "equilibrium" or "unstable", else ""."""
        borne = np.zeros(len(self.discs.radius), dtype=bool)
        borne[self.pairs[self._pressed()]] = True
        if (self.discs.pulled(self.load) & ~borne).any():
            return ""
        if np.abs(self._residual()).max(initial=0.0) > NEAR_REST * self.path.scale:
            return ""
        found = self.path.correct(self.point, self.point.displacement, 0.0, None)
        if found is None or (_distance(found, self.point) > moves).any():
            return ""
        structure = self.path.structure
        definite = regular(structure.tangent(found.response, found.response.soft), structure.weight).definite
        if not definite and np.abs(self._residual()).max(initial=0.0) > BALANCED * self.path.scale:
            return ""
        self.point = found
        return "equilibrium" if definite else "unstable"

    def _residual(self) -> Array:
        structure = self.path.structure
        return structure.gather(self.load - structure.internal(self.point.response))

    def _creep(self, moves: Array, penalty: float) -> float:
        """One implicit Euler step of length 1/penalty, shortened until no disc moves too far.

        Returns the penalty for the next, 0 if there is no step.
        """
        residual, structure = self._residual(), self.path.structure
        if penalty == 0.0:
            pace = structure.spread(residual / structure.weight)
            penalty = float((np.hypot(*pace.T) / moves).max(initial=0.0))
        penalty = max(penalty, SMALLEST_PENALTY)
        while penalty < LARGEST_PENALTY:
            displacement = implicit_step(self.path, self.point, residual, penalty)
            if displacement is not None:
                moved = self.path.after(self.point, displacement, 0.0)
                share = float((_distance(moved, self.point) / moves).max())
                if share <= 1.0:
                    self.point = moved
                    return penalty / (4.0 if share < 0.25 else 1.0 if share > 0.5 else 2.0)
            penalty *= 3.0
        return 0.0


def _distance(one: Point, other: Point) -> Array:
    distance: Array = np.hypot(*(one.displacement - other.displacement).T)
    return distance
