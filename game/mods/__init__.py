"""Mods: extensions by others, and parts of Pinjoint that are written as mods; assets/mods/README.md is their guide.

>>> from game import mods
>>> [mod.name for mod in mods.MODS if mod.problem]
[]
"""

from game.editor.context import FAULTS
from game.mods.app import App
from game.mods.loading import MODS, include, load, load_all, unload
from game.mods.mod import Mod, ModError

__all__ = ["FAULTS", "MODS", "App", "Mod", "ModError", "include", "load", "load_all", "unload"]
