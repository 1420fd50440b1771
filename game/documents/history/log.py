"""Log: entries of the history in order, of which only the newest keep their states in memory."""

from __future__ import annotations

import pickle
import tempfile
import weakref
from collections.abc import Hashable
from dataclasses import dataclass, replace
from typing import IO

from components.commands import Command
from components.snapshot import Snapshot
from systems.run.checkpoint import Checkpoint


@dataclass(frozen=True, slots=True)
class Edit:
    """One step that a person took; applying `inverse` takes it back.

    clock: the clock to return to then. key: edits in a row with the same key are one entry.
    """

    inverse: Command
    clock: Checkpoint
    key: Hashable | None = None


@dataclass(frozen=True, slots=True)
class Run:
    """Time that passed; returning to `before` takes it back (or, in the redo log, repeats it).

    single: it was stepped through one by one; such runs in a row are one entry.
    stored: where the state of `before` begins in a DiskStore; None: it is in memory.
    """

    before: Checkpoint
    single: bool = False
    stored: int | None = None


Entry = Edit | Run

_NOTHING = Snapshot((), (), {})


class DiskStore:
    """Snapshots in a temporary file, so that they do not fill the memory.

    The file has no name, so that nobody else can write to it, and goes away with the program.
    """

    def __init__(self) -> None:
        self._file: IO[bytes] | None = None

    def put(self, state: Snapshot) -> int:
        """Write a snapshot; returns where it begins. Raises OSError if the disk is full."""
        if self._file is None:
            self._file = tempfile.TemporaryFile()  # noqa: SIM115 (open as long as the store)
            weakref.finalize(self, self._file.close)
        place = self._file.seek(0, 2)
        pickle.dump(state, self._file, protocol=pickle.HIGHEST_PROTOCOL)
        return place

    def read(self, place: int) -> Snapshot:
        """The snapshot that begins there, bit for bit."""
        assert self._file is not None
        self._file.seek(place)
        state: Snapshot = pickle.load(self._file)
        return state


class Log:
    """Entries, the newest last; states beyond `memory` bytes go to the disk, the oldest first."""

    def __init__(self, store: DiskStore, memory: int) -> None:
        self._store = store
        self._memory = memory
        self._entries: list[Entry] = []
        self._held = 0  # bytes of states in memory,
        self._oldest = 0  # of the entries from this one on

    def __len__(self) -> int:
        return len(self._entries)

    @property
    def last(self) -> Entry | None:
        """The newest entry, or None."""
        return self._entries[-1] if self._entries else None

    def push(self, entry: Entry) -> None:
        """Add the newest entry."""
        self._entries.append(entry)
        if isinstance(entry, Run):
            self._held += entry.before.state.size
            while self._held > self._memory and self._store_oldest():
                pass

    def pop(self) -> Entry:
        """Take the newest entry out, its state in memory again."""
        entry = self._entries.pop()
        self._oldest = min(self._oldest, len(self._entries))
        if isinstance(entry, Run):
            if entry.stored is not None:
                return replace(entry, before=replace(entry.before, state=self._store.read(entry.stored)))
            self._held -= entry.before.state.size
        return entry

    def clear(self) -> None:
        """Forget all entries."""
        self._entries.clear()
        self._held = self._oldest = 0

    def _store_oldest(self) -> bool:
        """Move the oldest state that is in memory to the disk; False if that cannot be done."""
        entry = self._entries[self._oldest]
        if isinstance(entry, Run):
            try:
                stored = self._store.put(entry.before.state)
            except OSError:  # no room on the disk either
                return False
            before = replace(entry.before, state=_NOTHING)
            self._entries[self._oldest] = replace(entry, before=before, stored=stored)
            self._held -= entry.before.state.size
        self._oldest += 1
        return True
