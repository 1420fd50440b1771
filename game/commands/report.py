"""Reports: runs of a model without a window, with their results as plain data."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
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
from pinjoint.components.rod import Rod, bends
from pinjoint.components.settings import AUTOMATIC
from pinjoint.components.table import fields_of
from pinjoint.documents.open_documents import without_mods
from pinjoint.mods.mod import ModError, check_mods, heeding_mods
from pinjoint.paths import ENERGIES
from pinjoint.session import DEFAULT_LIMIT, Session
from pinjoint.systems.base import StopReason
from pinjoint.systems.physics.automatic import AFFORDABLE
from pinjoint.systems.run.measured_error import IN_A_COMMAND
from pinjoint.systems.run.simulation import Simulation
from pinjoint.systems.run.watch import watched

if TYPE_CHECKING:  # it imports scipy
    from pinjoint.systems.statics.state import StaticState

INTERRUPTED = marked("interrupted")  # the status of a run that Ctrl+C ended
FOUND = (  # statuses of a run that found what was asked for
    marked("equilibrium"),
    marked("at rest"),
    marked("time reached"),
)


State = dict[str, Any]
Run = Mapping[str, Any]
Read = Callable[..., State]  # takes what `state` takes


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


def reported(model: Model, group: str) -> tuple[Field[Any], ...]:
    """The fields of a table that results report: Pinjoint's own, then those of mods' components."""
    bent = bends(model) or model.rods.distributed_force.any()
    fields = model.tables[group].fields.values()
    of_mods = (field for field in fields if field.component and field.dtype in (float, int, bool))
    return (*_OWN[group], *(_OF_BENDING[group] if bent else ()), *of_mods)


# --- one state -----------------------------------------------------------------------------------------


def state(
    model: Model,
    energy: Mapping[str, float],
    load_factor: float | None = None,
    residual: float | None = None,
    columns: Mapping[str, Column] | None = None,
) -> State:
    """The present state of a model as plain data: SI units with kN, vectors as [x, y].

    energy: J, with the keys of ENERGIES. load_factor: of statics. residual: the largest
    force out of balance, relative to the largest force. columns: by "table.field", columns that are reported
    in place of the model's own. `position` is the original one. Raises ResultError.
    """
    made = facts(model, energy, load_factor, residual, columns)
    for group in _OWN:
        keys, rows = made[group], zip(*(column.tolist() for column in made[group].values()), strict=True)
        made[group] = {
            name: {key: None if value != value else value for key, value in zip(keys, row, strict=True)}
            for name, row in zip(model.tables[group].names, rows, strict=True)
        }
    return made


def facts(
    model: Model,
    energy: Mapping[str, float],
    load_factor: float | None = None,
    residual: float | None = None,
    columns: Mapping[str, Column] | None = None,
) -> State:
    """As `state`, but of particles and of rods whole columns by name, in which NaN stands for no value."""
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


# --- runs ------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Analysis:
    """The computation of a model's equilibria, of its state at certain times, or of its state at rest.

    load_factors: settle at each in turn (statics). times: run through these, in s, ascending; None for both:
    run until at rest, at most `limit` s of simulated time. measures_error: even if that takes long.
    """

    load_factors: tuple[float, ...] | None = None
    times: tuple[float, ...] | None = None
    limit: float = DEFAULT_LIMIT
    measures_error: bool = False

    def run(
        self, simulation: Simulation, name: str, reported: list[State] | None = None, read: Read = state
    ) -> Run:
        """The result of the analysis, in which `name` is the model. reported: gets the states at `times`, one by one.

        read: makes a state. Raises Mistake, ResultError, FieldError, and ModError if a mod has failed or fails meanwhile.
        """
        check_mods()
        with heeding_mods(simulation):
            if self.load_factors is not None:
                return self._settled(simulation, name, self.load_factors, read)
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

    @staticmethod
    def _settled(simulation: Simulation, name: str, factors: Sequence[float], read: Read) -> Run:
        """The equilibrium at each load factor in turn, with the yielding of those before."""
        from pinjoint.systems.statics.settle import settle

        left_out = simulation.schedule.left_out_of_statics(simulation.model)
        started = time.perf_counter()
        settlement = settle(simulation.model, factors)
        seconds = time.perf_counter() - started
        states = [static_state(simulation.model, found, read) for found in settlement.states]
        status, note = without_mods(settlement.status, left_out)
        return _run(simulation, name, status, states, moves=False) | {
            "message": joined([settlement.message, note]),
            "left_out": left_out,
            "wall_seconds": seconds,
            "events": [event.record(simulation.model) for event in settlement.events],
        }

    def run_in(self, session: Session, name: str) -> Run:
        """The same in a session, which adds remarks of theory on a run through time and its measured error."""
        reported: list[State] = []
        try:
            if self.load_factors is not None:
                return self.run(session.simulation, name)
            session.run(steps=0)  # records the beginning, for theory beside the run
            with session.without_frames(), watched(session.simulation):
                found = self.run(session.simulation, name, reported)
        except KeyboardInterrupt:
            if self.load_factors is not None:
                raise
            return _interrupted(session.simulation, name, reported)
        except ModError as failure:
            stopped = _run(session.simulation, name, marked("mod failed"), [_state(session.simulation)])
            return {**stopped, "message": str(failure)}
        happened = [asdict(event) for event in session.simulation.events]
        happened += [event.record(session.model) for event in session.document.assessment.remarks]
        error = session.document.assessment.error(math.inf if self.measures_error else IN_A_COMMAND)
        unknown = "" if error is not None else _uncontrolled(session.simulation)
        return {
            **found,
            "message": joined([session.message, unknown]),
            "events": happened,
            "error_estimate": error.record(bent=bends(session.model)) if error is not None else None,
        }


def _interrupted(simulation: Simulation, name: str, states: list[State]) -> Run:
    """The result of a run that was interrupted: what it had reported, and its last state between two steps."""
    if not states or simulation.model.clock.time > states[-1]["time"]:
        states = [*states, _state(simulation)]
    found = _run(simulation, name, INTERRUPTED, states)
    reached = tr(
        "Interrupted at t = {time:.9g} s, after {steps} steps.", time=found["time"], steps=found["steps"]
    )
    return {**found, "message": joined([reached, found["message"]]), "error_estimate": None}


def _uncontrolled(simulation: Simulation) -> str:
    """What is to be said of a run whose error is neither controlled, though a person left that choice, nor measured."""
    model = simulation.model
    automatic = model.settings.integrator == AUTOMATIC and model.settings.time_step is None
    if not automatic or model.rods.count <= AFFORDABLE or simulation.integrator.exact:
        return ""
    return tr(
        "With more than {count} rods, the time steps are the longest stable ones, and the error of the run was not"
        " measured. Use --measure-error to measure it, or --integrator dop853 to keep it small.",
        count=AFFORDABLE,
    )


def static_state(model: Model, found: StaticState, read: Read = state) -> State:
    """An equilibrium as a state; its work is the energy stored and dissipated on the path of equilibria."""
    energy = dict.fromkeys(ENERGIES, 0.0) | {
        "elastic": found.elastic_energy,
        "dissipated_plastic": found.dissipated_plastic,
        "work": found.elastic_energy + found.dissipated_plastic,
    }
    return read(model, energy, found.load_factor, found.residual, found.columns)


def _state(simulation: Simulation, read: Read = state) -> State:
    try:
        return read(simulation.model, simulation.energy.as_dict(), None, simulation.residual)
    except ResultError as error:
        raise ResultError(simulation.message or str(error)) from None


def _run(
    simulation: Simulation, name: str, status: str, states: list[State], *, moves: bool = True
) -> dict[str, Any]:
    """A result without events. moves: the run went through time, by an integrator; False in statics.

    left_out: the laws of mods that act in the model and are not in the result.
    """
    clock = simulation.model.clock
    return {
        "model": name,
        "status": status,
        "message": simulation.said,
        "time": clock.time,
        "steps": clock.steps,
        "time_step": clock.step_size if moves else None,
        "integrator": simulation.integrator.key if moves else None,
        "wall_seconds": simulation.compute_seconds,
        "compile_seconds": simulation.programs.compile_seconds,
        "left_out": [],
        "events": [],
        "states": states,
    }
