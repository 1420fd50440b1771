"""Surroundings: what a session is given in a window, and does without elsewhere."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from game.documents.open_documents import Desk
    from systems.run.simulation import Simulation


class Window(Protocol):
    """What a window does for actions that only make sense in one."""

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


class Autosaves(Protocol):
    """Where a window keeps unsaved work against a crash."""

    def left(self) -> list[Path]:
        """What a crash left behind."""

    def take_over(self, path: Path, desk: Desk) -> None:
        """What was left behind is unsaved work of this desk from now on."""

    def discard(self) -> None:
        """What a crash left behind is not wanted any more."""


class Prepares(Protocol):
    """What has step programs compiled in a window, which must not stand still meanwhile."""

    def waits_for(self, simulation: Simulation) -> float | None:
        """Seconds since the program of a simulation was wanted, or None if it can be had at once."""
