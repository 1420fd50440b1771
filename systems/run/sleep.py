"""Sleep: islands at rest are left out of the steps until something reaches them.

An island falls asleep where a run is reviewed, which is at fixed step counts and after edits, if it is at rest by
itself and no load on it still varies. Its particles keep their places and have no velocity; what was left of their
kinetic energy is dissipated. It wakes when an edit disturbs its rest, when something strikes it, and when forces
appear that depend on more than the state: a pulling hand, persistent contacts.
"""

from __future__ import annotations

import sys

import numpy as np

from pinjoint.components.arrays import Array, Flags, Rows
from pinjoint.components.field import Role
from pinjoint.components.load import load_ends
from pinjoint.components.model import Model
from pinjoint.systems.collision.system import persistent_contacts
from pinjoint.systems.islands import IMMOVABLE, islands
from pinjoint.systems.physics.rest import RestMeasure
from pinjoint.systems.program.entries import ASLEEP
from pinjoint.systems.program.program import Program
from pinjoint.systems.program.reordered import ReorderedProgram
from pinjoint.systems.run.programs import Dynamics

# Steps between reviews of islands; fewer: asleep sooner, but a review costs as much as ten steps.
INTERVAL = 1024


class Sleep:
    """Which particles of one model are asleep, and the step programs of those that are not."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self._asked: tuple[Dynamics, int] | None = None
        self._versions: tuple[int, int] | None = None
        self._looked_at = -1  # the version of particles.asleep for which any_asleep was determined
        self._parts: dict[Program, ReorderedProgram] = {}
        self._bound: ReorderedProgram | None = None  # to the model as it is
        self._left_out: Flags = np.zeros(0, dtype=bool)  # asleep when it was bound

    # --- who may sleep, and who does -------------------------------------------------------------------

    def may_happen(self, program: Dynamics) -> bool:
        """True if islands may sleep under this program, there is more than one, and no contact persists."""
        asked = program, self.model.newest(Role.DOCUMENT)
        if asked != self._asked:
            self._asked = asked
            self._answer = self.model.settings.sleeping and program.follows_state and not program.watches_events
            if self._answer:
                self._look_up()
                self._answer = self._count > 1
        return self._answer and persistent_contacts(self.model) is None

    @property
    def any_asleep(self) -> bool:
        """True if any particle is asleep."""
        version = self.model.particles.version("asleep")
        if version != self._looked_at:
            asleep = self.model.particles.storage("asleep")
            self._looked_at, self._any_asleep = version, bool(np.count_nonzero(asleep))
        return self._any_asleep

    def steps_to_review(self, program: Dynamics) -> int:
        """Number of steps until the islands are reviewed again."""
        if not self.may_happen(program):
            return sys.maxsize
        return INTERVAL - self.model.clock.steps % INTERVAL

    @property
    def is_due(self) -> bool:
        """True after so many steps that the islands are reviewed."""
        return self.model.clock.steps % INTERVAL == 0

    def _look_up(self) -> None:
        """Find the islands anew if supports or rods have changed."""
        model = self.model
        versions = model.particles.version("fixed"), model.rods.version("between")
        if versions != self._versions:
            self._versions = versions
            self._of_particle: Rows = islands(model)
            self._of_rod: Rows = self._of_particle[model.rods.between].max(axis=1, initial=IMMOVABLE)
            self._count = int(self._of_particle.max(initial=IMMOVABLE))

    def review(self, program: Dynamics) -> bool:
        """Put exactly the islands at rest to sleep; True if the set of sleeping particles changed."""
        if not self.may_happen(program):
            return self._wake()
        measure = self._observed(program)
        clock = self.model.clock
        rest = measure.at_rest(self._of_particle, self._of_rod, clock.force_scale, clock.energy_scale)
        rest[self._under_varying_loads] = rest[IMMOVABLE] = False
        return self._let_sleep(rest[self._of_particle], measure.kinetic)

    def disturb(self, program: Program) -> bool:
        """Wake the islands that something has struck, all if none may sleep any more; True if any woke."""
        if not self.may_happen(program):
            return self._wake()
        particles = self.model.particles
        struck = np.asarray(particles.asleep & particles.velocity.any(axis=1))
        return bool(struck.any()) and self._wake(struck)

    def _observed(self, program: Dynamics) -> RestMeasure:
        program.observe()
        return RestMeasure.of(self.model, program.unbalanced, program.unbalanced_moment)

    @property
    def _under_varying_loads(self) -> Rows:
        """The islands on which loads act that still vary."""
        varies = np.array(load_ends(self.model)) > self.model.clock.time
        return self._of_particle[self.model.loads.on[varies]]

    def _let_sleep(self, asleep: Flags, kinetic: Array) -> bool:
        """Let these particles sleep, and no others. kinetic: their energy (J), which they lose."""
        falling = asleep & ~self.model.particles.asleep
        if falling.any():
            self.model.writable("clock.dissipated_damping")[0] += kinetic[falling].sum()
            self.model.writable("particles.velocity")[falling] = 0.0
        return self._write(asleep)

    def _wake(self, particles: Flags | None = None) -> bool:
        """Wake the islands of these particles; none given: all."""
        still = np.zeros(self.model.particles.count, dtype=bool)
        if particles is not None:
            still = self.model.particles.asleep & ~np.isin(self._of_particle, self._of_particle[particles])
        return self._write(still)

    def _write(self, asleep: Flags) -> bool:
        if np.array_equal(asleep, self.model.particles.asleep):
            return False
        self.model.writable("particles.asleep")[...] = asleep
        return True

    # --- what takes the steps --------------------------------------------------------------------------

    def forget(self) -> None:
        """Release the bound part, since the document or particles.asleep was changed."""
        self._bound = None

    def part(self, program: Program) -> Program:
        """The program that takes the steps: the given one, or while islands sleep a program of the awake part."""
        if not self.any_asleep:
            return program
        asleep = self.model.particles.asleep
        part = self._parts.get(program)
        if self._bound is not part or part is None or not np.array_equal(self._left_out, asleep):
            part = self._bound = self._part_without(asleep, program)
            self._left_out = asleep.copy()
        return part

    def _part_without(self, asleep: Flags, program: Program) -> ReorderedProgram:
        """The program of those that are awake, bound to the model as it is."""
        moving = ~asleep & (self._of_particle != IMMOVABLE)
        part = self._parts.get(program)
        if part is None:
            part = ReorderedProgram(self.model, program.plan, program.integrator, program.form, moving)
            self._parts[program] = part
        else:
            part.move(moving)
        part.measures[ASLEEP] = self._observed(program).measures(self.model, *part.left_out)
        return part
