"""Progress: what a long computation says of itself on standard error, and how Ctrl+C ends it."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

from pinjoint.components.language import marked, tr
from pinjoint.session import Session
from pinjoint.streams import tell
from pinjoint.systems.run.simulation import Simulation

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
            seconds, progress = time.monotonic() - began, _followed[-1].progress
            said = marked(
                "after {seconds:.0f} s: t = {time:.9g} s, {steps} steps, {impacts} impacts. Ctrl+C stops it."
            )
            if progress.steps == 0 and progress.impacts == 0:
                said = marked("after {seconds:.0f} s: preparing, no step was made yet. Ctrl+C stops it.")
            tell(tr(said, seconds=seconds, **vars(progress)))

    voice = threading.Thread(target=speak, daemon=True)
    voice.start()
    try:
        yield
    finally:
        done.set()
        _followed.clear()
