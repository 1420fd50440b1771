"""Theory beside the simulation: linear, exact and simulated answers for every element, with their differences."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pinjoint.components import written
from pinjoint.components.arrays import ROUND_OFF, Array, Flags
from pinjoint.components.field import ENDS
from pinjoint.components.language import begun, joined, marked, tr
from pinjoint.components.model import Model
from pinjoint.components.particle import supported
from pinjoint.components.rod import rigid_joints
from pinjoint.components.wording import missing
from pinjoint.components.world import called
from pinjoint.systems.statics.equations import largest
from pinjoint.systems.statics.events import Event, NoEquilibrium
from pinjoint.systems.statics.explain import rod_names
from pinjoint.systems.statics.response import of_axes
from pinjoint.systems.statics.settle import Settlement, settle
from pinjoint.systems.statics.state import Start, StaticState
from pinjoint.systems.statics.theory import linear

QUANTITIES = {  # table, unit, title
    "axial_force": ("rods", "kN", marked("axial force")),
    "displacement": ("particles", "m", marked("displacement")),
    "reaction": ("particles", "kN", marked("reaction")),
    "rotation": ("particles", "rad", marked("rotation")),
    "reaction_moment": ("particles", "kN·m", marked("reaction moment")),
    "shear": ("rods", "kN", marked("shear force")),
    "bending_moment": ("rods", "kN·m", marked("bending moment")),
}
JUMPS = (marked("snap-through"), marked("bifurcation"))
DEPARTURES = {  # of a run from the path of a slowly growing load, by kind of event
    "overshoot": marked("yielded in the overshoot"),
    "other equilibrium": marked("in another equilibrium"),
}
ELSEWHERE = 1e-3  # of the largest value of its kind: a larger difference is no error of integration
FURTHER = 1e-2  # of the plastic strain in statics: a larger excess is an overshoot
LEAST = 1e-6  # of the strain at first yield: a smaller excess is rounding
ROUNDING = 64.0 * ROUND_OFF  # of the largest value of the same unit, or of that at a strain of 1


Answer = Mapping[str, Array]  # a state, as columns by "table.field"


@dataclass(frozen=True)
class Theories:
    """The answers of theory for a model in a state; linear: None if there is none, for the reason `refusal`."""

    start: Start
    linear: StaticState | None
    refusal: NoEquilibrium | None
    settlement: Settlement

    @property
    def exact(self) -> StaticState | None:
        """The equilibrium in exact geometry, or None if there is none under the whole load."""
        final = self.settlement.final
        return final if final.balanced else None

    @classmethod
    def of(cls, model: Model, start: Start | None = None) -> Theories:
        """The answers under the model's load, from a state (None: the present one) on.

        Raises FieldError for numbers too large or too small to compute with.
        """
        start = start or Start.of(model)
        exact = settle(model, start=start)
        refusal, first_order = None, None
        try:
            first_order = linear(model, start)
        except NoEquilibrium as reason:
            refusal = reason
        return cls(start, first_order, refusal, exact)

    def beside(self, model: Model, *, simulated: bool = True) -> Comparison:
        """The three answers side by side, that of a simulation being the present state; simulated: there is one at rest."""
        present = {
            f"{table}.{name}": model.tables[table].column(name).copy()
            for name, (table, *_) in QUANTITIES.items()
        }
        by_theory = {"linear": self.linear, "exact": self.exact}
        found = {way: None if state is None else state.columns for way, state in by_theory.items()}
        return Comparison(model, {"simulation": present if simulated else None, **found})

    # --- departures of a simulation from statics ---------------------------------------------------

    def remarks(self, model: Model) -> list[Event]:
        """Events about the model at rest: a collapse, jumps, overshoots, another equilibrium than that of statics.

        It must have come from `start` under one load, applied at once or growing by one history.
        """
        if self.exact is None:
            return [event for event in self.settlement.events if event.kind == "collapse"]
        overshot = [*self._overshoots(model, self.exact)]
        worst = self.beside(model).worst("simulation", "displacement")
        alike = not overshot and (model.rods.plastic_strain == self.exact.plastic_strain).all()
        if alike and worst is not None and (worst.simulation_error or 0.0) > ELSEWHERE:
            if {event.kind for event in self.settlement.events} & {"bifurcation", "mechanism"}:
                return []  # either side was possible
            message = tr(
                "The model is at rest in another equilibrium than under a slowly growing load: the {quantity} differs by"
                " {distance}. The sudden load carried the structure past an unstable position.",
                quantity=worst.title,
                distance=written.displacement(abs((worst.simulation or 0.0) - (worst.exact or 0.0))),
            )
            return [Event("other equilibrium", 1.0, message)]
        return [event for event in self.settlement.events if event.kind in JUMPS] + overshot

    def _overshoots(self, model: Model, final: StaticState) -> Iterator[Event]:
        """Rods that yielded, or yielded further, unlike under a slowly growing load."""
        present, before = model.rods.plastic_strain, of_axes(self.start.permanent)
        static, flowed = np.abs(final.plastic_strain - before), np.abs(present - before)
        limit = np.where(present > before, model.rods.tension_limit, model.rods.compression_limit)
        further = flowed - static > np.maximum(FURTHER * static, LEAST * limit / model.rods.stiffness)
        for row in np.flatnonzero(np.isfinite(limit) & further).tolist():
            who = begun(rod_names(model, np.array([row])))
            if static[row] == 0.0:
                message = tr(
                    "{rod} yielded only because the sudden load overshot: in equilibrium its force is {force} kN, below its"
                    " strength of {strength} kN. Apply the load more slowly, or raise the damping.",
                    rod=who,
                    force=written.given(abs(final.axial_force[row]), written.DIGITS),
                    strength=written.given(limit[row]),
                )
            else:
                message = tr(
                    "{rod} yielded more because the sudden load overshot: its plastic strain is {strain}, under a slowly"
                    " growing load {static}. Apply the load more slowly, or raise the damping.",
                    rod=who,
                    strain=written.strain(present[row]),
                    static=written.strain(final.plastic_strain[row]),
                )
            yield Event("overshoot", 1.0, message, (model.rods.names[row],))


@dataclass(frozen=True)
class Row:
    """One quantity of one element: its simulated, linear and exact values, None where there is none.

    element: "rod" or "particle". component: "", "x" or "y", of rods "start" or "end". Errors are differences from the
    exact value relative to the largest exact value of the quantity in the model; where this is rounding, to the largest
    of the same unit; where this is rounding as well, they are absolute.
    """

    element: str
    name: str
    quantity: str
    component: str
    unit: str
    simulation: float | None = None
    linear: float | None = None
    exact: float | None = None
    simulation_error: float | None = None
    linear_error: float | None = None

    @property
    def title(self) -> str:
        """Quantity and element, such as "displacement y of particle B"."""
        quantity, element = tr(self.quantity.replace("_", " ")), called(self.element, self.name)
        if self.component in ENDS:
            message = marked("{quantity} at the start of {rod}"), marked("{quantity} at the end of {rod}")
            return tr(message[ENDS.index(self.component)], quantity=quantity, rod=element)
        return tr("{quantity} of {element}", quantity=joined([quantity, self.component]), element=element)


@dataclass(frozen=True)
class Comparison:
    """The "simulation", "linear" and "exact" answers side by side, None where there is none."""

    model: Model
    answers: Mapping[str, Answer | None]

    @property
    def rows(self) -> Iterator[Row]:
        """Every quantity of every element: displacements of free directions, reactions of constrained ones.

        Of members that bend, shears and moments at both ends; of their particles, rotations or the moments of clamps.
        """
        for quantity in QUANTITIES:
            for place in np.argwhere(self._concerned(quantity)).tolist():
                yield self.row(quantity, tuple(place))

    def of(self, table: str, row: int) -> Iterator[tuple[str, tuple[int, ...]]]:
        """The quantities of one element, and the place of each value."""
        for quantity in (name for name, (of, *_) in QUANTITIES.items() if of == table):
            for place in np.argwhere(self._concerned(quantity)[row]).tolist():
                yield quantity, (row, *place)

    def row(self, quantity: str, place: tuple[int, ...]) -> Row:
        """One quantity of one element: (row,), of a vector (row, axis) and at an end of a rod (row, end)."""
        table, unit, _ = QUANTITIES[quantity]
        found = {way: float(values[place]) for way, values in self._values[quantity].items()}
        errors = {f"{way}_error": float(values[place]) for way, values in self._errors[quantity].items()}
        name = str(self.model.tables[table].column("name")[place[0]])
        component = (ENDS if table == "rods" else "xy")[place[1]] if place[1:] else ""
        return Row(table.removesuffix("s"), name, quantity, component, unit, **found, **errors)

    def worst(self, way: str, *quantities: str) -> Row | None:
        """The row with the largest error of the "simulation" or of "linear" theory, in all or some quantities.

        None if there is nothing to compare. Raises ValueError for other names.
        """
        for given, known in ((way, ("simulation", "linear")), *((name, QUANTITIES) for name in quantities)):
            if given not in known:
                raise ValueError(missing(marked("comparisons"), given, known))
        greatest, row = -1.0, None
        for quantity in quantities or QUANTITIES:
            errors, concerned = self._errors[quantity].get(way), self._concerned(quantity)
            if errors is None or not concerned.any():
                continue
            errors = np.where(concerned, errors, -1.0)
            if errors.max() > greatest:
                greatest = float(errors.max())
                row = self.row(quantity, tuple(int(i) for i in np.unravel_index(errors.argmax(), errors.shape)))
        return row

    @property
    def differs(self) -> bool:
        """True if the simulation is farther from the exact equilibrium than errors of integration account for."""
        worst = self.worst("simulation")
        return worst is not None and (worst.simulation_error or 0.0) > ELSEWHERE

    def _concerned(self, quantity: str) -> Flags:
        """Where a quantity has a meaning, in the shape of its array."""
        particles, rods = self.model.particles, self.model.rods
        rigid: Flags = rods.turning_shares > 0.0
        if quantity == "axial_force":
            return np.ones(rods.count, dtype=bool)
        if quantity in ("shear", "bending_moment"):
            return np.repeat(rigid.any(axis=1, keepdims=True), 2, axis=1)
        held = supported(self.model)
        if quantity in ("rotation", "reaction_moment"):
            clamped = held[:, 2] if quantity == "reaction_moment" else ~particles.fixed_rotation
            return np.asarray(rigid_joints(self.model) & clamped)
        return held[:, :2] if quantity == "reaction" else ~particles.fixed

    def scale(self, quantity: str) -> float:
        """The largest exact value of the quantity; where it is rounding, of its unit; 0 where that is rounding."""
        rods, unit = self.model.rods, QUANTITIES[quantity][1]
        at_strain_1 = {
            "kN": rods.stiffness,
            "m": rods.rest_length,
            "kN·m": rods.end_stiffness,
            "rad": np.ones(1),
        }
        of_strain_1 = float(at_strain_1[unit].max(initial=0.0))
        own = self._largest(quantity)
        alike = max(self._largest(name) for name, (_, other, _) in QUANTITIES.items() if other == unit)
        scale = own if own > ROUNDING * alike else alike
        return scale if scale > ROUNDING * of_strain_1 else 0.0

    def _largest(self, quantity: str) -> float:
        exact = self._values[quantity].get("exact")
        return largest(exact) if exact is not None else 0.0

    @cached_property
    def _values(self) -> dict[str, dict[str, Array]]:
        """By quantity and way."""
        given = {way: answer for way, answer in self.answers.items() if answer is not None}
        return {
            name: {way: answer[f"{table}.{name}"] for way, answer in given.items()}
            for name, (table, *_) in QUANTITIES.items()
        }

    @cached_property
    def _errors(self) -> dict[str, dict[str, Array]]:
        """By quantity and way, relative to the scale; none without an exact answer."""
        return {
            quantity: {
                way: np.abs(array - values["exact"]) / (self.scale(quantity) or 1.0)
                for way, array in values.items()
                if "exact" in values and way != "exact"
            }
            for quantity, values in self._values.items()
        }
