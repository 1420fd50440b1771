"""Worker: computes variants of a plan in one process, together where that is possible, else one by one."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

from game.sweeps.batches import Batches
from game.sweeps.plan import Outcome, Plan, Record
from game.sweeps.specimen import Specimen


class Worker:
    """Computes variants of a plan in this process: together where that is possible, else one by one.

    Raises SweepError if this installation is not that of the plan.
    """

    def __init__(self, plan: Plan, threads: int = 1) -> None:
        plan.installation.require()
        self._plan = plan
        self._specimen: Specimen | None = None
        self._batches: Batches | None = None
        with suppress(Exception):  # the first variant says what is wrong
            self._batches = Batches(Specimen(plan), plan, threads)

    @property
    def at_a_time(self) -> int:
        """How many variants are computed together; 1: none."""
        return self._batches.size if self._batches is not None else 1

    def compute(self, numbers: Sequence[int]) -> list[Outcome]:
        """Compute some variants; one that cannot be computed is a record that says why."""
        together = self.together(numbers) if len(numbers) > 1 else {}
        return [(n, together[n]) if n in together else self._alone(n) for n in numbers]

    def together(self, numbers: Sequence[int]) -> dict[int, list[Record]]:
        """What variants come to, of those that can be computed together."""
        return self._batches.records(numbers) if self._batches is not None else {}

    def _alone(self, number: int) -> Outcome:
        try:
            self._specimen = self._specimen or Specimen(self._plan)
            return number, self._specimen.records(number)
        except Exception as error:  # one bad variant of thousands must not end the others
            self._specimen = None
            known = isinstance(error, ValueError)
            return self._plan.failure(number, str(error) if known else f"{type(error).__name__}: {error}")


def compute(plan: Plan, numbers: Sequence[int]) -> list[Outcome]:
    """Compute some variants of a plan, here and by this thread; see Worker.compute."""
    return Worker(plan).compute(numbers)
