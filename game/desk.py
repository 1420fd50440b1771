"""Desk: one open model with its run, its log and its file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from components.field import Role
from components.model import Model
from components.snapshot import Snapshot
from game import models
from game.history import History
from game.live import Live
from game.schedule import Schedule
from game.simulation import Simulation
from game.timeline import Timeline
from systems.edit.pull import Pull


@dataclass(frozen=True)
class ModelFile:
    """Where a model is saved again (None: it has no place yet), and the name that it goes by."""

    path: Path | None = None
    name: str = ""


class Desk:
    """A model and all that belongs to it while it is open.

    beginning: the state from which time began to pass. spare: where unsaved work is kept against a crash.
    """

    def __init__(self, model: Model, schedule: Schedule, pull: Pull, file: ModelFile) -> None:
        self.model = model
        self.simulation = Simulation(model, schedule)
        self.timeline = Timeline(self.simulation, pull)
        self.history = History(model, self.simulation, on_edit=self.timeline.clear)
        self.live = Live(self.simulation)
        self.beginning: Snapshot | None = None
        self.file = file
        self.spare: Path | None = None
        self.saved = self.newest

    @property
    def newest(self) -> int:
        """The revision of the newest change to anything that a file holds."""
        return self.model.newest(Role.DOCUMENT, Role.STATE)

    @property
    def unsaved(self) -> bool:
        """True if something changed, or time passed, since the model was opened or saved."""
        return self.newest > self.saved

    @property
    def edited(self) -> bool:
        """True if a person changed the model since it was opened or saved."""
        return self.model.newest(Role.DOCUMENT) > self.saved


def file_of(source: str | Path | Mapping[str, Any]) -> ModelFile:
    """The file that a source of a model is; examples and documents have none."""
    if isinstance(source, Mapping):
        return ModelFile()
    if isinstance(source, str) and source in models.bundled():
        return ModelFile(None, source)
    return ModelFile(Path(source).absolute(), Path(source).stem)
