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
    what was edited. key: edits in a row with the same key are one entry.
    """

    inverse: Command
    clock: Checkpoint | None
    key: Hashable | None = None

    @property
    def whole(self) -> Checkpoint | None:
        """The checkpoint with all of the state, if there is one."""
        return self.clock if self.clock is not None and self.clock.whole else None


@dataclass(frozen=True, slots=True)
class Run:
    """Time that passed; returning to `before` takes it back (or, in the redo log, repeats it).

    single: it was stepped through one by one; such runs in a row are one entry.
    """

    before: Checkpoint
    single: bool = False

    @property
    def whole(self) -> Checkpoint:
        """The checkpoint with all of the state."""
        return self.before


Entry = Edit | Run


class Log:
    """Entries, the newest last; states beyond `memory` bytes go to a temporary file, the oldest first.

    The file has no name, so that nobody else can write to it, and goes away with the program.
    """

    def __init__(self, memory: int) -> None:
        self._memory = memory
        self._entries: list[Entry] = []
        self._held = 0  # bytes of states in memory,
        self._oldest = 0  # of the entries from this one on
        self._file: IO[bytes] | None = None
        self._places: dict[int, int] = {}  # where in the file the state of an entry begins

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
        """Take the newest entry out, its state in memory again, bit for bit."""
        entry, at = self._entries.pop(), len(self._entries)
        self._oldest = min(self._oldest, at)
        if at in self._places:
            assert self._file is not None
            self._file.seek(self._places.pop(at))
            return _with_state(entry, pickle.load(self._file))
        if entry.whole is not None:
            self._held -= entry.whole.state.nbytes
        return entry

    def clear(self) -> None:
        """Forget all entries."""
        self._entries.clear()
        self._places.clear()
        self._held = self._oldest = 0

    def _store_oldest(self) -> bool:
        """Move the oldest state that is in memory to the file; False if that cannot be done."""
        entry = self._entries[self._oldest]
        if entry.whole is not None:
            try:
                if self._file is None:
                    self._file = tempfile.TemporaryFile()  # noqa: SIM115 (open as long as the log)
                    weakref.finalize(self, self._file.close)
                place = self._file.seek(0, 2)
                pickle.dump(entry.whole.state, self._file, protocol=pickle.HIGHEST_PROTOCOL)
            except OSError:  # no room on the disk either
                return False
            self._places[self._oldest] = place
            self._held -= entry.whole.state.nbytes
            self._entries[self._oldest] = _with_state(entry, Snapshot({}, {}))
        self._oldest += 1
        return True


def _with_state(entry: Entry, state: Snapshot) -> Entry:
    """The entry with another state in its checkpoint."""
    if isinstance(entry, Run):
        return replace(entry, before=replace(entry.before, state=state))
    assert entry.clock is not None
    return replace(entry, clock=replace(entry.clock, state=state))
