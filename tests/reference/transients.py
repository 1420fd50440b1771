"""Transients to nearly full precision: the physics of this folder, followed by scipy from event to event.

Between events – a rod reaches its strength or unloads, a load has a kink – the motion is smooth, and a method
of order 8 with a tight tolerance follows it. An event is located first and then integrated up to, so that
nothing is interpolated. Slow; for a few rods and a few periods.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from tests.reference.elements import Model
from tests.reference.physics import Simulation

TIGHT = 1e-13  # relative tolerance of one step
MOST_EVENTS = 1000
AT_STRENGTH = 1e-12  # of it, within which a force is at a strength

Event = Callable[[float, np.ndarray], float]


class _Branched(Simulation):
    """Rods that stay on the branch of their law that they are on: 0 elastic, ±1 yielding in tension or compression."""

    branches: list[int] | None = None

    def axial_force(self, index: int, u: np.ndarray) -> float:
        """Return N [kN] on the present branch, however far."""
        if self.branches is None:
            return super().axial_force(index, u)
        branch = self.branches[index]
        return branch * self.strength(index, branch) if branch else self.elastic_force(index, u)

    def strength(self, index: int, branch: int) -> float:
        """Return the strength of a rod in tension (1) or compression (-1) [kN]."""
        rod = self.elements.rods[index]
        return rod.tensile_strength if branch > 0 else rod.compressive_strength


def follow(model: Model, duration: float) -> tuple[np.ndarray, float]:
    """Displacements (m) after so many seconds, shape (particles, 2), and the largest of any particle so far.

    Raises RuntimeError if there is no end of events.
    """
    s = _Branched(model)
    s.branches = [_first_branch(s, index) for index in range(len(s.elements.rods))]
    end, largest = s.time + duration, 0.0
    kinks = {time for load in s.elements.loads for time in load.breaks()[1::2] if s.time < time < end}
    events = 0
    for stop in sorted(kinks | {end}):
        while s.time < stop:
            largest = max(largest, _to_next_event(s, stop))
            events += 1
            if events > MOST_EVENTS:
                raise RuntimeError(f"More than {MOST_EVENTS} events until t = {s.time} s.")
    return s.u, largest


def _first_branch(s: _Branched, index: int) -> int:
    """The branch a rod begins on: one at its strength, as what began beyond it is, yields on if it goes on outwards."""
    outwards = math.copysign(1, s.elongation_rate(s.elements.rods[index], s.u, s.v))
    strength = s.strength(index, int(outwards))
    there = outwards * s.elastic_force(index, s.u) >= strength * (1.0 - AT_STRENGTH)
    return int(outwards) if there and strength < math.inf else 0


def _to_next_event(s: _Branched, stop: float) -> float:
    """Advance to the next change of a branch, or to the time `stop`; returns the largest displacement (m)."""
    watched = _ends_of_branches(s)
    until, then = stop, None
    found = _solve(s, stop, stop, [event for *_, event in watched])
    if found.status == 1:
        first = min((float(times[0]), k) for k, times in enumerate(found.t_events) if len(times))
        until, then = first[0], watched[first[1]][:2]
    if until > s.time:
        found = _solve(s, until, stop, []) if then is not None else found
        s.u, s.v = (half.reshape(-1, 2) for half in np.split(found.y[:, -1], 2))
        s.time = until
    if then is not None:
        _change_branch(s, *then)
    path = found.y[: s.u.size].reshape(-1, 2, len(found.t))
    return float(np.hypot(path[:, 0], path[:, 1]).max())


def _solve(s: _Branched, until: float, stop: float, events: list[Event]) -> Any:
    """Follow the present branches; loads are those before their next kink, at `stop`."""
    before = math.nextafter(stop, -math.inf)
    size = s.u.size

    def rates(time: float, state: np.ndarray) -> np.ndarray:
        u, v = (half.reshape(-1, 2) for half in np.split(state, 2))
        return np.concatenate([v, s.evaluate(min(time, before), u, v).acceleration]).ravel()

    start = np.concatenate([s.u, s.v]).ravel()
    floors = np.repeat([1e-17, 1e-14], size)
    span = (s.time, until)
    found = solve_ivp(rates, span, start, "DOP853", rtol=TIGHT, atol=floors, events=events or None)
    if not found.success:
        raise RuntimeError(found.message)
    return found


def _ends_of_branches(s: _Branched) -> list[tuple[int, int, Event]]:
    """Of every rod that can yield: its number, the branch it would change to, and what then passes zero."""
    assert s.branches is not None
    ends = []
    for index, branch in enumerate(s.branches):
        if not _changes(s, index):
            continue
        if branch:
            ends.append((index, 0, _unloading(s, index, branch)))
            continue
        for side in (1, -1):
            if s.strength(index, side) < math.inf:
                ends.append((index, side, _yielding(s, index, side)))
    return ends


def _changes(s: _Branched, index: int) -> bool:
    """False for a rod between two particles that are held: what is always zero would pass zero for ever."""
    rod, particles = s.elements.rods[index], s.elements.particles
    return not all(all(particles[end].fixed) for end in (rod.start, rod.end))


def _unloading(s: _Branched, index: int, branch: int) -> Event:
    def event(time: float, state: np.ndarray) -> float:
        u, v = (half.reshape(-1, 2) for half in np.split(state, 2))
        return branch * s.elongation_rate(s.elements.rods[index], u, v)

    return _terminal(event, -1)


def _yielding(s: _Branched, index: int, side: int) -> Event:
    def event(time: float, state: np.ndarray) -> float:
        u = state[: s.u.size].reshape(-1, 2)
        return side * s.elastic_force(index, u) - s.strength(index, side)

    return _terminal(event, 1)


def _terminal(event: Any, direction: int) -> Event:
    event.terminal, event.direction = True, direction
    return event


def _change_branch(s: _Branched, index: int, branch: int) -> None:
    """Let a rod go over to a branch; one that unloads has taken up what exceeded its strength."""
    assert s.branches is not None
    if branch == 0:
        rod = s.elements.rods[index]
        s.plastic_strain[index] += (s.elastic_force(index, s.u) - s.axial_force(index, s.u)) / rod.stiffness
    s.branches[index] = branch
