"""Pause and simulation: the scenes of the model itself, in which time stands still or passes."""

from __future__ import annotations

from components.tags import Selected
from game.editor.context import Context, Scene


class Pause(Scene):
    """Time stands still; the hub, where a person looks, selects and edits."""

    name = "pause"
    heading = "Pause"
    targets = ("simulation", "properties", "save", "load", "force method")

    def hint(self, context: Context) -> str:
        if context.model.particles.count == 0:
            return "click a tool, then the canvas     right click menu     F1 all keys"
        selected = context.model.rows_tagged(Selected)
        kinds = [context.model.tables[name].kind for name, rows in selected.items() if len(rows)]
        if kinds and all(kind.points for kind in kinds):
            return "drag it or its ends     Return properties     Esc deselect     F1 keys"
        if kinds:
            return "right click menu     Return properties     I its forces     Esc deselect     F1 keys"
        return "Space run     click select     right click menu     I forces     wheel zoom     F1 keys"


class Simulation(Scene):
    """Time passes, and the picture follows."""

    name = "simulation"
    targets = ("pause",)

    def hint(self, context: Context) -> str:
        return "Space pause     + − speed     I forces     R restart     F1 keys"
