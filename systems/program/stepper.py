"""What a run asks of whatever moves a model: two protocols that every way to advance time follows.

Program         compiled laws and an integrator         systems/program/program.py        Dynamics
Flight          exact paths from impact to impact       systems/collision/free/flight.py  Dynamics and Stepper
ProgramSteps    the steps of a Program                  systems/run/program_steps.py      Stepper
DrivenCollisions those steps, ended at impacts           systems/collision/driven/         Stepper
"""

from __future__ import annotations

import math
from typing import Protocol

from components.field import Column
from components.handle import Handle
from systems.base import Event, StopReason


class Dynamics(Protocol):
    """Forces and energies of one model, by the systems of its plan, bound to its columns.

    measures: kinetic, fᵀM⁻¹f, elastic, potential energy (J), residual, largest force, round-off (kN) and power (W)
        of the state last observed.
    compile_seconds: what compiling it took, or loading it from the cache.
    watches_events: it stops where the quantity of an Event changes sign; take_events() then says which did.
    follows_state: loads apart, what is at rest stays so, for forces follow from nothing but the state.
    """

    measures: Column
    compile_seconds: float
    follows_state: bool

    @property
    def watches_events(self) -> bool:
        """True if it may stop for events."""

    def take_events(self) -> list[tuple[Event, list[Handle], list[Handle]]]:
        """The events since the last call, with the elements whose quantity fell and rose."""

    @property
    def unbalanced(self) -> Column:
        """Sum of all forces on each particle but those of dampers and drag (kN), shape (n, 2), as last observed."""

    @property
    def changes_end(self) -> float:
        """The time (s) from which on nothing changes but by motion."""

    @property
    def lasting(self) -> str:
        """The name of a system that changes with time for ever, or ""."""

    @property
    def resists_motion(self) -> bool:
        """True if something takes energy from motion."""

    def bind(self) -> None:
        """Take hold of the model's columns; needed after every change of its document."""

    def commit(self) -> None:
        """Let history take note of a state that no step has led to."""

    def observe(self) -> None:
        """Bring the derived columns and the measures up to date with the state."""

    def conserved_energy(self) -> float:
        """What the integrator conserves, less the work done so far (J), in the state last observed."""


class Stepper(Protocol):
    """What takes the steps of one model."""

    def advance(self, steps: int, until: float = math.inf, landing: float = math.inf) -> tuple[int, StopReason]:
        """Take up to `steps` steps, none of which ends after `until` (s); returns how many, and why it stopped.

        A step that would pass `landing` (s) may be cut to end there.
        """

    def land(self, target: float) -> StopReason:
        """Take the last, short step, to exactly the time `target` (s)."""
