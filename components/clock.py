"""Clock: how far a run has come, and where its energy went."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from components.collision_state import CollisionState, check_collision_state
from components.field import Field, FieldError, Role
from components.handle import Handle


def check_events(value: Any, where: str) -> Mapping[str, tuple[str, ...]]:
    """Names of elements by the name of an event, from what a model file holds. Raises FieldError."""
    if isinstance(value, Mapping) and all(isinstance(names, list | tuple) for names in value.values()):
        found = {str(event): tuple(names) for event, names in value.items()}
        if all(isinstance(name, str) for names in found.values() for name in names):
            return found
    raise FieldError(f'{where}: write the names of elements by event, such as {{"mymod.breaking": ["AB"]}}.')


class Clock(Handle):
    """Simulated time and the energy account of the run. There is exactly one.

    time = origin + (steps − origin_steps) × time step, so that no rounding accumulates in it. Step programs
    take what they need in the order in which it is declared here.
    """

    __slots__ = ()
    table, noun, single = "clock", "clock", True

    time: Field[float] = Field("s", role=Role.STATE, minimum=0.0, doc="Simulated time.")
    step_size: Field[float] = Field("s", role=Role.STATE, doc="Present fixed step; 0: not yet chosen.")
    step_error: Field[float] = Field(
        role=Role.STATE, doc="Estimated error of the last step; 1 is the tolerance."
    )
    largest_displacement: Field[float] = Field(
        "m", role=Role.STATE, doc="Largest Euclidean norm of all displacements, the scale of their error."
    )
    largest_speed: Field[float] = Field(
        "m/s", role=Role.STATE, doc="Largest Euclidean norm of all velocities, the scale of their error."
    )
    origin: Field[float] = Field(
        "s", role=Role.STATE, title="time origin", doc="Time at which the present step size began."
    )
    step_limit: Field[float] = Field(
        "s", role=Role.STATE, doc="Largest step when the steps were last reviewed."
    )
    work: Field[float] = Field(
        "J", role=Role.STATE, doc="Of varying loads, edits and constant forces up to the last edit."
    )
    dissipated_damping: Field[float] = Field(
        "J", role=Role.STATE, title="dissipated by damping", doc="By axial dampers and drag."
    )
    dissipated_plastic: Field[float] = Field(
        "J", role=Role.STATE, title="dissipated by yielding", doc="Σ |N| |Δε_p| L₀."
    )
    dissipated_impact: Field[float] = Field(
        "J", role=Role.STATE, title="dissipated by impacts", doc="Kinetic energy lost in impacts."
    )
    initial_energy: Field[float] = Field(
        "J", role=Role.STATE, doc="Kinetic and elastic energy at the start of the run."
    )
    potential_reference: Field[float] = Field(
        "J", role=Role.STATE, doc="Σ constant force · displacement at the last edit."
    )
    force_scale: Field[float] = Field(
        "kN", role=Role.STATE, doc="Largest force of the run, the scale for being at rest."
    )
    energy_scale: Field[float] = Field(
        "J", role=Role.STATE, doc="Largest energy of the run, the scale for divergence."
    )
    guard_energy: Field[float] = Field(
        "J",
        role=Role.STATE,
        doc="What the integrator conserves, less the work, when the present step size began.",
    )
    steps: Field[int] = Field(dtype=int, role=Role.STATE, doc="Fixed steps taken.")
    origin_steps: Field[int] = Field(dtype=int, role=Role.STATE, doc="Steps at the time origin.")
    collisions: Field[int] = Field(dtype=int, role=Role.STATE, doc="Impacts so far.")
    events: Field[Mapping[str, tuple[str, ...]] | None] = Field(
        dtype=object,
        nullable=True,
        role=Role.STATE,
        doc="The elements whose quantity is negative, by the name of the event.",
        checker=check_events,
    )
    collision_state: Field[CollisionState | None] = Field(
        dtype=object,
        nullable=True,
        role=Role.STATE,
        doc="Paths of free particles, or persistent contacts of driven ones, so that the run goes on bit for bit.",
        checker=check_collision_state,
    )
