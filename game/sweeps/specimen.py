"""Specimen: the model of a sweep in this process, brought back to its beginning after each variant."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from components.snapshot import Snapshot
from game import models
from game.catalogue import step_systems
from game.overrides import apply_override
from game.registry import SYSTEMS
from game.schedule import Schedule
from game.simulation import Simulation
from game.sweeps.plan import Outcome, Plan, Record


def compute(plan: Plan, numbers: Sequence[int]) -> list[Outcome]:
    """Compute some variants of a plan, here; one that cannot be is a record that says why.

    Raises SweepError if this installation is not that of the plan.
    """
    plan.installation.require()
    outcomes: list[Outcome] = []
    specimen: Specimen | None = None
    for number in numbers:
        try:
            specimen = specimen or Specimen(plan)
            outcomes.append((number, specimen.records(number)))
        except Exception as error:  # one bad variant of thousands must not end the others
            known = isinstance(error, ValueError)
            reason = str(error) if known else f"{type(error).__name__}: {error}"
            outcomes.append(plan.failure(number, reason))
            specimen = None
    return outcomes


class Specimen:
    """One model for many variants: opening one and loading its step program takes longer than most runs.

    A variant is edited and run inside a transaction that is taken back: commands have exact inverses, and
    all that time changes is in the snapshot, so that the next one begins with the same bits as the first.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._model = models.parse(plan.document)
        schedule = Schedule([*step_systems(), *(make() for make in SYSTEMS)])
        self._simulation = Simulation(self._model, schedule)
        self._beginning = Snapshot.take(self._model)

    def records(self, number: int) -> list[Record]:
        """What a variant comes to, a record of each state. Raises what its overrides or its run raise."""
        with self._taken_back():
            for override in self._plan.overrides_of(number):
                apply_override(self._model, override)
            run = self._plan.analysis.run(self._simulation, self._plan.name)
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

    @contextmanager
    def _taken_back(self) -> Iterator[None]:
        """What is done to the model inside is not done any more in the end."""
        try:
            with self._model.transaction("variant"):
                yield
                raise _TakenBack
        except _TakenBack:
            self._beginning.restore(self._model)
            self._simulation.forget()


class _TakenBack(Exception):
    pass
