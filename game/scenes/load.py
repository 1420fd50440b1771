"""Load: opening what was saved."""

from __future__ import annotations

from typing import TYPE_CHECKING

from game.scenes.base import Scene

if TYPE_CHECKING:
    from game.session import Session


class Load(Scene):
    """Opening what was saved."""

    name = "load"
    heading = "Load"

    def hint(self, session: Session) -> str:
        return "This mode has no boxes yet; Esc goes back to pause"
