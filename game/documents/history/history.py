"""History: undo and redo of everything, from one log of edits and runs."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from dataclasses import replace

from pinjoint.components.commands import Assign, Command, Group
from pinjoint.components.field import Role
from pinjoint.components.model import Model
from pinjoint.documents.history.log import Edit, Entry, Log, Run
from pinjoint.systems.run.checkpoint import Checkpoint
from pinjoint.systems.run.simulation import Simulation


class History:
    """The log of one model, from when it was opened.

    on_change: called after every edit, and after every undo and redo, with the entry of the log. memory: bytes that the
    states before runs may take; older ones go to the disk.
    """

    def __init__(
        self,
        model: Model,
        simulation: Simulation,
        on_change: Callable[[Entry], None],
        memory: int = 256 * 2**20,
    ) -> None:
        self._done, self._undone = Log(memory), Log(memory)
        self._model = model
        self._simulation = simulation
        self._on_change = on_change
        self._run: Run | None = None
        self._run_revision = -1
        self._key: Hashable | None = None
        self._clock: Checkpoint | None = None  # before the command that is being executed
        model.before_change = self._before_change
        model.on_command = self._record

    # --- edits ---------------------------------------------------------------------------------------

    def _before_change(self) -> None:
        # Of the changes of a transaction only the first finds all earlier edits accounted for.
        if self._clock is None or self._simulation.armed:
            # Undone together with time between them.
            through_time = self._run is not None and self._key is not None
            self._clock = self._simulation.checkpoint(*(() if through_time else ("clock",)))
        self._simulation.before_change()

    def _record(self, inverse: Command) -> None:
        edit, self._clock = Edit(inverse, self._clock, self._key), None
        run, last, concerns_runs = self._run, self._done.last, edit.clock is not None
        if self._key is not None and isinstance(last, Edit) and last.key == self._key:
            self._run = None if concerns_runs else run
            edit = merged(self._done.pop(), edit)
        elif run is not None and self._add_run(run):
            self._run = None
        elif run is not None and concerns_runs:
            self._run, edit = None, replace(edit, clock=run.before)
        self._add(edit)
        self._on_change(edit)
        if run is not None:
            self.begin_run(single=run.single)

    def _add(self, entry: Entry) -> None:
        self._done.push(entry)
        self._undone.clear()

    @contextmanager
    def as_one(self, key: Hashable) -> Iterator[None]:
        """Edits inside become one entry, together with the edits just before that have the same key."""
        outer, self._key = self._key, key
        try:
            yield
        finally:
            self._key = outer

    def retract(self, key: Hashable) -> None:
        """Take back the last entry, if it has this key, as if it had never been.

        While time passes, the time that went by since stays, and the entry with it.
        """
        last = self._done.last
        if not isinstance(last, Edit) or last.key != key:
            return
        if self._run is None:
            self.undo()
            self._undone.pop()
        else:
            with self.as_one(key):
                self._model.execute(last.inverse)

    # --- runs ----------------------------------------------------------------------------------------

    def begin_run(self, *, single: bool = False) -> None:
        """Time begins to pass."""
        if self._run is None:
            self._run = Run(self._simulation.checkpoint(), single)
            self._run_revision = self._model.newest(Role.STATE)

    def end_run(self) -> None:
        """Time stops; the run since begin_run becomes one entry, if time has passed."""
        run, self._run = self._run, None
        if run is None or self._add_run(run) or self._simulation.halted:
            return  # halted: a run that diverged at once stays so
        if self._model.newest(Role.STATE) != self._run_revision:
            self._simulation.resume(run.before)  # no step was taken: getting ready alone changed the state

    def _add_run(self, run: Run) -> bool:
        """Enter a run in the log; False if no time passed in it."""
        if self._model.clock.time == run.before.time:
            return False
        last = self._done.last
        if run.single and isinstance(last, Run) and last.single:
            self._undone.clear()
        else:
            self._add(run)
        return True

    # --- going through the log -------------------------------------------------------------------------

    @property
    def can_undo(self) -> bool:
        """True if there is something to take back."""
        return len(self._done) > 0 or self._run is not None

    @property
    def can_redo(self) -> bool:
        """True if there is something to repeat."""
        return len(self._undone) > 0

    def forget_undone(self) -> None:
        """Forget what could be repeated, as an edit does."""
        self._undone.clear()

    def undo(self) -> str:
        """Take the last entry back; returns what it was, "" if there is none."""
        self.end_run()
        return self._move(self._done, self._undone)

    def redo(self) -> str:
        """Repeat the entry last taken back; returns what it was, "" if there is none."""
        self.end_run()
        return self._move(self._undone, self._done)

    def _move(self, source: Log, target: Log) -> str:
        if len(source) == 0:
            return ""
        entry = source.pop()
        if isinstance(entry, Run):
            target.push(Run(self._simulation.checkpoint(), entry.single))
            self._simulation.resume(entry.before)
            title = "run"
        else:
            # as the edit left it, such as settling at the end of a load's history
            clock = self._like(entry.clock)
            target.push(Edit(self._model.apply(entry.inverse), clock, entry.key))
            if entry.clock is not None:
                self._simulation.resume(entry.clock)
            title = _title(entry.inverse)
        self._clock = None
        self._on_change(entry)
        return title

    def _like(self, before: Checkpoint | None) -> Checkpoint | None:
        """A checkpoint of the present with as much as one before the edits has: all of the state if time passed between
        them, or if a run without time went before that only moved overlapping discs apart."""
        if before is None:
            return None
        return self._simulation.checkpoint(*(() if before.whole else ("clock",)))


def _title(command: Command) -> str:
    return (command.title if isinstance(command, Group) else "") or "edit"


def merged(earlier: Entry, later: Edit) -> Edit:
    """One edit whose inverse takes back both; of values assigned twice only the first are kept."""
    assert isinstance(earlier, Edit)
    old, new = _parts(earlier.inverse), _parts(later.inverse)
    if all(isinstance(command, Assign) for command in (*old, *new)):
        known = {_target(command) for command in old}
        new = tuple(command for command in new if _target(command) not in known)
    inverse = Group((*new, *old), _title(earlier.inverse))
    return replace(earlier, inverse=inverse, clock=earlier.clock or later.clock)


def _parts(command: Command) -> tuple[Command, ...]:
    if isinstance(command, Group):
        return tuple(part for inner in command.commands for part in _parts(inner))
    return (command,)


def _target(command: Command) -> tuple[object, ...]:
    assert isinstance(command, Assign)
    return command.table, command.field, command.entities
