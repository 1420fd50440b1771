"""Recovery: the last good state of a run, and the ways to go on from it when the steps failed."""

from __future__ import annotations

from pinjoint.components import written
from pinjoint.components.field import same
from pinjoint.components.language import joined, tr
from pinjoint.components.model import Model
from pinjoint.components.snapshot import Snapshot
from pinjoint.systems.base import REVIEW_INTERVAL
from pinjoint.systems.program.culprit import find_culprit
from pinjoint.systems.program.program import MOTION, TURNING
from pinjoint.systems.run.programs import Programs
from pinjoint.systems.run.sleep import Sleep
from pinjoint.systems.run.step_size import StepSize

MOST_HALVINGS = 6  # of an automatic step before a run is given up

MOVING = *MOTION, *TURNING, "rods.plastic_strain"


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
        return before is None or not all(same(before.columns[name], state.columns[name]) for name in MOVING)

    def without_mod(self) -> bool:
        """Switch off the mod whose numbers were not finite, and return to the good state; False if no mod is to blame.

        Whoever interrupts the search finds the good state, too, and not numbers that are blamed on an element.
        """
        assert self.safe is not None
        try:
            if find_culprit(self._programs.compiled, self.safe) is None:
                return False
        except BaseException:
            self._programs.return_to(self.safe)
            raise
        self._programs.return_to(self.safe)
        return True

    def with_shorter_steps(self) -> bool:
        """Return to the good state and halve an automatic step, which proved too long as the geometry changed.

        False if the step is not automatic, or was halved MOST_HALVINGS times already.
        """
        chosen = self._model.settings.time_step is not None or self._programs.integrator.estimates_error
        if chosen or self._halvings == MOST_HALVINGS:
            return False
        assert self.safe is not None
        size = self._model.clock.step_size
        self._programs.return_to(self.safe)
        self._sleep.forget()
        self._step_size.begin(0.5 * size)
        self._halvings += 1
        return True

    def give_up(self, message: str) -> str:
        """Return to the good state for good; says what happened, by a message with {time}, and what helps."""
        failed, size = self._model.clock.time, self._model.clock.step_size
        assert self.safe is not None
        self._programs.return_to(self.safe)
        what = tr(message, time=written.time(failed), steps=REVIEW_INTERVAL)
        kept = tr("The last good state, at t = {time}, was kept.", time=written.time(self._model.clock.time))
        return joined([what, self._step_size.remedy(size), kept, self._acting_mods()])

    def _acting_mods(self) -> str:
        """The sentence that names the laws of mods in the run that was given up, which may be the cause."""
        laws = [law.name for law in self._programs.plan if law.kernel and law.mod is not None]
        if not laws:
            return ""
        return tr(
            "Laws of mods act in the model: {laws}; see whether it runs without them.", laws=", ".join(laws)
        )
