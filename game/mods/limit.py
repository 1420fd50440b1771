"""The time limit of mods: code of one that runs for too long gets an exception, so that no loop of it hangs the window."""

from __future__ import annotations

import ctypes
import math
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import TypeVar

from pinjoint.components.language import tr
from pinjoint.systems import is_ours

T = TypeVar("T")

LOOK = 0.02  # s between looks at what runs
AGAIN = 0.05  # s after which code that caught the exception and goes on is interrupted once more


class TooLong(BaseException):
    """Raised in Python code that ran longer than its limit (s); `except Exception` does not catch it."""

    limit = 0.0

    def __init__(self) -> None:
        super().__init__(tr("it ran for more than {seconds:g} s", seconds=self.limit))


class _Watchdog:
    """One thread for the whole program, started when first needed, that looks at one call of a mod's code at a time."""

    def __init__(self) -> None:
        self._changing = threading.Lock()
        self._started = self._fired = False
        self._thread, self._folder = 0, ""  # which makes the call, and of whose code; 0: nothing is watched
        self.deadline = math.inf

    def begin(self, folder: str, seconds: float) -> bool:
        """Watch a call; False if one is watched already, whose limit counts."""
        with self._changing:
            if self._thread:
                return False
            self._thread, self._folder, self._fired = threading.get_ident(), folder, False
            TooLong.limit, self.deadline = seconds, time.monotonic() + seconds
            if not self._started:
                threading.Thread(target=self._run, name="watchdog", daemon=True).start()
                self._started = True
            return True

    def end(self) -> None:
        """End the watch; an exception that is due comes now, and is taken back."""
        with self._changing:
            self._thread, self.deadline = 0, math.inf
        with suppress(TooLong):
            for _ in range(100 if self._fired else 0):
                pass

    def _run(self) -> None:
        while True:
            with self._changing:
                late = time.monotonic() > self.deadline
                if late and self._runs():
                    self._fired, self.deadline = True, time.monotonic() + AGAIN
                    given = ctypes.c_ulong(self._thread), ctypes.py_object(TooLong)
                    ctypes.pythonapi.PyThreadState_SetAsyncExc(*given)
            time.sleep(1e-4 if late else LOOK)

    def _runs(self) -> bool:
        """True if the thread is in code of the folder, or in code called by that which is not Pinjoint's own."""
        frame = sys._current_frames().get(self._thread)
        while frame is not None and not frame.f_code.co_filename.startswith(self._folder):
            frame = None if is_ours(frame.f_globals.get("__name__")) else frame.f_back
        return frame is not None


_watchdog = _Watchdog()


def within(seconds: float, folder: str, function: Callable[[], T]) -> T:
    """The result of a function; once it takes longer, TooLong is raised as soon as code of a folder runs in it.

    Compiled code is interrupted as it returns. Inside each other, the outermost limit counts.
    """
    if not _watchdog.begin(folder, seconds):
        return function()
    try:
        return function()
    finally:
        try:
            _watchdog.end()
        except TooLong:  # that was due when the function returned
            _watchdog.end()


def check_limit() -> None:
    """Raise TooLong if the call that is watched takes too long: where it is interrupted in no code of its own."""
    if time.monotonic() > _watchdog.deadline:
        raise TooLong
