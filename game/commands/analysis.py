"""Analyses: what is asked of a model without a window, and what comes of it as plain data, for commands and sweeps."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pinjoint.commands.output import ResultError, plain
from pinjoint.components.field import Column, Field
from pinjoint.components.handle import Handle
from pinjoint.components.language import joined, marked, tr
from pinjoint.components.mistake import Mistake
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod, bearing, bends, can_collapse, has_plastic_moments, has_struts
from pinjoint.components.settings import AUTOMATIC
from pinjoint.components.table import fields_of
from pinjoint.components.theory import EXACT, FIRST_ORDER
from pinjoint.mods.mod import ModError, check_mods, heeding_mods
from pinjoint.paths import ENERGIES
from pinjoint.systems.base import DEFAULT_LIMIT, StopReason
from pinjoint.systems.catalogue import all_systems, left_out_of_statics
from pinjoint.systems.schedule import Schedule

if TYPE_CHECKING:  # statics needs no session, and a run no scipy
    from pinjoint.headless import Headless
    from pinjoint.systems.run.simulation import Simulation
    from pinjoint.systems.statics.state import StaticState

State = dict[str, Any]
Run = Mapping[str, Any]
Read = Callable[[Model, State], State]  # what is kept of a model and its `facts`

INTERRUPTED = marked("interrupted")  # the status of a run that Ctrl+C ended
FOUND = (  # statuses of a run that found what was asked for
    marked("equilibrium"),
    marked("at rest"),
    marked("time reached"),
)


def _facts(kind: type[Handle], *names: str) -> tuple[Field[Any], ...]:
    fields = {field.name: field for field in fields_of(kind)}
    return tuple(fields[name] for name in names)


# Reported facts of every element, by key in a state, under their names and in their units.
_OWN: Mapping[str, tuple[Field[Any], ...]] = {
    "particles": _facts(Particle, "position", "displacement", "velocity", "reaction", "mass"),
    "rods": _facts(Rod, "axial_force", "length", "strain", "plastic_strain", "yielding"),
}
# Further ones of models that bend, or bear distributed forces.
_OF_BENDING: Mapping[str, tuple[Field[Any], ...]] = {
    "particles": _facts(Particle, "rotation", "angular_velocity", "reaction_moment", "inertia"),
    "rods": _facts(Rod, "end_axial_force", "shear", "bending_moment", "end_rotation", "largest_moment"),
}
# Of models with plastic moments.
_OF_HINGES = _facts(Rod, "plastic_rotation", "hinge_yielding")

# --- states --------------------------------------------------------------------------------------------


def reported(model: Model, group: str) -> tuple[Field[Any], ...]:
    """The fields of a table that results report: Pinjoint's own, then those of mods' components."""
    bent = bends(model) or bearing(model).any()
    fields = model.tables[group].fields.values()
    of_mods = (field for field in fields if field.component and field.dtype in (float, int, bool))
    hinges = _OF_HINGES if group == "rods" and has_plastic_moments(model) else ()
    of_struts = _facts(Rod, "lateral_deflection") if group == "rods" and has_struts(model) else ()
    return (*_OWN[group], *(_OF_BENDING[group] if bent else ()), *hinges, *of_struts, *of_mods)


def facts(
    model: Model,
    energy: Mapping[str, float],
    load_factor: float | None = None,
    residual: float | None = None,
    columns: Mapping[str, Column] | None = None,
) -> State:
    """The present state of a model: whole columns by name, in which NaN stands for no value; SI units with kN.

    energy: J, with the keys of ENERGIES. load_factor: of statics. residual: the largest
    force out of balance, relative to the largest force. columns: by "table.field", columns that are reported
    in place of the model's own. `position` is the original one. Raises ResultError.
    """
    made = {
        "time": model.clock.time,
        "load_factor": load_factor,
        **{group: _columns(model, group, columns or {}) for group in _OWN},
        "energy": {name: energy[name] for name in ENERGIES},
        "residual": residual,
        "collisions": model.clock.collisions,
    }
    return made | {key: plain(made[key], key) for key in ("time", "load_factor", "energy", "residual")}


def _columns(model: Model, group: str, given: Mapping[str, Column]) -> dict[str, Column]:
    table, columns = model.tables[group], {}
    for field in reported(model, group):
        key = f"{group}.{field.name}"
        columns[field.name] = column = given[key] if key in given else table.column(field.name)
        finite = np.isfinite(column) | np.isnan(column) if field.nullable else np.isfinite(column)
        if not finite.all():
            row = int(np.argwhere(~finite)[0, 0])
            element, value = model.describe(table[row]), field.loaded(column, row)
            raise ResultError(
                "{where} is {value}, not a finite number; report an earlier state.",
                where=joined([element, field.named()], ": "),
                value=str(value),
            )
    return columns


def static_facts(model: Model, found: StaticState) -> State:
    """Those of an equilibrium; its work is the energy stored and dissipated on the path of equilibria."""
    energy = dict.fromkeys(ENERGIES, 0.0) | {
        "elastic": found.elastic_energy,
        "dissipated_plastic": found.dissipated_plastic,
        "work": found.elastic_energy + found.dissipated_plastic,
    }
    return facts(model, energy, found.load_factor, found.residual, found.columns)


def by_element(model: Model, found: State) -> State:
    """Facts as plain data, those of particles and of rods by name: vectors as [x, y], None for no value."""
    made = dict(found)
    for group in _OWN:
        keys, rows = found[group], zip(*(column.tolist() for column in found[group].values()), strict=True)
        made[group] = {
            name: {key: None if value != value else value for key, value in zip(keys, row, strict=True)}
            for name, row in zip(model.tables[group].names, rows, strict=True)
        }
    return made


# --- analyses ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Analysis:
    """The computation of a model's equilibria, of its state at certain times, or of its state at rest.

    load_factors: settle at each in turn (statics). times: run through these, in s, ascending; None for both:
    run until at rest, at most `limit` s of simulated time. measures_error: even if that takes long. theory: of statics.
    """

    load_factors: tuple[float, ...] | None = None
    times: tuple[float, ...] | None = None
    limit: float = DEFAULT_LIMIT
    measures_error: bool = False
    theory: str = EXACT

    def run(
        self, simulation: Simulation, name: str, reported: list[State] | None = None, read: Read = by_element
    ) -> Run:
        """The result of the analysis, in which `name` is the model. reported: gets the states at `times`, one by one.

        read: makes a state. Raises Mistake, ResultError, FieldError, and ModError if a mod has failed or fails meanwhile.
        """
        check_mods()
        if self.load_factors is not None:
            return self.settled(simulation.model, name, read)
        with heeding_mods(simulation):
            return self._through_time(simulation, name, [] if reported is None else reported, read)

    def _through_time(self, simulation: Simulation, name: str, states: list[State], read: Read) -> Run:
        if self.times is None:
            simulation.run_until_rest(simulation.model.clock.time + self.limit)
            states.append(_state(simulation, read))
            ended = {StopReason.REST: marked("at rest"), StopReason.DIVERGED: marked("diverged")}
            return _run(simulation, name, ended.get(simulation.reason, marked("limit reached")), states)
        if self.times[0] < (present := simulation.model.clock.time):
            raise Mistake(
                "The model is at t = {present:.9g} s already, after {asked:.9g} s; ask for later times.",
                present=present,
                asked=self.times[0],
            )
        for target in self.times:
            simulation.run_to(target)
            states.append(_state(simulation, read))
            if simulation.reason is StopReason.DIVERGED:
                return _run(simulation, name, "diverged", states)
        return _run(simulation, name, "time reached", states)

    def settled(self, model: Model, name: str, read: Read = by_element) -> Run:
        """The equilibrium of a model at each load factor in turn, with the yielding of those before.

        Raises ModError if a mod has failed or fails meanwhile.
        """
        from pinjoint.systems.statics.settle import settle

        check_mods()
        left_out = left_out_of_statics(model)
        started = time.perf_counter()
        settlement = settle(model, self.load_factors or (1.0,), self.theory)
        seconds = time.perf_counter() - started
        states = [read(model, static_facts(model, found)) for found in settlement.states]
        status, note = settlement.beside(left_out)
        check_mods(time=model.clock.time)
        return _result(model, name, status, states) | {
            "message": joined([settlement.message, note]),
            "theory": self.theory,
            "left_out": left_out,
            "wall_seconds": seconds,
            "events": [event.record(model) for event in settlement.events],
            **_limit_load(model, self.theory),
        }

    def settled_in(self, model: Model, name: str) -> Run:
        """The same, also where a mod fails."""
        try:
            return self.settled(model, name)
        except ModError as failure:
            from pinjoint.systems.run.simulation import Simulation

            return _failed(Simulation(model, Schedule(all_systems())), name, failure)

    def run_in(self, session: Headless, name: str) -> Run:
        """A run through time in a session, which adds remarks of theory and its measured error."""
        from pinjoint.documents.chronicle import hinge_records
        from pinjoint.systems.run.measured_error import IN_A_COMMAND

        reported: list[State] = []
        try:
            with session.running() as simulation:
                found = self.run(simulation, name, reported)
        except KeyboardInterrupt:
            return _interrupted(session.simulation, name, reported)
        except ModError as failure:
            return _failed(session.simulation, name, failure)
        happened = [asdict(event) for event in session.simulation.events]
        remarks = [event.record(session.model) for event in session.document.assessment.remarks]
        error = session.document.assessment.error(math.inf if self.measures_error else IN_A_COMMAND)
        unknown = "" if error is not None else _uncontrolled(session.simulation)
        return {
            **found,
            "message": joined([session.message, unknown]),
            "events": [*hinge_records(session.model), *happened, *remarks],
            "error_estimate": error.record(bent=bends(session.model)) if error is not None else None,
        }


def _limit_load(model: Model, theory: str) -> Run:
    """The collapse load by limit analysis, beside first-order statics of models that it has an answer for."""
    if theory != FIRST_ORDER or not can_collapse(model):
        return {}
    from pinjoint.collapse_steps import collapse_steps
    from pinjoint.systems.statics.limit_analysis import LimitLoad

    limit = LimitLoad.of(model)
    found: State = {"limit_load": limit.record(model), "hinge_by_hinge": []}
    if (steps := collapse_steps(model, limit)) is not None:
        heads, *rows = steps.rows()
        found["hinge_by_hinge"] = [
            {"step": row[0], **dict(zip(map(str, heads[1:]), row[1:], strict=True))} for row in rows
        ]
    return found


def _interrupted(simulation: Simulation, name: str, states: list[State]) -> Run:
    """The result of a run that was interrupted: what it had reported, and its last state between two steps."""
    if not states or simulation.model.clock.time > states[-1]["time"]:
        states = [*states, _state(simulation)]
    found = _run(simulation, name, INTERRUPTED, states)
    reached = tr(
        "Interrupted at t = {time:.9g} s, after {steps} steps.", time=found["time"], steps=found["steps"]
    )
    return {**found, "message": joined([reached, found["message"]]), "error_estimate": None}


def _failed(simulation: Simulation, name: str, error: ModError) -> Run:
    """The result of a run that stopped because a mod failed, with the state in which it did."""
    return {**_run(simulation, name, marked("mod failed"), [_state(simulation)]), "message": str(error)}


def _uncontrolled(simulation: Simulation) -> str:
    """What is to be said of a run whose error is neither controlled, though a person left that choice, nor measured."""
    from pinjoint.systems.physics.automatic import AFFORDABLE

    model = simulation.model
    automatic = model.settings.integrator == AUTOMATIC and model.settings.time_step is None
    if not automatic or model.rods.count <= AFFORDABLE or simulation.integrator.exact:
        return ""
    return tr(
        "With more than {count} rods, the time steps are the longest stable ones, and the error of the run was not"
        " measured. Use --measure-error to measure it, or --integrator dop853 to keep it small.",
        count=AFFORDABLE,
    )


def _state(simulation: Simulation, read: Read = by_element) -> State:
    model = simulation.model
    try:
        return read(model, facts(model, simulation.energy.as_dict(), residual=simulation.residual))
    except ResultError as error:
        raise ResultError(simulation.message or str(error)) from None


def _run(simulation: Simulation, name: str, status: str, states: list[State]) -> dict[str, Any]:
    """The result of a run through time, without events."""
    return _result(simulation.model, name, status, states) | {
        "message": simulation.said,
        "time_step": simulation.model.clock.step_size,
        "integrator": simulation.integrator.key,
        "wall_seconds": simulation.compute_seconds,
        "compile_seconds": simulation.programs.compile_seconds,
    }


def _result(model: Model, name: str, status: str, states: list[State]) -> dict[str, Any]:
    """What every result has. left_out: the laws of mods that act in the model and are not in the result."""
    return {
        "model": name,
        "status": status,
        "message": "",
        "time": model.clock.time,
        "steps": model.clock.steps,
        "time_step": None,
        "integrator": None,
        "wall_seconds": 0.0,
        "compile_seconds": 0.0,
        "left_out": [],
        "events": [],
        "states": states,
    }
