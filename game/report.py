"""Reports: running a model without a window, and what came of it as plain data (DESIGN of the results)."""

from __future__ import annotations

from collections.abc import Sequence

from components.snapshot import Snapshot
from game.results import Run, State, state
from game.session import Session

FOUND = ("equilibrium", "at rest", "time reached")  # statuses of a run that found what was asked for


def run_until_rest(session: Session, name: str, limit: float) -> Run:
    """Run until at rest, at most `limit` s of simulated time."""
    status = session.run(until="rest", limit=limit)
    return _run(session, name, status, [_state(session)])


def run_at(session: Session, name: str, times: Sequence[float]) -> Run:
    """Run through the given times (s, ascending) and report the state at exactly each of them.

    The short last step to a reported time is taken on a copy, so that a report never changes the run.
    """
    states: list[State] = []
    status = "time reached"
    for target in times:
        status = _run_before(session, target)
        before = Snapshot.take(session.model)
        if status == "time reached":
            session.simulation.run_to(target)
        states.append(_state(session))
        if target != times[-1]:
            before.restore(session.model)
        if status == "diverged":
            break
    return _run(session, name, status, states)


def _run_before(session: Session, target: float) -> str:
    """Take all full steps that end at or before a time; at rest, time passes without steps."""
    session.run(steps=0)
    clock = session.model.clock
    status = "time reached"
    while not session.simulation.halted:
        full = session.simulation.full_steps_to(target)
        if full == 0:
            return status
        status = session.run(steps=min(full, 1 << 20))
    if status == "at rest":
        session.model.writable("clock.time")[0] = max(target, clock.time)
        return "time reached"
    return status


def _state(session: Session) -> State:
    return state(session.model, session.energy.as_dict(), None, session.simulation.residual)


def _run(session: Session, name: str, status: str, states: list[State]) -> Run:
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
        "events": [],
        "states": states,
    }
