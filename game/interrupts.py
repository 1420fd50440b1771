"""Ctrl+C while the program loads: it ends without a word, as there is nothing yet to tidy up."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_HERE = Path(__file__).parent


def _is_program(called: str) -> bool:
    """Whether the process is the program: `pinjoint`, or `python -m game`, before and after that is found."""
    return Path(called).stem in ("pinjoint", "pinjoint-script", "-m") or Path(called).parent == _HERE


@contextmanager
def quietly_interrupted() -> Iterator[None]:
    """Let Ctrl+C end the process at once, if it is the program itself: a script that imports it has its own way."""
    usual = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    in_main_thread = threading.current_thread() is threading.main_thread()
    if not (usual and in_main_thread and _is_program(*sys.argv[:1] or [""])):
        yield
        return
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
