"""Log: entries of the history in order, of which only the newest keep their states in memory."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace

from components.commands import Command
from components.snapshot import Snapshot
from game.documents.history.shelf import Shelf, Shelved
from systems.run.checkpoint import Moment


@dataclass(frozen=True, slots=True)
class Edit:
    """One step that a person took; applying `inverse` takes it back.

    clock: the clock to return to then. key: edits in a row with the same key are one entry.
    """

    inverse: Command
    clock: Moment
    key: Hashable | None = None


@dataclass(frozen=True, slots=True)
class Run:
    """Time that passed; returning to `before` takes it back (or, in the redo log, repeats it).

    single: it was stepped through one by one; such runs in a row are one entry.
    shelved: where the state of `before` is if it was put aside.
    """

    before: Moment
    single: bool = False
    shelved: Shelved | None = None


Entry = Edit | Run

_NOTHING = Snapshot((), (), {})


class Log:
    """Entries, the newest last; states beyond so many bytes are put on a shelf, the oldest first."""

    def __init__(self, shelf: Shelf, memory: int) -> None:
        self._shelf = shelf
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
            while self._held > self._memory and self._put_aside():
                pass

    def pop(self) -> Entry:
        """Take the newest entry out, its state in memory again."""
        entry = self._entries.pop()
        self._oldest = min(self._oldest, len(self._entries))
        if isinstance(entry, Run):
            if entry.shelved is not None:
                return replace(entry, before=replace(entry.before, state=self._shelf.take(entry.shelved)))
            self._held -= entry.before.state.size
        return entry

    def clear(self) -> None:
        """Forget all entries."""
        self._entries.clear()
        self._held = self._oldest = 0

    def _put_aside(self) -> bool:
        """Put the oldest state that is in memory on the shelf; False if that cannot be done."""
        entry = self._entries[self._oldest]
        if isinstance(entry, Run):
            try:
                shelved = self._shelf.put(entry.before.state)
            except OSError:  # no room on the disk either
                return False
            before = replace(entry.before, state=_NOTHING)
            self._entries[self._oldest] = replace(entry, before=before, shelved=shelved)
            self._held -= entry.before.state.size
        self._oldest += 1
        return True
