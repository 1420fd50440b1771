"""Progress: what a long computation says of itself on standard error, and how Ctrl+C ends it."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from pinjoint.components.language import tr
from pinjoint.streams import tell

SILENT = 5.0  # s; what takes less says nothing
FURTHER = 10.0  # s between two sentences

Progress = Callable[[], tuple[float, int, int]]  # of a run: up to which time (s) it is, steps and impacts
_followed: list[Progress] = []  # the runs of the command, the last one being told of


def follow(progress: Progress = lambda: (0.0, 0, 0)) -> None:
    """From now on tell how far a run is; by default that it takes no steps."""
    _followed.append(progress)


@contextmanager
def told() -> Iterator[None]:
    """While a command works inside, tell every few seconds how far the run is that it follows."""
    done = threading.Event()
    began = time.monotonic()

    def speak() -> None:
        wait = SILENT
        while not done.wait(wait):
            wait = FURTHER
            if _followed:
                tell(_how_far(time.monotonic() - began, *_followed[-1]()))

    voice = threading.Thread(target=speak, daemon=True)
    voice.start()
    try:
        yield
    finally:
        done.set()
        _followed.clear()


def _how_far(seconds: float, passed: float, steps: int, impacts: int) -> str:
    if steps == 0 and impacts == 0:
        return tr(
            "after {seconds:.0f} s: still at work, no step in time was made yet. Ctrl+C stops it.",
            seconds=seconds,
        )
    return tr(
        "after {seconds:.0f} s: t = {time:.9g} s, {steps} steps, {impacts} impacts. Ctrl+C stops it.",
        seconds=seconds,
        time=passed,
        steps=steps,
        impacts=impacts,
    )
