"""Clock: how far a run has come, and where its energy went."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pinjoint.components.collision_state import CollisionState, check_collision_state
from pinjoint.components.field import Field, FieldError, state
from pinjoint.components.handle import Handle
from pinjoint.components.snapshot import Snapshot, check_departure


def check_events(value: Any, where: str) -> Mapping[str, tuple[str, ...]]:
    """Names of elements by the name of an event, from what a model file holds. Raises FieldError."""
    if isinstance(value, Mapping) and all(isinstance(names, list | tuple) for names in value.values()):
        found = {str(event): tuple(names) for event, names in value.items()}
        if all(isinstance(name, str) for names in found.values() for name in names):
            return found
    raise FieldError(
        '{where}: write a list of names of elements for each event, such as {{"mymod.breaking": ["AB"]}}.',
        where=where,
    )


class Clock(Handle):
    """Simulated time and the energy account of the run. There is exactly one.

    time = origin + (steps − origin_steps) × time step, so that no rounding accumulates in it. Step programs
    take what they need in the order in which it is declared here. A moment within a step that is under way is an
    excursion: the step counts among `steps`, and `departure` holds the state after the step before it.
    """

    __slots__ = ()
    table, noun, single = "clock", "clock", True

    time: Field[float] = state("s", minimum=0.0, doc="Simulated time.")
    step_size: Field[float] = state("s", doc="Present fixed step; 0: not yet chosen.")
    step_error: Field[float] = state(doc="Estimated error of the last step; 1 is the tolerance.")
    largest_displacement: Field[float] = state(
        "m", doc="Largest Euclidean norm of all displacements, the scale of their error."
    )
    largest_speed: Field[float] = state(
        "m/s", doc="Largest Euclidean norm of all velocities, the scale of their error."
    )
    largest_rotation: Field[float] = state(
        "m",
        doc="Largest Euclidean norm of all rotations, as ways by about the longest rod, the scale of their error.",
    )
    largest_spin: Field[float] = state(
        "m/s", doc="Largest Euclidean norm of all angular velocities, as speeds by about the longest rod."
    )
    origin: Field[float] = state("s", title="time origin", doc="Time at which the present step size began.")
    step_limit: Field[float] = state("s", doc="Largest step when the steps were last reviewed.")
    work: Field[float] = state("J", doc="Of varying loads, edits and constant forces up to the last edit.")
    dissipated_damping: Field[float] = state(
        "J", title="dissipated by damping", doc="By axial dampers and drag."
    )
    dissipated_plastic: Field[float] = state("J", title="dissipated by yielding", doc="Σ |N| |Δε_p| L₀.")
    dissipated_impact: Field[float] = state(
        "J", title="dissipated by impacts", doc="Kinetic energy lost in impacts."
    )
    initial_energy: Field[float] = state("J", doc="Kinetic and elastic energy at the start of the run.")
    potential_reference: Field[float] = state("J", doc="Σ constant force · displacement at the last edit.")
    force_scale: Field[float] = state("kN", doc="Largest force of the run, the scale for being at rest.")
    energy_scale: Field[float] = state("J", doc="Largest energy of the run, the scale for divergence.")
    guard_energy: Field[float] = state(
        "J", doc="What the integrator conserves, less the work, when the present step size began."
    )
    largest_imbalance: Field[float] = state(
        "J", doc="Energy that the steps lost (positive) or created at most, in the run so far."
    )
    at_rest: Field[bool] = state(dtype=bool, doc="The run came to rest; edits let it go on.")
    steps: Field[int] = state(dtype=int, doc="Steps taken, one that is under way included.")
    origin_steps: Field[int] = state(dtype=int, doc="Steps at the time origin.")
    collisions: Field[int] = state(dtype=int, doc="Impacts so far.")
    events: Field[Mapping[str, tuple[str, ...]] | None] = state(
        dtype=object,
        nullable=True,
        doc="The elements whose quantity is negative, by the name of the event.",
        checker=check_events,
    )
    collision_state: Field[CollisionState | None] = state(
        dtype=object,
        nullable=True,
        doc="Paths of free particles, or persistent contacts of driven ones, so that the run goes on bit for bit.",
        checker=check_collision_state,
    )
    departure: Field[Snapshot | None] = state(
        dtype=object,
        nullable=True,
        doc="All state after the last whole step, where the present moment lies within the next; edits end it.",
        checker=check_departure,
    )


def is_error_controlled(clock: Clock) -> bool:
    """True if the integrator chooses each step by its error, to which any stiffness is good."""
    return clock.step_limit > 0.0 or clock.step_error > 0.0
