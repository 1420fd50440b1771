"""The options --mods and --no-mods, which every command has, and the safe start after a crash."""

from __future__ import annotations

import logging
import uuid
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from pinjoint.commands.arguments import Parser
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import marked, tr
from pinjoint.documents.library import data_folder
from pinjoint.documents.models import lock_file
from pinjoint.mods.loading import folder_of, load
from pinjoint.mods.mod import LOG, ModError
from pinjoint.streams import tell

LEFT_OUT = marked(
    "Pinjoint crashed while your mods were loaded, so they are left out this time. The next"
    " start loads them again; --no-mods always leaves them out."
)


def load_as_asked(words: Sequence[str]) -> list[str]:
    """Load the mods that the options --mods DIR and --no-mods ask for; returns the other words.

    Mods that are left out are named on standard error. After a crash with mods, a window opens without those that
    --mods did not name. Raises ModError; also for a mod that --mods names and that cannot be used, where a command
    would compute without it.
    """
    parser = Parser(add_help=False, allow_abbrev=False)
    parser.add_argument("--mods", action="append", default=[], metavar="DIR")
    parser.add_argument("--no-mods", action="store_true")
    options, others = parser.parse_known_args(list(words))
    options.mods = [folder_of(folder) for folder in options.mods]
    for folder in options.mods:
        if not folder.is_dir():
            raise ModError("--mods {folder}: there is no such folder; check its name.", folder=folder)
    unsafe = not options.no_mods and others[:1] not in [[name] for name in EXTENSIONS.commands] and crashed()
    if unsafe:
        EXTENSIONS.faults.append(tr(LEFT_OUT))
    named = {folder.resolve() for folder in options.mods}
    computes = set(others[:1]) & set(EXTENSIONS.commands) - {"open"}
    for mod in load(options.mods, installed=not (options.no_mods or unsafe)):
        if mod.off and others[:1] != ["mods"]:
            if computes and mod.folder is not None and {mod.folder, mod.folder.parent} & named:
                raise ModError("The mod '{name}' cannot be used: {problem}", name=mod.name, problem=mod.problem)
            tell(tr("The mod '{name}' was left out: {problem}", name=mod.name, problem=mod.problem))
    return others


def crashed() -> bool:
    """True if a window with mods ended without being closed; asking deletes its lock file."""
    found = False
    for path in (data_folder() / "running").glob("*.lock"):
        lock = lock_file(path)
        if lock is not None:
            lock.close()
            path.unlink(missing_ok=True)
            found = True
    return found


@contextmanager
def in_use() -> Iterator[None]:
    """Keep a log and a lock file while a window is open with a person's mods; only a crash leaves the file behind."""
    if not any(mod.loaded and not mod.included for mod in EXTENSIONS.mods):
        yield
        return
    path = data_folder() / "running" / f"{uuid.uuid4().hex}.lock"
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        lock = lock_file(path)
        LOG.addHandler(logging.FileHandler(data_folder() / "mods.log", encoding="utf-8", delay=True))
    except OSError:  # the folder cannot be written; the window works all the same
        lock = None
    try:
        yield
    finally:
        if lock is not None:
            lock.close()
        path.unlink(missing_ok=True)
