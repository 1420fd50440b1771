"""Reports: running a model without a window, and what came of it as plain data (DESIGN of the results)."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from game.results import ENERGIES, Run, State, state
from game.session import DEFAULT_LIMIT, Session
from systems.base import StopReason

if TYPE_CHECKING:
    from systems.statics.events import Event
    from systems.statics.settle import StaticState

FOUND = ("equilibrium", "at rest", "time reached")  # statuses of a run that found what was asked for


@dataclass(frozen=True)
class Analysis:
    """What is asked of a model: its equilibria, its state at certain times, or its state at rest.

    load_factors: settle at each in turn (statics). times: run through these, in s, ascending; None for both:
    run until at rest, at most `limit` s of simulated time.
    """

    load_factors: tuple[float, ...] | None = None
    times: tuple[float, ...] | None = None
    limit: float = DEFAULT_LIMIT

    def run(self, session: Session, name: str) -> Run:
        """Compute it; `name` is what the result calls the model."""
        if self.load_factors is not None:
            return run_static(session, name, self.load_factors)
        if self.times is not None:
            return run_at(session, name, self.times)
        return run_until_rest(session, name, self.limit)


def run_until_rest(session: Session, name: str, limit: float) -> Run:
    """Run until at rest, at most `limit` s of simulated time."""
    session.simulation.smooth = False  # nobody watches
    status = session.run(until="rest", limit=limit)
    return _run(session, name, status, [_state(session)])


def run_at(session: Session, name: str, times: Sequence[float]) -> Run:
    """Run through the given times (s, ascending) and report the state at exactly each of them.

    The short last step to a reported time is taken on a copy, so that a report never changes the run.
    """
    simulation, states = session.simulation, list[State]()
    simulation.smooth = False  # nobody watches
    session.run(steps=0)
    for target in times:
        simulation.run_to(target, whole_steps=True)
        if simulation.reason is StopReason.DIVERGED:
            return _run(session, name, "diverged", [*states, _state(session)])
        if simulation.reason is StopReason.REST:  # time passes without steps
            session.model.writable("clock.time")[0] = max(target, session.time)
        with simulation.at(target):
            states.append(_state(session))
            run = _run(session, name, "time reached", states)
    return run


def run_static(session: Session, name: str, factors: Sequence[float]) -> Run:
    """Settle at each load factor in turn; the history (yielding) is kept from one to the next."""
    from systems.statics.settle import settle

    started = time.perf_counter()
    settlement = settle(session.model, factors)
    seconds = time.perf_counter() - started
    states = [_static_state(session, found) for found in settlement.states]
    return _run(session, name, settlement.status, states) | {
        "message": settlement.message,
        "wall_seconds": seconds,
        "time_step": None,
        "integrator": None,
        "events": _records(session, settlement.events),
    }


def _static_state(session: Session, found: StaticState) -> State:
    """In statics, work is what the path of equilibria stores and dissipates."""
    energy = dict.fromkeys(ENERGIES, 0.0) | {
        "elastic": found.elastic_energy,
        "dissipated_plastic": found.dissipated_plastic,
        "work": found.elastic_energy + found.dissipated_plastic,
    }
    columns = {
        "particles.displacement": found.displacement,
        "particles.velocity": np.zeros_like(found.displacement),
        "particles.reaction": found.reaction,
        "rods.axial_force": found.axial_force,
        "rods.length": found.length,
        "rods.strain": found.strain,
        "rods.plastic_strain": found.plastic_strain,
        "rods.yielding": found.yielding,
    }
    return state(session.model, energy, found.load_factor, found.residual, columns)


def _state(session: Session) -> State:
    return state(session.model, session.energy.as_dict(), None, session.simulation.residual)


def _records(session: Session, events: Sequence[Event]) -> list[dict[str, Any]]:
    from systems.statics.events import event_record

    return [event_record(session.model, event) for event in events]


def _run(session: Session, name: str, status: str, states: list[State]) -> dict[str, Any]:
    clock, simulation = session.model.clock, session.simulation
    return {
        "model": name,
        "status": status,
        "message": session.message,
        "time": clock.time,
        "steps": clock.steps,
        "time_step": clock.step_size,
        "integrator": simulation.integrator,
        "wall_seconds": simulation.compute_seconds,
        "compile_seconds": simulation.compile_seconds,
        "events": _records(session, session.remarks),
        "states": states,
    }
