"""Named actions, a module for each purpose of the help; importing them registers them.

The only way in, for keys, mouse, scripts and mods.
"""

from pinjoint.editor.actions import (  # noqa: F401
    boxes,
    drawing,
    editing,
    files,
    menu,
    methods,
    results,
    sliding,
    table,
    time,
    view,
)
