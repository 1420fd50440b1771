"""Crowds: particles that others than rods drive, of which so many touch that single impacts no longer pay."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from components.model import Model
from components.paths import Paths, resting
from components.snapshot import Snapshot
from systems.base import StopReason
from systems.broad_phase import Floats, Rows
from systems.collision.driven.compiled import kernels
from systems.collision.driven.contacts import note_energy, push
from systems.collision.driven.impact import CROWD_HEIGHT, Strikes
from systems.collision.driven.neighbours import Vicinity
from systems.collision.system import contacts_of, support_forces
from systems.program.program import Program

CROWDED = 24  # contacts that last or impacts to come, from which on particles take such steps
FEWEST = 8  # particles that are no nodes; fewer never are a crowd
STEP_SHARE = 0.04  # of the time in which a particle falls through its diameter: the longest step
TRAVEL = 0.35  # of the smaller radius of two that approach, relative to one another, in a step
SHORTEST_SHARE = 1.0 / 16.0  # of the longest step, where they are fast
TOUCH = 1e-12  # of a radius: by how much particles may sink into others in a step
NO_IMPACT = -1.0  # as the restitution of contacts that are only held apart
ROUND_OFF = 1e-14  # of an energy
MOST_TRIES = 4  # of the forces in a step


class Crowds:
    """Takes steps in which impacts happen at the beginning, and particles that then would sink in push each other.

    Both are projections, of the velocities and of the ways that particles go in the step: the least change after which
    no pair closes by more than its gap along the line of centres at the start. Distances are convex, so that nothing
    sinks in; no force does work; and no impact supplies energy.
    """

    def __init__(self, model: Model, vicinity: Vicinity, strikes: Strikes) -> None:
        self.model = model
        self._near = vicinity
        self._strikes = strikes

    def found(self, until: float, landing: bool) -> Squeeze | None:
        """What particles may do to each other in the next step if they are a crowd: so many last in contact or are to meet.

        Not where a structure is near, which would answer to forces in its own way.
        """
        near, clock, particles = self._near, self.model.clock, self.model.particles
        if near.loose < FEWEST:
            return None
        pull = np.hypot(*(particles.mobility * particles.constant_force).T)
        pulled, longest = pull > 0.0, until - clock.time if landing else clock.step_size
        if pulled.any():
            fall = np.sqrt(4.0 * particles.radius[pulled] / pull[pulled])
            longest = min(longest, STEP_SHARE * float(np.median(fall)))
        travel = longest * (2.0 * float(np.hypot(*particles.velocity.T).max()) + longest * float(pull.max()))
        near.list_within(travel)
        if len(near.pairs) < CROWDED:
            return None
        gap, normal = near.gaps(near.pairs, near.displacement)
        close = np.flatnonzero(gap <= 2.0 * travel)
        squeeze = Squeeze(near, near.pairs[close], gap[close], normal[close], near.everywhere(pull))
        squeeze.choose_length(longest)
        lasting = contacts_of(self.model)
        number = squeeze.impacts_to_come + (0 if lasting is None else len(lasting.contacts))
        return squeeze if number >= CROWDED and not near.are_nodes(squeeze.pairs).any() else None

    def step(
        self,
        squeeze: Squeeze,
        program: Program,
        before: Snapshot,
        take: Callable[[float | None], StopReason],
        until: float,
        landing: bool,
    ) -> StopReason:
        """A step from a moment before, taken by `take`: a whole one, or up to a time (s). None that ends after `until`."""
        clock, near = self.model.clock, self._near
        start, whole = clock.time, not landing and squeeze.h == clock.step_size
        end = None if whole else start + squeeze.h
        if end is not None and end > until:
            return StopReason.DONE
        origin = before.columns["particles.displacement"]

        def moved() -> Floats:
            return near.displacement - origin

        velocity, impulses = squeeze.impacts()
        loss = squeeze.energy(near.velocity) - squeeze.energy(velocity)
        forces = squeeze.known(contacts_of(self.model))
        for turn in range(MOST_TRIES):
            if turn > 0:
                forces = squeeze.better(forces, moved(), clock.time - start)
                before.restore(self.model)
            self.model.writable("particles.velocity")[...] = velocity
            note_energy(self.model, float((forces * squeeze.size).sum()))
            push(program, self.model, support_forces(squeeze.normal, squeeze.pairs, forces, near.count))
            reason = take(end)
            if clock.time == start or reason is StopReason.DIVERGED:
                before.restore(self.model)
                return reason
            if program.integrator.controlled:
                end = clock.time
            if squeeze.holds(forces, moved()):
                break
        self.model.writable("clock.dissipated_impact")[0] = clock.dissipated_impact + loss
        self._strikes.record(squeeze.pairs, squeeze.normal, impulses, loss, start, origin)
        gap, _ = near.gaps(squeeze.pairs, near.displacement)
        lasts = (forces > 0.0) | (gap <= CROWD_HEIGHT * squeeze.size)
        self.model.writable("clock.paths")[0] = resting(squeeze.pairs[lasts], forces[lasts])
        return reason


class Squeeze:
    """What pairs do to each other in a step.

    h: its length, s. impacts_to_come: how many pairs would meet in it, without those that lose no energy.
    """

    def __init__(self, near: Vicinity, pairs: Rows, gap: Floats, normal: Floats, pull: Floats) -> None:
        from systems.collision.columns import NX, NY
        from systems.collision.free.discs import room_for

        self._near = near
        self.pairs, self.normal = pairs, normal
        self.room: Floats = np.maximum(gap, 0.0)
        self.size: Floats = near.size[pairs].min(axis=1)
        self._pull: Floats = pull[pairs].max(axis=1)
        self._restitution: Floats = near.restitution[pairs[:, 1]]
        self._rate = near.rates(pairs, normal)
        self._tolerance = 0.1 * TOUCH * float(self.size.min(initial=np.inf))
        self._members, links = np.unique(pairs, return_inverse=True)
        self._group = room_for(len(self._members), len(pairs))
        self._group.links[...] = links.reshape(-1, 2)
        self._group.contacts[:, [NX, NY]] = normal
        self._group.mobility[...] = near.weight[self._members]

    def choose_length(self, longest: float) -> None:
        """Let no two that are about to meet travel far relative to one another."""
        travel = TRAVEL * self.size
        fast = -self._rate * longest > np.maximum(travel, self.room)
        h = float((travel[fast] / -self._rate[fast]).min(initial=longest))
        self.h = max(h, SHORTEST_SHARE * longest)
        self._meets = self.room + self.h * self._rate < 0.0
        self.impacts_to_come = np.count_nonzero(self._meets & (self._restitution < 1.0))

    def impacts(self) -> tuple[Floats, Floats]:
        """Velocities of the particles after impacts, and impulses (N·s) of those that bounce.

        Poisson's law: what the plastic impact took is given back, e times, where two approach faster than what two steps
        of free fall give, and would rise more than a little.
        """
        near, h = self._near, self.h
        slow = np.maximum(2.0 * h * self._pull, np.sqrt(2.0 * self._pull * CROWD_HEIGHT * self.size))
        fast = self._meets & (self._rate < -slow)
        bias, none = np.where(fast, 0.0, self.room / h), np.zeros(len(fast))
        velocity = near.velocity.copy()
        plastic, impulses = self._project(velocity, bias, none, self._tolerance / h)
        impulses[~fast] = 0.0
        back = self._restitution * impulses
        if back.any():
            bounced, _ = self._project(plastic + self._answer(back), bias, none, self._tolerance / h)
            if self.energy(bounced) <= self.energy(velocity) * (1.0 + ROUND_OFF):
                return bounced, impulses + back
        return plastic, impulses

    def energy(self, velocity: Floats) -> float:
        """Of motion, J."""
        particles = self._near.model.particles
        return 0.5 * float((particles.mass[:, None] * velocity * velocity).sum())

    def known(self, contacts: Paths | None) -> Floats:
        """Forces (N) in the pairs, as lasting contacts had them in the step before."""
        forces = np.zeros(len(self.size))
        if contacts is not None:
            pairs, count = self.pairs, len(self._near.position)
            keys, sought = pairs @ [count, 1], contacts.contacts @ [count, 1]
            places = np.minimum(np.searchsorted(keys, sought), len(keys) - 1)
            there = keys[places] == sought
            forces[places[there]] = contacts.forces[there]
        return forces

    def closed(self, moved: Floats) -> Floats:
        """By how much (m) pairs part along their lines of centres at the start, beyond what room there was."""
        moved = self._near.everywhere(moved)
        apart: Floats = (self.normal * (moved[self.pairs[:, 1]] - moved[self.pairs[:, 0]])).sum(axis=1)
        return apart + self.room

    def holds(self, forces: Floats, moved: Floats) -> bool:
        """True if with these forces nothing sinks in, and nothing is pushed that would not."""
        left = self.closed(moved)
        return bool((np.where(forces > 0.0, np.abs(left), -left) <= TOUCH * self.size).all())

    def better(self, forces: Floats, moved: Floats, h: float) -> Floats:
        """Forces (N) instead of those with which particles moved so in h seconds."""
        free = 0.5 * h * h
        without = moved - free * self._answer(forces)
        _, given = self._project(without, self.room, free * forces, self._tolerance)
        return given / free

    def _project(self, motion: Floats, bias: Floats, given: Floats, tolerance: float) -> tuple[Floats, Floats]:
        """The least change of a motion after which no pair closes faster than `bias`, and the impulses that make it.

        given: impulses to begin with. tolerance: rate at which pairs may close beyond that.
        """
        from systems.collision.columns import BIAS, GIVEN

        group, members = self._group, self._members
        moves = members < len(motion)
        group.motion[moves] = motion[members[moves]]
        group.contacts[:, BIAS], group.contacts[:, GIVEN] = bias, given
        kernels().push(len(members), len(bias), NO_IMPACT, tolerance, group)
        changed = motion.copy()
        changed[members[moves]] = group.motion[moves]
        return changed, group.contacts[:, GIVEN].copy()

    def _answer(self, impulses: Floats) -> Floats:
        """How impulses (N·s) in the pairs change the motion of the particles."""
        pushes = 1000.0 * support_forces(self.normal, self.pairs, impulses, self._near.count)
        answer: Floats = self._near.weight[: self._near.count] * pushes
        return answer
