"""Specimen: the model of a sweep in this process, brought back to its beginning after each variant."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress

from components.snapshot import Snapshot
from game import models
from game.catalogue import step_systems
from game.overrides import apply_override
from game.registry import SYSTEMS
from game.schedule import Schedule
from game.simulation import Simulation
from game.sweeps.batches import Batches
from game.sweeps.plan import Outcome, Plan, Record
from systems.base import StepSystem


def compute(plan: Plan, numbers: Sequence[int]) -> list[Outcome]:
    """Compute some variants of a plan, here and by this thread; see Bench.compute."""
    return Bench(plan).compute(numbers)


class Bench:
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


class Specimen:
    """One model for many variants: opening one and loading its step program takes longer than most runs.

    A variant is edited and run inside a transaction that is taken back: commands have exact inverses, and
    all that time changes is in the snapshot, so that the next one begins with the same bits as the first.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self.model = models.parse(plan.document)
        systems = [*step_systems(), *(make() for make in SYSTEMS)]
        self.step_systems = [system for system in systems if isinstance(system, StepSystem)]
        self.simulation = Simulation(self.model, Schedule(systems))
        self._beginning = Snapshot.take(self.model)

    def records(self, number: int) -> list[Record]:
        """What a variant comes to, a record of each state. Raises what its overrides or its run raise."""
        with self.taken_back():
            self.override(self._plan.overrides_of(number))
            run = self._plan.analysis.run(self.simulation, self._plan.name)
        about = run["status"], run["message"]
        return [
            (
                *about,
                state["time"],
                state["load_factor"],
                *(measure.of(state) for measure in self._plan.measures),
            )
            for state in run["states"]
        ]

    def override(self, overrides: Iterable[str]) -> None:
        """Change the model. Raises OverrideError."""
        for override in overrides:
            apply_override(self.model, override)

    @contextmanager
    def taken_back(self) -> Iterator[None]:
        """What is done to the model inside is not done any more in the end."""
        try:
            with self.model.transaction("variant"):
                yield
                raise _TakenBack
        except _TakenBack:
            self._beginning.restore(self.model)
            self.simulation.forget()


class _TakenBack(Exception):
    pass
