"""Limits that nothing may exceed, whatever it is given."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager


class Hang(AssertionError):
    """Something went on for longer than anything may."""


@contextmanager
def within(seconds: float, what: str = "this") -> Iterator[None]:
    """Raise Hang in whatever takes more processor time (s) than that; not where the system has no such timers."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def handle(*_: object) -> None:
        raise Hang(f"{what} took more than {seconds:g} s of processor time")

    before = signal.signal(signal.SIGPROF, handle)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)
