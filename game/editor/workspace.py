"""Workspace: the open documents, and what can be asked of and done to the one in front, in whichever scene."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

from pinjoint.components.handle import Handle
from pinjoint.components.language import begun, tr
from pinjoint.components.model import Model
from pinjoint.components.settings import Settings
from pinjoint.components.tags import Selected
from pinjoint.documents import models
from pinjoint.documents.autosave import Autosave
from pinjoint.documents.chronicle import Happening
from pinjoint.documents.open_documents import ModelFile, OpenDocument, OpenDocuments
from pinjoint.editor.clipboard import Part
from pinjoint.editor.host import ProgramPreparation, Waiting, Window
from pinjoint.systems.collision.impacts import Impacts
from pinjoint.systems.edit.pull import Pull
from pinjoint.systems.physics.pace import natural_pace
from pinjoint.systems.run.energy import Energy
from pinjoint.systems.run.simulation import Simulation
from pinjoint.systems.schedule import Schedule

H = TypeVar("H", bound=Handle)


class Workspace:
    """The open documents with their runs, logs and files, and the selection and the clipboard.

    schedule: all systems. notice: the last sentence said. copied: what was put on the clipboard last, as text and as
    data. window, autosave, preparation: what a window gives, see host.py; None without one. awaited: the simulation that
    is too large to go on before its step program is compiled.
    """

    def __init__(self, model: Model, schedule: Schedule, pull: Pull, file: ModelFile) -> None:
        self.schedule = schedule
        self.pull = pull
        self.documents = OpenDocuments(model, schedule, pull, file)
        self._clipboard = ""
        self.copied: tuple[str, Part] | None = None
        self.notice = ""
        self.window: Window | None = None
        self.autosave: Autosave | None = None
        self.preparation: ProgramPreparation | None = None
        self.awaited: Simulation | None = None

    # --- documents ---------------------------------------------------------------------------------

    @property
    def document(self) -> OpenDocument:
        """The document that is open, with its run, its log and its file."""
        return self.documents.current

    def save(self, path: str | Path) -> None:
        """Write the model, with its present state, to a file."""
        self.simulation.account_for_edits()
        models.save(self.model, Path(path))

    def save_as(self, path: str | Path) -> None:
        """Write the model to a file that is its own from now on. Raises ModelError."""
        path = Path(path)
        self.save(path)
        self.document.file, self.document.practice = ModelFile.at(path), False
        self.document.saved = self.model.revision
        self.notice = tr("Saved as '{name}'.", name=path.stem)

    @property
    def model(self) -> Model:
        """The model that is open."""
        return self.document.model

    @property
    def simulation(self) -> Simulation:
        """The run of the open document."""
        return self.document.simulation

    @property
    def settings(self) -> Settings:
        """How the model is computed and drawn."""
        return self.model.settings

    @property
    def time(self) -> float:
        """Simulated time (s)."""
        return self.model.clock.time

    @property
    def energy(self) -> Energy:
        """The energy account of the run."""
        return self.simulation.energy

    @property
    def impacts(self) -> Impacts:
        """The impacts of the run so far, in columns."""
        return self.simulation.impacts

    @property
    def events(self) -> tuple[Happening, ...]:
        """What happened in the run so far, in order of time: rods that yield, cables that go slack, collapse, rest."""
        return self.document.chronicle.happenings

    # --- time --------------------------------------------------------------------------------------

    @property
    def pace(self) -> float:
        """Simulated seconds per second shown that suit the model as it is now, whatever a person chose."""
        return natural_pace(self.model)  # found anew: the clock's may be from any earlier frame

    def settle(self, factors: Sequence[float] | float = (1.0,)) -> str:
        """Go to the static equilibrium at each load factor in turn, without letting time pass.

        Can be undone. Returns "equilibrium", "neutral equilibrium" or "unstable equilibrium"; or "mechanism",
        "collapse" or "limit reached" with the last good state; `message` says more. Time moves on to the end of the
        last load history. Raises ValueError.
        """
        status, self.notice = self.document.settle(factors)
        return status

    def has_program(self, simulation: Simulation) -> bool:
        """False while a large model waits for another process to compile its step program (see `awaited`)."""
        self.awaited = None if self.waited_for(simulation) is None else simulation
        return self.awaited is None

    def waited_for(self, simulation: Simulation) -> Waiting | None:
        """What a simulation waits for; None if it can go on."""
        return self.preparation.waits_for(simulation) if self.preparation is not None else None

    # --- editing -----------------------------------------------------------------------------------

    @property
    def can_undo(self) -> bool:
        """True if there is something to take back."""
        return self.document.history.can_undo or self.documents.can_move(-1)

    @property
    def can_redo(self) -> bool:
        """True if there is something to repeat."""
        return self.document.history.can_redo or self.documents.can_move(1)

    @property
    def selected(self) -> list[Handle]:
        """The selected elements, in order of creation."""
        return self.model.tagged(Selected)

    def selected_of(self, *kinds: type[H]) -> list[H]:
        """Those of the selected elements that are of these kinds."""
        return [handle for handle in self.selected if isinstance(handle, kinds)]

    @property
    def has_selected(self) -> bool:
        """True if anything is selected."""
        return self.model.any_tagged(Selected)

    def select(self, *handles: Handle) -> None:
        """Select exactly these elements; none: deselect."""
        self.model.tag_only(handles, Selected)

    def name(self, handle: Handle) -> str:
        """An element as a sentence begins with it, such as "Rod AB"."""
        return begun(self.model.describe(handle))

    @property
    def clipboard(self) -> str:
        """The text that was copied last, here or, with a window, in any program."""
        return self.window.copied() if self.window is not None else self._clipboard

    @clipboard.setter
    def clipboard(self, text: str) -> None:
        self._clipboard = text
        if self.window is not None:
            self.window.copy(text)
