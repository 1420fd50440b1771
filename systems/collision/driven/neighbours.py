"""The neighbour list of driven particles: which pairs may collide soon."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from components.collision_state import PersistentContacts
from components.field import Role
from components.model import Model
from components.obstacles import obstacles
from components.rod import nodes
from systems.broad_phase import Floats, Rows, near_pairs
from systems.collision.columns import STEP_SHARE
from systems.collision.driven.columns import Driven, Phase, Real, Whole
from systems.collision.driven.compiled import kernels
from systems.collision.system import persistent_contacts

LISTED_AROUND = 0.5  # of the radius of a particle: the least margin within which others are listed
FEWEST_STEPS = 512  # for which the list is to last, at the present speed of a particle,
FARTHEST = 4.0  # where that is no farther than so many of its radii
WIDER, MOST_WIDENED = 4.0, 4  # times the margin, as long as nothing is within it
CONTACTS = 8  # room at first


class NeighbourList:
    """The pairs of one model's particles that are near each other, in the arrays that the kernels share.

    driven: these arrays. pairs: rows i < j in ascending order, without pairs that a rod joins or that cannot move.
    count: of the particles. The numbers of obstacles follow those of the particles.
    """

    driven: Driven

    def __init__(self, model: Model) -> None:
        self.model = model
        self._revision = -1
        self._held: PersistentContacts | None = None
        self._is_stored = False

    # --- the document --------------------------------------------------------------------------------

    def look_up(self) -> None:
        """Read from the document which particles may collide, if the document changed."""
        revision = self.model.newest(Role.DOCUMENT)
        if self._revision == revision:
            return
        self._revision, self._held = revision, None
        particles, ends = self.model.particles, np.sort(self.model.rods.between.astype(np.int64), axis=1)
        self.obstacles = others = obstacles(self.model)
        self.count = particles.count
        joined = np.sort(ends[:, 0] * (self.count + len(others)) + ends[:, 1])
        self._joined = np.append(joined, -1)  # the sentinel equals no pair that is looked up
        self._moves: NDArray[np.bool_] = self.everywhere(np.any(particles.mobility > 0.0, axis=1))
        self._least: Floats = LISTED_AROUND * particles.radius
        self._document = self._of_document()
        self.driven = Driven.empty(self._document, self.count, 0, CONTACTS)
        self.driven.margin[:] = -1.0  # no pair is listed yet
        whole, real = self.driven.whole, self.driven.real
        whole[Whole.BOUNCY] = (self.driven.restitution < 1.0).any()
        whole[Whole.DAMPED] = self.model.rods.damping.any() or self.model.environment.drag > 0.0
        real[Real.LONGEST] = np.inf
        pull = self.driven.pull
        fall = np.sqrt(4.0 * particles.radius[pull > 0.0] / pull[pull > 0.0])
        real[Real.CROWD_STEP] = STEP_SHARE * float(np.median(fall)) if len(fall) else np.inf
        real[Real.STRONGEST] = pull.max(initial=0.0)

    def _of_document(self) -> dict[str, Any]:
        """The arrays of Driven that follow from the document."""
        particles, others = self.model.particles, self.obstacles
        alike = np.full(self.count, self.model.settings.restitution)
        span = self.everywhere(np.zeros((self.count, 2)))
        span[self.count :] = others.span
        node = np.ones(self.count + len(others), dtype=np.int64)
        node[: self.count] = nodes(self.model)
        return {
            "position": np.concatenate([particles.position, others.start]),
            "span": span,
            "weight": self.everywhere(np.where(particles.fixed, 0.0, 1.0 / particles.mass[:, None])),
            "radius": np.concatenate([particles.radius, others.radius]),
            "size": np.concatenate([particles.radius, np.full(len(others), np.inf)]),
            "restitution": np.concatenate([alike, others.restitution]),
            "node": node,
            "loose": np.flatnonzero(node[: self.count] == 0),
            "asleep": self.model.tables["particles"].storage("asleep"),
            "pull": np.hypot(*(particles.mobility * particles.constant_force).T),
        }

    def everywhere(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values of the particles, followed by zeros for the obstacles, which do not move."""
        if len(self.obstacles) == 0:
            return np.ascontiguousarray(values)
        return np.concatenate([values, np.zeros((len(self.obstacles), *values.shape[1:]), values.dtype)])

    # --- the list ------------------------------------------------------------------------------------

    @property
    def pairs(self) -> Rows:
        return self.driven.pairs

    def list_within(self, span: float) -> None:
        """List the pairs that can meet before any particle has moved by `span` (m) from where the step began, or now."""
        midst = self.driven.whole[Whole.PHASE] != Phase.BETWEEN
        taken = midst and not self.driven.whole[Whole.FORESEEN]
        displacement = self.driven.before if taken else self.displacement
        radius, speed = self.driven.radius[: self.count], np.hypot(*self.velocity.T)
        far = np.minimum(FEWEST_STEPS * self.model.clock.step_size * speed, FARTHEST * radius)
        margin = np.maximum(np.maximum(self._least, far), 2.0 * span)
        pairs = self._near(displacement, margin)
        for _ in range(MOST_WIDENED):
            wider = WIDER * margin
            if len(pairs) or len(more := self._near(displacement, wider)):
                break
            margin, pairs = wider, more  # nothing is near: it will be long until something is
        self._put(pairs)
        self.driven.margin[:], self.driven.listed[:] = margin, displacement

    def _near(self, displacement: Floats, margin: Floats) -> Rows:
        """The pairs that can meet before any particle has moved by its margin (m) from there."""
        others = self.obstacles
        place, radius = self.driven.position[: self.count] + displacement, self.driven.radius[: self.count]
        near = near_pairs(place, radius + margin, others)
        may = np.logical_or(self._moves[near[:, 0]], self._moves[near[:, 1]])
        keys = self._keys(near)
        joined = self._joined[np.searchsorted(self._joined[:-1], keys)] == keys
        found: Rows = near[np.flatnonzero(may & ~joined)]
        return found

    def _keys(self, pairs: Rows) -> Rows:
        keys: Rows = pairs[:, 0] * (self.count + len(self.obstacles)) + pairs[:, 1]
        return keys

    def _put(self, pairs: Rows) -> None:
        """Put pairs in place of those listed; what lasts in those that stay goes on."""
        old = self.driven
        new = Driven.empty(self._document, self.count, len(pairs), 0)
        new.pairs[:] = pairs
        lasting = np.flatnonzero(old.lasting)
        rows = np.searchsorted(self._keys(pairs), self._keys(old.pairs[lasting]))
        new.lasting[rows], new.forces[rows] = 1, old.forces[lasting]
        of_pairs = (
            *("pairs", "lasting", "forces", "normal", "slow", "rate", "room", "pushes", "impulses"),
            *("touching", "chain", "group", "report"),
        )
        members = np.unique(pairs)
        near = np.ascontiguousarray(members[members < self.count])
        self.driven = old._replace(near=near, **{name: getattr(new, name) for name in of_pairs})
        self.driven.support[:] = 0.0
        self.driven.whole[Whole.PUSHED] = 1
        if old.whole[Whole.PHASE] == Phase.HELD:  # else they are chosen anew before they are used
            chosen = self.driven.chosen[: old.whole[Whole.CHOSEN]]
            chosen[:] = np.searchsorted(self._keys(pairs), self._keys(old.pairs[chosen]))

    def make_room(self) -> None:
        """Make room for twice as many persistent contacts, if there are more than before."""
        if self.driven.lasting.sum() <= len(self.driven.chosen):
            return
        new = Driven.empty(self._document, self.count, 0, 2 * len(self.driven.chosen))
        of_contacts = ("chosen", "search", "start", "end", "slope", "learnt", "matrix", "block", "sides")
        self.driven = self.driven._replace(**{name: getattr(new, name) for name in of_contacts})

    # --- persistent contacts ----------------------------------------------------------------------------

    def load_contacts(self) -> None:
        """Begin with the state of the model: take its persistent contacts, if they are others than were stored last."""
        driven, held = self.driven, persistent_contacts(self.model)
        known, self._is_stored = self._is_stored and held is self._held, False  # not stored: interrupted
        driven.whole[Whole.PHASE], driven.whole[Whole.EXAMINE] = Phase.BETWEEN, 0
        if known:
            return
        driven.lasting[:], driven.forces[:] = 0, 0.0
        driven.real[Real.LONGEST] = np.inf if held is None else held.longest_step
        self._held = held
        if held is None:
            return
        self.list_within(0.0)
        keys, sought = self._keys(self.pairs), self._keys(held.pairs)
        rows = np.minimum(np.searchsorted(keys, sought), max(len(keys) - 1, 0))
        there = keys[rows] == sought if len(keys) else np.zeros(len(sought), dtype=bool)
        self.driven.lasting[rows[there]], self.driven.forces[rows[there]] = 1, held.forces[there]

    def store_contacts(self) -> None:
        """Note the persistent contacts in the state of the model."""
        driven, held = self.driven, self._held
        rows = np.flatnonzero(driven.lasting)
        longest = float(driven.real[Real.LONGEST])
        if len(rows) or held is not None:
            self._held = (
                PersistentContacts(driven.pairs[rows], driven.forces[rows], longest) if len(rows) else None
            )
            self.model.writable("clock.collision_state")[0] = self._held
        self._is_stored = True

    # --- how near ------------------------------------------------------------------------------------

    @property
    def displacement(self) -> Floats:
        """Of the particles, now (m); not a read-only view, for which kernels are not compiled."""
        return self.model.tables["particles"].storage("displacement")

    @property
    def velocity(self) -> Floats:
        """Of the particles, now (m/s)."""
        return self.model.tables["particles"].storage("velocity")

    def gaps(self, pairs: Rows, displacement: Floats) -> tuple[Floats, Floats]:
        """Distance between the rims of pairs, and unit vectors from the first centres to the second."""
        gap, normal, driven = np.empty(len(pairs)), np.empty((len(pairs), 2)), self.driven
        kernels().gaps(pairs, driven.position, displacement, driven.radius, driven.span, gap, normal)
        return gap, normal
