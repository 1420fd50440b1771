"""Named actions, by subject: the only way in, for keys, mouse, scripts and mods."""

from game.editor.actions import (
    clipboard,
    drawing,
    editing,
    files,
    force_method,
    forms,
    grids,
    scenes,
    selection,
    time,
    view,
)
from game.editor.actions.registry import ACTIONS, WHILE_DRAWING, Action, action

__all__ = [
    "ACTIONS",
    "WHILE_DRAWING",
    "Action",
    "action",
    "clipboard",
    "drawing",
    "editing",
    "files",
    "force_method",
    "forms",
    "grids",
    "scenes",
    "selection",
    "time",
    "view",
]
