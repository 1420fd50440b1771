"""Save: saving under a name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from game.scenes.base import Scene

if TYPE_CHECKING:
    from game.session import Session


class Save(Scene):
    """Saving under a name."""

    name = "save"
    heading = "Save"

    def hint(self, session: Session) -> str:
        return "This mode has no boxes yet; Esc goes back to pause"
