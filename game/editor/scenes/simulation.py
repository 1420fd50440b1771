"""Simulation: physics runs and the picture is live."""

from __future__ import annotations

from typing import TYPE_CHECKING

from game.editor.scenes.base import Scene

if TYPE_CHECKING:
    from game.session import Session


class Simulation(Scene):
    """Time passes."""

    name = "simulation"
    targets = ("pause",)

    def busy(self, session: Session) -> bool:
        return not session.simulation.halted

    def hint(self, session: Session) -> str:
        return "Space pause     + − speed     I forces     R restart     F1 keys"
