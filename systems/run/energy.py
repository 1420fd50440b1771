"""Energy: the account of a run, in which what edits add counts as work."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pinjoint.components.field import Column
from pinjoint.components.model import Model
from pinjoint.systems.program.entries import Measure

ENERGIES = (Measure.KINETIC, Measure.ELASTIC, Measure.POTENTIAL)  # the measures that enter the account
DISSIPATED = ("dissipated_damping", "dissipated_plastic", "dissipated_impact")
ENTRIES = ("initial_energy", "work", "potential_reference")  # of the clock


@dataclass(frozen=True)
class Energy:
    """The energy account of a run, in J: initial + work = kinetic + elastic + dissipated + imbalance."""

    initial: float
    work: float
    kinetic: float
    elastic: float
    dissipated_damping: float
    dissipated_plastic: float
    dissipated_impact: float

    @property
    def imbalance(self) -> float:
        """What the integration has lost (positive) or created (negative)."""
        dissipated = self.dissipated_damping + self.dissipated_plastic + self.dissipated_impact
        return self.initial + self.work - (self.kinetic + self.elastic + dissipated)

    def as_dict(self) -> dict[str, float]:
        """All entries by name, the imbalance included."""
        return vars(self) | {"imbalance": self.imbalance}


class Account:
    """The energy account of one model's run; its entries are columns of the clock.

    measure: gives what a step program measures in the present state.
    before_edit: the measures of the state before edits that are not accounted for yet; None: the run begins.
    """

    def __init__(self, model: Model, measure: Callable[[], Column]) -> None:
        self._model = model
        self._measure = measure
        self.before_edit: Column | None = None

    def begin_edit(self) -> None:
        """Note the energy that edits start from."""
        self.before_edit = self._measure().copy()

    def close(self) -> None:
        """Enter the energy that edits added; afterwards no edit is open."""
        for name, value in zip(ENTRIES, self._edited(self._measure().tolist()), strict=True):
            self._model.writable(f"clock.{name}")[0] = value
        self.before_edit = None

    def energy(self, *, edited: bool) -> Energy:
        """The account now. edited: the model was edited since `close`."""
        measures = self._measure().tolist()
        kinetic, elastic, potential = (measures[entry] for entry in ENERGIES)
        initial, work, reference = self._edited(measures) if edited else self._of_clock(ENTRIES)
        return Energy(initial, work + potential - reference, kinetic, elastic, *self._of_clock(DISSIPATED))

    def _of_clock(self, names: Sequence[str]) -> list[float]:
        return [getattr(self._model.clock, name) for name in names]

    def _edited(self, measures: list[float]) -> tuple[float, float, float]:
        """ENTRIES with the edits since the account was closed.

        What an edit adds to the energy counts as work; the energy that a run begins with is its initial one.
        """
        clock = self._model.clock
        kinetic, elastic, potential = (measures[entry] for entry in ENERGIES)
        if self.before_edit is None:
            initial = kinetic + elastic + sum(self._of_clock(DISSIPATED)) - clock.work
            return initial, clock.work, potential
        kinetic_before, elastic_before, potential_before = self.before_edit[list(ENERGIES)].tolist()
        work = potential_before - clock.potential_reference
        work += kinetic + elastic - kinetic_before - elastic_before
        return clock.initial_energy, clock.work + work, potential
