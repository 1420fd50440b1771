"""Log: entries of the history in order, of which only the newest keep their states in memory."""

from __future__ import annotations

import pickle
import tempfile
import weakref
from collections.abc import Hashable
from dataclasses import dataclass, replace
from typing import IO

from pinjoint.components.commands import Command
from pinjoint.components.snapshot import Snapshot
from pinjoint.systems.run.checkpoint import Checkpoint


@dataclass(frozen=True, slots=True)
class Edit:
    """One step that a person took; applying `inverse` takes it back.

    clock: the clock to return to then, with all of the state if time passed during the edit; None: no run depends on
    what was edited. key: edits in a row with the same key are one entry. stored: as of a run.
    """

    inverse: Command
    clock: Checkpoint | None
    key: Hashable | None = None
    stored: int | None = None

    @property
    def whole(self) -> Checkpoint | None:
        """The checkpoint with all of the state, if there is one."""
        return self.clock if self.clock is not None and self.clock.whole else None


@dataclass(frozen=True, slots=True)
class Run:
    """Time that passed; returning to `before` takes it back (or, in the redo log, repeats it).

    single: it was stepped through one by one; such runs in a row are one entry.
    stored: where the state of `before` begins in a DiskStore; None: it is in memory.
    """

    before: Checkpoint
    single: bool = False
    stored: int | None = None

    @property
    def whole(self) -> Checkpoint:
        """The checkpoint with all of the state."""
        return self.before


Entry = Edit | Run

_NOTHING = Snapshot({}, {})


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
        if entry.whole is not None:
            self._held += entry.whole.state.nbytes
            while self._held > self._memory and self._store_oldest():
                pass

    def pop(self) -> Entry:
        """Take the newest entry out, its state in memory again."""
        entry = self._entries.pop()
        self._oldest = min(self._oldest, len(self._entries))
        if entry.stored is not None:
            return _with_state(entry, self._store.read(entry.stored), None)
        if entry.whole is not None:
            self._held -= entry.whole.state.nbytes
        return entry

    def clear(self) -> None:
        """Forget all entries."""
        self._entries.clear()
        self._held = self._oldest = 0

    def _store_oldest(self) -> bool:
        """Move the oldest state that is in memory to the disk; False if that cannot be done."""
        entry = self._entries[self._oldest]
        if entry.whole is not None:
            try:
                stored = self._store.put(entry.whole.state)
            except OSError:  # no room on the disk either
                return False
            self._entries[self._oldest] = _with_state(entry, _NOTHING, stored)
            self._held -= entry.whole.state.nbytes
        self._oldest += 1
        return True


def _with_state(entry: Entry, state: Snapshot, stored: int | None) -> Entry:
    """The entry with another state in its checkpoint."""
    if isinstance(entry, Run):
        return replace(entry, before=replace(entry.before, state=state), stored=stored)
    assert entry.clock is not None
    return replace(entry, clock=replace(entry.clock, state=state), stored=stored)
