"""Contacts: the forces between particles that stay in contact while other forces drive them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from components.model import Model
from components.paths import Paths, longest_step, resting
from components.snapshot import Snapshot
from systems.base import StopReason
from systems.broad_phase import Floats, Rows
from systems.collision.driven.compiled import kernels
from systems.collision.driven.impact import CROWD, CROWD_HEIGHT
from systems.collision.driven.neighbours import Vicinity
from systems.collision.system import Support, contacts_of, support_forces
from systems.program.program import Program

HELD = 1e-13  # of the smaller radius, within which particles in contact are kept
GIVES = 2e-11  # of how far forces move what they push: at least this much of it contacts may be off; see FIRM
HARDLY = 1e-11  # of the same, after a few tries: gaps in a row between walls hardly follow forces
FEW, MOST_TRIES = 3, 8  # tries of the forces in a step
CUT = 0.25  # of a step, which is taken instead where its forces are not found
MOST_CUTS = 12  # until forces no longer matter, and those of the step before are as good as any


class Contacts:
    """Takes steps in which particles in lasting contact push each other so that they touch at the end."""

    def __init__(self, model: Model, vicinity: Vicinity) -> None:
        self.model = model
        self._near = vicinity

    def step(
        self,
        program: Program,
        before: Snapshot,
        take: Callable[[float | None], StopReason],
        until: float | None,
    ) -> StopReason:
        """One step from a moment before, taken by `take`: a whole one, or up to a time (s); or less of it.

        Forces F ≥ 0, constant during the step and along the lines of centres at its start, are such that what they
        push apart is no farther apart at the end, and nothing is deeper in anything else. As distances are convex,
        such forces do no work, whatever they are: of contacts that depend on one another, many are possible. A step
        in which none are found is cut, and the next ones are short at first.
        """
        contacts = contacts_of(self.model)
        if contacts is None:
            push(program, self.model, 0.0)
            return take(until)
        clock, start = self.model.clock, float(before.columns["clock.time"][0])
        longest = longest_step(contacts)
        if longest < clock.step_size:
            until = start + longest if until is None else min(until, start + longest)
        reason, found = self._try(program, before, take, until, contacts)
        cuts = 0
        while not found:
            cuts, longest = cuts + 1, CUT * (clock.time - start)
            before.restore(self.model)
            reason, found = self._try(
                program, before, take, start + longest, contacts, anyhow=cuts == MOST_CUTS
            )
        if clock.time - start > 0.5 * longest:
            longest *= 2.0
        if longest < clock.step_size and clock.paths is not None:
            lasting = resting(clock.paths.contacts, clock.paths.forces, longest)
            self.model.writable("clock.paths")[0] = lasting
        return reason

    def _try(
        self,
        program: Program,
        before: Snapshot,
        take: Callable[[float | None], StopReason],
        until: float | None,
        contacts: Paths,
        *,
        anyhow: bool = False,
    ) -> tuple[StopReason, bool]:
        """Such a step, and True if its forces were found; those of the step before are good enough `anyhow`.

        All tries end at the same time: where the error is controlled, other forces would choose another step, and gaps
        would jump with it.
        """
        pairs, forces, near = contacts.contacts, contacts.forces, self._near
        least, normal = near.gaps(pairs, before.columns["particles.displacement"])
        least, size = np.minimum(least, 0.0), near.size[pairs].min(axis=1)
        search = _Search(near, pairs, normal)
        for turn in range(MOST_TRIES):
            if turn > 0:
                before.restore(self.model)
            note_energy(self.model, float((forces * size).sum()))
            push(program, self.model, support_forces(normal, pairs, forces, self.model.particles.count))
            reason = take(until)
            h = float(self.model.clock.time - before.columns["clock.time"][0])
            if h == 0.0 or reason is StopReason.DIVERGED:
                return reason, turn == 0  # the fault is not that of forces that were tried
            if program.integrator.controlled:
                until = self.model.clock.time
            gap, last = near.gaps(pairs, near.displacement)
            gap -= least
            allowed = (HELD if turn < FEW else HARDLY) * size + search.give(forces)
            if anyhow or (np.where(forces > 0.0, np.abs(gap), -gap) <= allowed).all():
                self._note(pairs, forces, gap, gap + h * near.rates(pairs, last), size)
                return reason, True
            better = search.better(forces, gap, last, h, allowed)
            if np.array_equal(better, forces):
                break
            forces = better
        return reason, False

    def _note(self, pairs: Rows, forces: Floats, gap: Floats, later: Floats, size: Floats) -> None:
        """Which contacts last: those that push or touch; in a crowd also those that are hardly open now and later."""
        lasts = (forces > 0.0) | (gap <= HELD * size)
        if len(pairs) >= CROWD:
            lasts |= np.maximum(gap, later) <= CROWD_HEIGHT * size
        self.model.writable("clock.paths")[0] = resting(pairs[lasts], forces[lasts])


class _Search:
    """Forces in contacts that close the gaps that push, sought by Newton's method.

    Its slope is h²/2 N₁ᵀ M⁻¹ N₀, as of free particles, N₀ and N₁ being the lines of centres at the start and at the end
    of the step, and what Broyden's method learns of the rods. Where that leaves no forces it is h²/2 N₀ᵀ M⁻¹ N₀ from
    then on, for which there always are some.
    """

    def __init__(self, near: Vicinity, pairs: Rows, normal: Floats) -> None:
        self._near, self._pairs, self._normal = near, pairs, normal
        self._slope, self._learnt = np.zeros((2, len(pairs), len(pairs)))
        self._tried: tuple[Floats, Floats] | None = None
        self._is_regular = True

    def give(self, forces: Floats) -> Floats:
        """By how much (m) gaps may be off with these forces."""
        allowed: Floats = GIVES * (np.abs(self._slope) @ forces)
        return allowed

    def better(self, forces: Floats, gap: Floats, last: Floats, h: float, allowed: Floats) -> Floats:
        """What to try after forces that left these gaps and lines of centres at the end of a step of h seconds."""
        if self._tried is not None:
            moved = forces - self._tried[0]
            missed = gap - self._tried[1] - self._slope @ moved
            missed[np.abs(missed) <= allowed] = 0.0
            self._learnt += np.outer(missed, moved) / float(moved @ moved)
        self._tried = forces, gap
        free, near = 0.5 * h * h, self._near
        if self._is_regular:
            self._slope = free * near.compliance(self._pairs, last, self._normal) + self._learnt
            found, self._is_regular = complementary(self._slope, gap, forces)
        if not self._is_regular:
            self._slope = free * near.compliance(self._pairs, self._normal, self._normal)
            found, _ = complementary(self._slope, gap, forces)
        return found


def note_energy(model: Model, energy: float) -> None:
    """Energies (J) are small or large beside what forces in contact would do along the radii of what they hold.

    What begins in contact is supplied none, and would be told neither to rest nor from what appears from nowhere.
    """
    if energy > model.clock.energy_scale:
        model.writable("clock.energy_scale")[0] = energy


def push(program: Program, model: Model, force: Floats | float) -> None:
    """Push the particles by these forces (kN) in the next step."""
    for system in program.systems:
        if isinstance(system, Support):
            system.push(model, force)


def complementary(slope: Floats, gap: Floats, forces: Floats) -> tuple[Floats, bool]:
    """Forces that leave gaps ≥ 0, where gaps follow forces by `slope`; False if they are none.

    See systems/collision/kernels/complementarity.py.
    """
    count = len(gap)
    found, scale, offset = np.empty((3, count))
    sides, wrong = np.empty((2, count), dtype=np.int64)
    room = found, np.empty((count, count + 1)), scale, offset, sides, wrong
    return found, bool(kernels().forces(slope, gap, forces, *room))
