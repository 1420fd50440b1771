"""Interrupts: Ctrl+C ends the program silently while it loads, when there is nothing to clean up."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_HERE = Path(__file__).parent


def _is_program(called: str) -> bool:
    """True if the process is the program: `pinjoint` or `python -m game` (called "-m" before Python has found it)."""
    return Path(called).stem in ("pinjoint", "pinjoint-script", "-m") or Path(called).parent == _HERE


@contextmanager
def quietly_interrupted() -> Iterator[None]:
    """Let Ctrl+C end the process at once, if it is the program itself; scripts that import game handle it themselves."""
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
