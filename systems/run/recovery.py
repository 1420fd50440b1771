"""Recovery: the last good state of a run, and the ways to go on from it when the steps failed."""

from __future__ import annotations

from functools import partial

import numpy as np

from pinjoint.components import written
from pinjoint.components.field import same
from pinjoint.components.language import joined, tr
from pinjoint.components.model import Model
from pinjoint.components.snapshot import Snapshot
from pinjoint.systems.base import REVIEW_INTERVAL, StopReason
from pinjoint.systems.program.faults import blame_mod
from pinjoint.systems.program.program import MOTION, TURNING, Program
from pinjoint.systems.run.programs import Programs
from pinjoint.systems.run.sleep import Sleep
from pinjoint.systems.run.step_size import StepSize

FAILURES = (StopReason.DIVERGED, StopReason.UNRESOLVED, StopReason.FAILED)
_MOST_HALVINGS = 6  # of an automatic step before a run is given up


class Recovery:
    """Keeps the last good state of one model's run. safe: that state, or None."""

    def __init__(self, model: Model, programs: Programs, sleep: Sleep, step_size: StepSize) -> None:
        self._model = model
        self._programs = programs
        self._sleep = sleep
        self._step_size = step_size
        self.forget()

    def forget(self) -> None:
        """The state was replaced."""
        self.safe: Snapshot | None = None
        self._halvings = 0

    def keep(self, state: Snapshot) -> bool:
        """A review found this state good; False if nothing moved since the last one.

        Far from where a rod was drawn, a creep may be lost in rounding.
        """
        before, self.safe, self._halvings = self.safe, state, 0
        moving = *MOTION, *TURNING, "rods.plastic_strain", "rods.plastic_rotation"
        return before is None or not all(same(before.columns[name], state.columns[name]) for name in moving)

    def without_mod(self, reason: StopReason) -> bool:
        """Switch off the mod without which the steps lead on, and return to the good state; False if there is none.

        A mod is to blame for errors, for numbers that are not finite, and for steps that lead to none, but for no other
        ones that diverged: the steps are tried again without one mod after the other. Whoever interrupts that finds the
        good state, too.
        """
        assert self.safe is not None
        program, present = self._programs.compiled, Snapshot.take(self._model)
        if reason is StopReason.DIVERGED and _is_finite(program):
            return False
        steps = self._model.clock.steps - int(self.safe.columns["clock.steps"][0]) + 1
        found = program.failure is not None and blame_mod(program.failure)
        try:
            problem = tr("The run leads to numbers that are not finite.")
            found = found or self._programs.blame_by_leaving_out(partial(self._lead_on, steps), problem)
        finally:
            self.safe.restore(self._model)
        if not found:
            present.restore(self._model)
        return found

    def _lead_on(self, steps: int) -> bool:
        """Whether so many steps from the good state, as the plan now is, have finite results."""
        assert self.safe is not None
        self.safe.restore(self._model)
        program = self._programs.dynamics
        if not isinstance(program, Program):
            return True
        self._step_size.begin(self._step_size.first())
        _, reason = program.advance(steps)
        return reason not in FAILURES and _is_finite(program)

    def with_shorter_steps(self) -> bool:
        """Return to the good state and halve an automatic step, which proved too long as the geometry changed.

        False if the step is not automatic, or was halved _MOST_HALVINGS times already.
        """
        chosen = self._model.settings.time_step is not None or self._programs.integrator.estimates_error
        if chosen or self._halvings == _MOST_HALVINGS:
            return False
        assert self.safe is not None
        size = self._model.clock.step_size
        self.safe.restore(self._model)
        self._sleep.forget()
        self._step_size.begin(0.5 * size)
        self._halvings += 1
        return True

    def give_up(self, message: str) -> str:
        """Return to the good state for good; says what happened, by a message with {time}, and what helps."""
        failed, size = self._model.clock.time, self._model.clock.step_size
        assert self.safe is not None
        self.safe.restore(self._model)
        what = tr(message, time=written.time(failed), steps=REVIEW_INTERVAL)
        kept = tr("The last good state, at t = {time}, was kept.", time=written.time(self._model.clock.time))
        return joined([what, self._step_size.remedy(size), kept, self._acting_mods()])

    def _acting_mods(self) -> str:
        """The sentence that names the laws of mods in the run that was given up, which may be the cause."""
        laws = [law.name for law in self._programs.plan if law.kernel and law.mod and not law.mod.included]
        if not laws:
            return ""
        return tr(
            "Laws of mods act in the model: {laws}; see whether it runs without them.", laws=", ".join(laws)
        )


def _is_finite(program: Program) -> bool:
    numbers = (program.model.column(name) for name in (*MOTION, *TURNING))
    return all(bool(np.isfinite(some).all()) for some in (*numbers, program.measures))
