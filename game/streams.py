"""Streams: standard output and standard error that take any text, whatever their encoding, even if they are closed."""

from __future__ import annotations

import io
import json
import os
import re
import sys
from contextlib import suppress

from pinjoint.components.language import tr
from pinjoint.components.wording import printable


def prepare_streams() -> None:
    """Let standard streams write "?" for what their encoding lacks, and keep files from taking the places of closed ones."""
    while (free := os.open(os.devnull, os.O_RDWR)) <= 2:
        pass
    os.close(free)
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 (until the end)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def put(text: str) -> None:
    """Write a text to standard output at once. Raises OSError, also if it is closed."""
    if sys.stdout is None:
        if text:
            raise OSError(tr("it is closed"))
        return
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except OSError:
        discard_output()
        raise


def discard_output() -> None:
    """Forget the buffered rest of standard output, which cannot be written; Python would try again on leaving."""
    if sys.stdout is not None:
        with suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def tell(sentence: str) -> None:
    """Write a sentence for the person, if there is one, to standard error, without characters that do not print."""
    with suppress(OSError):
        if sentence:
            print(*map(printable, f"pinjoint: {sentence}".splitlines()), sep="\n", file=sys.stderr)


def encodable_json(text: str) -> str:
    """JSON that standard output can encode: what it lacks is written as \\u00e9, so that nothing is lost."""
    try:
        text.encode(getattr(sys.stdout, "encoding", None) or "utf-8")
    except UnicodeEncodeError:
        return re.sub(r"[^\x00-\x7f]", lambda found: json.dumps(found[0])[1:-1], text)
    return text
