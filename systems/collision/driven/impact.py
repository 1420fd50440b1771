"""Impacts of driven particles: what happens at the instant at which a step ended at an impact."""

from __future__ import annotations

import math

import numpy as np

from components.collision_state import PersistentContacts
from components.model import Model
from components.snapshot import Snapshot
from systems.broad_phase import Floats, Rows
from systems.collision.columns import Contact, Group, PairKind
from systems.collision.driven.compiled import kernels
from systems.collision.driven.neighbours import NeighbourList
from systems.collision.impacts import Impacts
from systems.collision.system import REST_HEIGHT, persistent_contacts

TOUCHING_GAP = 1e-12  # of the reach of two particles, below which they touch
SETTLING_CONTACTS = 4  # persistent contacts, from which on bounces would go on and on
SETTLING_HEIGHT = 1e-3  # replaces REST_HEIGHT from then on: of the smaller radius


class ImpactResolver:
    """Carries out the impacts at an instant, and notes which particles stay in contact."""

    def __init__(self, model: Model, impacts: Impacts, neighbours: NeighbourList) -> None:
        self.model = model
        self._record = impacts
        self._neighbours = neighbours

    def resolve(self, before: Snapshot, rest_speed: Floats | None = None) -> bool:
        """Resolve the impacts of all pairs that touch now, after a step that began with the state `before`.

        True if the plan of the next steps may differ: contacts have begun to persist, or a sleeping particle was struck.
        rest_speed: speeds (m/s) below which pairs stay in contact; None: as this step shows.
        """
        near, particles = self._neighbours, self.model.particles
        gap, normal = near.gaps(near.pairs, near.displacement)
        kinds = near.kinds(before.columns["particles.displacement"], persistent_contacts(self.model))
        touching = np.flatnonzero(
            (kinds != PairKind.LEFT_ALONE) & (gap <= 4.0 * TOUCHING_GAP * near.reach(near.pairs))
        )
        rate = self._neighbours.rates(near.pairs, normal)
        noise = 1e-14 * np.hypot(*particles.velocity.T).max(initial=0.0)
        if not (rate[touching] < -noise).any() and not (kinds[touching] == PairKind.WATCHED).any():
            return False
        slow = self.rest_speed(before) if rest_speed is None else rest_speed
        slow[kinds == PairKind.PERSISTENT] = math.inf
        for group in connected(self._with_separate_obstacles(near.pairs[touching])):
            self._resolve_group(touching[group], normal, rate, slow)
        struck = near.pairs[touching]
        touching = touching[kinds[touching] == PairKind.WATCHED]
        begun = self._begin_contacts(near.pairs[touching], normal[touching], slow[touching])
        return begun or bool(near.everywhere(particles.asleep)[struck].any())

    def _with_separate_obstacles(self, pairs: Rows) -> Rows:
        """The pairs, with another number for an obstacle in each pair: obstacles do not pass impulses on."""
        fixed = pairs[:, 1] >= self.model.particles.count
        numbers = len(self._neighbours.position) + np.arange(len(pairs))
        return np.column_stack([pairs[:, 0], np.where(fixed, numbers, pairs[:, 1])])

    def rest_speed(self, before: Snapshot) -> Floats:
        """Speed of approach below which pairs stay in contact: √(2 a h), a being the larger acceleration."""
        particles, pairs = self.model.particles, self._neighbours.pairs
        height, contacts = TOUCHING_GAP * self._neighbours.reach(pairs), persistent_contacts(self.model)
        if (self._neighbours.restitution < 1.0).any():
            settling = contacts is not None and len(contacts.pairs) >= SETTLING_CONTACTS
            share = SETTLING_HEIGHT if settling else REST_HEIGHT
            height = np.maximum(height, share * self._neighbours.size[pairs].min(axis=1))
        pull = np.hypot(*(particles.mobility * particles.applied_force).T)
        h = self.model.clock.time - before.columns["clock.time"][0]
        if h > 0.0:
            change = (particles.velocity - before.columns["particles.velocity"]) / h
            pull = np.maximum(pull, np.hypot(*change.T))
        speed: Floats = np.sqrt(2.0 * self._neighbours.everywhere(pull)[pairs].max(axis=1) * height)
        return speed

    def _resolve_group(self, chosen: Rows, normal: Floats, rate: Floats, slow: Floats) -> None:
        """Resolve the joint impact of a group of pairs; it is plastic if no pair approaches faster than at rest."""
        pairs = self._neighbours.pairs[chosen]
        fast = rate[chosen] < -slow[chosen]
        count, restitution = len(pairs), self._neighbours.restitution[pairs[fast, 1]].min(initial=1.0)
        group, members = group_of(self._neighbours, pairs, normal[chosen])
        velocity = self.model.writable("particles.velocity")
        group.motion[...] = self._neighbours.everywhere(velocity)[members]
        kernels().resolve(len(members), count, restitution if fast.any() else 0.0, 0.0, group)
        moves = members < len(velocity)
        velocity[members[moves]] = group.motion[moves]
        impulse = group.contacts[:, Contact.TOTAL_IMPULSE]
        loss = -0.5 * float((impulse * (rate[chosen] + self._neighbours.rates(pairs, normal[chosen]))).sum())
        clock = self.model.clock
        self.model.writable("clock.dissipated_impact")[0] = clock.dissipated_impact + loss
        if fast.any() and impulse.any():
            self.record(pairs, normal[chosen], impulse, loss, clock.time, self.model.particles.displacement)

    def record(
        self, pairs: Rows, normal: Floats, impulse: Floats, loss: float, time: float, displacement: Floats
    ) -> None:
        """Record the impacts of pairs with an impulse (N·s) at a time (s) and these displacements, and their loss (J)."""
        struck, clock = impulse > 0.0, self.model.clock
        pairs, impulse = pairs[struck], impulse[struck]
        place = self._neighbours.position + self._neighbours.everywhere(displacement)
        point = place[pairs[:, 0]] + normal[struck] * self._neighbours.radius[pairs[:, 0]][:, None]
        share = loss * impulse / impulse.sum()
        self._record.record(np.column_stack((np.full(len(pairs), time), pairs, impulse, share, point)))
        self.model.writable("clock.collisions")[0] = clock.collisions + len(pairs)

    def _begin_contacts(self, pairs: Rows, normal: Floats, slow: Floats) -> bool:
        """Begin persistent contacts of the pairs that touch and part no faster than at rest; True if there are any."""
        new = pairs[(self._neighbours.rates(pairs, normal) <= slow) & (slow > 0.0)]
        if len(new) == 0:
            return False
        known = persistent_contacts(self.model)
        pairs, forces, longest = new, np.zeros(len(new)), math.inf
        if known is not None:
            pairs = np.concatenate([known.pairs, pairs])
            forces = np.concatenate([known.forces, forces])
            longest = known.longest_step
        self.model.writable("clock.collision_state")[0] = PersistentContacts(pairs, forces, longest)
        return True


def group_of(near: NeighbourList, pairs: Rows, normal: Floats) -> tuple[Group, Rows]:
    """The group of pairs with these unit vectors, in contact, and the particle or obstacle that each member is."""
    members, links = np.unique(pairs, return_inverse=True)
    group = Group.empty(len(members), len(pairs))
    group.links[...] = links.reshape(-1, 2)
    group.contacts[:, [Contact.NX, Contact.NY]] = normal
    group.mobility[...] = near.weight[members]
    return group, members


def connected(pairs: Rows) -> list[Rows]:
    """Groups of the pairs that are connected through shared members; each group in ascending order."""
    group = {int(i): {int(i)} for i in np.unique(pairs)}
    for i, j in pairs.tolist():
        if group[i] is not group[j]:
            group[i] |= group[j]
            for k in group[j]:
                group[k] = group[i]
    found: dict[int, list[int]] = {}
    for k, (i, _) in enumerate(pairs.tolist()):
        found.setdefault(min(group[i]), []).append(k)
    return [np.array(rows, dtype=np.int64) for rows in found.values()]
