"""Shelf: states of long ago, put aside in a temporary file so that they do not fill the memory."""

from __future__ import annotations

import tempfile
import weakref
from dataclasses import dataclass
from typing import IO

import numpy as np

from components.snapshot import Snapshot


@dataclass(frozen=True)
class Shelved:
    """Where on the shelf a snapshot begins, and the names of what follows there."""

    place: int
    columns: tuple[str, ...]
    entities: tuple[str, ...]


class Shelf:
    """Its file goes away with the program."""

    def __init__(self) -> None:
        self._file: IO[bytes] | None = None

    def put(self, state: Snapshot) -> Shelved:
        """Put a snapshot aside. Raises OSError if the disk is full."""
        if self._file is None:
            self._file = tempfile.TemporaryFile()  # noqa: SIM115 (open as long as the shelf)
            weakref.finalize(self, self._file.close)
        place = self._file.seek(0, 2)
        for column in (*state.columns.values(), *state.entities.values()):
            np.save(self._file, column, allow_pickle=False)
        return Shelved(place, tuple(state.columns), tuple(state.entities))

    def take(self, shelved: Shelved) -> Snapshot:
        """A snapshot as it was, bit for bit."""
        assert self._file is not None
        self._file.seek(shelved.place)
        return Snapshot(
            {name: np.load(self._file) for name in shelved.columns},
            {name: np.load(self._file) for name in shelved.entities},
        )
