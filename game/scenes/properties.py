"""Properties: what an element is, as boxes to type into."""

from __future__ import annotations

from typing import TYPE_CHECKING

from game.scenes.base import Scene

if TYPE_CHECKING:
    from game.session import Session


class Properties(Scene):
    """What an element is, as boxes to type into."""

    name = "properties"
    heading = "Properties"

    def hint(self, session: Session) -> str:
        return "This mode has no boxes yet; Esc goes back to pause"
