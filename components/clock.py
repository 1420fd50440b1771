"""Clock: how far a run has come, where its energy went, and what it goes on from besides the state of the particles.

Of a model whose particles fly free that is a FreeFlightState, of one whose particles an integrator moves
PersistentContacts; a model has at most one of them, in the clock's column `collision_state`. Both are mappings: what a
model file holds.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.arrays import Array
from pinjoint.components.field import Field, FieldError, state
from pinjoint.components.handle import Handle
from pinjoint.components.snapshot import Snapshot, check_departure

Pairs = NDArray[np.int64]
_DIMENSIONS = {"motion": 2, "forces": 1, "pile": 1, "longest_step": 0}  # of attributes that are real numbers


class _Saved(Mapping[str, Any]):
    """A mapping of the kind and all attributes, in what JSON can hold: ∞ is None."""

    kind: ClassVar[str]

    def _arrays(self) -> list[NDArray[Any]]:
        return [np.asarray(value) for value in vars(self).values()]

    @property
    def nbytes(self) -> int:
        """Memory of the arrays, bytes."""
        return sum(array.nbytes for array in self._arrays())

    def __iter__(self) -> Iterator[str]:
        return iter(("kind", *vars(self)))

    def __len__(self) -> int:
        return 1 + len(vars(self))

    def __getitem__(self, key: str) -> Any:
        return self.kind if key == "kind" else _replaced(np.asarray(vars(self)[key]).tolist(), math.inf, None)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, _Saved) or type(self) is not type(other):
            return False
        return [array.tobytes() for array in self._arrays()] == [array.tobytes() for array in other._arrays()]

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"{type(self).__name__}({dict(self)!r})"


@dataclass(eq=False, repr=False)
class FreeFlightState(_Saved):
    """The paths of all particles and the contacts that persist, of particles that fly free.

    motion: one row per particle, its columns FLIGHT of systems/collision/columns.py. contacts: a particle and one that it
    touches, in the order in which the flight looks at them, shape (k, 2). forces: in the contacts, N, shape (k,). pile:
    PILE_COUNTS and PILE_NUMBERS of columns.py, how far a pile is with its steps, shape (9,).
    """

    kind = "free flight"
    motion: Array
    contacts: Pairs
    forces: Array
    pile: Array


class PersistentContacts(_Saved):
    """The contacts that persist, of particles that an integrator moves.

    pairs: two particles, or a particle and an obstacle, whose number follows those of the particles, shape (k, 2).
    forces: that keep the pairs apart, N, shape (k,). longest_step: of the next step, s; ∞: as long as usual.
    """

    kind = "persistent contacts"

    def __init__(self, pairs: NDArray[np.integer[Any]], forces: Array, longest_step: float = math.inf) -> None:
        self.pairs: Pairs = pairs.astype(np.int64)
        self.forces = forces
        self.longest_step = float(longest_step)


CollisionState = FreeFlightState | PersistentContacts
_KINDS: dict[str, type[CollisionState]] = {cls.kind: cls for cls in (FreeFlightState, PersistentContacts)}


def _check_collision_state(value: Any, where: str) -> CollisionState:
    """The collision state that a model file holds. Raises FieldError."""
    if isinstance(value, FreeFlightState | PersistentContacts):
        return value
    try:
        entries = dict(value)
        kind = _KINDS[entries.pop("kind")]
        found = kind(**{key: _read(key, entry) for key, entry in entries.items()})
        count = len(found.contacts if isinstance(found, FreeFlightState) else found.pairs)
        if len(found.forces) != count:
            raise ValueError
    except (TypeError, ValueError, KeyError, OverflowError):
        raise FieldError(
            "{where}: this is not what Pinjoint saves here. Remove it: the run then goes on with"
            " differences of round-off only.",
            where=where,
        ) from None
    return found


def _read(key: str, value: Any) -> Any:
    """An attribute as a model file holds it. Raises ValueError or TypeError."""
    if key in ("contacts", "pairs"):
        array = np.array(value, dtype=np.int64).reshape(-1, 2)
        holds = not (array < 0).any()
    else:
        array = np.array(_replaced(value, None, math.inf), dtype=np.float64)
        holds = array.ndim == _DIMENSIONS.get(key) and not np.isnan(array).any()
    if not holds:
        raise ValueError
    return array


def _replaced(value: Any, old: Any, new: Any) -> Any:
    """A value, or nested lists of values, with another one in place of `old`."""
    if isinstance(value, list | tuple):
        return [_replaced(entry, old, new) for entry in value]
    return new if value == old else value


def _check_events(value: Any, where: str) -> Mapping[str, tuple[str, ...]]:
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
        checker=_check_events,
    )
    collision_state: Field[CollisionState | None] = state(
        dtype=object,
        nullable=True,
        doc="Paths of free particles, or persistent contacts of driven ones, so that the run goes on bit for bit.",
        checker=_check_collision_state,
    )
    departure: Field[Snapshot | None] = state(
        dtype=object,
        nullable=True,
        doc="All state after the last whole step, where the present moment lies within the next; edits end it.",
        checker=check_departure,
    )
