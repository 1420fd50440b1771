"""The cache of compiled programs on disk, which processes share: each file is whole and as it was written, or is none.

A power cut leaves empty files, a full disk parts of them, and damaged machine code would end the process.
"""

from __future__ import annotations

import hashlib
import logging
import os
import tempfile
from contextlib import suppress
from functools import cache
from pathlib import Path

from platformdirs import user_cache_path

from components.language import tr

NOWHERE = Path(os.devnull)  # stands for a folder where none can be had: there is nothing in it, nor can be
LOG = logging.getLogger("pinjoint.cache")
TROUBLE: list[str] = []  # the sentence that programs cannot be kept, and why, once that is known


@cache
def folder() -> Path:
    """A folder that can be written to: the user's cache, or a temporary one.

    What lies in it is run: a folder of another owner is not used.
    """
    owner = os.getuid() if hasattr(os, "getuid") else 0
    try:
        shared = Path(tempfile.gettempdir()) / f"pinjoint-programs-{owner}"
        for tried in (user_cache_path("pinjoint") / "programs", shared):
            if _can_be_used(tried, owner):
                return tried
        return Path(tempfile.mkdtemp(prefix="pinjoint-programs-"))
    except OSError as error:
        _say(user_cache_path("pinjoint") / "programs", error)
        return NOWHERE


def _can_be_used(tried: Path, owner: int) -> bool:
    try:
        tried.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=tried):
            pass
        return not hasattr(os, "getuid") or tried.stat().st_uid == owner
    except OSError:
        return False


def read(name: str) -> bytes | None:
    """What was written under this name; None if nothing was, or if it is damaged, and then the file is deleted."""
    path = folder() / name
    try:
        digest, content = _divided(path.read_bytes())
    except OSError:
        return None
    if hashlib.sha256(content).digest() == digest:
        return content
    with suppress(OSError):
        path.unlink(missing_ok=True)
    return None


def _divided(written: bytes) -> tuple[bytes, bytes]:
    size = hashlib.sha256().digest_size
    return written[:size], written[size:]


def write(name: str, content: bytes) -> None:
    """Keep a content under a name, in one go: no other process reads a part of it.

    Where that is impossible, on a full disk above all, it is not kept, which is said once.
    """
    path = folder() / name
    try:
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=name, suffix=".tmp")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(hashlib.sha256(content).digest() + content)
            os.replace(temporary, path)
        except BaseException:
            os.unlink(temporary)
            raise
    except OSError as error:
        _say(path.parent, error)


def _say(where: Path, error: OSError) -> None:
    if not TROUBLE:
        TROUBLE.append(
            tr(
                "Compiled programs cannot be kept in {folder}: {error}. Everything works, but starts more slowly next time."
                " Make room in that folder, or allow writing to it.",
                folder=where,
                error=error.strerror,
            )
        )
        LOG.warning(TROUBLE[0])
