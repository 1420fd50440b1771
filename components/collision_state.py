"""What a run with collisions goes on from besides the state of the particles, so that it goes on bit for bit.

Of a model whose particles fly free it is a FreeFlightState, of one whose particles an integrator moves it is a
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

from pinjoint.components.field import FieldError

Floats = NDArray[np.float64]
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
    motion: Floats
    contacts: Pairs
    forces: Floats
    pile: Floats


class PersistentContacts(_Saved):
    """The contacts that persist, of particles that an integrator moves.

    pairs: two particles, or a particle and an obstacle, whose number follows those of the particles, shape (k, 2).
    forces: that keep the pairs apart, N, shape (k,). longest_step: of the next step, s; ∞: as long as usual.
    """

    kind = "persistent contacts"

    def __init__(self, pairs: NDArray[np.integer[Any]], forces: Floats, longest_step: float = math.inf) -> None:
        self.pairs: Pairs = pairs.astype(np.int64)
        self.forces = forces
        self.longest_step = float(longest_step)


CollisionState = FreeFlightState | PersistentContacts
_KINDS: dict[str, type[CollisionState]] = {cls.kind: cls for cls in (FreeFlightState, PersistentContacts)}


def check_collision_state(value: Any, where: str) -> CollisionState:
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
