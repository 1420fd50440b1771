"""Named actions, by subject: the only way in, for keys, mouse, scripts and mods; importing them registers them."""

from pinjoint.editor.actions import editing, force_method, members, menu, modes, pointer, sliding, time, view
from pinjoint.editor.context import ACTIONS, WHILE_DRAWING, Action, action

__all__ = [
    "ACTIONS",
    "WHILE_DRAWING",
    "Action",
    "action",
    "editing",
    "force_method",
    "members",
    "menu",
    "modes",
    "pointer",
    "sliding",
    "time",
    "view",
]
