"""Paths: what particles that fly free are on, and which of them rest on one another."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from components.field import FieldError

_KEYS = ("motion", "contacts", "forces", "crowd")


class Paths(Mapping[str, Any]):
    """The parabolas of all particles and their lasting contacts; with them a run goes on bit for bit.

    motion: one row per particle, its columns those of systems.collision.columns.MOVING. contacts: a particle
    and one that it touches, in the order in which they are looked at, shape (k, 2). forces: in them, N.
    crowd: how far a pile is with its steps, as Discs.paths has it; of particles that do not fly free, the longest step
    (s) to begin with, if that is short.

    As a mapping it is what a model file holds.
    """

    def __init__(
        self,
        motion: NDArray[np.float64],
        contacts: NDArray[np.int64],
        forces: NDArray[np.float64],
        crowd: NDArray[np.float64],
    ) -> None:
        self.motion = motion
        self.contacts = contacts
        self.forces = forces
        self.crowd = crowd

    @property
    def nbytes(self) -> int:
        """Memory that it takes."""
        return sum(getattr(self, key).nbytes for key in _KEYS)

    def __iter__(self) -> Iterator[str]:
        return iter(_KEYS)

    def __len__(self) -> int:
        return len(_KEYS)

    def __getitem__(self, key: str) -> Any:
        if key not in _KEYS:
            raise KeyError(key)
        values = getattr(self, key).tolist()
        if key == "motion":  # no file can hold infinity
            return [[None if number == math.inf else number for number in row] for row in values]
        return values

    def __repr__(self) -> str:
        return f"Paths({dict(self)!r})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Paths) and all(
            getattr(self, key).tobytes() == getattr(other, key).tobytes() for key in _KEYS
        )

    __hash__ = None  # type: ignore[assignment]


def resting(
    contacts: NDArray[np.integer[Any]], forces: NDArray[np.float64], longest: float = math.inf
) -> Paths:
    """Paths of particles that do not fly free, of which these are in lasting contact.

    longest: step (s) to begin with, where one as long as usual is too long.
    """
    crowd = np.array([longest] if longest < math.inf else [])
    return Paths(np.zeros((0, 0)), contacts.astype(np.int64), forces, crowd)


def longest_step(paths: Paths) -> float:
    """The step (s) that particles in lasting contact begin with, if they do not fly free; infinite if that is as usual."""
    return float(paths.crowd[0]) if len(paths.crowd) else math.inf


def check_paths(value: Any, where: str) -> Paths:
    """Paths from what a model file holds. Raises FieldError."""
    if isinstance(value, Paths):
        return value
    try:
        numbers = [[math.inf if number is None else number for number in row] for row in value["motion"]]
        motion = np.array(numbers, dtype=np.float64) if numbers else np.zeros((0, 0))
        contacts = np.array(value["contacts"], dtype=np.int64).reshape(-1, 2)
        forces = np.array(value["forces"], dtype=np.float64).reshape(-1)
        crowd = np.array(value["crowd"], dtype=np.float64)
        whole = set(value) == set(_KEYS) and motion.ndim == 2 and len(forces) == len(contacts)
        whole = whole and crowd.ndim == 1
    except (TypeError, ValueError, KeyError, OverflowError):
        whole = False
    if not whole or (contacts < 0).any() or np.isnan(motion).any():
        raise FieldError(
            f"{where}: paths are not what a saved run holds; remove them, and it goes on to within round-off."
        )
    return Paths(motion, contacts, forces, crowd)
