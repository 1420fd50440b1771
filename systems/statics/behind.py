"""Behind: a long calculation that goes on in parts, some of each frame, so that a window stays alive meanwhile.

It runs in a thread of its own, but only while somebody waits for its part: never beside what edits the model. It rests where
it asks how rods respond, which each of its iterations does. Where one frame is enough, it costs 0.1 ms.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from contextvars import ContextVar
from typing import Generic, TypeVar

T = TypeVar("T")

_FORGOTTEN = 60.0  # s without being asked to go on, after which a calculation ends
_rest: ContextVar[Callable[[], None]] = ContextVar("_rest", default=lambda: None)


def rest() -> None:
    """Let others go on, if a part is over."""
    _rest.get()()


class _GivenUp(BaseException):
    """Nobody waits for the calculation any more."""


class Behind(Generic[T]):
    """A calculation in parts. seconds: that it has taken so far."""

    def __init__(self, calculate: Callable[[], T]) -> None:
        self._calculate = calculate
        self._go, self._over = threading.Semaphore(0), threading.Semaphore(0)
        self._until, self._wanted = 0.0, True
        self._thread: threading.Thread | None = None
        self._found: list[T] = []
        self._error: Exception | None = None
        self._ended = False
        self.seconds = 0.0

    def part(self, seconds: float) -> bool:
        """Let it go on for about so long; True once it has ended. Without an end to that, it needs no thread."""
        started = time.perf_counter()
        self._until = started + seconds
        if self._thread is None and seconds == math.inf:
            self._end()
        elif not self._ended:
            if self._thread is None or not self._thread.is_alive():  # not begun, or forgotten
                self._thread = threading.Thread(target=self._run, daemon=True)
                self._thread.start()
            else:
                self._go.release()
            while not self._over.acquire(timeout=1.0) and self._thread.is_alive():
                pass
        self.seconds += time.perf_counter() - started
        return self._ended

    def result(self) -> T:
        """What came of it, or the exception that it raised."""
        if self._error is not None:
            raise self._error
        return self._found[0]

    def give_up(self) -> None:
        """Let it end where it is."""
        self._wanted = False
        if self._thread is not None:
            self._go.release()
            self._thread.join()

    def _run(self) -> None:
        _rest.set(self._rest)
        with suppress(_GivenUp):
            self._end()
            self._over.release()

    def _end(self) -> None:
        try:
            self._found.append(self._calculate())
        except Exception as error:  # for whoever waits for it
            self._error = error
        self._ended = True

    def _rest(self) -> None:
        if time.perf_counter() < self._until:
            return
        self._over.release()
        if not (self._go.acquire(timeout=_FORGOTTEN) and self._wanted):
            raise _GivenUp
