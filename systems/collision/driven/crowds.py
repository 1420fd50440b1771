"""Crowds: driven particles, no nodes of structures, of which so many touch that single impacts no longer pay.

When the next step is one of a crowd, the kernels say (kernels/crowd.py).
"""

from __future__ import annotations

import numpy as np

from components.collision_state import PersistentContacts
from components.model import Model
from systems.base import StopReason
from systems.broad_phase import Floats, Rows
from systems.collision.columns import SHORTEST_SHARE, TRAVEL, Contact, Group
from systems.collision.driven.columns import Real
from systems.collision.driven.compiled import kernels
from systems.collision.driven.kernels.contacts import SETTLING_HEIGHT
from systems.collision.driven.neighbours import NeighbourList
from systems.collision.driven.trial import Land, TrialStep
from systems.collision.impacts import Impacts
from systems.collision.system import persistent_contacts, support_forces
from systems.program.program import Program

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

    def __init__(self, model: Model, neighbours: NeighbourList, impacts: Impacts, land: Land) -> None:
        self.model = model
        self._neighbours = neighbours
        self._record = impacts
        self._land = land

    def _problem(self) -> ContactProblem:
        """The contacts and impacts of the next whole step, of pairs that the list holds."""
        near, driven = self._neighbours, self._neighbours.driven
        longest = min(self.model.clock.step_size, float(driven.real[Real.CROWD_STEP]))
        fastest = float(np.hypot(*near.velocity[driven.loose].T).max())
        travel = longest * (2.0 * fastest + longest * float(driven.real[Real.STRONGEST]))
        gap, normal = near.gaps(near.pairs, near.displacement)
        close = np.flatnonzero(gap <= 2.0 * travel)
        problem = ContactProblem(near, near.pairs[close], gap[close], normal[close])
        problem.choose_length(longest)
        return problem

    def step(self, program: Program, until: float, *, landing: bool) -> StopReason:
        """Take a step of the crowd; none where it would end after `until` (s), or (landing) its part up to then."""
        clock, near = self.model.clock, self._neighbours
        if clock.step_size > program.longest_in_contact:
            self.model.writable("clock.step_size")[0] = program.longest_in_contact
        if persistent_contacts(self.model) is None:
            none = PersistentContacts(np.zeros((0, 2), dtype=np.int64), np.zeros(0))
            self.model.writable("clock.collision_state")[0] = none
        trial, problem = TrialStep(self.model, program, until, self._land), self._problem()
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
            self._raise_energy_scale(float((forces * problem.size).sum()))
            program.push(support_forces(problem.normal, problem.pairs, forces, near.count))
            reason = trial.take(end)
            if clock.time == trial.start or reason is StopReason.DIVERGED:
                trial.take_back()
                return reason
            if trial.program.integrator.controlled:
                end = clock.time
            if problem.holds(forces, near.displacement - origin):
                break
        work = float(forces @ (problem.closed(near.displacement - origin) - problem.room))
        self.model.writable("clock.work")[0] = clock.work + work
        self.model.writable("clock.dissipated_impact")[0] = clock.dissipated_impact + loss
        self._enter(problem.pairs, problem.normal, impulses, loss, trial.start, origin)
        gap, _ = near.gaps(problem.pairs, near.displacement)
        persists = (forces > 0.0) | (gap <= SETTLING_HEIGHT * problem.size)
        kept = PersistentContacts(problem.pairs[persists], forces[persists])
        self.model.writable("clock.collision_state")[0] = kept
        return reason

    def _raise_energy_scale(self, energy: float) -> None:
        """As try_forces() in kernels/contacts.py does."""
        if energy > self.model.clock.energy_scale:
            self.model.writable("clock.energy_scale")[0] = energy

    def _enter(
        self, pairs: Rows, normal: Floats, impulse: Floats, loss: float, time: float, displacement: Floats
    ) -> None:
        """Enter the impacts of pairs with an impulse (N·s) at a time (s) and these displacements, and their loss (J)."""
        struck, clock, driven = impulse > 0.0, self.model.clock, self._neighbours.driven
        pairs, impulse = pairs[struck], impulse[struck]
        place = driven.position + self._neighbours.everywhere(displacement)
        point = place[pairs[:, 0]] + normal[struck] * driven.radius[pairs[:, 0]][:, None]
        share = loss * impulse / impulse.sum()
        self._record.record(np.column_stack((np.full(len(pairs), time), pairs, impulse, share, point)))
        self.model.writable("clock.collisions")[0] = clock.collisions + len(pairs)


class ContactProblem:
    """The contacts and impacts of a crowd in one step.

    h: length of the step, s. pairs, normal, room, size: the pairs, their unit vectors, gaps (at least 0, m) and smaller
    radii (m).
    """

    def __init__(self, near: NeighbourList, pairs: Rows, gap: Floats, normal: Floats) -> None:
        driven = near.driven
        self._neighbours = near
        self.pairs, self.normal = pairs, normal
        self.room: Floats = np.maximum(gap, 0.0)
        self.size: Floats = driven.size[pairs].min(axis=1)
        self._pull: Floats = near.everywhere(driven.pull)[pairs].max(axis=1)
        self._restitution: Floats = driven.restitution[pairs[:, 1]]
        self._rate = near.rates(pairs, normal)
        self._tolerance = 0.1 * DEEPEST_OVERLAP * float(self.size.min(initial=np.inf))
        self._group, self._members = _group_of(near, pairs, normal)

    def choose_length(self, longest: float) -> None:
        """Choose a length (s) in which no two particles that are about to meet travel far relative to one another."""
        travel = TRAVEL * self.size
        fast = -self._rate * longest > np.maximum(travel, self.room)
        h = float((travel[fast] / -self._rate[fast]).min(initial=longest))
        self.h = max(h, SHORTEST_SHARE * longest)
        self._meets = self.room + self.h * self._rate < 0.0

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
            pairs, count = self.pairs, len(self._neighbours.driven.position)
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
        answer: Floats = self._neighbours.driven.weight[: self._neighbours.count] * pushes
        return answer


def _group_of(near: NeighbourList, pairs: Rows, normal: Floats) -> tuple[Group, Rows]:
    """The group of pairs with these unit vectors, in contact, and the particle or obstacle that each member is."""
    members, links = np.unique(pairs, return_inverse=True)
    group = Group.empty(len(members), len(pairs))
    group.links[...] = links.reshape(-1, 2)
    group.contacts[:, [Contact.NX, Contact.NY]] = normal
    group.mobility[...] = near.driven.weight[members]
    return group, members
