"""Scenes: the modes of the program, a state machine with pause as its hub."""

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.editor.context import PHYSICS, Scene, Scenes
from pinjoint.editor.scenes.files import Pictures
from pinjoint.editor.scenes.force_method import ForceMethod, Sets
from pinjoint.editor.scenes.live import Pause, Simulation
from pinjoint.editor.scenes.load import Load
from pinjoint.editor.scenes.properties import Properties
from pinjoint.editor.scenes.save import Save
from pinjoint.systems.base import System
from pinjoint.systems.render.picture import Stage

__all__ = ["PHYSICS", "SCENES", "Scene", "Scenes", "Stage", "all_scenes", "scene_systems"]


def all_scenes() -> list[Scene]:
    """The six modes of Pinjoint, beginning with the one that the program starts in, and the modes of mods."""
    return [
        Pause(),
        Simulation(),
        Properties(),
        Save(),
        Load(),
        ForceMethod(),
        *(scene() for scene in EXTENSIONS.scenes),
    ]


def scene_systems() -> list[System]:
    """The systems that belong to single modes."""
    return [Pictures(), Sets()]
