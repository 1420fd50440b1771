"""The cache of compiled programs on disk, which processes share: each file is whole and as it was written, or is none.

A power cut leaves empty files, a full disk parts of them, and damaged machine code would end the process. What
somebody else could have written is not run.
"""

from __future__ import annotations

import errno
import hashlib
import logging
import os
import stat
import tempfile
from contextlib import suppress
from functools import cache
from pathlib import Path

from platformdirs import user_cache_path

from pinjoint.components.language import english, tr

NOWHERE = Path(os.devnull)  # stands for a folder where none can be had: there is nothing in it, nor can be
LOG = logging.getLogger("pinjoint.programs")
TROUBLE: list[str] = []  # the sentence that programs cannot be kept, and why, once that is known
SAID: list[str] = []  # sentences, each once: what could not be kept, compiled or trusted, and why


@cache
def folder() -> Path:
    """A folder that can be written to: the user's cache, or a temporary one.

    What lies in it is run: one that somebody else could write to is refused, which is said.
    """
    own = user_cache_path("pinjoint") / "programs"
    trouble: OSError = PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    try:
        for tried in (own, Path(tempfile.gettempdir()) / f"pinjoint-programs-{_user()}"):
            with suppress(OSError):
                tried.mkdir(mode=0o700, parents=True, exist_ok=True)
                if problem := _folder_problem(tried):
                    _refuse(tried, problem)
                else:
                    with tempfile.TemporaryFile(dir=tried):
                        return tried
    except OSError as error:
        trouble = error
    _say(own, trouble)
    return NOWHERE


def _user() -> int:
    return os.getuid() if hasattr(os, "getuid") else 0


def _problem(path: Path) -> str:
    """Why what lies there may be another's, in words; "" if it is this person's alone. Raises OSError."""
    if not hasattr(os, "getuid"):
        return ""
    found = path.lstat()
    if stat.S_ISLNK(found.st_mode):
        return tr("it is a link")
    if found.st_uid != _user():
        return tr("it belongs to another user")
    return tr("others may write to it") if found.st_mode & (stat.S_IWGRP | stat.S_IWOTH) else ""


def _folder_problem(path: Path) -> str:
    """The same of a folder, which others could put another in the place of if they may write to one around it."""
    around = Path(os.path.realpath(path)).parents if hasattr(os, "getuid") else ()
    for folder in around:
        mode = folder.stat().st_mode
        if mode & stat.S_IWOTH and not mode & stat.S_ISVTX:
            return tr("others may write to {folder}", folder=folder)
    return _problem(path)


def _refuse(path: Path, problem: str) -> None:
    tell(
        tr(
            "What was got ready in {path} is not used, since it would be run and {problem}; delete it, or let nobody"
            " but yourself write there.",
            path=path,
            problem=problem,
        )
    )


def tell(sentence: str) -> None:
    """Say what a person should know of compiled programs, once in whatever language."""
    if english(sentence) not in map(english, SAID):
        SAID.append(sentence)
        LOG.warning(sentence)


def read(name: str) -> bytes | None:
    """What was written under this name; None if nothing was.

    What is damaged, was written under another name or may be another's is deleted.
    """
    path = folder() / name
    try:
        if problem := _problem(path):
            _refuse(path, problem)
        else:
            written = path.read_bytes()
            content = written[_SIZE:]
            if written[:_SIZE] == _digest(name, content):
                return content
    except OSError:
        return None
    _delete(path)
    return None


def drop(name: str, problem: Exception) -> None:
    """Delete what is whole and can still not be used, which is said once for each kind of problem."""
    kind = f"{type(problem).__name__}: {problem}"
    tell(tr("What was got ready before cannot be used, and is made anew: {problem}.", problem=kind))
    _delete(folder() / name)


def _delete(path: Path) -> None:
    with suppress(OSError):
        path.unlink(missing_ok=True)


def _digest(name: str, content: bytes) -> bytes:
    return hashlib.sha256(name.encode() + b"\0" + content).digest()


_SIZE = hashlib.sha256().digest_size


def write(name: str, content: bytes) -> None:
    """Keep a content under a name, in one go: no other process reads a part of it.

    Where that is impossible, on a full disk above all, it is not kept, which is said once.
    """
    path = folder() / name
    try:
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=name, suffix=".tmp")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(_digest(name, content) + content)
            os.replace(temporary, path)
        except BaseException:
            os.unlink(temporary)
            raise
    except OSError as error:
        _say(path.parent, error)


def _say(where: Path, error: OSError) -> None:
    if not TROUBLE:
        said = tr(
            "What was got ready cannot be kept in {folder}: {error}. Everything works, but starts more slowly next time."
            " Make room in that folder, or allow writing to it.",
            folder=where,
            error=error.strerror,
        )
        TROUBLE.append(said)
        tell(said)
