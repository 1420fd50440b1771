"""What a run with collisions goes on from besides the state of the particles, so that it goes on bit for bit.

Of a model whose particles fly free it is a FreeFlightState, of one whose particles an integrator moves it is a
PersistentContacts; a model has at most one of them, in the clock's column `collision_state`. Both are mappings: what a
model file holds. Files written before the two were told apart hold one mapping for both, under the key `paths`
(see `_from_paths`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from components.field import FieldError

Floats = NDArray[np.float64]
Pairs = NDArray[np.int64]


class _Saved(Mapping[str, Any]):
    """A mapping of its attributes `keys`, with its `kind`, in what JSON can hold: ∞ is None."""

    kind: ClassVar[str]
    keys_saved: ClassVar[tuple[str, ...]]

    @property
    def nbytes(self) -> int:
        """Memory of the arrays, bytes."""
        return sum(np.asarray(getattr(self, key)).nbytes for key in self.keys_saved)

    def __iter__(self) -> Iterator[str]:
        return iter(("kind", *self.keys_saved))

    def __len__(self) -> int:
        return 1 + len(self.keys_saved)

    def __getitem__(self, key: str) -> Any:
        if key == "kind":
            return self.kind
        if key not in self.keys_saved:
            raise KeyError(key)
        return _without_infinity(np.asarray(getattr(self, key)).tolist())

    def __repr__(self) -> str:
        return f"{type(self).__name__}({dict(self)!r})"

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and all(
            np.asarray(getattr(self, key)).tobytes() == np.asarray(getattr(other, key)).tobytes()
            for key in self.keys_saved
        )

    __hash__ = None  # type: ignore[assignment]


class FreeFlightState(_Saved):
    """The parabolas of all particles and the contacts that last, of particles that fly free.

    motion: one row per particle, its columns FLIGHT of systems/collision/columns.py. contacts: a particle and one that it
    touches, in the order in which the flight looks at them, shape (k, 2). forces: in the contacts, N, shape (k,). pile:
    PILE_COUNTS and PILE_NUMBERS of columns.py, how far a pile is with its steps, shape (7,).
    """

    kind = "free flight"
    keys_saved = ("motion", "contacts", "forces", "pile")

    def __init__(self, motion: Floats, contacts: Pairs, forces: Floats, pile: Floats) -> None:
        self.motion = motion
        self.contacts = contacts
        self.forces = forces
        self.pile = pile


class PersistentContacts(_Saved):
    """The contacts that last, of particles that an integrator moves.

    pairs: two particles, or a particle and an obstacle, which counts on after the particles, shape (k, 2).
    forces: that keep the pairs apart, N, shape (k,). longest_step: of the next step, s; ∞: as long as usual.
    """

    kind = "persistent contacts"
    keys_saved = ("pairs", "forces", "longest_step")

    def __init__(self, pairs: NDArray[np.integer[Any]], forces: Floats, longest_step: float = math.inf) -> None:
        self.pairs: Pairs = pairs.astype(np.int64)
        self.forces = forces
        self.longest_step = longest_step


CollisionState = FreeFlightState | PersistentContacts


def check_collision_state(value: Any, where: str) -> CollisionState:
    """The collision state that a model file holds. Raises FieldError."""
    if isinstance(value, FreeFlightState | PersistentContacts):
        return value
    try:
        return _from_paths(value) if "kind" not in value else _from_file(value)
    except (TypeError, ValueError, KeyError, OverflowError):
        raise FieldError(
            f"{where}: it is not what a saved run holds; remove it, and the run goes on to within round-off."
        ) from None


def _from_file(value: Mapping[str, Any]) -> CollisionState:
    kind = {cls.kind: cls for cls in (FreeFlightState, PersistentContacts)}[value["kind"]]
    _expect(set(value) == {"kind", *kind.keys_saved})
    if kind is FreeFlightState:
        return FreeFlightState(
            _motion(value["motion"]), *_contacts(value["contacts"], value["forces"]), _vector(value["pile"])
        )
    longest = value["longest_step"]
    return _persistent(value["pairs"], value["forces"], math.inf if longest is None else longest)


def _from_paths(value: Mapping[str, Any]) -> CollisionState:
    """From files of earlier programs: with motion, `crowd` is the pile; without, at most the longest step."""
    _expect(set(value) == {"motion", "contacts", "forces", "crowd"})
    if len(value["motion"]):
        return _from_file(
            {
                "kind": FreeFlightState.kind,
                "motion": value["motion"],
                "contacts": value["contacts"],
                "forces": value["forces"],
                "pile": value["crowd"],
            }
        )
    crowd = _vector(value["crowd"])
    _expect(len(crowd) <= 1)
    return _persistent(value["contacts"], value["forces"], *crowd.tolist())


def _persistent(pairs: Any, forces: Any, longest_step: float = math.inf) -> PersistentContacts:
    longest = float(longest_step)
    _expect(longest > 0.0)
    return PersistentContacts(*_contacts(pairs, forces), longest)


def _contacts(pairs: ArrayLike, forces: ArrayLike) -> tuple[Pairs, Floats]:
    rows, values = np.array(pairs, dtype=np.int64).reshape(-1, 2), _vector(forces)
    _expect(len(rows) == len(values) and not (rows < 0).any())
    return rows, values


def _motion(value: Any) -> Floats:
    motion = np.array(
        [[math.inf if number is None else number for number in row] for row in value], dtype=np.float64
    )
    _expect(motion.ndim == 2 and not np.isnan(motion).any())
    return motion


def _vector(value: ArrayLike) -> Floats:
    vector = np.array(value, dtype=np.float64)
    _expect(vector.ndim == 1)
    return vector


def _expect(holds: bool) -> None:
    if not holds:
        raise ValueError


def _without_infinity(value: Any) -> Any:
    if isinstance(value, list):
        return [_without_infinity(entry) for entry in value]
    return None if value == math.inf else value
