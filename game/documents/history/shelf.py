"""Shelf: states of long ago, put aside in a temporary file so that they do not fill the memory."""

from __future__ import annotations

import pickle
import tempfile
import weakref
from dataclasses import dataclass
from typing import IO

from components.snapshot import Snapshot


@dataclass(frozen=True)
class Shelved:
    """Where on the shelf a snapshot begins."""

    place: int


class Shelf:
    """Its file has no name, so that nobody else can write to it, and goes away with the program."""

    def __init__(self) -> None:
        self._file: IO[bytes] | None = None

    def put(self, state: Snapshot) -> Shelved:
        """Put a snapshot aside. Raises OSError if the disk is full."""
        if self._file is None:
            self._file = tempfile.TemporaryFile()  # noqa: SIM115 (open as long as the shelf)
            weakref.finalize(self, self._file.close)
        place = self._file.seek(0, 2)
        pickle.dump(state, self._file, protocol=pickle.HIGHEST_PROTOCOL)
        return Shelved(place)

    def take(self, shelved: Shelved) -> Snapshot:
        """A snapshot as it was, bit for bit."""
        assert self._file is not None
        self._file.seek(shelved.place)
        state: Snapshot = pickle.load(self._file)
        return state
