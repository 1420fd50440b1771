"""Open documents: models with their runs, their logs and their files, one of them in use."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pinjoint.components.clock import PersistentContacts
from pinjoint.components.field import SAVED, Column, Role
from pinjoint.components.language import joined, plural, tr
from pinjoint.components.latest import Latest
from pinjoint.components.load import load_ends
from pinjoint.components.model import Model
from pinjoint.components.particle import of_rigid_supports
from pinjoint.components.rod import idle_moment
from pinjoint.components.snapshot import Snapshot
from pinjoint.documents import models
from pinjoint.documents.assessment import Assessment
from pinjoint.documents.chronicle import Chronicle
from pinjoint.documents.exaggeration import Exaggeration
from pinjoint.documents.history.history import History
from pinjoint.documents.history.log import Edit, Entry
from pinjoint.documents.history.timeline import Timeline
from pinjoint.documents.shapes import Shapes
from pinjoint.documents.statics import Statics
from pinjoint.systems.catalogue import left_out_of_statics
from pinjoint.systems.edit.pull import Pull
from pinjoint.systems.run.real_time import RealTimeRunner
from pinjoint.systems.run.simulation import Simulation
from pinjoint.systems.schedule import Schedule

if TYPE_CHECKING:  # statics takes a tenth of a second to import
    from pinjoint.systems.statics.envelope import Envelope

Source = str | Path | Mapping[str, Any]  # of a model: a file, the name of a bundled one, or its content

_YIELDED = ("rods.plastic_strain", "rods.plastic_rotation")
SETTLED = ("particles.displacement", "particles.rotation", *_YIELDED)  # what settling changes


@dataclass(frozen=True)
class ModelFile:
    """The file of a model and its name. path: None if the model was never saved.

    stamp: of the content when it was opened or saved; another one whenever the file is written.
    """

    path: Path | None = None
    name: str = ""
    stamp: tuple[int, ...] = ()

    @classmethod
    def at(cls, path: Path) -> ModelFile:
        """The file at a path with its present stamp, () if there is none."""
        try:
            found = path.stat()
        except OSError:
            return cls(path, models.name_of(path))
        return cls(path, models.name_of(path), (found.st_ino, found.st_mtime_ns, found.st_size))


class OpenDocument:
    """A model and all that belongs to it while it is open.

    beginning: the state from which time began to pass. undeformed: that in which it was neither run nor settled yet;
    None until then, or if its file does not say. saved: the revision of what its file holds.
    recovery: the file that keeps unsaved work against a crash. practice: it belongs to a lesson, and asks for no saving.
    pull: the hand on a particle.
    """

    def __init__(self, model: Model, schedule: Schedule, pull: Pull, file: ModelFile) -> None:
        self.model = model
        self.pull = pull
        self.simulation = Simulation(model, schedule)
        self.timeline = Timeline(self.simulation, pull)
        self.history = History(model, self.simulation, on_change=self._changed)
        self.live = RealTimeRunner(self.simulation)
        self.beginning: Snapshot | None = None
        self.undeformed: Snapshot | None = None
        self.assessment = Assessment(model, self.simulation)
        self.shapes = Shapes(model)
        self.statics = Statics(model, self._permanent_undeformed)
        self._enveloped = Latest["Envelope"]()
        self.exaggeration = Exaggeration(model)
        self.chronicle = Chronicle(model, self.simulation)
        self.file = file
        self.recovery: Path | None = None
        self.practice = False
        self.saved = self._last_edit = model.revision

    def _changed(self, entry: Entry) -> None:
        self._last_edit = self.model.revision
        if isinstance(entry, Edit) and entry.clock is None:
            return  # it only changed how the model is drawn
        self.timeline.clear()
        if isinstance(entry, Edit):
            self.assessment.disturb()

    # --- time --------------------------------------------------------------------------------------

    @property
    def at_beginning(self) -> bool:
        """True if no time has passed, or restarting took it back."""
        return self.beginning is None or not self.simulation.passed_since(self.beginning)

    def envelope(self, path: Sequence[str] = ()) -> Envelope:
        """That of all combinations in statics, or of a force along a path, found anew after an edit. Raises ValueError."""
        of = self.model.newest(Role.DOCUMENT), tuple(path)
        return self._enveloped.get(of, lambda: self.statics.envelope(path=path))

    @property
    def is_undeformed(self) -> bool:
        """True if it was neither run nor settled, or that was taken back."""
        if self.undeformed is None:
            return bool(self.model.clock.time == 0.0)
        if self.simulation.passed_since(self.undeformed):
            return False
        return all(
            np.array_equal(self.undeformed.column(self.model, name), self._held(name)) for name in SETTLED
        )

    def _held(self, name: str) -> Column:
        """A column of the state, whatever is shown in its place."""
        table, _, field = name.partition(".")
        return self.model.tables[table].storage(field)

    def _permanent_undeformed(self) -> Column:
        """The plastic strain and rotations from before it was run or settled, (rods, 3)."""
        if self.is_undeformed:
            return np.column_stack([self._held(name) for name in _YIELDED])
        begun = self.undeformed or Snapshot.initial(self.model)
        return np.column_stack([begun.column(self.model, name) for name in _YIELDED])

    def _note_undeformed(self) -> None:
        """Time is about to pass, or the structure to settle."""
        if self.is_undeformed:
            self.undeformed = self.simulation.present()

    def note_beginning(self) -> None:
        """Time is about to pass: if none has passed yet, it begins at the present state."""
        self._note_undeformed()
        if self.at_beginning:
            self.beginning = self.simulation.present()
            self.assessment.begin(self.beginning)

    def get_ready(self) -> None:
        """Account for edits as if a frame had begun, so that what follows does not depend on when frames do."""
        self.note_beginning()
        if not self.simulation.halted:
            self.simulation.advance(0)

    def restart(self) -> None:
        """Go back to before the first run and the first settling, keeping all edits; the log ends the run.

        Where the file does not say how that was, to the original positions, at rest.
        """
        self.history.end_run()
        begun = self.undeformed or Snapshot.initial(self.model)
        if self.model.clock.time == begun.columns["clock.time"][0]:
            self._unsettle(begun)
            return
        self.history.begin_run()
        begun.restore(self.model)
        particles = self.model.particles
        self.model.writable("particles.velocity")[particles.fixed] = 0.0  # supported since
        self.model.writable("particles.angular_velocity")[particles.fixed_rotation] = 0.0
        self.simulation.start_anew()
        self.timeline.clear()
        self.history.end_run()

    def _unsettle(self, begun: Snapshot) -> None:
        """Take back what settling did while no time has passed: an edit, since a run is entered by its time."""
        model = self.model
        with model.transaction("restart"):
            for name in SETTLED:
                model.give(name, begun.column(model, name))
            velocity = begun.column(model, "particles.velocity").copy()
            velocity[model.particles.fixed] = 0.0
            model.give("particles.velocity", velocity)
            spin = begun.column(model, "particles.angular_velocity")
            model.give("particles.angular_velocity", np.where(model.particles.fixed_rotation, 0.0, spin))
            model.clock.collision_state = begun.columns["clock.collision_state"][0]

    def settle(self, factors: Sequence[float] | float, *, anew: bool = False) -> tuple[str, str]:
        """Go to the static equilibrium at each load factor; returns its status and the account of the way there.

        It is not called "equilibrium" where laws of mods act that statics does not know. anew: from the undeformed
        beginning, not from the present state.
        """
        from pinjoint.systems.statics.settle import settle  # scipy
        from pinjoint.systems.statics.state import Start

        self._note_undeformed()
        model, clock = self.model, self.model.clock
        start = Start.present(model)
        if anew:  # without settlements by loads, which the state would then have twice
            moved = of_rigid_supports(model, start.displacement)
            turned = np.where(model.particles.fixed_rotation, start.rotation, 0.0)
            start = Start(moved, turned, self._permanent_undeformed())
        found = settle(model, factors, start=start)
        with model.transaction("settle"):
            found.final.put(model)
            time = max([clock.time, *(end for end in load_ends(model) if end < math.inf)])
            model.give("clock.time", np.array([time]))
            model.give("clock.origin", np.array([time]))
            model.give("clock.origin_steps", np.array([clock.steps]))
            if len(found.final.contacts) and not self.simulation.integrator.exact:
                clock.collision_state = PersistentContacts(
                    found.final.contacts, 1000.0 * found.final.contact_force
                )
        self.assessment.disturb("settled")
        account = [found.account]
        yielded = np.flatnonzero((found.final.permanent != start.permanent).any(axis=1))
        if len(yielded) and not found.events:  # at once: what it began from is beyond the strengths
            rod = model.describe(model.rods[yielded[0]])
            said = plural(
                "Even before the load grew, {rod} yielded.",
                "Even before the load grew, {count} rods yielded.",
                len(yielded),
                rod=rod,
            )
            account.append(said)
        status, note = found.beside(left_out_of_statics(model))
        return status, joined([*account, note, idle_moment(model)])

    # --- edits and the file ------------------------------------------------------------------------

    def save(self, path: str | Path) -> None:
        """Write the model, with its present state, to a file."""
        self.simulation.account_for_edits()
        models.save(self.model, Path(path))

    def save_as(self, path: Path) -> str:
        """Write the model to a file that is its own from now on, and say so. Raises ModelError."""
        self.save(path)
        self.file, self.practice, self.saved = ModelFile.at(path), False, self.model.revision
        return tr("Saved as '{name}'.", name=path.stem)

    @property
    def newest(self) -> int:
        """The revision of the newest change to anything that a file holds."""
        return self.model.newest(*SAVED)

    @property
    def unsaved(self) -> bool:
        """True if a person changed the model since it was opened or saved, or let time pass in one of theirs."""
        return self.edited or (self.file.path is not None and self.newest > self.saved)

    def leave(self) -> None:
        """End the run and the pull of a hand, and drop the checkpoints."""
        if self.pull.hand is not None:
            self.timeline.hold(None)
        self.history.end_run()
        self.timeline.clear()

    @property
    def edited(self) -> bool:
        """True if a person changed the model since it was opened or saved; never of one that belongs to a lesson."""
        return self._last_edit > self.saved and not self.practice


class OpenDocuments:
    """The open documents, one of them in use; undo and redo lead to the others.

    on_leave, on_begin: called before another one comes into use, and when it has.
    """

    def __init__(self, model: Model, schedule: Schedule, pull: Pull, file: ModelFile) -> None:
        self.on_leave: Callable[[], None] = lambda: None
        self.on_begin: Callable[[], None] = lambda: None
        self._schedule = schedule
        self._pull = pull
        self._documents = [OpenDocument(model, schedule, pull, file)]
        self._at = 0

    def __iter__(self) -> Iterator[OpenDocument]:
        return iter(tuple(self._documents))

    def __len__(self) -> int:
        return len(self._documents)

    @property
    def current(self) -> OpenDocument:
        """The document in use."""
        return self._documents[self._at]

    def open(self, source: Source | Model, file: ModelFile | None = None, *, keep: bool = False) -> None:
        """Open a model, of its own file unless another is given. Raises ModelError.

        The document in use until now stays open if it has unsaved work, or is to be kept; what could be repeated in
        it is forgotten, as by any edit. Work in later documents, from which undo came back, is repeated, and they stand
        before the new one.
        """
        model = source if isinstance(source, Model) else models.load(source)
        file = file_of(source) if file is None else file
        self.on_leave()
        self.current.leave()
        self.current.history.forget_undone()
        earlier, later = self._documents[: self._at], self._documents[self._at + 1 :]
        for document in later:
            while document.history.redo():
                pass
        here = [self.current] if keep or self.current.unsaved else []
        self._documents = [*earlier, *later, *here, OpenDocument(model, self._schedule, self._pull, file)]
        self._at = len(self._documents) - 1
        self.on_begin()

    def can_move(self, by: int) -> bool:
        """True if there is a document before (-1) or after (1) this one."""
        return 0 <= self._at + by < len(self._documents)

    def move(self, by: int) -> str:
        """Use the document before (-1) or after (1) this one; returns what is undone or repeated so, or ""."""
        target = self._at + by
        if not self.can_move(by):
            return ""
        self.on_leave()
        self.current.leave()
        opened = self._documents[max(self._at, target)].file.name
        self._at = target
        self.on_begin()
        return tr("opening {name}", name=opened) if opened else tr("opening a new model")


def file_of(source: Source | Model) -> ModelFile:
    """The file that a source of a model is; examples and documents have none."""
    if isinstance(source, Mapping | Model):
        return ModelFile()
    if isinstance(source, str) and source in models.bundled():
        return ModelFile(None, source)
    return ModelFile.at(Path(source).absolute())
