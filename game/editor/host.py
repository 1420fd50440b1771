"""Host: what a window offers to a session; without a window there is none."""

from __future__ import annotations

from typing import Protocol

from systems.run.simulation import Simulation


class Window(Protocol):
    """The window, for actions that only make sense in one."""

    def toggle_full_screen(self) -> None:
        """Fill the screen, or stop doing so."""

    def magnify(self, by: int) -> str:
        """Draw type and symbols a step larger or smaller; 0: as they suit the window. Returns which it is."""

    def screenshot(self) -> str:
        """Save a picture of the window; returns where. Raises OSError."""

    def copied(self) -> str:
        """The text on the system's clipboard."""

    def copy(self, text: str) -> None:
        """Put a text on the system's clipboard."""


class ProgramPreparation(Protocol):
    """Compiles step programs in another process, so that the window goes on meanwhile."""

    def waits_for(self, simulation: Simulation) -> float | None:
        """Seconds since the program of a simulation was wanted, or None if it can be had at once."""
