"""Watchdog: an exception raised in a thread whose Python code runs for too long."""

from __future__ import annotations

import ctypes
import sys
import threading
import time
from collections.abc import Callable
from typing import TypeVar

from pinjoint.components.language import tr
from pinjoint.systems import is_ours

T = TypeVar("T")

RETRY = 1e-4  # s
AGAIN = 0.05  # s after which code that caught the exception and goes on is interrupted once more


class TooLong(BaseException):
    """Raised in Python code that ran longer than its limit (s); `except Exception` does not catch it."""

    limit = 0.0

    def __init__(self) -> None:
        super().__init__(tr("it ran for more than {seconds:g} s", seconds=self.limit))


class _Watchdog:
    """One thread for the whole program, started when first needed, that sleeps between deadlines."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._deadline: float | None = None
        self._waits_until: float | None = None  # None: for a call of watch()
        self._fired = False
        self._may: Callable[[], bool] = bool
        self._thread = 0  # identifier of the watched thread
        self._depth = 0  # of watches inside each other, of which the outermost counts
        self._started = False

    def watch(self, seconds: float, may: Callable[[], bool]) -> bool:
        """Interrupt the calling thread after some seconds, then as soon as may() is true; False: another is watched."""
        with self._changed:
            if self._depth and self._thread != threading.get_ident():
                return False
            self._depth += 1
            if self._depth > 1:
                return True
            if not self._started:
                threading.Thread(target=self._run, name="watchdog", daemon=True).start()
                self._started = True
            self._thread, TooLong.limit, self._fired = threading.get_ident(), seconds, False
            self._may, self._deadline = may, time.monotonic() + seconds
            if self._waits_until is None or self._deadline < self._waits_until:
                self._changed.notify()
            return True

    def stop(self) -> None:
        """End the watch; an exception that is already due is taken back."""
        with self._changed:
            self._depth -= 1
            if self._depth:
                return
            self._deadline = None
            if self._fired:
                _take_back()

    def _run(self) -> None:
        with self._changed:
            while True:
                left = None if self._deadline is None else self._deadline - time.monotonic()
                if left is not None and left <= 0.0:
                    if self._may():
                        self._fired, self._deadline = True, time.monotonic() + AGAIN
                        _raise_in(self._thread, TooLong)
                    left = RETRY
                self._waits_until = None if left is None else time.monotonic() + left
                self._changed.wait(left)


_watchdog = _Watchdog()


def _raise_in(thread: int, exception: type[BaseException]) -> None:
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


def within(seconds: float, may: Callable[[], bool], function: Callable[[], T]) -> T:
    """The result of a function; once it takes longer, TooLong is raised in it. Compiled code is interrupted as it returns.

    may: called by the watchdog; True if the function may be interrupted where it is. Only one thread runs Python
    code at a time, so it has not moved on when the exception comes. Inside each other, the outermost limit counts.
    """
    if not _watchdog.watch(seconds, may):
        return function()
    try:
        return function()
    finally:
        try:
            _watchdog.stop()
        except TooLong:  # that was due when the function returned
            _watchdog.stop()


def is_running(folder: str) -> Callable[[], bool]:
    """A question for `within`: whether the calling thread runs code from a folder, or code called by that.

    Pinjoint's own is not interrupted although code of that folder called it.
    """
    thread = threading.get_ident()

    def running() -> bool:
        frame = sys._current_frames().get(thread)
        while frame is not None:
            if frame.f_code.co_filename.startswith(folder):
                return True
            if is_ours(frame.f_globals.get("__name__")):
                return False
            frame = frame.f_back
        return False

    return running


def stop_after(seconds: float) -> Callable[[], None]:
    """A function that raises TooLong when it is called after some seconds."""
    deadline = time.monotonic() + seconds

    def check() -> None:
        if time.monotonic() > deadline:
            raise TooLong

    return check
