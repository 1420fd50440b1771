"""Named actions, by subject: the only way in, for keys, mouse, scripts and mods."""

from game.actions import grids, scenes, selection, time, view
from game.actions.registry import ACTIONS, Action, action

__all__ = ["ACTIONS", "Action", "action", "grids", "scenes", "selection", "time", "view"]
