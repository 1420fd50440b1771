"""Watchdog: an exception raised in a thread whose Python code runs for too long."""

from __future__ import annotations

import ctypes
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

RETRY = 1e-4  # s


class TooLong(Exception):
    """Raised in Python code that ran longer than its limit (s)."""

    limit = 0.0

    def __str__(self) -> str:
        return f"it ran for more than {self.limit:g} s"


class _Watchdog:
    """One thread for the whole program, started when first needed, that sleeps between deadlines."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._deadline: float | None = None
        self._may: Callable[[], bool] = bool
        self._thread = 0  # identifier of the watched thread
        self._started = False

    def watch(self, seconds: float, may: Callable[[], bool]) -> None:
        """Interrupt the calling thread after some seconds, then as soon as may() is true."""
        with self._changed:
            if not self._started:
                threading.Thread(target=self._run, name="watchdog", daemon=True).start()
                self._started = True
            self._thread, TooLong.limit = threading.get_ident(), seconds
            self._may, self._deadline = may, time.monotonic() + seconds
            self._changed.notify()

    def stop(self) -> None:
        """End the watch; an exception that is already due is taken back."""
        with self._changed:
            fired, self._deadline = self._deadline is None, None
            if fired:
                _take_back()

    def _run(self) -> None:
        with self._changed:
            while True:
                left = None if self._deadline is None else self._deadline - time.monotonic()
                if left is not None and left <= 0.0 and not self._may():
                    self._changed.wait(RETRY)
                elif left is not None and left <= 0.0:
                    self._deadline = None
                    _raise_in(self._thread, TooLong)
                else:
                    self._changed.wait(left)


_watchdog = _Watchdog()


def _raise_in(thread: int, exception: type[Exception]) -> None:
    """Let an exception be raised in a thread before its next Python instruction."""
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(exception))


class _Nothing(Exception):
    """Raised in place of an exception that is taken back."""


def _take_back() -> None:
    """Replace an exception that is due in this thread by one that is caught here.

    The interpreter clears its flag for exceptions from other threads only when one is raised. If the exception
    were only unset, the flag would stay: a slower interpreter, and an endless loop under a debugger.
    """
    try:
        _raise_in(threading.get_ident(), _Nothing)
        while True:
            pass
    except _Nothing:
        pass


@contextmanager
def interrupted_after(seconds: float, may: Callable[[], bool]) -> Iterator[None]:
    """Raise TooLong in the body of a `with` that takes longer; compiled code is interrupted when it returns.

    may: called by the watchdog; True if the body may be interrupted where it is. Only one thread runs Python
    code at a time, so the body has not moved on when the exception comes.
    """
    _watchdog.watch(seconds, may)
    try:
        yield
    finally:
        _watchdog.stop()


def stop_after(seconds: float) -> Callable[[], None]:
    """A function that raises TooLong when it is called after some seconds."""
    deadline = time.monotonic() + seconds

    def check() -> None:
        if time.monotonic() > deadline:
            raise TooLong

    return check
