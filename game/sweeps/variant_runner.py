"""Variant runner: the one model by which a process runs variants one by one, brought back after each."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import islice
from typing import Any

from pinjoint.commands.reports.results import facts
from pinjoint.components.language import english
from pinjoint.components.model import Model
from pinjoint.components.snapshot import Snapshot
from pinjoint.documents import models
from pinjoint.paths import apply_override, locate, quoted, settable
from pinjoint.sweeps.plan import Plan, Record
from pinjoint.sweeps.variation import as_text
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
        for override in plan.overrides:
            apply_override(self.model, override)
        self._targets = [locate(self.model, varied.path, settable)[0] for varied in plan.variations]
        systems = all_systems()
        self.step_systems = [system for system in systems if isinstance(system, StepSystem)]
        self.simulation = Simulation(self.model, Schedule(systems))
        self._beginning = Snapshot.take(self.model)

    def records(self, number: int) -> list[Record]:
        """A record of each state of a variant. Raises the errors of its overrides and of its run."""
        with self.taken_back():
            values = iter(self._plan.values(number))
            for varied, target in zip(self._plan.variations, self._targets, strict=True):
                given = list(islice(values, len(varied.columns)))
                with quoted(f"{varied.path}={', '.join(map(as_text, given))}"):
                    target.give_each(given if len(given) > 1 else given * len(target.handles))
            run = self._plan.analysis.run(self.simulation, self._plan.name, read=self._measured)
        about = run["status"], english(run["message"])
        return [(*about, *measured) for measured in run["states"]]

    def _measured(self, model: Model, *given: Any) -> Record:
        """What is kept of a state: time, load factor, measures."""
        found = facts(model, *given)
        measures = (measure.of(model, found) for measure in self._plan.measures)
        return found["time"], found["load_factor"], *measures

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
