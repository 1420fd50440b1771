"""Choices: what a person chose or did, kept by name in a JSON file beside the settings; a damaged file loses nothing."""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path
from typing import Any

from pinjoint.documents import models


def read(path: Path) -> dict[str, Any]:
    """What a file says; nothing if it is damaged, or not there."""
    try:
        entries = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return entries if isinstance(entries, dict) else {}


def keep(path: Path, entry: str, choice: object) -> None:
    """Write an entry of a file, the others as they are.

    Where nothing can be written, it is not kept. A file that cannot be read, such as one with a slip in what was
    written by hand, is put aside.
    """
    entries = read(path)
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        if not entries and path.is_file() and path.stat().st_size > 0:
            models.replace(path.with_stem(f"{path.stem}-unreadable"), path.read_bytes())
        models.replace(path, json.dumps({**entries, entry: choice}, indent=1).encode() + b"\n")
