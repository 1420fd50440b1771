"""Simulation: physics runs and the picture is live."""

from __future__ import annotations

from game.editor.context import Context, Scene


class Simulation(Scene):
    """Time passes."""

    name = "simulation"
    targets = ("pause",)

    def busy(self, context: Context) -> bool:
        return not context.simulation.halted

    def hint(self, context: Context) -> str:
        return "Space pause     + − speed     I forces     R restart     F1 keys"
