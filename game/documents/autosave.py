"""Autosave: unsaved work, written every few seconds, so that a crash loses no more than that."""

from __future__ import annotations

import contextlib
import itertools
import threading
import time
import uuid
from collections.abc import Iterable
from pathlib import Path
from typing import Any, cast

import msgspec

from components.field import Column, Role
from components.handle import Handle
from components.model import Model
from components.table import Table
from game.documents import library, models
from game.documents.document import document
from game.documents.locks import lock_file
from game.documents.open_documents import Desk
from systems.base import Phase, System

INTERVAL = 2.0  # s between spares of the same model, at least
SHARE = 0.05  # of the time at most goes into making them
LAST_SESSION = "last session"  # the name under which edits are kept that nobody saved


def spare_name(path: Path) -> str:
    """The name of the model in a spare."""
    return path.stem.partition(".")[2].partition(".")[2]


def unkept(folder: Path, error: OSError) -> str:
    """That unsaved work would not survive a crash, and why."""
    return (
        f"Unsaved work is not kept against a crash: {folder}: {error.strerror}. Make room there, or start Pinjoint with"
        f" {library.DATA_VARIABLE} naming another folder."
    )


class Autosave(System):
    """Writes the unsaved work of a window to files that only a crash leaves behind.

    The folder holds, for every running program, a lock "ID.lock" that its end releases, however it ends,
    and its spares "ID.NUMBER.NAME.json".
    """

    name = "files.autosave"
    phase = Phase.EVENTS
    reads = ("document", "state")
    writes = ("spares",)
    headless = False

    def __init__(self, folder: Path | None = None, interval: float = INTERVAL) -> None:
        self._folder = folder or library.data_folder() / "autosave"
        self._interval = interval
        self._id = uuid.uuid4().hex[:8]
        self._count = 0
        self._written: dict[Desk, int] = {}  # revision of what the spare of a desk holds
        self._due = 0.0
        self._trouble = self._told = ""  # why the last spare could not be written; what of that was said
        self._thread: threading.Thread | None = None
        self._folder.mkdir(parents=True, exist_ok=True)
        lock = lock_file(self._folder / f"{self._id}.lock")
        self._locks = [lock] if lock is not None else []
        self._left = self._orphans()

    # --- what a crash left behind --------------------------------------------------------------------

    def _orphans(self) -> list[Path]:
        """Spares of programs that are not running any more, the newest first; they are ours now."""
        for path in self._folder.glob("*.lock"):
            if path.stem == self._id:
                continue
            lock = lock_file(path)
            if lock is not None:
                self._locks.append(lock)
        ours = {Path(lock.name).stem for lock in self._locks}
        files = [p for p in self._folder.glob("[!.]*.json") if p.name.partition(".")[0] in ours]
        return sorted(files, key=lambda path: path.stat().st_mtime, reverse=True)

    def left(self) -> list[Path]:
        """What a crash left behind."""
        return [path for path in self._left if path.exists()]

    def take_over(self, path: Path, desk: Desk) -> None:
        """What was left behind is unsaved work of this desk from now on."""
        self._left.remove(path)
        desk.spare = path
        desk.saved = -1
        self._written[desk] = -1

    def discard(self) -> None:
        """What a crash left behind is not wanted any more."""
        for path in self._left:
            path.unlink(missing_ok=True)
        self._left = []

    # --- writing -------------------------------------------------------------------------------------

    def process(self, frame: Any) -> None:
        """Write a spare of one model that changed, if it is time to; say once if that cannot be done."""
        if self._trouble != self._told:
            self._told = self._trouble
            frame.session.notice = self._trouble or frame.session.notice
        if (self._thread is not None and self._thread.is_alive()) or time.monotonic() < self._due:
            return
        desks = [desk for desk in frame.session.desks if desk.unsaved]
        for desk in self._written.keys() - set(desks):
            self._remove(desk)
        changed = (desk for desk in desks if self._written.get(desk) != desk.newest)
        for desk in itertools.islice(changed, 1):
            self._write(desk)

    def _write(self, desk: Desk) -> None:
        """Take the model as it is now; a thread puts it into the file."""
        if desk.spare is None:
            self._count += 1
            desk.spare = self._folder / f"{self._id}.{self._count}.{desk.file.name}.json"
        self._written[desk] = desk.newest
        still = _Still(desk.model)
        self._thread = threading.Thread(target=self._put, args=(desk.spare, still), daemon=True)
        self._thread.start()

    def _put(self, path: Path, still: _Still) -> None:
        began = time.monotonic()
        with contextlib.suppress(models.ModelError):  # what no file can hold; saving says what is wrong
            content = msgspec.json.encode(document(cast(Model, still)))
            try:
                models.replace(path, content)
                self._trouble = ""
            except OSError as error:
                self._trouble = unkept(self._folder, error)
        spent = time.monotonic() - began
        self._due = began + max(self._interval, spent / SHARE)

    def _remove(self, desk: Desk) -> None:
        del self._written[desk]
        if desk.spare is not None:
            desk.spare.unlink(missing_ok=True)
            desk.spare = None

    def close(self, desks: Iterable[Desk]) -> None:
        """A clean end: no spare stays. Edits that nobody saved are kept as the model "last session"."""
        if self._thread is not None:
            self._thread.join()
        edited = [desk for desk in desks if desk.edited and desk.model.particles.count]
        with contextlib.suppress(models.ModelError, OSError):
            for desk in edited[-1:]:
                library.models_folder().mkdir(parents=True, exist_ok=True)
                models.save(desk.model, library.path_of(LAST_SESSION))
        for desk in tuple(self._written):
            self._remove(desk)
        for lock in self._locks:
            path = Path(lock.name)
            lock.close()
            if not any(self._folder.glob(f"{path.stem}.*.json")):
                path.unlink(missing_ok=True)


class _Still:
    """What a file holds of a model, as it is now, for `document` to read in another thread."""

    def __init__(self, model: Model) -> None:
        self.title = model.title
        self.description = model.description
        self.foreign = dict(model.foreign)
        self.foreign_kinds = dict(model.foreign_kinds)
        self.tables = {name: _StillTable(table) for name, table in model.tables.items()}

    def describe(self, handle: Handle) -> str:
        """What kind of element it is."""
        return handle.noun


class _StillTable:
    def __init__(self, table: Table[Any]) -> None:
        self.count = table.count
        self.handles: tuple[Handle, ...] = tuple(table.handles)
        fields = table.fields_in(Role.DOCUMENT, Role.STATE)
        self._columns = {field.name: table.column(field.name).copy() for field in fields}

    def __getitem__(self, row: int) -> Handle:
        return self.handles[row]

    def column(self, name: str) -> Column:
        return self._columns[name]
