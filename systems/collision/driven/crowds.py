"""Crowds: driven particles, no nodes of structures, of which so many touch that single impacts no longer pay."""

from __future__ import annotations

import numpy as np

from components.collision_state import PersistentContacts
from components.model import Model
from systems.base import StopReason
from systems.broad_phase import Floats, Rows
from systems.collision.columns import SHORTEST_SHARE, STEP_SHARE, TRAVEL, Contact
from systems.collision.driven.compiled import kernels
from systems.collision.driven.contacts import apply_contact_forces, raise_energy_scale
from systems.collision.driven.impact import SETTLING_HEIGHT, ImpactResolver, group_of
from systems.collision.driven.neighbours import NeighbourList
from systems.collision.driven.trial import TrialStep
from systems.collision.system import persistent_contacts, support_forces

CROWD_CONTACTS = 24  # persistent contacts and impacts in the next step, from which on particles are a crowd
CROWD_PARTICLES = 8  # particles that are no nodes, below which they are no crowd
DEEPEST_OVERLAP = 1e-12  # of a radius, by which particles may sink into others in a step
NO_IMPACT = -1.0  # as the restitution of contacts that are only held apart
ROUND_OFF = 1e-14  # of an energy
MOST_FORCE_TRIES = 4  # of the forces in a step


class CrowdStepper:
    """Takes steps at whose start all impacts happen, and in which particles that would sink in push each other.

    Impacts and forces are projections, of the velocities and of the displacements in the step: the least change after
    which no pair closes by more than its gap along the line of centres at the start. Distances are convex, so that no
    particle sinks in; no force does work; and no impact supplies energy.
    """

    def __init__(self, model: Model, neighbours: NeighbourList, impacts: ImpactResolver) -> None:
        self.model = model
        self._neighbours = neighbours
        self._impacts = impacts

    def problem(self) -> ContactProblem | None:
        """The contacts and impacts of the next whole step if the particles are a crowd.

        They are none where nodes of a structure are near, since a structure answers to forces in its own way.
        """
        near, clock, particles = self._neighbours, self.model.clock, self.model.particles
        if near.loose < CROWD_PARTICLES:
            return None
        pull = np.hypot(*(particles.mobility * particles.constant_force).T)
        pulled, longest = pull > 0.0, clock.step_size
        if pulled.any():
            fall = np.sqrt(4.0 * particles.radius[pulled] / pull[pulled])
            longest = min(longest, STEP_SHARE * float(np.median(fall)))
        travel = longest * (2.0 * float(np.hypot(*particles.velocity.T).max()) + longest * float(pull.max()))
        near.list_within(travel)
        if len(near.pairs) < CROWD_CONTACTS:
            return None
        gap, normal = near.gaps(near.pairs, near.displacement)
        close = np.flatnonzero(gap <= 2.0 * travel)
        problem = ContactProblem(near, near.pairs[close], gap[close], normal[close], near.everywhere(pull))
        problem.choose_length(longest)
        persistent = persistent_contacts(self.model)
        number = problem.impacts_to_come + (0 if persistent is None else len(persistent.pairs))
        return problem if number >= CROWD_CONTACTS and not near.are_nodes(problem.pairs).any() else None

    def step(self, problem: ContactProblem, trial: TrialStep, landing: bool) -> StopReason:
        """Take a step of the crowd; none where it would end after `trial.until`, or (landing) its part up to then."""
        clock, near = self.model.clock, self._neighbours
        whole = not landing and problem.h == clock.step_size
        end = None if whole else trial.start + problem.h
        if end is not None and landing:
            end = min(end, trial.until)
        if end is not None and end > trial.until:
            return StopReason.DONE
        origin = trial.before.columns["particles.displacement"]
        velocity, impulses = problem.impacts()
        loss = problem.energy(near.velocity) - problem.energy(velocity)
        forces = problem.known(persistent_contacts(self.model))
        for turn in range(MOST_FORCE_TRIES):
            if turn > 0:
                forces = problem.better(forces, near.displacement - origin, clock.time - trial.start)
                trial.take_back()
            self.model.writable("particles.velocity")[...] = velocity
            raise_energy_scale(self.model, float((forces * problem.size).sum()))
            push = support_forces(problem.normal, problem.pairs, forces, near.count)
            apply_contact_forces(trial.program, self.model, push)
            reason = trial.take(end)
            if clock.time == trial.start or reason is StopReason.DIVERGED:
                trial.take_back()
                return reason
            if trial.program.integrator.controlled:
                end = clock.time
            if problem.holds(forces, near.displacement - origin):
                break
        self.model.writable("clock.dissipated_impact")[0] = clock.dissipated_impact + loss
        self._impacts.record(problem.pairs, problem.normal, impulses, loss, trial.start, origin)
        gap, _ = near.gaps(problem.pairs, near.displacement)
        persists = (forces > 0.0) | (gap <= SETTLING_HEIGHT * problem.size)
        kept = PersistentContacts(problem.pairs[persists], forces[persists])
        self.model.writable("clock.collision_state")[0] = kept
        return reason


