"""History: undo and redo of everything, from one log of edits and runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from components.commands import Command
from components.model import Model
from components.snapshot import Snapshot


@dataclass(frozen=True)
class Edit:
    """One step that a person took; applying `inverse` takes it back."""

    inverse: Command


@dataclass(frozen=True)
class Run:
    """Time that passed; restoring `state` takes it back (or, in the redo log, repeats it)."""

    state: Snapshot


Entry = Edit | Run


class History:
    """The log of one model, from when it was opened. `on_restore` is called after a state came back."""

    def __init__(self, model: Model, on_restore: Callable[[], None]) -> None:
        self._model = model
        self._on_restore = on_restore
        self._done: list[Entry] = []
        self._undone: list[Entry] = []
        self._run: tuple[Snapshot, int] | None = None
        model.on_command = self._record

    def _record(self, inverse: Command) -> None:
        running = self._run is not None
        self.end_run()
        self._done.append(Edit(inverse))
        self._undone.clear()
        if running:
            self.begin_run()

    def begin_run(self) -> None:
        """Time begins to pass."""
        if self._run is None:
            self._run = (Snapshot.take(self._model), self._model.clock.steps)

    def end_run(self) -> None:
        """Time stops; what passed since begin_run is one entry, if anything did."""
        if self._run is None:
            return
        before, steps = self._run
        self._run = None
        if self._model.clock.steps != steps:
            self._done.append(Run(before))
            self._undone.clear()

    @property
    def can_undo(self) -> bool:
        """True if there is something to take back."""
        return bool(self._done) or self._run is not None

    @property
    def can_redo(self) -> bool:
        """True if there is something to repeat."""
        return bool(self._undone)

    def undo(self) -> bool:
        """Take the last entry back; False if there is none."""
        self.end_run()
        return self._move(self._done, self._undone)

    def redo(self) -> bool:
        """Repeat the entry last taken back; False if there is none."""
        return self._move(self._undone, self._done)

    def _move(self, source: list[Entry], target: list[Entry]) -> bool:
        if not source:
            return False
        match source.pop():
            case Edit(inverse):
                target.append(Edit(self._model.apply(inverse)))
            case Run(state):
                target.append(Run(Snapshot.take(self._model)))
                state.restore(self._model)
                self._on_restore()
        return True
