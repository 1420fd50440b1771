"""Discs that come to rest on one another and on structures: gap ≥ 0, force ≥ 0, no friction.

A contact is a rod in compression only. The discs sink as in a viscous fluid, by implicit Euler steps so short that
the search for contacts misses none. Contacts are stiff springs; at rest each is lengthened by its own shortening
until the discs just touch (the method of multipliers [M. R. Hestenes, 1969]).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pinjoint.components.arrays import Array, Flags, Rows
from pinjoint.components.model import Model
from pinjoint.components.obstacles import Obstacles, obstacles
from pinjoint.systems.broad_phase import near_pairs, nearest
from pinjoint.systems.statics.equations import Structure, largest
from pinjoint.systems.statics.factor import is_stable
from pinjoint.systems.statics.follow import Path, Point
from pinjoint.systems.statics.relax import BALANCED, creep, has_run_away

_CONTACT_STRAIN = 1e-3  # of a contact under the largest load, before it is lengthened
_SHORTEST_MOVE = 0.25  # of its radius: the travel of a disc in a step, whatever is near
_LONGEST_MOVE = 0.45  # of its distance from the nearest other: the same elsewhere
# Of the sum of radii, or of a side: a gap, an overlap or a distance from its end that is round-off.
_TOUCHING = 1e-12
_NEARLY_TOUCHING = 1e-9  # the same, where lengthening no longer lessens it
_MOST_PAIRS = 10**6  # between which distances are measured; above, nodes of structures move _SHORTEST_MOVE
STIFF = 1e-4  # overlap, of the sum of radii, below which contacts need not become stiffer
_STIFFER = 10.0
_NEAR_REST = 0.1  # of the largest force, unbalanced: from here on an equilibrium is sought
MOST_STEPS = 1000  # the pile of 60 stones takes 280
_SMALLEST_PENALTY = 1e-9  # of the stiffness: hardly any damping


@dataclass(frozen=True)
class Discs:
    """The bodies that may touch: the discs of all n particles, then the straight obstacles, N in all.

    start: original positions, of obstacles their first end, (N, 2). span: from there to the other end of obstacles,
    0 for discs, (N, 2). movable: free directions (N, 2). is_alone:
    movable and without rods (N,). apart: keys of the pairs that never touch: those that a rod joins, and
    nodes of structures that overlap another node or an obstacle at the beginning.
    """

    start: Array
    span: Array
    obstacles: Obstacles
    radius: Array
    movable: Flags
    is_alone: Flags
    apart: Rows

    @classmethod
    def of(cls, model: Model, displacement: Array) -> Discs:
        """The discs of a model that begins at these displacements (n, 2)."""
        particles, others = model.particles, obstacles(model)
        ends, still = np.sort(model.rods.between.astype(np.intp), axis=1), np.zeros(len(others), dtype=bool)
        is_node = np.concatenate([np.zeros(particles.count, dtype=bool), ~still])
        is_node[ends] = True
        fixed = np.concatenate([particles.fixed, np.ones((len(others), 2), dtype=bool)])
        discs = cls(
            start=np.concatenate([particles.position, others.start]),
            span=np.concatenate([np.zeros((particles.count, 2)), others.span]),
            obstacles=others,
            radius=np.concatenate([particles.radius, others.radius]),
            movable=~fixed,
            is_alone=~fixed.all(axis=1) & ~is_node,
            apart=ends[:, 0] * len(fixed) + ends[:, 1],
        )
        overlapping = discs.touching(displacement)
        nodes = overlapping[is_node[overlapping].all(axis=1)]
        return replace(discs, apart=np.concatenate([discs.apart, discs.keys(nodes)]))

    @property
    def smallest(self) -> float:
        """The least radius of a particle (m)."""
        return float(self.radius[: self._count].min(initial=np.inf))

    @property
    def _count(self) -> int:
        return len(self.radius) - len(self.obstacles)

    def beside(self, structure: Structure) -> Structure:
        """A structure with the obstacles added as held particles."""
        still = np.zeros((len(self.obstacles), structure.width))
        return replace(
            structure,
            position=self.start,
            fixed=np.concatenate([structure.fixed, still == 0.0]),
            springs=np.concatenate([structure.springs, still]),
            angle=np.concatenate([structure.angle, np.zeros(len(still))]),
            unknown=np.concatenate([structure.unknown, still != 0.0]),
            body=np.concatenate([structure.body, structure.body.max() + 1 + np.arange(len(still))]),
            own_weight=np.concatenate([structure.own_weight, still[:, 0]]),
        )

    def keys(self, pairs: Rows) -> Rows:
        """One number (k,) for each pair (k, 2), the lower row of which is first."""
        return pairs[:, 0] * len(self.radius) + pairs[:, 1]

    # --- distances -----------------------------------------------------------------------------------

    def _place(self, displacement: Array) -> Array:
        place = self.start.copy()
        place[: len(displacement)] += displacement[:, :2]
        return place

    def lines(self, displacement: Array, pairs: Rows) -> Array:
        """Vectors (k, 2) from the centre of the first of each pair to the nearest point of the second."""
        place = self._place(displacement)
        return nearest(place[pairs[:, 1]] - place[pairs[:, 0]], self.span[pairs[:, 1]])

    def gap(self, displacement: Array, pairs: Rows) -> Array:
        """Distances (k,) between the rims of pairs (k, 2), negative where they overlap."""
        return np.hypot(*self.lines(displacement, pairs).T) - self.radius[pairs].sum(axis=1)

    def touching(self, displacement: Array) -> Rows:
        """Pairs (k, 2) that overlap by more than round-off."""
        pairs = self.near(displacement, np.zeros(len(self.radius)))
        return pairs[self.gap(displacement, pairs) < -_TOUCHING * self.radius[pairs].sum(axis=1)]

    def moves(self, displacement: Array) -> Array:
        """The distance (m) that each body may move, (N,), before the next search for contacts."""
        moves, total = _SHORTEST_MOVE * self.radius, len(self.radius)
        free = np.flatnonzero(self.movable.any(axis=1))
        free = free if len(free) * total <= _MOST_PAIRS else np.flatnonzero(self.is_alone)
        pairs = np.column_stack([np.repeat(free, total), np.tile(np.arange(total), len(free))])
        gaps = self.gap(displacement, pairs).reshape(len(free), total)
        gaps[np.arange(len(free)), free] = np.inf
        moves[free] = np.maximum(moves[free], _LONGEST_MOVE * gaps.min(axis=1, initial=np.inf))
        moves[self._count :] = np.inf
        return moves

    def near(self, displacement: Array, moves: Array) -> Rows:
        """Pairs (k, 2) that touch or come to touch while every body moves at most so far; obstacles second."""
        count = self._count
        reach = (self.radius + moves)[:count]
        pairs = near_pairs(self._place(displacement)[:count], reach, self.obstacles).astype(np.intp)
        may_touch = self.movable[pairs].any(axis=(1, 2)) & ~np.isin(self.keys(pairs), self.apart)
        return pairs[may_touch]

    # --- contacts as rods ----------------------------------------------------------------------------

    def axes(self, displacement: Array, pairs: Rows) -> tuple[Array, Array, Flags]:
        """The contacts of pairs (k, 2) as rods: undisplaced vectors (k, 2), present axes (k, 2), flatness (k,).

        A vector leads from the first centre to the second, or to the end or side of the obstacle that is nearest
        now. A flat contact, with a side, keeps its axis.
        """
        line, span = self.lines(displacement, pairs), self.span[pairs[:, 1]]
        way = self.start[pairs[:, 1]] - self.start[pairs[:, 0]]
        place = self._place(displacement)
        along = ((place[pairs[:, 0]] + line - self.start[pairs[:, 1]]) * span).sum(axis=1)
        squared = (span * span).sum(axis=1)
        beyond = along >= squared * (1.0 - _TOUCHING)
        flat = (along > _TOUCHING * squared) & (squared > 0.0) & ~beyond
        way = way + beyond[:, None] * span
        length = np.hypot(*line.T)
        turned = np.column_stack([-span[:, 1], span[:, 0]])
        line = np.where((length > 0.0)[:, None], line, turned)
        return way, line / np.where(length > 0.0, length, np.hypot(*turned.T) + (squared == 0.0))[:, None], flat


class Sinking:
    """The motion of a structure and discs to rest under a load (n, 2), from a point without contacts.

    pairs (k, 2): the discs that are in contact or near it; way, axis, flat: the contacts, as by Discs.axes.
    lengthened (k,): the share by which contacts are longer than the sum of their radii. scale: the largest load (kN).
    """

    def __init__(self, structure: Structure, discs: Discs, load: Array, start: Point, share: float) -> None:
        self.scale = structure.largest(load) or 1.0
        own = self.scale / _CONTACT_STRAIN * discs.is_alone / np.where(discs.is_alone, discs.radius, 1.0)
        unknown = np.column_stack([discs.movable, structure.unknown[:, 2:]])
        self.bare = replace(structure, unknown=unknown, own_weight=own)
        self.discs, self.load, self.stiffness = discs, load, self.scale / _CONTACT_STRAIN
        self.pairs, self.lengthened = np.zeros((0, 2), dtype=np.intp), np.zeros(0)
        self.way, self.axis, self.flat = discs.axes(start.displacement, self.pairs)
        self.shares = share, share
        self.path = Path(self.bare, load, np.zeros_like(load), self.shares)
        self.point, self.rods = start, slice(len(structure.ends))

    def run(self) -> str:
        """Move until everything rests.

        Returns "equilibrium", "unstable" (a balance that the least push ends), "falls" or "gave up".
        """
        penalty, worst, begun = 0.0, np.inf, self.point.displacement
        for _ in range(MOST_STEPS):
            moves = self.discs.moves(self.point.displacement)
            self._look_around(moves)
            rested = self._rested(moves)
            if rested:
                gap = self._gap()
                if gap <= _TOUCHING or (gap >= 0.5 * worst and gap <= _NEARLY_TOUCHING):
                    return rested
                if gap > STIFF:
                    if self.stiffness * _TOUCHING > self.scale:  # what is stiffer is hardly less shortened
                        break
                    self.stiffness *= _STIFFER
                    self._use(self.lengthened)
                else:
                    worst = min(gap, worst)
                    pressing = -self.point.response.axial_force[self.rods.stop :]
                    self._use(pressing / self.stiffness)  # longer by what their forces shorten them
                penalty = 0.0
                continue
            crept = self._creep(moves, penalty)
            if crept is None:
                break
            penalty = crept
            if has_run_away(self.bare, self.point.displacement, begun):
                return "falls"
        return "gave up"

    # --- contacts ----------------------------------------------------------------------------------

    def _look_around(self, moves: Array) -> None:
        """Find the pairs that may touch before the next search."""
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

    def _use(self, lengthened: Array) -> None:
        """Go on with contacts of this lengthening; they do not yield."""
        self.lengthened = lengthened
        of_rods = self.point.plastic_strain[self.rods]
        plastic_strain = np.zeros((self.rods.stop + len(lengthened), *of_rods.shape[1:]))
        plastic_strain[self.rods] = of_rods
        self.path = Path(self._with_contacts(), self.load, np.zeros_like(self.load), self.shares)
        start = self.path.start(self.point.displacement, plastic_strain)
        self.point = replace(start, dissipated=self.point.dissipated)

    def _with_contacts(self) -> Structure:
        """The structure with a rod in compression only between the discs of each pair."""
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
            buckling_load=np.concatenate([bare.buckling_load, unlimited]),
            flat=np.concatenate([bare.flat, self.flat]),
            bending=None if bare.bending is None else bare.bending.with_bars(reach),
        )

    def _pressed(self) -> Flags:
        return self.point.response.axial_force[self.rods.stop :] < 0.0

    def _gap(self) -> float:
        """The largest gap or overlap of pressed contacts, as a share of their length."""
        gap = self.point.response.strain[self.rods.stop :] + self.lengthened
        return largest(gap[self._pressed()])

    # --- moving --------------------------------------------------------------------------------------

    def _rested(self, moves: Array) -> str:
        """Go to the equilibrium nearby, if there is one: "equilibrium" or "unstable", else ""."""
        borne = np.zeros(len(self.discs.radius), dtype=bool)
        borne[self.pairs[self._pressed()]] = True
        pulled = self.discs.is_alone & (self.discs.movable & (self.load[:, :2] != 0.0)).any(axis=1)
        if (pulled & ~borne).any():
            return ""
        structure = self.path.structure
        if structure.greatest(self._residual()) > _NEAR_REST * self.path.scale:
            return ""
        found = self.path.correct(self.point, self.point.displacement, 0.0, None)
        if found is None or (_travel(found.displacement, self.point.displacement) > moves).any():
            return ""
        stable = is_stable(structure, found.response)
        if not stable and structure.greatest(self._residual()) > BALANCED * self.path.scale:
            return ""
        self.point = found
        return "equilibrium" if stable else "unstable"

    def _residual(self) -> Array:
        structure = self.path.structure
        return structure.gather(self.load - structure.internal(self.point.response))

    def _creep(self, moves: Array, penalty: float) -> float | None:
        """One implicit Euler step of length 1/penalty, short enough that no disc moves too far (moves: (N,), m).

        Returns the penalty for the next step, None if no step succeeds.
        """
        residual, structure, start = self._residual(), self.path.structure, self.point.displacement
        if penalty == 0.0:
            pace = structure.spread(residual / structure.weight)
            penalty = float((np.hypot(*pace[:, :2].T) / moves).max(initial=0.0))
        penalty = max(penalty, _SMALLEST_PENALTY)
        crept = creep(
            self.path, self.point, residual, penalty, lambda to: float((_travel(to, start) / moves).max())
        )
        if crept is None:
            return None
        self.point, penalty = crept
        return penalty


def _travel(displacement: Array, start: Array) -> Array:
    """How far each body has moved between two fields of displacements (m), (N,)."""
    return np.hypot(*(displacement - start)[:, :2].T)