class ContactProblem:
    """The contacts and impacts of a crowd in one step.

    h: length of the step, s. impacts_to_come: number of pairs that would meet in it, without those that lose no energy.
    pairs, normal, room, size: the pairs, their unit vectors, gaps (at least 0, m) and smaller radii (m).
    """

    def __init__(self, near: NeighbourList, pairs: Rows, gap: Floats, normal: Floats, pull: Floats) -> None:
        self._neighbours = near
        self.pairs, self.normal = pairs, normal
        self.room: Floats = np.maximum(gap, 0.0)
        self.size: Floats = near.size[pairs].min(axis=1)
        self._pull: Floats = pull[pairs].max(axis=1)
        self._restitution: Floats = near.restitution[pairs[:, 1]]
        self._rate = near.rates(pairs, normal)
        self._tolerance = 0.1 * DEEPEST_OVERLAP * float(self.size.min(initial=np.inf))
        self._group, self._members = group_of(near, pairs, normal)

    def choose_length(self, longest: float) -> None:
        """Choose a length (s) in which no two particles that are about to meet travel far relative to one another."""
        travel = TRAVEL * self.size
        fast = -self._rate * longest > np.maximum(travel, self.room)
        h = float((travel[fast] / -self._rate[fast]).min(initial=longest))
        self.h = max(h, SHORTEST_SHARE * longest)
        self._meets = self.room + self.h * self._rate < 0.0
        self.impacts_to_come = np.count_nonzero(self._meets & (self._restitution < 1.0))

    def impacts(self) -> tuple[Floats, Floats]:
        """Velocities of the particles after the impacts, and impulses (N·s) of the pairs that bounce.

        Poisson's law: e times the impulse of the plastic impact is added where two particles approach faster than two
        steps of free fall make them, and would rise more than SETTLING_HEIGHT.
        """
        near, h = self._neighbours, self.h
        slow = np.maximum(2.0 * h * self._pull, np.sqrt(2.0 * self._pull * SETTLING_HEIGHT * self.size))
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
        particles = self._neighbours.model.particles
        return 0.5 * float((particles.mass[:, None] * velocity * velocity).sum())

    def known(self, contacts: PersistentContacts | None) -> Floats:
        """Forces (N) in the pairs, as persistent contacts had them in the step before."""
        forces = np.zeros(len(self.size))
        if contacts is not None:
            pairs, count = self.pairs, len(self._neighbours.position)
            keys, sought = pairs @ [count, 1], contacts.pairs @ [count, 1]
            places = np.minimum(np.searchsorted(keys, sought), len(keys) - 1)
            there = keys[places] == sought
            forces[places[there]] = contacts.forces[there]
        return forces

    def closed(self, moved: Floats) -> Floats:
        """Gaps (m) along the lines of centres at the start, after particles moved so (m)."""
        moved = self._neighbours.everywhere(moved)
        apart: Floats = (self.normal * (moved[self.pairs[:, 1]] - moved[self.pairs[:, 0]])).sum(axis=1)
        return apart + self.room

    def holds(self, forces: Floats, moved: Floats) -> bool:
        """True if with these forces no particle sinks into another, and none is pushed away from another."""
        left = self.closed(moved)
        return bool((np.where(forces > 0.0, np.abs(left), -left) <= DEEPEST_OVERLAP * self.size).all())

    def better(self, forces: Floats, moved: Floats, h: float) -> Floats:
        """The next forces (N) after some with which particles moved so (m) in h seconds."""
        free = 0.5 * h * h
        without = moved - free * self._answer(forces)
        _, impulses = self._project(without, self.room, free * forces, self._tolerance)
        return impulses / free

    def _project(self, motion: Floats, bias: Floats, first: Floats, tolerance: float) -> tuple[Floats, Floats]:
        """The motion after the least change after which no pair closes faster than `bias`, and the impulses of it.

        first: impulses to begin with. tolerance: rate at which pairs may close beyond that.
        """

        group, members = self._group, self._members
        moves = members < len(motion)
        group.motion[moves] = motion[members[moves]]
        group.contacts[:, Contact.BIAS], group.contacts[:, Contact.IMPULSE] = bias, first
        kernels().resolve(len(members), len(bias), NO_IMPACT, tolerance, group)
        changed = motion.copy()
        changed[members[moves]] = group.motion[moves]
        return changed, group.contacts[:, Contact.IMPULSE].copy()

    def _answer(self, impulses: Floats) -> Floats:
        """Change of the motion of the particles by impulses (N·s) in the pairs."""
        pushes = 1000.0 * support_forces(self.normal, self.pairs, impulses, self._neighbours.count)
        answer: Floats = self._neighbours.weight[: self._neighbours.count] * pushes
        return answer
