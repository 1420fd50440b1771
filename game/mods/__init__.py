"""Mods: extensions by others, and parts of Pinjoint that are written as mods; assets/mods/README.md is their guide.

>>> from pinjoint import mods
>>> [mod.name for mod in mods.MODS if mod.problem]
[]
"""

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.mods.app import App
from pinjoint.mods.loading import include, load, load_all, unload
from pinjoint.mods.mod import Mod, ModError

FAULTS, MODS = EXTENSIONS.faults, EXTENSIONS.mods

__all__ = ["FAULTS", "MODS", "App", "Mod", "ModError", "include", "load", "load_all", "unload"]
