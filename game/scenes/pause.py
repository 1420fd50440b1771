"""Pause: the hub, where a person looks, selects and edits."""

from __future__ import annotations

from typing import TYPE_CHECKING

from game.scenes.base import Scene

if TYPE_CHECKING:
    from game.session import Session


class Pause(Scene):
    """Time stands still."""

    name = "pause"
    heading = "Pause"
    targets = ("simulation", "properties", "save", "load", "force method")

    def hint(self, session: Session) -> str:
        if session.model.particles.count == 0:
            return (
                "P new particle under the pointer     L rod from one to another     C support     F force"
                "     D open a model     F1 all keys"
            )
        if any(handle.points for handle in session.selected[:1]):
            return "drag it or its ends     Return properties     Esc deselect     F1 keys"
        if session.has_selected:
            return "Return properties     I its forces     Esc deselect     F1 keys"
        return "Space run     click select     I forces     wheel zoom     F1 keys"
