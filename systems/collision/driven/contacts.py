"""Contact forces of driven particles: between particles that stay in contact while an integrator moves them."""

from __future__ import annotations

import numpy as np

from components.collision_state import PersistentContacts
from components.model import Model
from systems.base import StopReason
from systems.broad_phase import Floats, Rows
from systems.collision.driven.compiled import kernels
from systems.collision.driven.impact import SETTLING_CONTACTS, SETTLING_HEIGHT
from systems.collision.driven.neighbours import NeighbourList
from systems.collision.driven.trial import TrialStep
from systems.collision.system import Support, persistent_contacts, support_forces
from systems.program.program import Program

CLOSED_GAP = 1e-13  # of the smaller radius: contacts with a smaller gap are closed
LOOSELY_CLOSED_GAP = 1e-11  # instead, after STRICT_TRIES: gaps in a row between walls hardly follow forces
COMPLIANCE_GAP = (
    2e-11  # of how far forces move particles: a gap that small is closed; see FIRM in complementarity.py
)
STRICT_TRIES, MOST_FORCE_TRIES = 3, 8  # tries of the forces in a step
STEP_CUT = 0.25  # of a step whose forces are not found: the length of the step taken instead
MOST_STEP_CUTS = 12  # after which forces no longer matter, and those of the step before are good enough


class ContactStepper:
    """Takes steps in which particles in persistent contact push each other so that they touch at the end."""

    def __init__(self, model: Model, neighbours: NeighbourList) -> None:
        self.model = model
        self._neighbours = neighbours

    def step(self, trial: TrialStep, end: float | None) -> StopReason:
        """Take a trial step: a whole one, one that ends at a time (s), or a shorter one.

        Forces F ≥ 0, constant during the step and along the lines of centres at its start, are such that the particles
        that they push apart are no farther apart at the end, and no particle is deeper in another. As distances are
        convex, such forces do no work, whichever they are: of contacts that depend on one another, many are possible. A
        step for which no forces are found is cut, and the next steps are short at first.
        """
        contacts = persistent_contacts(self.model)
        if contacts is None:
            apply_contact_forces(trial.program, self.model, 0.0)
            return trial.take(end)
        clock, longest = self.model.clock, contacts.longest_step
        if longest < clock.step_size:
            end = trial.start + longest if end is None else min(end, trial.start + longest)
        reason, found = self._try(trial, end, contacts)
        cuts = 0
        while not found:
            cuts, longest = cuts + 1, STEP_CUT * (clock.time - trial.start)
            trial.take_back()
            anyhow = cuts == MOST_STEP_CUTS
            reason, found = self._try(trial, trial.start + longest, contacts, anyhow=anyhow)
        if clock.time - trial.start > 0.5 * longest:
            longest *= 2.0
        if longest < clock.step_size and isinstance(clock.collision_state, PersistentContacts):
            kept = clock.collision_state
            shorter = PersistentContacts(kept.pairs, kept.forces, longest)
            self.model.writable("clock.collision_state")[0] = shorter
        return reason

    def _try(
        self, trial: TrialStep, end: float | None, contacts: PersistentContacts, *, anyhow: bool = False
    ) -> tuple[StopReason, bool]:
        """Take a trial step with contact forces: why it stopped, and True if forces were found. anyhow: accept the last.

        All tries end at the same time: where the error is controlled, other forces would choose another step, and gaps
        would jump with it.
        """
        pairs, forces, near = contacts.pairs, contacts.forces, self._neighbours
        least, normal = near.gaps(pairs, trial.before.columns["particles.displacement"])
        least, size = np.minimum(least, 0.0), near.size[pairs].min(axis=1)
        search = _ForceSearch(near, pairs, normal)
        for turn in range(MOST_FORCE_TRIES):
            if turn > 0:
                trial.take_back()
            raise_energy_scale(self.model, float((forces * size).sum()))
            push = support_forces(normal, pairs, forces, self.model.particles.count)
            apply_contact_forces(trial.program, self.model, push)
            reason = trial.take(end)
            h = float(self.model.clock.time - trial.start)
            if h == 0.0 or reason is StopReason.DIVERGED:
                return reason, turn == 0  # contact forces that were tried are not to blame
            if trial.program.integrator.controlled:
                end = self.model.clock.time
            gap, last = near.gaps(pairs, near.displacement)
            gap -= least
            closed = CLOSED_GAP if turn < STRICT_TRIES else LOOSELY_CLOSED_GAP
            allowed = closed * size + search.tolerance(forces)
            if anyhow or (np.where(forces > 0.0, np.abs(gap), -gap) <= allowed).all():
                self._keep(pairs, forces, gap, gap + h * near.rates(pairs, last), size)
                return reason, True
            better = search.better(forces, gap, last, h, allowed)
            if np.array_equal(better, forces):
                break
            forces = better
        return reason, False

    def _keep(self, pairs: Rows, forces: Floats, gap: Floats, later: Floats, size: Floats) -> None:
        """Keep the contacts that push or touch; among many, also those with a small gap now and a step later."""
        persists = (forces > 0.0) | (gap <= CLOSED_GAP * size)
        if len(pairs) >= SETTLING_CONTACTS:
            persists |= np.maximum(gap, later) <= SETTLING_HEIGHT * size
        kept = PersistentContacts(pairs[persists], forces[persists])
        self.model.writable("clock.collision_state")[0] = kept


