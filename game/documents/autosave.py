"""Autosave: unsaved work is written to recovery files every few seconds, and stays in them when a window closes."""

from __future__ import annotations

import contextlib
import itertools
import logging
import threading
import time
import uuid
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import msgspec

from pinjoint.components.language import tr
from pinjoint.components.mistake import reason_of
from pinjoint.documents import library, models
from pinjoint.documents.facts import Facts
from pinjoint.documents.open_documents import OpenDocument
from pinjoint.systems.base import Phase, System

LOG = logging.getLogger("pinjoint.autosave")
INTERVAL = 2.0  # s between recovery files of the same model, at least
SHARE = 0.2  # of one core at most is spent on writing them; 10⁵ rods take less than 0.4 s


def recovered_name(path: Path) -> str:
    """The name of the model in a recovery file."""
    return models.name_of(path).partition(".")[2].partition(".")[2]


def unkept(folder: Path, error: Exception) -> str:
    """The sentence that unsaved work would not survive a crash, and why."""
    return tr(
        "Unsaved work cannot be kept in {folder}, so a crash would lose it: {reason}. Make room there, or set {variable} to"
        " another folder and start Pinjoint again.",
        folder=folder,
        reason=reason_of(error),
        variable=library.DATA_VARIABLE,
    )


class Autosave(System):
    """Writes the unsaved work of a window to files that outlive it, until somebody saves or discards what is in them.

    The folder holds, for every running program, a lock "ID.lock" that its end releases, however it ends,
    and its recovery files "ID.NUMBER.NAME.json".
    """

    name = "files.autosave"
    phase = Phase.EVENTS
    reads = ("document", "state")
    writes = ("recovery",)
    headless = False

    def __init__(self, folder: Path | None = None, interval: float = INTERVAL) -> None:
        self._folder = folder or library.data_folder() / "autosave"
        self._interval = interval
        self._id = uuid.uuid4().hex[:8]
        self._count = 0
        self._written: dict[OpenDocument, int] = {}  # revision of what the recovery file of a document holds
        self._due = 0.0
        self._trouble = ""  # why the last recovery file could not be written
        self._said = ""  # the trouble that was reported last
        self._thread: threading.Thread | None = None
        self._folder.mkdir(parents=True, exist_ok=True)
        lock = models.lock_file(self._folder / f"{self._id}.lock")
        self._locks = [lock] if lock is not None else []
        self._left = self._orphans()

    # --- what other windows left ---------------------------------------------------------------------

    def _orphans(self) -> list[Path]:
        """Recovery files of programs that are not running any more, the newest first; they are ours now."""
        for path in self._folder.glob("*.lock"):
            if path.stem == self._id:
                continue
            with contextlib.suppress(OSError):  # such as a folder of that name
                lock = models.lock_file(path)
                self._locks += [lock] if lock is not None else []
        ours = {Path(lock.name).stem for lock in self._locks}
        files = self._folder.glob("[!.]*.json")
        return library.newest_first(path for path in files if path.name.partition(".")[0] in ours)

    def left(self) -> list[Path]:
        """The recovery files that windows left behind which are gone now, the newest first."""
        return [path for path in self._left if path.exists()]

    def take_over(self, path: Path, opened: OpenDocument) -> None:
        """Make a recovery file that of a document, whose work is unsaved."""
        self._left.remove(path)
        opened.recovery = path
        opened.saved = -1
        self._written[opened] = -1

    def discard(self) -> None:
        """Delete the recovery files that windows left behind."""
        for path in self._left:
            _delete(path)
        self._left = []

    # --- writing -------------------------------------------------------------------------------------

    def process(self, frame: Any) -> None:
        """Write a recovery file of one model that changed, if it is time to; say once if that cannot be done."""
        if self._trouble != self._said:
            self._said = self._trouble
            frame.session.notice = self._trouble or frame.session.notice
        if (self._thread is not None and self._thread.is_alive()) or time.monotonic() < self._due:
            return
        open_ones = [opened for opened in frame.session.documents if opened.unsaved]
        for opened in self._written.keys() - set(open_ones):
            self._remove(opened)
        changed = (opened for opened in open_ones if self._written.get(opened) != opened.newest)
        for opened in itertools.islice(changed, 1):
            self._write(opened)

    def _write(self, opened: OpenDocument) -> threading.Thread:
        """Take the model as it is now; a thread, which is returned, puts it into the file."""
        if opened.recovery is None:
            self._count += 1
            name = opened.file.name.encode()[: library.MOST_BYTES].decode(errors="ignore")
            opened.recovery = self._folder / f"{self._id}.{self._count}.{name}.json"
        self._written.setdefault(opened, -1)
        self._thread = threading.Thread(
            target=self._put, args=(opened, opened.recovery, opened.newest, Facts(opened.model)), daemon=True
        )
        self._thread.start()
        return self._thread

    def _put(self, opened: OpenDocument, path: Path, revision: int, facts: Facts) -> None:
        """Write a file; what could not be written, on a full disk above all, is tried again."""
        began, trouble = time.monotonic(), ""
        try:
            models.replace(path, msgspec.json.encode(facts.document()))
        except models.ModelError as error:  # no file can hold it as it is now
            trouble = tr(
                "The unsaved work on '{name}' cannot be kept, so a crash would lose it: {reason}",
                name=opened.file.name or tr("Untitled"),
                reason=error,
            )
        except Exception as error:
            trouble, revision = unkept(self._folder, error), self._written[opened]
        self._written[opened] = revision
        self._trouble = trouble
        self._due = began + max(self._interval, time.thread_time() / SHARE)

    def _remove(self, opened: OpenDocument) -> None:
        del self._written[opened]
        if opened.recovery is not None:
            _delete(opened.recovery)
            opened.recovery = None

    def close(self, open_ones: Iterable[OpenDocument]) -> None:
        """A clean end: of every model with edits that nobody saved the recovery file stays, and no other."""
        if self._thread is not None:
            self._thread.join()
        edited = [opened for opened in open_ones if opened.edited and opened.model.particles.count]
        for opened in edited:
            if self._written.get(opened) != opened.newest:
                self._write(opened).join()
                if self._trouble:  # no window says it any more
                    LOG.warning(self._trouble)
        for opened in self._written.keys() - set(edited):
            self._remove(opened)
        for lock in self._locks:
            path = Path(lock.name)
            lock.close()
            if not any(self._folder.glob(f"{path.stem}.*.json")):
                _delete(path)


def _delete(path: Path) -> None:
    """Delete a file, where that is possible."""
    with contextlib.suppress(OSError):
        path.unlink(missing_ok=True)
