"""Scenes: the modes of the program, a state machine with pause as its hub."""

from game.registry import SCENES
from game.scenes.base import Scene, SceneError, Scenes, Stage
from game.scenes.force_method import ForceMethod
from game.scenes.load import Load
from game.scenes.pause import Pause
from game.scenes.properties import Properties
from game.scenes.save import Save
from game.scenes.simulation import Simulation

__all__ = ["Scene", "SceneError", "Scenes", "Stage", "all_scenes"]


def all_scenes() -> list[Scene]:
    """The six modes, the first of which the program starts in, and those of mods."""
    return [Pause(), Simulation(), Properties(), Save(), Load(), ForceMethod(), *(scene() for scene in SCENES)]