class _ForceSearch:
    """Newton's method for the forces that close the gaps of the contacts that push.

    Its slope is h²/2 N₁ᵀ M⁻¹ N₀, that of free particles, with the lines of centres N₀ at the start and N₁ at the end of
    the step, plus what Broyden's method learns of the rods. Where no forces result, it is h²/2 N₀ᵀ M⁻¹ N₀ from
    then on, for which forces always exist.
    """

    def __init__(self, near: NeighbourList, pairs: Rows, normal: Floats) -> None:
        self._neighbours, self._pairs, self._normal = near, pairs, normal
        self._slope, self._learnt = np.zeros((2, len(pairs), len(pairs)))
        self._tried: tuple[Floats, Floats] | None = None
        self._is_regular = True

    def tolerance(self, forces: Floats) -> Floats:
        """Error of the gaps (m) that is allowed with these forces."""
        allowed: Floats = COMPLIANCE_GAP * (np.abs(self._slope) @ forces)
        return allowed

    def better(self, forces: Floats, gap: Floats, last: Floats, h: float, allowed: Floats) -> Floats:
        """The next forces after some that left these gaps and lines of centres at the end of a step of h seconds."""
        if self._tried is not None:
            moved = forces - self._tried[0]
            missed = gap - self._tried[1] - self._slope @ moved
            missed[np.abs(missed) <= allowed] = 0.0
            self._learnt += np.outer(missed, moved) / float(moved @ moved)
        self._tried = forces, gap
        free, near = 0.5 * h * h, self._neighbours
        if self._is_regular:
            self._slope = free * near.compliance(self._pairs, last, self._normal) + self._learnt
            found, self._is_regular = complementary(self._slope, gap, forces)
        if not self._is_regular:
            self._slope = free * near.compliance(self._pairs, self._normal, self._normal)
            found, _ = complementary(self._slope, gap, forces)
        return found


def raise_energy_scale(model: Model, energy: float) -> None:
    """Raise the energy scale of the checks for rest and divergence to at least the work (J) of contact forces along radii.

    A model that begins in contact is supplied no energy otherwise: it would never be found at rest, and any round-off
    would count as divergence.
    """
    if energy > model.clock.energy_scale:
        model.writable("clock.energy_scale")[0] = energy


def apply_contact_forces(program: Program, model: Model, force: Floats | float) -> None:
    """Push the particles by these forces (kN) in the next step."""
    for system in program.systems:
        if isinstance(system, Support):
            system.push(model, force)


def complementary(slope: Floats, gap: Floats, forces: Floats) -> tuple[Floats, bool]:
    """Forces that leave gaps ≥ 0, where gaps follow forces by `slope`; False if none are found.

    See systems/collision/kernels/complementarity.py.
    """
    count = len(gap)
    found, scale, offset = np.empty((3, count))
    sides, wrong = np.empty((2, count), dtype=np.int64)
    work = found, np.empty((count, count + 1)), scale, offset, sides, wrong
    return found, bool(kernels().forces(slope, gap, forces, *work))
