"""`pinjoint mods list|check|new`: extensions of the program."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from pinjoint.checks import Trial
from pinjoint.commands.arguments import Parser, option
from pinjoint.commands.options import ANSWERED, NOT_ANSWERED
from pinjoint.commands.output import Row, add_output, write_result
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import tr
from pinjoint.mods.loading import load, mods_folder
from pinjoint.mods.mod import Mod, ModError
from pinjoint.mods.skeleton import write_skeleton
from pinjoint.version import __version__


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status. Raises ModError."""
    parser = Parser("mods", "Mods extend the program; see assets/mods/README.md.")
    commands = parser.add_subparsers(dest="command", required=True, metavar="list|check|new")
    add_output(commands.add_parser("list", help=tr("list the mods, and why some were left out")))
    check = commands.add_parser(
        "check", help=tr("try everything that a mod adds, on a small model, and report what is wrong")
    )
    check.add_argument("folder", metavar="FOLDER")
    add_output(check)
    new = commands.add_parser("new", help=tr("write a new mod that works, with its test"))
    new.add_argument("name", metavar="NAME")
    option(new, "--into FOLDER", "where to write it; default: the present folder", default=".")
    options = parser.parse_args(list(words))
    if options.command == "new":
        return _new(options.name, Path(options.into))
    if options.command == "list":
        found = [_described(mod) for mod in EXTENSIONS.mods]
        write_result(options, found, _rows, _lines_of_list)
        return NOT_ANSWERED if any(mod.off for mod in EXTENSIONS.mods) else ANSWERED
    found = _checked(Path(options.folder))
    write_result(options, found, _rows, _lines_of_check)
    return NOT_ANSWERED if any(mod["problems"] for mod in found) else ANSWERED


def _new(name: str, into: Path) -> int:
    for path in write_skeleton(name, into, __version__):
        print(tr("wrote {path}", path=path))
    folder = into / name
    print(tr("To test it: {command}", command=f"pytest {folder}"))
    print(tr("To try it: {command}", command=f"pinjoint pendulum --mods {folder}"))
    print(tr("To load it at every start, move it to {folder}.", folder=mods_folder()))
    return ANSWERED


def _described(mod: Mod) -> dict[str, Any]:
    """A mod and its state as plain data."""
    state = "included" if mod.included else "loaded"
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
        raise ModError("There is no folder {folder}; check its name.", folder=folder)
    found = load([folder])
    if not found:
        raise ModError("There is no mod in {folder}; to write one, use: pinjoint mods new NAME", folder=folder)
    return [_described(mod) | ({} if mod.off else {"problems": Trial(mod).found}) for mod in found]


def _rows(found: Sequence[dict[str, Any]]) -> Iterator[Row]:
    yield "name", "version", "state", "source", "description", "problems", "notes"
    for mod in found:
        texts = (" ".join(mod[key]) for key in ("problems", "notes"))
        yield mod["name"], mod["version"], mod["state"], mod["source"], mod["description"], *texts


def _lines_of_list(found: Sequence[dict[str, Any]]) -> Iterator[str]:
    for mod in found:
        names = {name: mod[name] for name in ("name", "version", "source")}
        if mod["state"] == "left out":
            yield tr("{name} {version}: LEFT OUT, from {source}", **names)
        else:
            yield tr("{name} {version}: loaded, from {source}", **names)
        told = (mod["description"], *mod["problems"], *mod["notes"])
        yield from (f"    {tr(line)}" for line in told if line)
    yield tr("Put your mods into {folder}", folder=mods_folder())


def _lines_of_check(found: Sequence[dict[str, Any]]) -> Iterator[str]:
    for mod in found:
        names = {name: mod[name] for name in ("name", "version")}
        if mod["problems"]:
            yield tr("{name} {version}: PROBLEMS", **names)
        else:
            yield tr("{name} {version}: no problems", **names)
        yield from (f"    {line}" for line in (*mod["problems"], *mod["notes"]))
