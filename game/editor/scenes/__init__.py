"""Scenes: the modes of the program, a state machine with pause as its hub."""

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import marked, tr
from pinjoint.components.tags import Selected
from pinjoint.editor.context import PHYSICS, Context, Scene, Scenes
from pinjoint.editor.scenes.files import Pictures, Save
from pinjoint.editor.scenes.load import Load
from pinjoint.editor.scenes.methods import DisplacementMethod, ForceMethod, Sets
from pinjoint.editor.scenes.properties import Properties
from pinjoint.editor.scenes.statics import Solve, Statics
from pinjoint.systems.base import System
from pinjoint.systems.input.actions import METHODS
from pinjoint.systems.render.model.sheet import Stage

__all__ = ["PHYSICS", "Scene", "Scenes", "Stage", "all_scenes", "scene_systems"]


def all_scenes() -> list[Scene]:
    """The eight modes of Pinjoint, beginning with the one that the program starts in, and the modes of mods."""
    return [
        Pause(),
        Simulation(),
        Statics(),
        Properties(),
        Save(),
        Load(),
        ForceMethod(),
        DisplacementMethod(),
        *(scene() for scene in EXTENSIONS.scenes),
    ]


def scene_systems() -> list[System]:
    """The systems that belong to single modes."""
    return [Pictures(), Sets(), Solve()]


class Pause(Scene):
    """Time stands still; the hub, where a person looks, selects and edits."""

    name = "pause"
    heading = marked("Pause")
    targets = ("simulation", "statics", "properties", "save", "load", *METHODS)

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
