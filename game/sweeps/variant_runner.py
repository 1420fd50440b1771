"""Variant runner: the one model by which a process runs variants one by one, brought back after each."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from pinjoint.components.language import english
from pinjoint.components.snapshot import Snapshot
from pinjoint.documents import models
from pinjoint.paths import apply_override
from pinjoint.sweeps.plan import Plan, Record
from pinjoint.systems.base import StepSystem
from pinjoint.systems.catalogue import all_systems
from pinjoint.systems.run.simulation import Simulation
from pinjoint.systems.schedule import Schedule


class VariantRunner:
    """Runs variants of a plan by one model: opening one and loading its step program takes longer than most runs.

    A variant is edited and run inside a transaction that is taken back: commands have exact inverses, and
    all that time changes is in the snapshot, so that the next one begins with the same bits as the first.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self.model = models.parse(plan.document)
        systems = all_systems()
        self.step_systems = [system for system in systems if isinstance(system, StepSystem)]
        self.simulation = Simulation(self.model, Schedule(systems))
        self._beginning = Snapshot.take(self.model)

    def records(self, number: int) -> list[Record]:
        """A record of each state of a variant. Raises the errors of its overrides and of its run."""
        with self.taken_back():
            self.override(self._plan.overrides_of(number))
            run = self._plan.analysis.run(self.simulation, self._plan.name)
        about = run["status"], english(run["message"])
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
        """Change the model. Raises PathError."""
        for override in overrides:
            apply_override(self.model, override)

    @contextmanager
    def taken_back(self) -> Iterator[None]:
        """Changes of the model inside the `with` are taken back at its end."""
        try:
            with self.model.transaction("variant"):
                yield
                raise _TakenBack
        except _TakenBack:
            self._beginning.restore(self.model)
            self.simulation.forget()


class _TakenBack(Exception):
    pass
