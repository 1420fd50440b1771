"""How the program ends: Ctrl+C while it loads, signals while a window is open, threads that go on.

Ctrl+C is told from a KeyboardInterrupt that a mod raises, which must not end the program.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

CLOSING = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
PATIENCE = 1.5  # s that what is in progress may take to end before it is cut off
AGAIN = 0.02  # s after which what could not be raised is tried again


@contextmanager
def quietly_interrupted() -> Iterator[None]:
    """Let Ctrl+C end the process at once, if it is the program itself; scripts handle it themselves.

    `pinjoint` and `python -m pinjoint` are the program; that is called "-m" before Python has found it.
    """
    called = Path(next(iter(sys.argv), ""))
    is_program = called.stem in ("pinjoint", "pinjoint-script", "-m") or called.parent == Path(__file__).parent
    usual = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    in_main_thread = threading.current_thread() is threading.main_thread()
    if not (usual and in_main_thread and is_program):
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


def end_in_time() -> None:
    """From now on end the process where one of these signals has not ended it soon: inside a compiler, code that swallows
    errors, or a thread that is waited for, Python raises nothing.
    """
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    signal.set_wakeup_fd(writer, warn_on_full_buffer=False)

    def cut_off() -> None:
        while (number := os.read(reader, 1)[0]) not in CLOSING:
            pass
        time.sleep(PATIENCE)
        os._exit(128 + number)

    threading.Thread(target=cut_off, name="end in time", daemon=True).start()


class Interrupt(KeyboardInterrupt):
    """Ctrl+C."""


def interrupt(number: int, frame: FrameType | None) -> None:
    """Raise Interrupt; a little later in what LLVM calls while it compiles, where nothing raised goes on."""

    def again() -> None:
        if signal.getsignal(number) is interrupt:
            signal.raise_signal(number)

    while frame is not None:
        if frame.f_code.co_name.startswith("_raw_object_cache"):
            threading.Timer(AGAIN, again).start()
            return
        frame = frame.f_back
    raise Interrupt


def mark_interrupts() -> None:
    """From now on Ctrl+C raises Interrupt, wherever Python would raise KeyboardInterrupt."""
    usual = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if usual and threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, interrupt)


def is_persons(error: BaseException) -> bool:
    """True for an interrupt by the person; False for other errors, and for a KeyboardInterrupt that code raised."""
    if not isinstance(error, KeyboardInterrupt):
        return False
    handler = signal.getsignal(signal.SIGINT)
    ours = getattr(handler, "__module__", "") == __name__  # it raises nothing else
    return isinstance(error, Interrupt) or not (ours or handler is signal.SIG_IGN)  # ignored: none can come


def ended_with(status: int) -> int:
    """The exit status; the process ends with it even if threads, which a mod may have started, do not end."""
    main = threading.main_thread()

    def left() -> list[str]:
        return [thread.name for thread in threading.enumerate() if not (thread.daemon or thread is main)]

    def end() -> None:
        from pinjoint.components.language import listed, tr  # this module is loaded before all that takes time

        time.sleep(2.0)  # threads may take as long to end after the program
        said = tr("These threads did not end and were left: {threads}.", threads=listed(left()))
        print(f"pinjoint: {said}", file=sys.stderr, flush=True)
        os._exit(status)

    if left():  # which Python would wait for
        threading.Thread(target=end, daemon=True).start()
    return status
