"""Limits that nothing may exceed, whatever it is given, and Ctrl+C after a while."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from pinjoint.interrupts import interrupt

AGAIN = 10.0  # s of processor time


class Hang(AssertionError):
    """Something went on for longer than anything may."""


@contextmanager
def within(seconds: float, what: str = "this") -> Iterator[None]:
    """Raise Hang in whatever takes more processor time (s) than that; not where the system has no such timers."""

    def handle(*_: object) -> None:
        raise Hang(f"{what} took more than {seconds:g} s of processor time")

    with _after(seconds, handle):
        yield


@contextmanager
def interrupted_after(seconds: float) -> Iterator[None]:
    """Ctrl+C in whatever takes more processor time (s) than that, and again after AGAIN, since ends of objects swallow some.

    Not where the system has no such timers.
    """
    with _after(seconds, interrupt, AGAIN):
        yield


@contextmanager
def _after(seconds: float, handle: Callable[..., object], again: float = 0.0) -> Iterator[None]:
    if not hasattr(signal, "setitimer"):
        yield
        return
    before = signal.signal(signal.SIGPROF, handle)
    signal.setitimer(signal.ITIMER_PROF, seconds, again)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)
