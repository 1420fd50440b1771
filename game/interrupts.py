"""Interrupts: Ctrl+C ends the program silently while it loads; it and others close a window as its icon does."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

_HERE = Path(__file__).parent
CLOSING = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
PATIENCE = 5.0  # s that a frame in progress may take before it is cut off


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


@contextmanager
def closed_by_signals(close: Callable[[], None]) -> Iterator[None]:
    """Call `close` when somebody ends the program from outside; where it does not end soon, the system ends it.

    Only the latter leaves recovery files behind. Systems without timers wait.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    timed = hasattr(signal, "setitimer")

    def handle(*_: object) -> None:
        close()
        if timed:
            signal.signal(signal.SIGALRM, signal.SIG_DFL)
            signal.setitimer(signal.ITIMER_REAL, PATIENCE)

    heard = [number for number in CLOSING if signal.getsignal(number) is not signal.SIG_IGN]
    before = {number: signal.signal(number, handle) for number in heard}
    try:
        yield
    finally:
        if timed:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
        for number, handler in before.items():
            signal.signal(number, handler or signal.SIG_DFL)
