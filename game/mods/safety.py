"""Safe start: after a crash with mods, the next start leaves them out once."""

from __future__ import annotations

import logging
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from game.documents.library import data_folder
from game.documents.locks import lock_file
from game.mods.loading import MODS
from game.mods.mod import INCLUDED, LOG

LEFT_OUT = (
    "Pinjoint crashed while your mods were loaded, so they are left out this time. The next"
    " start loads them again; --no-mods always leaves them out."
)


def _folder() -> Path:
    return data_folder() / "running"


def crashed() -> bool:
    """True if a window with mods that does not run any more never ended; asking forgets it."""
    found = False
    for path in _folder().glob("*.lock"):
        lock = lock_file(path)
        if lock is not None:
            lock.close()
            path.unlink(missing_ok=True)
            found = True
    return found


@contextmanager
def in_use() -> Iterator[None]:
    """While a window is open with a person's mods: a log, and a file that only a crash leaves behind."""
    if not any(mod.loaded and mod.source != INCLUDED for mod in MODS):
        yield
        return
    path = _folder() / f"{uuid.uuid4().hex}.lock"
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        lock = lock_file(path)
        LOG.addHandler(logging.FileHandler(data_folder() / "mods.log", encoding="utf-8", delay=True))
    except OSError:  # nothing can be written here; the window is of use all the same
        lock = None
    try:
        yield
    finally:
        if lock is not None:
            lock.close()
        path.unlink(missing_ok=True)
