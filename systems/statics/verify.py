"""Theory beside the simulation: linear, exact and simulated answers for every element, and their differences."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from components.model import Model
from systems.statics.equations import Array
from systems.statics.events import NoEquilibrium
from systems.statics.settle import Settlement, settle
from systems.statics.theory import Indeterminacy, LinearState, indeterminacy, linear

QUANTITIES = {
    "axial_force": ("rods", "kN"),
    "displacement": ("particles", "m"),
    "reaction": ("particles", "kN"),
}


@dataclass(frozen=True)
class Answer:
    """One answer, whoever found it: axial_force (rods,) in kN, displacement in m and reaction in kN, (n, 2)."""

    axial_force: Array
    displacement: Array
    reaction: Array
    plastic_strain: Array


@dataclass(frozen=True)
class Theories:
    """What theory says about a model. linear: None if it has no answer, which `refusal` explains.

    plastic_strain: of the state from which the exact answer was followed, (rods,).
    """

    linear: LinearState | None
    refusal: str
    exact: Settlement
    indeterminacy: Indeterminacy
    plastic_strain: Array


def theories(model: Model) -> Theories:
    """Linear and exact answers from the model's present state on; take them before simulating."""
    refusal, first_order = "", None
    try:
        first_order = linear(model)
    except NoEquilibrium as reason:
        refusal = str(reason)
    return Theories(first_order, refusal, settle(model), indeterminacy(model), model.rods.plastic_strain.copy())


def observed(model: Model) -> Answer:
    """The present state of a model, as a simulation left it."""
    particles, rods = model.particles, model.rods
    return Answer(
        rods.axial_force.copy(),
        particles.displacement.copy(),
        particles.reaction.copy(),
        rods.plastic_strain.copy(),
    )


@dataclass(frozen=True)
class Row:
    """One quantity of one element: its values by the three ways, None where one has no answer.

    component: "", "x" or "y". Errors are against the exact value, relative to the largest exact value of
    the same quantity in the model.
    """

    element: str
    name: str
    quantity: str
    component: str
    unit: str
    simulation: float | None
    linear: float | None
    exact: float
    simulation_error: float | None
    linear_error: float | None


@dataclass(frozen=True)
class Comparison:
    """All rows, the degrees of indeterminacy, and what a person should know about the answers.

    overshoot: rods that yielded in the simulation only, though their static force is below their strength.
    """

    rows: tuple[Row, ...]
    indeterminacy: Indeterminacy
    status: str
    messages: tuple[str, ...]
    overshoot: tuple[str, ...]

    @property
    def worst_simulation(self) -> Row | None:
        """The row with the largest error of the simulation."""
        rows = [row for row in self.rows if row.simulation_error is not None]
        return max(rows, key=lambda row: row.simulation_error or 0.0, default=None)

    @property
    def worst_linear(self) -> Row | None:
        """The row with the largest error of linear theory."""
        rows = [row for row in self.rows if row.linear_error is not None]
        return max(rows, key=lambda row: row.linear_error or 0.0, default=None)

    def as_dict(self) -> dict[str, Any]:
        """Plain data."""
        worst = {"simulation": self.worst_simulation, "linear": self.worst_linear}
        return {
            "status": self.status,
            "messages": list(self.messages),
            "indeterminacy": vars(self.indeterminacy).copy(),
            "overshoot": list(self.overshoot),
            "worst": {way: vars(row).copy() if row else None for way, row in worst.items()},
            "elements": [vars(row).copy() for row in self.rows],
        }


def compare(model: Model, theory: Theories, simulated: Answer | None) -> Comparison:
    """Put the three answers side by side; simulated: None if there is no simulation at rest."""
    overshoot: tuple[str, ...] = ()
    messages = [text for text in (theory.exact.message, theory.refusal) if text]
    if simulated is not None:
        overshoot, told = _overshoot(model, theory, simulated)
        messages += told
    rows = tuple(row for quantity in QUANTITIES for row in _rows(model, quantity, theory, simulated))
    return Comparison(rows, theory.indeterminacy, theory.exact.status, tuple(messages), overshoot)


def _rows(model: Model, quantity: str, theory: Theories, simulated: Answer | None) -> Iterator[Row]:
    table, unit = QUANTITIES[quantity]
    exact = getattr(theory.exact.final, quantity)
    others = {"simulation": simulated, "linear": theory.linear}
    values = {way: getattr(answer, quantity) for way, answer in others.items() if answer is not None}
    largest = float(np.abs(exact).max(initial=0.0))
    for place in np.ndindex(exact.shape):
        if quantity == "reaction" and not model.particles.fixed[place]:
            continue
        found = {way: float(array[place]) for way, array in values.items()}
        truth = float(exact[place])
        errors = {way: abs(value - truth) / largest if largest else abs(value) for way, value in found.items()}
        yield Row(
            element=table.removesuffix("s"),
            name=str(model.tables[table].column("name")[place[0]]),
            quantity=quantity,
            component="" if len(place) == 1 else "xy"[place[1]],
            unit=unit,
            simulation=found.get("simulation"),
            linear=found.get("linear"),
            exact=truth,
            simulation_error=errors.get("simulation"),
            linear_error=errors.get("linear"),
        )


def _overshoot(model: Model, theory: Theories, simulated: Answer) -> tuple[tuple[str, ...], list[str]]:
    """Rods that yielded in the simulation but not in statics, and a sentence about each."""
    exact, names = theory.exact.final, model.rods.column("name")
    unyielded = exact.plastic_strain == theory.plastic_strain
    rows = np.flatnonzero(unyielded & (simulated.plastic_strain != theory.plastic_strain)).tolist()
    sentences = []
    for row in rows:
        stretched = simulated.plastic_strain[row] > theory.plastic_strain[row]
        strength = float((model.rods.tension_limit if stretched else model.rods.compression_limit)[row])
        sentences.append(
            f"Rod {names[row]} yielded only in the overshoot: static force {abs(exact.axial_force[row]):.4g} kN"
            f" < strength {strength:.4g} kN. Load it more slowly or raise its damping."
        )
    return tuple(str(names[row]) for row in rows), sentences
