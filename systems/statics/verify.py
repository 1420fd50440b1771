"""Theory beside the simulation: linear, exact and simulated answers for every element, and their differences."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from components.model import Model
from systems.statics.equations import Array
from systems.statics.events import NoEquilibrium
from systems.statics.explain import rod_names
from systems.statics.settle import Settlement, settle
from systems.statics.theory import LinearState, linear

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


@dataclass(frozen=True)
class Theories:
    """What theory says about a model. linear: None if it has no answer, which `refusal` explains.

    plastic_strain: of the state from which the exact answer was followed, (rods,).
    """

    linear: LinearState | None
    refusal: str
    settlement: Settlement
    plastic_strain: Array

    @property
    def exact(self) -> Answer | None:
        """The equilibrium in exact geometry, or None if there is none under the whole load."""
        final = self.settlement.final
        if final.status != "equilibrium":
            return None
        return Answer(final.axial_force, final.displacement, final.reaction)


def theories(model: Model) -> Theories:
    """Linear and exact answers from the model's present state on; take them before simulating."""
    refusal, first_order = "", None
    try:
        first_order = linear(model)
    except NoEquilibrium as reason:
        refusal = str(reason)
    return Theories(first_order, refusal, settle(model), model.rods.plastic_strain.copy())


def observed(model: Model) -> Answer:
    """The present state of a model, as a simulation left it."""
    particles, rods = model.particles, model.rods
    return Answer(rods.axial_force.copy(), particles.displacement.copy(), particles.reaction.copy())


@dataclass(frozen=True)
class Row:
    """One quantity of one element: its values by the three ways, None where one has no answer.

    element: "rod" or "particle". component: "", "x" or "y". Errors are against the exact value, relative to
    the largest exact value of the same quantity in the model (absolute, if that is zero).
    """

    element: str
    name: str
    quantity: str
    component: str
    unit: str
    simulation: float | None
    linear: float | None
    exact: float | None
    simulation_error: float | None
    linear_error: float | None

    @property
    def title(self) -> str:
        """What it is a quantity of, such as "displacement y of particle B"."""
        quantity = f"{self.quantity.replace('_', ' ')} {self.component}".rstrip()
        return f"{quantity} of {self.element} {self.name.removeprefix(self.element + ' ')}"


@dataclass(frozen=True)
class Comparison:
    """Three answers side by side, element by element."""

    rows: tuple[Row, ...]

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


def compare(model: Model, theory: Theories, simulated: Answer | None) -> Comparison:
    """Put the three answers side by side; simulated: None if there is no simulation at rest."""
    answers = {"simulation": simulated, "linear": theory.linear, "exact": theory.exact}
    return Comparison(tuple(row for quantity in QUANTITIES for row in _rows(model, quantity, answers)))


def _rows(model: Model, quantity: str, answers: Mapping[str, Answer | LinearState | None]) -> Iterator[Row]:
    table, unit = QUANTITIES[quantity]
    values: dict[str, Array] = {w: getattr(a, quantity) for w, a in answers.items() if a is not None}
    exact = values.get("exact")
    largest = float(np.abs(exact).max(initial=0.0)) if exact is not None else 0.0
    names = model.tables[table].column("name")
    for place in np.ndindex(model.particles.displacement.shape if table == "particles" else (len(names),)):
        if table == "particles" and model.particles.fixed[place] == (quantity == "displacement"):
            continue
        found = {way: float(array[place]) for way, array in values.items()}
        errors = {}
        if "exact" in found:
            errors = {way: abs(value - found["exact"]) / (largest or 1.0) for way, value in found.items()}
        yield Row(
            element=table.removesuffix("s"),
            name=str(names[place[0]]),
            quantity=quantity,
            component="" if len(place) == 1 else "xy"[place[1]],
            unit=unit,
            simulation=found.get("simulation"),
            linear=found.get("linear"),
            exact=found.get("exact"),
            simulation_error=errors.get("simulation"),
            linear_error=errors.get("linear"),
        )


@dataclass(frozen=True)
class Overshoot:
    """A rod that yielded in a simulation only because the load came suddenly; message: a sentence about it."""

    rod: str
    message: str


def overshoots(model: Model, theory: Theories) -> list[Overshoot]:
    """Rods that yielded on the way to the model's present state, but do not when the load grows slowly."""
    final, names = theory.settlement.final, model.rods.column("name")
    if theory.exact is None:
        return []
    unyielded = final.plastic_strain == theory.plastic_strain
    present = model.rods.plastic_strain
    found = []
    for row in np.flatnonzero(unyielded & (present != theory.plastic_strain)).tolist():
        stretched = present[row] > theory.plastic_strain[row]
        strength = float((model.rods.tension_limit if stretched else model.rods.compression_limit)[row])
        message = (
            f"{rod_names(model, np.array([row]))} yielded only in the overshoot of a sudden load: static force"
            f" {abs(final.axial_force[row]):.4g} kN < strength {strength:.4g} kN."
            " Load it more slowly, or raise its damping."
        )
        found.append(Overshoot(str(names[row]), message[:1].upper() + message[1:]))
    return found
