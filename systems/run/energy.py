"""Energy: the account of a run, in which what edits add counts as work."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass

from components.field import Column
from components.model import Model
from systems.entries import Measure

ENERGIES = [Measure.KINETIC, Measure.ELASTIC, Measure.POTENTIAL]  # what the account takes of the measures


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
        return asdict(self) | {"imbalance": self.imbalance}


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
        """Enter what was edited."""
        for name, value in zip(("initial_energy", "work", "potential_reference"), self._edited(), strict=True):
            self._model.writable(f"clock.{name}")[0] = value
        self.before_edit = None

    def energy(self, *, edited: bool) -> Energy:
        """The account now; edited: something was, since it was closed."""
        clock = self._model.clock
        kinetic, elastic, potential = self._measure()[ENERGIES].tolist()
        initial, work, reference = clock.initial_energy, clock.work, clock.potential_reference
        if edited:
            initial, work, reference = self._edited()
        return Energy(
            initial=initial,
            work=work + potential - reference,
            kinetic=kinetic,
            elastic=elastic,
            dissipated_damping=clock.dissipated_damping,
            dissipated_plastic=clock.dissipated_plastic,
            dissipated_impact=clock.dissipated_impact,
        )

    def _edited(self) -> tuple[float, float, float]:
        """(initial energy, work, potential reference) in J, with the edits since it was closed.

        What an edit adds to the energy counts as work; the energy that a run begins with is its initial one.
        """
        clock = self._model.clock
        kinetic, elastic, potential = self._measure()[ENERGIES].tolist()
        if self.before_edit is None:
            dissipated = clock.dissipated_damping + clock.dissipated_plastic + clock.dissipated_impact
            return kinetic + elastic + dissipated - clock.work, clock.work, potential
        kinetic_before, elastic_before, potential_before = self.before_edit[ENERGIES].tolist()
        work = potential_before - clock.potential_reference
        work += kinetic + elastic - kinetic_before - elastic_before
        return clock.initial_energy, clock.work + work, potential
