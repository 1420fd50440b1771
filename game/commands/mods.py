"""`pinjoint mods list|check|new`, the options --mods and --no-mods of every command, and the safe start after a crash."""

from __future__ import annotations

import logging
import uuid
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from game.commands import COMMANDS
from game.commands.arguments import Parser
from game.commands.options import ANSWERED, NOT_ANSWERED
from game.commands.output import Row, add_output, write_result
from game.documents.library import data_folder
from game.documents.locks import lock_file
from game.editor.context import FAULTS
from game.mods.finding import mods_folder
from game.mods.loading import MODS, load
from game.mods.mod import INCLUDED, LOG, Mod, ModError
from game.mods.skeleton import write_skeleton
from game.mods.trial import mistakes_of
from game.streams import tell
from game.version import __version__

LEFT_OUT = (
    "Pinjoint crashed while your mods were loaded, so they are left out this time. The next"
    " start loads them again; --no-mods always leaves them out."
)


def load_as_asked(words: Sequence[str]) -> list[str]:
    """Load the mods that the options --mods DIR and --no-mods ask for; returns the other words.

    Mods that are left out are named on standard error. After a crash with mods, a window opens without those that
    --mods did not name. Raises ModError; also for a mod that --mods names and that cannot be used, where a command
    would compute without it.
    """
    parser = Parser(prog="pinjoint", add_help=False, allow_abbrev=False)
    parser.add_argument("--mods", action="append", default=[], metavar="DIR")
    parser.add_argument("--no-mods", action="store_true")
    options, others = parser.parse_known_args(list(words))
    for folder in options.mods:
        if not Path(folder).is_dir():
            raise ModError(f"--mods {folder}: there is no such folder.")
    unsafe = not options.no_mods and others[:1] not in [[name] for name in COMMANDS] and crashed()
    if unsafe:
        FAULTS.append(LEFT_OUT)
    named = {Path(folder).resolve() for folder in options.mods}
    computes = set(others[:1]) & set(COMMANDS) - {"open"}
    for mod in load(options.mods, installed=not (options.no_mods or unsafe)):
        if mod.off and others[:1] != ["mods"]:
            if computes and mod.folder is not None and {mod.folder, mod.folder.parent} & named:
                raise ModError(f"The mod '{mod.name}' cannot be used: {mod.problem}")
            tell(f"the mod '{mod.name}' was left out: {mod.problem}")
    return others


# --- the command ---------------------------------------------------------------------------------------


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status. Raises ModError."""
    parser = Parser(prog="pinjoint mods", description="Extensions of the program; see assets/mods/README.md.")
    commands = parser.add_subparsers(dest="command", required=True, metavar="list|check|new")
    add_output(commands.add_parser("list", help="which mods there are, and why some were left out"))
    check = commands.add_parser(
        "check", help="try all that a mod can do with a model of its own, and say what is wrong"
    )
    check.add_argument("folder", metavar="FOLDER")
    add_output(check)
    new = commands.add_parser("new", help="write the skeleton of a mod, with a test that passes")
    new.add_argument("name", metavar="NAME")
    new.add_argument("--into", default=".", metavar="FOLDER", help="default: the present folder")
    options = parser.parse_args(list(words))
    if options.command == "new":
        return _new(options.name, Path(options.into))
    if options.command == "list":
        found = [_described(mod) for mod in MODS]
        write_result(options, found, _rows, _lines_of_list)
        return NOT_ANSWERED if any(mod.off for mod in MODS) else ANSWERED
    found = _checked(Path(options.folder))
    write_result(options, found, _rows, _lines_of_check)
    return NOT_ANSWERED if any(mod["problems"] for mod in found) else ANSWERED


def _new(name: str, into: Path) -> int:
    for path in write_skeleton(name, into, __version__):
        print(f"wrote {path}")
    folder = into / name
    print(f"test it:    pytest {folder}\ntry it:     pinjoint pendulum --mods {folder}")
    print(f"to keep it, move it to {mods_folder()}")
    return ANSWERED


def _described(mod: Mod) -> dict[str, Any]:
    """A mod and its state as plain data."""
    state = "included" if mod.source == INCLUDED else "loaded"
    return {
        "name": mod.name,
        "version": mod.version,
        "description": mod.description,
        "source": mod.source,
        "state": state if mod.loaded else "left out",
        "problems": [mod.problem] if mod.off else [],
        "notes": mod.notes,
    }


def _checked(folder: Path) -> list[dict[str, Any]]:
    """The mods in a folder, each with its problems. Raises ModError if there is none."""
    if not folder.is_dir():
        raise ModError(f"{folder} is no folder.")
    found = load([folder])
    if not found:
        raise ModError(f"There is no mod in {folder}; `pinjoint mods new NAME` writes one to begin with.")
    return [_described(mod) | ({} if mod.off else {"problems": mistakes_of(mod)}) for mod in found]


def _rows(found: Sequence[dict[str, Any]]) -> Iterator[Row]:
    yield "name", "version", "state", "source", "description", "problems", "notes"
    for mod in found:
        texts = (" ".join(mod[key]) for key in ("problems", "notes"))
        yield mod["name"], mod["version"], mod["state"], mod["source"], mod["description"], *texts


def _lines_of_list(found: Sequence[dict[str, Any]]) -> Iterator[str]:
    for mod in found:
        state = mod["state"].upper() if mod["state"] == "left out" else mod["state"]
        yield f"{mod['name']} {mod['version']}: {state}, from {mod['source']}"
        yield from (f"    {line}" for line in (mod["description"], *mod["problems"], *mod["notes"]) if line)
    yield f"Your mods belong into {mods_folder()}"


def _lines_of_check(found: Sequence[dict[str, Any]]) -> Iterator[str]:
    for mod in found:
        yield f"{mod['name']} {mod['version']}: {'WRONG' if mod['problems'] else 'all is well'}"
        yield from (f"    {line}" for line in (*mod["problems"], *mod["notes"]))


# --- safe start ----------------------------------------------------------------------------------------


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
    if not any(mod.loaded and mod.source != INCLUDED for mod in MODS):
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
