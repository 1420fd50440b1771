"""Named actions, by subject: the only way in, for keys, mouse, scripts and mods; importing them registers them."""

from game.editor.actions import drawing, editing, force_method, modes, time, view
from game.editor.context import ACTIONS, Action, action

__all__ = ["ACTIONS", "Action", "action", "drawing", "editing", "force_method", "modes", "time", "view"]
