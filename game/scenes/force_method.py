"""Force method: the guided solution of a hyperstatic structure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from game.scenes.base import Scene

if TYPE_CHECKING:
    from game.session import Session


class ForceMethod(Scene):
    """The seven parts of the force method."""

    name = "force method"
    heading = "Force method"

    def hint(self, session: Session) -> str:
        return "This mode is not guided yet; Esc goes back to pause"
