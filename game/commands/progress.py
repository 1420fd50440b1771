"""Progress: what a long computation says of itself on standard error, and how Ctrl+C ends it."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

from game.session import Session
from game.streams import tell
from systems.run.checkpoint import Checkpoint
from systems.run.simulation import Simulation

SILENT = 5.0  # s; what takes less says nothing
FURTHER = 10.0  # s between two sentences
KEPT_EVERY = 0.5  # s between the states of a run from which one is reported if it is interrupted
WORK_AT_ONCE = 2**22  # steps × elements, after which a run looks up

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


class Watch:
    """Keeps the state of a run from time to time, so that a run that is interrupted has one to report."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._kept: Checkpoint | None = None
        self._when = 0.0

    def __enter__(self) -> Watch:
        self._simulation.before_steps.append(self._look)
        return self

    def __exit__(self, *error: object) -> None:
        self._simulation.before_steps.remove(self._look)

    def _look(self) -> int:
        """Keep the state if it is time to; returns the number of steps until the next look."""
        model, now = self._simulation.model, time.monotonic()
        if self._kept is None or now - self._when > KEPT_EVERY:
            self._kept, self._when = self._simulation.checkpoint(), now
        return max(WORK_AT_ONCE // (model.particles.count + model.rods.count + 1), 1)

    def take_back(self) -> None:
        """Return to the last state that was kept: the present one may be in the midst of a step."""
        if self._kept is not None:
            self._simulation.resume(self._kept)
