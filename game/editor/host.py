"""Host: what a window offers to a session; without a window there is none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from pinjoint.systems.run.simulation import Simulation


class Window(Protocol):
    """The window, for actions that only make sense in one."""

    def toggle_full_screen(self) -> None:
        """Fill the screen, or stop doing so."""

    def magnify(self, by: int) -> str:
        """Draw type and symbols a step larger or smaller; 0: as they suit the window. Returns which it is."""

    def screenshot(self, suffix: str) -> str:
        """Save a picture in the format of that suffix; returns where. Raises OSError."""

    def save(self, name: str, contents: bytes) -> str:
        """Save a file under this name, or one like it that is free; returns where. Raises OSError."""

    def copied(self) -> str:
        """The text on the system's clipboard."""

    def copy(self, text: str) -> None:
        """Put a text on the system's clipboard."""


@dataclass(frozen=True)
class Waiting:
    """That a model waits for its program to be compiled: for how long already, and in all, probably (s)."""

    seconds: float
    expected: float

    @property
    def share(self) -> float:
        """How much of that is over: from 0 on, and less than 1."""
        return min(self.seconds / self.expected, 0.99)


class ProgramPreparation(Protocol):
    """Compiles step programs in another process, so that the window goes on meanwhile."""

    def waits_for(self, simulation: Simulation) -> Waiting | None:
        """What a simulation waits for; None if it can go on, interpreted or compiled."""
