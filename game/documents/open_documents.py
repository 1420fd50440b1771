"""Desk: one open model with its run, its log and its file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from components.field import Role
from components.model import Model
from components.snapshot import Snapshot
from game.documents import models
from game.documents.assessment import Assessment
from game.documents.history.history import History
from game.documents.history.log import Edit, Entry
from game.documents.history.timeline import Timeline
from game.editor.shapes import Shapes
from systems.edit.pull import Pull
from systems.run.real_time import RealTimeRunner
from systems.run.simulation import Simulation
from systems.schedule import Schedule

Stamp = tuple[int, ...]


@dataclass(frozen=True)
class ModelFile:
    """Where a model is saved again (None: it has no place yet), and the name that it goes by.

    stamp: of what the file held when it was opened or saved.
    """

    path: Path | None = None
    name: str = ""
    stamp: Stamp = ()

    @classmethod
    def at(cls, path: Path) -> ModelFile:
        """The file there, as it is now."""
        return cls(path, path.stem, stamp_of(path))


def stamp_of(path: Path) -> Stamp:
    """What is another one as soon as anybody has written to a file; () if there is none."""
    try:
        found = path.stat()
    except OSError:
        return ()
    return found.st_ino, found.st_mtime_ns, found.st_size


class Desk:
    """A model and all that belongs to it while it is open.

    beginning: the state from which time began to pass. saved: the revision of what its file holds.
    spare: where unsaved work is kept against a crash.
    """

    def __init__(self, model: Model, schedule: Schedule, pull: Pull, file: ModelFile) -> None:
        self.model = model
        self._pull = pull
        self.simulation = Simulation(model, schedule)
        self.timeline = Timeline(self.simulation, pull)
        self.history = History(model, self.simulation, on_change=self._changed)
        self.live = RealTimeRunner(self.simulation)
        self.beginning: Snapshot | None = None
        self.assessment = Assessment(model, self.simulation)
        self.shapes = Shapes(model)
        self.file = file
        self.spare: Path | None = None
        self.saved = self._last_edit = model.revision

    def _changed(self, entry: Entry) -> None:
        self._last_edit = self.model.revision
        self.timeline.clear()
        if isinstance(entry, Edit):
            self.assessment.disturb()

    def begin(self) -> None:
        """Time begins to pass from the present state."""
        self.beginning = self.simulation.present()
        self.assessment.begin(self.beginning)

    @property
    def newest(self) -> int:
        """The revision of the newest change to anything that a file holds."""
        return self.model.newest(Role.DOCUMENT, Role.STATE)

    @property
    def unsaved(self) -> bool:
        """True if a person changed the model since it was opened or saved, or let time pass in one of theirs."""
        return self.edited or (self.file.path is not None and self.newest > self.saved)

    def leave(self) -> None:
        """Its time stops, nothing of it is held any more, and what only helps to step back is forgotten."""
        if self._pull.hand is not None:
            self.timeline.hold(None)
        self.history.end_run()
        self.timeline.clear()

    @property
    def edited(self) -> bool:
        """True if a person changed the model since it was opened or saved."""
        return self._last_edit > self.saved


class Desks:
    """The open models, one of them in use; those with unsaved work wait to be gone back to."""

    def __init__(self, model: Model, schedule: Schedule, pull: Pull, file: ModelFile) -> None:
        self._schedule = schedule
        self._pull = pull
        self._desks = [Desk(model, schedule, pull, file)]
        self._at = 0

    def __iter__(self) -> Iterator[Desk]:
        return iter(tuple(self._desks))

    def __len__(self) -> int:
        return len(self._desks)

    @property
    def current(self) -> Desk:
        """The one in use."""
        return self._desks[self._at]

    def add(self, model: Model, file: ModelFile) -> None:
        """Use a new desk with this model; the one in use until now stays if it has unsaved work.

        What could be done again here is forgotten, as by any edit. Work on the desks that were gone back from
        is not: they come before this one now, with all that was done on them.
        """
        self.current.leave()
        self.current.history.forget_undone()
        earlier, later = self._desks[: self._at], self._desks[self._at + 1 :]
        for desk in later:
            desk.history.redo_all()
        here = [self.current] if self.current.unsaved else []
        self._desks = [*earlier, *later, *here, Desk(model, self._schedule, self._pull, file)]
        self._at = len(self._desks) - 1

    def can_move(self, by: int) -> bool:
        """True if there is a desk before (-1) or after (1) this one."""
        return 0 <= self._at + by < len(self._desks)

    def move(self, by: int) -> str:
        """Use the desk before (-1) or after (1) this one; returns what that undoes or repeats, or ""."""
        target = self._at + by
        if not self.can_move(by):
            return ""
        self.current.leave()
        opened = self._desks[max(self._at, target)].file.name
        self._at = target
        return f"opening {opened or 'a new model'}"


def file_of(source: str | Path | Mapping[str, Any]) -> ModelFile:
    """The file that a source of a model is; examples and documents have none."""
    if isinstance(source, Mapping):
        return ModelFile()
    if isinstance(source, str) and source in models.bundled():
        return ModelFile(None, source)
    return ModelFile.at(Path(source).absolute())
