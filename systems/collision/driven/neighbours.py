"""The neighbour list of driven particles: which pairs may collide soon, and for how long none can."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from components.collision_state import PersistentContacts
from components.field import Role
from components.model import Model
from components.obstacles import obstacles
from components.rod import nodes
from components.snapshot import Snapshot
from systems.broad_phase import Floats, Rows, near_pairs
from systems.collision.columns import PairKind
from systems.collision.driven.compiled import kernels
from systems.collision.system import persistent_contacts
from systems.islands import islands

LISTED_AROUND = 0.5  # of the radius of a particle: the least margin within which others are listed
SLOWEST = 1e-300  # m/s; avoids division by zero: no motion is that slow
NO_PAIRS = np.zeros((0, 2), dtype=np.int64)


def _any_force() -> np.errstate:
    """No warnings of forces of mods and people that are too large to compute with; the check of the model reports them."""
    return np.errstate(over="ignore", invalid="ignore")


class NeighbourList:
    """The pairs of one model's particles that are near each other.

    pairs: rows i < j in ascending order, shape (k, 2), without pairs that a rod joins or that cannot move.
    count: of the particles; loose: of the particles that are no nodes. position, radius, weight, restitution, size: of
    all particles and, after them, of the obstacles. weight: inverse mass in each direction (1/kg), 0 where a particle is
    held. restitution: of impacts with the particle or obstacle. size: the radius, ∞ for obstacles (m): the scale of gaps.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self._revision = -1

    def look_up(self) -> None:
        """Read from the document which particles may collide, if the document changed."""
        revision = self.model.newest(Role.DOCUMENT)
        if self._revision == revision:
            return
        self._revision = revision
        particles, ends = self.model.particles, np.sort(self.model.rods.between.astype(np.int64), axis=1)
        self.obstacles = others = obstacles(self.model)
        self.count = particles.count
        joined = np.sort(ends[:, 0] * (self.count + len(others)) + ends[:, 1])
        self._joined = np.append(joined, -1)  # the sentinel equals no pair that is looked up
        self._node = np.ones(self.count + len(others), dtype=bool)
        self._node[: self.count] = nodes(self.model)
        self.loose = self.count - int(np.count_nonzero(self._node[: self.count]))
        self._moves: NDArray[np.bool_] = self.everywhere(np.any(particles.mobility > 0.0, axis=1))
        self.position = np.concatenate([particles.position, others.start])
        self.radius = np.concatenate([particles.radius, others.radius])
        self.size = np.concatenate([particles.radius, np.full(len(others), np.inf)])
        self.weight: Floats = self.everywhere(np.where(particles.fixed, 0.0, 1.0 / particles.mass[:, None]))
        alike = np.full(self.count, self.model.settings.restitution)
        self.restitution = np.concatenate([alike, others.restitution])
        self.span = self.everywhere(np.zeros((self.count, 2)))
        self.span[self.count :] = others.span
        self._island = islands(self.model)
        self._least: Floats = LISTED_AROUND * particles.radius
        self._margin: Floats = np.full(self.count, -1.0)  # no pair is listed yet
        self._listed: Floats = np.zeros((self.count, 2))

    @property
    def displacement(self) -> Floats:
        """Of the particles, now (m); not a read-only view, for which kernels are not compiled."""
        return self.model.tables["particles"].storage("displacement")

    @property
    def velocity(self) -> Floats:
        """Of the particles, now (m/s)."""
        return self.model.tables["particles"].storage("velocity")

    def everywhere(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values of the particles, followed by zeros for the obstacles, which do not move."""
        if len(self.obstacles) == 0:
            return values
        return np.concatenate([values, np.zeros((len(self.obstacles), *values.shape[1:]), values.dtype)])

    def _list(self, margin: Floats, displacement: Floats) -> None:
        """List the pairs that can collide before any particle has moved by its margin (m) from these displacements (m)."""
        place, radius = self.position[: self.count] + displacement, self.radius[: self.count]
        near = near_pairs(place, radius + margin, self.obstacles)
        may = np.logical_or(self._moves[near[:, 0]], self._moves[near[:, 1]])
        keys = near[:, 0] * len(self.position) + near[:, 1]
        joined = self._joined[np.searchsorted(self._joined[:-1], keys)] == keys
        self.pairs: Rows = near[np.flatnonzero(may & ~joined)]
        self._margin = margin
        self._listed = displacement.copy()

    def list_within(self, travel: float) -> None:
        """Ensure that the list holds all pairs that can collide before any particle has moved farther than `travel` (m)."""
        displacement = self.displacement
        if (lengths(displacement - self._listed) + travel > self._margin).any():
            self._list(np.maximum(self._least, 2.0 * travel), displacement)

    def are_nodes(self, pairs: Rows) -> NDArray[np.bool_]:
        """True where a member of a pair is a node of a structure, shape (k, 2)."""
        nodes: NDArray[np.bool_] = self._node[pairs] & (pairs < self.count)
        return nodes

    # --- how near ------------------------------------------------------------------------------------

    def gaps(self, pairs: Rows, displacement: Floats) -> tuple[Floats, Floats]:
        """Distance between the rims of pairs, and unit vectors from the first centres to the second."""
        gap, normal = np.empty(len(pairs)), np.empty((len(pairs), 2))
        kernels().gaps(pairs, self.position, displacement, self.radius, self.span, gap, normal)
        return gap, normal

    def rates(self, pairs: Rows, normal: Floats) -> Floats:
        """Speeds (m/s) at which pairs part along their lines of centres."""
        velocity = self.everywhere(self.velocity)
        rates: Floats = (normal * (velocity[pairs[:, 1]] - velocity[pairs[:, 0]])).sum(axis=1)
        return rates

    def reach(self, pairs: Rows) -> Floats:
        """The sum of the radii of each pair."""
        total: Floats = self.radius[pairs].sum(axis=1)
        return total

    def kinds(self, displacement: Floats, contacts: PersistentContacts | None) -> Rows:
        """The PairKind of every pair at the start of a step, at these displacements (m)."""
        kinds = np.empty(len(self.pairs), dtype=np.int64)
        persistent = NO_PAIRS if contacts is None else contacts.pairs
        where = self.position, displacement, self.radius, self.span
        kernels().kinds(self.pairs, persistent, self._node, *where, kinds)
        return kinds

    def compliance(self, pairs: Rows, normal: Floats, pushed: Floats) -> Floats:
        """Rates at which unit forces in contacts, along `pushed` (columns), open contacts along `normal` (rows), 1/kg."""
        slope = np.empty((len(pairs), len(pairs)))
        kernels().compliance(pairs, normal, pushed, self.weight, slope)
        return slope

    def clear_time(self, enough: float = math.inf) -> float:
        """Time (s) in which no pair can collide, whatever forces do; 0 while contacts persist.

        A longer time than `enough` (s) is not sought. Forces of mods, and forces that vary with time, are taken to be
        constant; `outran` tells whether they were.
        """
        if persistent_contacts(self.model) is not None:
            return 0.0
        displacement = self.displacement
        self._since, self._speed, self._pull = self.model.clock.time, *self._greatest_speeds()
        covered = self._covered(displacement)
        if covered < 0.0:
            self._list(self._least, displacement)
            covered = self._covered(displacement)
        before, apart = -math.inf, self._time_apart(displacement)
        while before < covered < min(enough, 0.5 * apart):  # forces that are not finite leave no time
            self._list(np.maximum(self._least, self._travel(2.0 * covered)), displacement)
            before, covered, apart = covered, self._covered(displacement), self._time_apart(displacement)
        return min(covered, apart)

    def time_of_impact(self, before: Snapshot, held: PersistentContacts | None) -> float:
        """Time of the first impact in the step since `before` (s from its start), without contacts held; infinite: none.

        NaN if paths differ too much from parabolas for the step to tell.
        """
        old, velocity = before.columns["particles.displacement"], before.columns["particles.velocity"]
        h = float(self.model.clock.time - before.columns["clock.time"][0])
        if h == 0.0:
            return math.inf
        after, path_error = self.displacement, np.empty(self.count)
        span = kernels().path_deviation(
            h, old, velocity, after, self.velocity, self._listed, self._margin, path_error
        )
        if span > 0.0:
            self._list(np.maximum(self._least, 2.0 * span), old)
        pairs, kinds = self.pairs, self.kinds(old, held)
        of_all = self.radius, self.span, self.size, path_error
        s: float = kernels().time_of_impact(h, pairs, kinds, self.position, old, velocity, after, *of_all)
        return s if s >= 0.0 else math.nan

    @property
    def outran(self) -> bool:
        """True if a particle has gained more speed than `clear_time` allowed for when it was last called."""
        speed, _ = self._greatest_speeds()
        passed = self.model.clock.time - self._since
        with _any_force():
            return bool((speed > (self._speed + passed * self._pull) * (1.0 + 1e-6)).any())

    def _time_apart(self, displacement: Floats) -> float:
        """Time (s) in which none of the listed pairs can collide, or separate if they are nodes that overlap."""
        gap, _ = self.gaps(self.pairs, displacement)
        room = np.where(self.kinds(displacement, None) == PairKind.LEFT_ALONE, -gap, np.maximum(gap, 0.0))
        of_pairs = (self.everywhere(values)[self.pairs].sum(axis=1) for values in (self._speed, self._pull))
        return _soonest(room, *of_pairs)

    def _covered(self, displacement: Floats) -> float:
        """Time (s) for which the list is complete; negative if it no longer is."""
        room = self._margin - lengths(displacement - self._listed)
        return _soonest(room, self._speed, self._pull) if (room >= 0.0).all() else -math.inf

    def _travel(self, time: float) -> Floats:
        """Farthest that particles can move in a time (s), m."""
        with _any_force():
            return time * (self._speed + 0.5 * time * self._pull)

    def _greatest_speeds(self) -> tuple[Floats, Floats]:
        """Bounds of the speeds of particles (m/s), and of the growth of these bounds in time (m/s²).

        On an island with the kinetic and elastic energy E, forces F do at most the work
            dE/dt ≤ F · v ≤ √(Σ F²/m) √(2E),   so that   √m v ≤ √(2E) ≤ √(2E₀) + t √(Σ F²/m).
        """
        particles, rods, count = self.model.particles, self.model.rods, int(self._island.max(initial=0)) + 1
        awake = self._moves[: self.count] & ~particles.asleep
        of_rods = self._island[rods.between].max(axis=1, initial=0)
        with _any_force():
            stored = 1000.0 * rods.axial_force**2 * rods.rest_length / rods.stiffness
            pull = particles.mass * ((particles.mobility * particles.applied_force) ** 2).sum(axis=1)
            twice = np.bincount(self._island, particles.mass * (particles.velocity**2).sum(axis=1), count)
            twice += np.bincount(of_rods, stored, count)
            squares = (
                np.array([twice, np.bincount(self._island, pull, count)])[:, self._island] / particles.mass
            )
        speed, growth = np.where(awake, np.sqrt(squares), 0.0)
        return speed, growth


def lengths(vectors: Floats) -> Floats:
    """Lengths of vectors, shape (n, 2)."""
    found: Floats = np.hypot(vectors[:, 0], vectors[:, 1])
    return found


def _soonest(room: Floats, speed: Floats, pull: Floats) -> float:
    """The least time (s) in which a particle covers its room (m): speed t + pull t²/2 = room."""
    moves = (speed > 0.0) | (pull > 0.0)
    room, speed, pull = room[moves], speed[moves], pull[moves]
    with np.errstate(over="ignore"):
        time = np.where(room > 0.0, 2.0 * room, 0.0) / (speed + np.sqrt(speed**2 + 2.0 * pull * room) + SLOWEST)
    return float(time.min(initial=math.inf))
