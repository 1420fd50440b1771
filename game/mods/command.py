"""`pinjoint mods list|check|new`, and the options --mods and --no-mods of every command."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from game.commands.arguments import Parser
from game.mods.finding import mods_folder
from game.mods.loading import MODS, load
from game.mods.mod import FAULTS, INCLUDED, Mod, ModError
from game.mods.probing import problems
from game.mods.safety import LEFT_OUT, crashed
from game.mods.skeleton import write_skeleton
from game.registry import COMMANDS


def load_as_asked(words: Sequence[str]) -> list[str]:
    """Load the mods that the options --mods DIR and --no-mods ask for; returns the other words.

    What was left out is told on standard error. After a crash with mods, a window is opened without those
    that were not asked for. Raises ModError.
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
    for mod in load(options.mods, installed=not (options.no_mods or unsafe)):
        if mod.off and others[:1] != ["mods"]:
            print(f"pinjoint: the mod '{mod.name}' was left out: {mod.problem}", file=sys.stderr)
    return others


def run(words: Sequence[str], parser: argparse.ArgumentParser, version: str) -> int:
    """The command; returns the exit status. Raises ModError."""
    commands = parser.add_subparsers(dest="command", required=True, metavar="list|check|new")
    commands.add_parser("list", help="which mods there are, and why some were left out")
    check = commands.add_parser("check", help="load a mod, compile its kernels, and tell whether all is well")
    check.add_argument("folder", metavar="FOLDER")
    new = commands.add_parser("new", help="write the skeleton of a mod, with a test that passes")
    new.add_argument("name", metavar="NAME")
    new.add_argument("--into", default=".", metavar="FOLDER", help="default: the folder that you are in")
    options = parser.parse_args(list(words))
    if options.command == "list":
        return _list()
    if options.command == "check":
        return _check(Path(options.folder))
    for path in write_skeleton(options.name, Path(options.into), version):
        print(f"wrote {path}")
    folder = Path(options.into) / options.name
    print(f"test it:    pytest {folder}\ntry it:     pinjoint pendulum --mods {folder}")
    print(f"to keep it, move it to {mods_folder()}")
    return 0


def _list() -> int:
    for mod in MODS:
        print(f"{mod.name} {mod.version}: {_state(mod)}, from {mod.source}")
        for line in filter(None, (mod.description, mod.problem, *mod.notes)):
            print(f"    {line}")
    print(f"Your mods belong into {mods_folder()}")
    return 1 if any(mod.off for mod in MODS) else 0


def _state(mod: Mod) -> str:
    if not mod.loaded:
        return "LEFT OUT"
    return "included" if mod.source == INCLUDED else "loaded"


def _check(folder: Path) -> int:
    if not folder.is_dir():
        raise ModError(f"{folder} is no folder.")
    found = load([folder])
    if not found:
        raise ModError(f"There is no mod in {folder}; `pinjoint mods new NAME` writes one to begin with.")
    wrong = {mod.name: [mod.problem] if mod.off else list(problems(mod)) for mod in found}
    for mod in found:
        print(f"{mod.name} {mod.version}: {'WRONG' if wrong[mod.name] else 'all is well'}")
        for line in (*wrong[mod.name], *mod.notes):
            print(f"    {line}")
    return 1 if any(wrong.values()) else 0
