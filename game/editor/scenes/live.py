"""Pause and simulation: the scenes of the model itself, in which time stands still or passes."""

from __future__ import annotations

from pinjoint.components.language import marked, tr
from pinjoint.components.tags import Selected
from pinjoint.editor.context import Context, Scene


class Pause(Scene):
    """Time stands still; the hub, where a person looks, selects and edits."""

    name = "pause"
    heading = marked("Pause")
    targets = ("simulation", "properties", "save", "load", "force method")

    def hint(self, context: Context) -> str:
        if context.model.particles.count == 0:
            return tr("click a tool, then the canvas     right click menu     F1 help")
        selected = context.model.rows_tagged(Selected)
        kinds = [context.model.tables[name].kind for name, rows in selected.items() if len(rows)]
        if kinds and all(kind.points for kind in kinds):
            return tr("drag it or its ends     Return properties     Esc deselect     F1 help")
        if kinds:
            return tr("right click menu     Return properties     I force diagram     Esc deselect     F1 help")
        return tr(
            "Space run     click select     right click menu     I force diagrams     wheel zoom     F1 help"
        )


class Simulation(Scene):
    """Time passes, and the picture follows."""

    name = "simulation"
    targets = ("pause",)

    def hint(self, context: Context) -> str:
        return tr("Space pause     + faster     − slower     I force diagrams     R restart     F1 help")
