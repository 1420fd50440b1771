"""Vicinity: which particles that other forces drive may meet soon, and for how long none can."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from components.field import Role
from components.model import Model
from components.obstacles import obstacles
from systems.collision.system import contacts_of
from systems.near import Floats, Rows, near_pairs, nearest

FAR = 0.5  # of the largest radius; particles that are farther apart are watched less closely
OVERLAP = 1e-9  # of the reach of two nodes; more at the start of a step is from before they ever parted
WATCHED, LEFT_ALONE, LASTING = 0, 1, 2  # kinds of pairs


class Vicinity:
    """The pairs of one model's particles that are near each other.

    pairs: rows i < j in ascending order, shape (k, 2); without those that a rod joins or that cannot move.
    position, radius: of the particles and, after them, the obstacles. weight: inverse mass in each direction
    (1/kg), 0 where it is held. restitution: of impacts with each. size: m; of which gaps are small shares.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self._revision = -1

    def look_up(self) -> None:
        """Find out what the document says of who may meet whom, if it changed."""
        revision = self.model.newest(Role.DOCUMENT)
        if self._revision == revision:
            return
        self._revision = revision
        particles, ends = self.model.particles, np.sort(self.model.rods.between.astype(np.int64), axis=1)
        self.obstacles = others = obstacles(self.model)
        self._count = particles.count
        joined = np.sort(ends[:, 0] * (self._count + len(others)) + ends[:, 1])
        self._joined = np.append(joined, -1)  # what is looked up and would come last meets no pair
        self._node = np.ones(self._count + len(others), dtype=bool)
        self._node[: self._count] = False
        self._node[ends.ravel()] = True
        self._moves: NDArray[np.bool_] = self.everywhere(np.any(particles.mobility > 0.0, axis=1))
        self.position = np.concatenate([particles.position, others.start])
        self.radius = np.concatenate([particles.radius, others.radius])
        self.size = np.concatenate([particles.radius, np.full(len(others), np.inf)])
        self.weight: Floats = self.everywhere(np.where(particles.fixed, 0.0, 1.0 / particles.mass[:, None]))
        alike = np.full(self._count, self.model.settings.restitution)
        self.restitution = np.concatenate([alike, others.restitution])
        self.span = self.everywhere(np.zeros((self._count, 2)))
        self.span[self._count :] = others.span
        self._far = self._widest(FAR * float(particles.radius.max(initial=0.0)))
        self._margin = -1.0

    def everywhere(self, values: NDArray[Any]) -> NDArray[Any]:
        """What particles have, with zeros for the obstacles, which do not move."""
        if len(self.obstacles) == 0:
            return values
        return np.concatenate([values, np.zeros((len(self.obstacles), *values.shape[1:]), values.dtype)])

    def _widest(self, least: float) -> float:
        """About half the least gap (m) between those that may meet in the original geometry, or the least."""
        far = least
        self._list(far, np.zeros((self._count, 2)))
        while len(self.pairs) == 0 and far < 1e6 * least:
            far *= 2.0
            self._list(far, np.zeros((self._count, 2)))
        return max(0.5 * far, least)

    def _list(self, margin: float, displacement: Floats) -> None:
        """List the pairs that can meet before any particle has moved by the margin (m) from there."""
        place, radius = self.position[: self._count] + displacement, self.radius[: self._count]
        near = near_pairs(place, radius + margin, self.obstacles)
        may = np.logical_or(self._moves[near[:, 0]], self._moves[near[:, 1]])
        keys = near[:, 0] * len(self.position) + near[:, 1]
        joined = self._joined[np.searchsorted(self._joined[:-1], keys)] == keys
        self.pairs: Rows = near[np.flatnonzero(may & ~joined)]
        self._margin = margin
        self._listed = displacement.copy()

    # --- how near ------------------------------------------------------------------------------------

    def gaps(self, pairs: Rows, displacement: Floats) -> tuple[Floats, Floats]:
        """Distance between the rims of pairs, and unit vectors from the first centres to the second."""
        first, second = pairs[:, 0], pairs[:, 1]
        displacement = self.everywhere(displacement)
        line = (self.position[second] - self.position[first]) + (displacement[second] - displacement[first])
        line = nearest(line, self.span[second])
        distance = np.hypot(line[:, 0], line[:, 1])
        normal = line / np.where(distance > 0.0, distance, 1.0)[:, None]
        return distance - self.reach(pairs), normal

    def reach(self, pairs: Rows) -> Floats:
        """The sum of the radii of each pair."""
        total: Floats = self.radius[pairs].sum(axis=1)
        return total

    def kinds(self, displacement: Floats) -> Rows:
        """Of every pair at the start of a step: WATCHED, LEFT_ALONE (nodes that overlap) or LASTING."""
        gap, _ = self.gaps(self.pairs, displacement)
        nodes = self._node[self.pairs].all(axis=1)
        kinds = np.where(nodes & (gap < -OVERLAP * self.reach(self.pairs)), LEFT_ALONE, WATCHED)
        contacts, count = contacts_of(self.model), len(self.position)
        if contacts is not None:
            lasting = contacts.contacts[:, 0] * count + contacts.contacts[:, 1]
            kinds[np.isin(self.pairs[:, 0] * count + self.pairs[:, 1], lasting)] = LASTING
        return kinds

    def clear_time(self) -> float:
        """For how long (s) nothing can meet, whatever forces do; 0 while anything is in contact.

        It follows from the present state alone: wide gaps count as no wider than `_far`.
        """
        displacement = self.model.particles.displacement
        if self._margin < 0.0 or self._travel(displacement) > self._margin - 0.5 * self._far:
            self._list(self._far, displacement)
        if contacts_of(self.model) is not None:
            return 0.0
        gap, _ = self.gaps(self.pairs, displacement)
        awake = self._moves & ~self.everywhere(self.model.particles.asleep)
        may_meet = awake[self.pairs].any(axis=1) & (~self._node[self.pairs].all(axis=1) | (gap > 0.0))
        room = 0.5 * min(self._far, float(gap[may_meet].min(initial=math.inf)))
        fastest = self._fastest(awake[: self._count]) if room > 0.0 else math.inf
        return room / fastest if fastest > 0.0 else math.inf

    def cover(self, start: Floats, swing: float) -> None:
        """List all pairs that can be near each other in a step from `start` to the present displacement.

        swing: by how much (m) paths may leave the straight line.
        """
        if self._travel(self.model.particles.displacement) + swing > self._margin:
            moved = self.model.particles.displacement - start
            span = float(np.hypot(moved[:, 0], moved[:, 1]).max(initial=0.0)) + swing
            self._list(max(2.0 * span, self._far), start)

    def _travel(self, displacement: Floats) -> float:
        moved = displacement - self._listed
        return float(np.hypot(moved[:, 0], moved[:, 1]).max(initial=0.0))

    def _fastest(self, awake: NDArray[np.bool_]) -> float:
        """A speed (m/s) that none exceeds before it has moved by `_far`: all energy of what is awake in the lightest."""
        particles, rods = self.model.particles, self.model.rods
        supply = 1000.0 * np.abs(particles.applied_force[awake]).sum() * self._far
        kinetic = 0.5 * (particles.mass[:, None] * particles.velocity**2).sum()
        energy = 500.0 * rods.axial_force**2 * rods.rest_length / rods.stiffness
        stored = energy[awake[rods.between].any(axis=1)].sum()
        lightest = particles.mass[awake].min(initial=math.inf)
        return math.sqrt(2.0 * float(kinetic + stored + supply) / float(lightest))
