"""Progress: what a long computation says of itself on standard error, and how Ctrl+C ends it."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

from game.session import Session
from game.streams import tell
from systems.run.simulation import Simulation

SILENT = 5.0  # s; what takes less says nothing
FURTHER = 10.0  # s between two sentences

_followed: list[Simulation] = []  # the runs of the command, the last one being told of


def follow(session: Session) -> Session:
    """Tell how far the run of this session is from now on; returns it."""
    _followed.append(session.simulation)
    return session


@contextmanager
def told() -> Iterator[None]:
    """While a command works inside, tell every few seconds how far the run is that it follows."""
    done = threading.Event()
    began = time.monotonic()

    def speak() -> None:
        wait = SILENT
        while not done.wait(wait):
            wait = FURTHER
            if not _followed:
                continue
            tell(f"after {time.monotonic() - began:.0f} s: {how_far()}. Ctrl+C stops it.")

    voice = threading.Thread(target=speak, daemon=True)
    voice.start()
    try:
        yield
    finally:
        done.set()
        _followed.clear()


def how_far() -> str:
    """What the command does and how far it is, as a part of a sentence."""
    progress = _followed[-1].progress
    if progress.steps == 0 and progress.impacts == 0:
        return "computing, and no time has passed yet"
    return f"t = {progress.time:.9g} s, {progress.steps} steps, {progress.impacts} impacts"
