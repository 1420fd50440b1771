"""`pinjoint mods list|check|new`: extensions of the program."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from game.commands.arguments import Parser
from game.commands.options import ANSWERED, NOT_ANSWERED
from game.commands.output import Row, add_output, write_result
from game.mods.finding import mods_folder
from game.mods.loading import MODS, load
from game.mods.mod import INCLUDED, Mod, ModError
from game.mods.skeleton import write_skeleton
from game.mods.trial import mistakes_of
from game.version import __version__


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
