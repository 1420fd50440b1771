"""Strikes: what impacts do to particles that other forces drive."""

from __future__ import annotations

import math

import numpy as np

from components.model import Model
from components.paths import longest_step, resting
from components.snapshot import Snapshot
from systems.broad_phase import Floats, Rows
from systems.collision.columns import LASTING, LEFT_ALONE, WATCHED
from systems.collision.driven.compiled import kernels
from systems.collision.driven.neighbours import Vicinity
from systems.collision.impacts import Impacts
from systems.collision.system import REST_HEIGHT, contacts_of

TOUCH = 1e-12  # of the reach of two particles: nearer than this they touch
CROWD = 4  # contacts that last, from which on bounces would go on and on
CROWD_HEIGHT = 1e-3  # replaces REST_HEIGHT there


class Strikes:
    """Carries out the impacts at an instant, and notes which particles stay in contact."""

    def __init__(self, model: Model, impacts: Impacts, vicinity: Vicinity) -> None:
        self.model = model
        self._impacts = impacts
        self._near = vicinity

    def happen(self, before: Snapshot, resting: Floats | None = None) -> bool:
        """Impacts of all that touch now, after a step from a moment before.

        True if what takes the steps may not be the same any more: new contacts last, or what slept was struck.
        resting: speeds below which pairs stay in contact, if not those that this step tells.
        """
        near, particles = self._near, self.model.particles
        gap, normal = near.gaps(near.pairs, near.displacement)
        kinds = near.kinds(before.columns["particles.displacement"], contacts_of(self.model))
        touching = np.flatnonzero((kinds != LEFT_ALONE) & (gap <= 4.0 * TOUCH * near.reach(near.pairs)))
        rate = self._near.rates(near.pairs, normal)
        noise = 1e-14 * np.hypot(*particles.velocity.T).max(initial=0.0)
        if not (rate[touching] < -noise).any() and not (kinds[touching] == WATCHED).any():
            return False
        slow = self.rest_speed(before) if resting is None else resting
        slow[kinds == LASTING] = math.inf
        for group in connected(self._apart(near.pairs[touching])):
            self._strike(touching[group], normal, rate, slow)
        struck = near.pairs[touching]
        touching = touching[kinds[touching] == WATCHED]
        lasts = self._note_contacts(near.pairs[touching], normal[touching], slow[touching])
        return lasts or bool(near.everywhere(particles.asleep)[struck].any())

    def _apart(self, pairs: Rows) -> Rows:
        """The pairs, every obstacle a different one in each: it passes nothing on from one to another."""
        fixed = pairs[:, 1] >= self.model.particles.count
        numbers = len(self._near.position) + np.arange(len(pairs))
        return np.column_stack([pairs[:, 0], np.where(fixed, numbers, pairs[:, 1])])

    def rest_speed(self, before: Snapshot) -> Floats:
        """Speed of approach below which pairs stay in contact: √(2 a h), a being the larger acceleration."""
        particles, pairs = self.model.particles, self._near.pairs
        height, contacts = TOUCH * self._near.reach(pairs), contacts_of(self.model)
        if (self._near.restitution < 1.0).any():
            share = REST_HEIGHT if contacts is None or len(contacts.contacts) < CROWD else CROWD_HEIGHT
            height = np.maximum(height, share * self._near.size[pairs].min(axis=1))
        pull = np.hypot(*(particles.mobility * particles.applied_force).T)
        h = self.model.clock.time - before.columns["clock.time"][0]
        if h > 0.0:
            change = (particles.velocity - before.columns["particles.velocity"]) / h
            pull = np.maximum(pull, np.hypot(*change.T))
        speed: Floats = np.sqrt(2.0 * self._near.everywhere(pull)[pairs].max(axis=1) * height)
        return speed

    def _strike(self, chosen: Rows, normal: Floats, rate: Floats, slow: Floats) -> None:
        """The joint impact of a group of pairs; plastic if none approaches faster than at rest."""
        from systems.collision.columns import IMPULSE, NX, NY
        from systems.collision.free.discs import room_for

        pairs = self._near.pairs[chosen]
        fast = rate[chosen] < -slow[chosen]
        count, restitution = len(pairs), self._near.restitution[pairs[fast, 1]].min(initial=1.0)
        members, links = np.unique(pairs, return_inverse=True)
        group = room_for(len(members), count)
        group.links[:count] = links.reshape(-1, 2)
        group.contacts[:count, [NX, NY]] = normal[chosen]
        group.mobility[...] = self._near.weight[members]
        velocity = self.model.writable("particles.velocity")
        group.motion[...] = self._near.everywhere(velocity)[members]
        kernels().push(len(members), count, restitution if fast.any() else 0.0, 0.0, group)
        moves = members < len(velocity)
        velocity[members[moves]] = group.motion[moves]
        impulse = group.contacts[:count, IMPULSE]
        loss = -0.5 * float((impulse * (rate[chosen] + self._near.rates(pairs, normal[chosen]))).sum())
        clock = self.model.clock
        self.model.writable("clock.dissipated_impact")[0] = clock.dissipated_impact + loss
        if fast.any() and impulse.any():
            self.record(pairs, normal[chosen], impulse, loss, clock.time, self.model.particles.displacement)

    def record(
        self, pairs: Rows, normal: Floats, impulse: Floats, loss: float, time: float, displacement: Floats
    ) -> None:
        """Enter impacts of pairs at a time (s) at these displacements, where there are impulses (N·s), and the loss (J)."""
        felt, clock = impulse > 0.0, self.model.clock
        pairs, impulse = pairs[felt], impulse[felt]
        place = self._near.position + self._near.everywhere(displacement)
        point = place[pairs[:, 0]] + normal[felt] * self._near.radius[pairs[:, 0]][:, None]
        share = loss * impulse / impulse.sum()
        self._impacts.record(np.column_stack((np.full(len(pairs), time), pairs, impulse, share, point)))
        self.model.writable("clock.collisions")[0] = clock.collisions + len(pairs)

    def _note_contacts(self, pairs: Rows, normal: Floats, slow: Floats) -> bool:
        """Pairs that touch and part no faster than at rest are in contact from now on."""
        new = pairs[(self._near.rates(pairs, normal) <= slow) & (slow > 0.0)]
        if len(new) == 0:
            return False
        known = contacts_of(self.model)
        contacts, forces, longest = new, np.zeros(len(new)), math.inf
        if known is not None:
            contacts = np.concatenate([known.contacts, contacts])
            forces = np.concatenate([known.forces, forces])
            longest = longest_step(known)
        self.model.writable("clock.paths")[0] = resting(contacts, forces, longest)
        return True


def connected(pairs: Rows) -> list[Rows]:
    """Which of the pairs are connected through shared members; each group in ascending order."""
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
