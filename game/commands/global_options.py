"""The options that every command has: --language, --cores, --mods and --no-mods; and the safe start after a crash.

The language is that of --language, of PINJOINT_LANGUAGE, the person's choice, or else that of the system.
"""

from __future__ import annotations

import locale
import logging
import os
import uuid
from argparse import Namespace
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from pinjoint.commands.arguments import Parser, UsageError, count
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import ENGLISH, LANGUAGES, marked, speak, tr
from pinjoint.documents.library import data_folder
from pinjoint.documents.models import lock_file
from pinjoint.documents.preferences import preferred
from pinjoint.mods.loading import load
from pinjoint.mods.mod import INCLUDED, LOG, ModError
from pinjoint.streams import tell
from pinjoint.systems.program.reordered import VARIABLE as CORES

VARIABLE = "PINJOINT_LANGUAGE"
_OF_SYSTEM = ("LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG")  # the first that is set counts, as for gettext
LEFT_OUT = marked(
    "Pinjoint crashed while your mods were loaded, so they are left out this time. The next"
    " start loads them again; --no-mods always leaves them out."
)


def _taken(words: Sequence[str], **options: Mapping[str, Any]) -> tuple[Namespace, list[str]]:
    """The values of options that every command has, and the other words."""
    parser = Parser(prog="pinjoint", add_help=False, allow_abbrev=False)
    for name, meaning in options.items():
        parser.add_argument(f"--{name.replace('_', '-')}", **meaning)
    return parser.parse_known_args(list(words))


def speak_as_asked(words: Sequence[str]) -> list[str]:
    """Speak the language of the option --language CODE, which every command has, or else that of the person.

    Returns the other words. Raises UsageError for a language that there is not.
    """
    speak(asked_language() or preferred("language") or language_of_system())
    options, others = _taken(words, language={"metavar": "CODE"})
    if options.language is not None:
        if not (code := _known([options.language])):
            raise UsageError(
                "--language {code}: there is no such language; write one of {languages}.",
                code=options.language,
                languages=", ".join(LANGUAGES),
            )
        os.environ[VARIABLE] = code  # for this process and those that it starts
        speak(code)
    return others


def asked_language() -> str:
    """The language that a person asked for this time, "" if none."""
    return _known([os.environ.get(VARIABLE, "")])


def language_of_system() -> str:
    """The first language of the system that there is a catalogue for; English if there is none."""
    said = next(filter(None, map(os.environ.get, _OF_SYSTEM)), None) or locale.getlocale()[0] or ""
    return _known(said.split(":")) or ENGLISH


def _known(codes: Iterable[str]) -> str:
    """The first language of ours among codes such as "pt_BR.UTF-8" or, on Windows, "Portuguese_Brazil"; else ""."""
    names = {"english": ENGLISH, "portuguese": "pt", "c": ENGLISH, "posix": ENGLISH}
    for code in codes:
        name = code.replace("-", "_").replace(".", "_").partition("_")[0].lower()
        if (name := names.get(name, name)) in LANGUAGES:
            return name
    return ""


def use_cores_as_asked(words: Sequence[str]) -> list[str]:
    """Read the option --cores N, which every command has, into the environment; returns the other words."""
    options, others = _taken(words, cores={"type": partial(count, least=1), "metavar": "N"})
    if options.cores is not None:
        os.environ[CORES] = str(options.cores)  # for this process and those that it starts
    return others


def load_as_asked(words: Sequence[str]) -> list[str]:
    """Load the mods that the options --mods DIR and --no-mods ask for; returns the other words.

    Mods that are left out are named on standard error. After a crash with mods, a window opens without those that
    --mods did not name. Raises ModError; also for a mod that --mods names and that cannot be used, where a command
    would compute without it.
    """
    several = {"action": "append", "default": [], "metavar": "DIR"}
    options, others = _taken(words, mods=several, no_mods={"action": "store_true"})
    for folder in options.mods:
        if not Path(folder).is_dir():
            raise ModError("--mods {folder}: there is no such folder; check its name.", folder=folder)
    unsafe = not options.no_mods and others[:1] not in [[name] for name in EXTENSIONS.commands] and crashed()
    if unsafe:
        EXTENSIONS.faults.append(tr(LEFT_OUT))
    named = {Path(folder).resolve() for folder in options.mods}
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
    if not any(mod.loaded and mod.source != INCLUDED for mod in EXTENSIONS.mods):
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
