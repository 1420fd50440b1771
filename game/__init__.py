"""COMPOSITION: the program. `Session` drives it from scripts, without a window.

session.py                what scripts and tests drive: an open document in the editor
editor/                   scenes, actions, gestures, toolbar: what keys and buttons do, and what the window says
documents/                models as plain data and in files, undo and stepping back, autosave, preferences
commands/                 the command line and its reports
paths.py                  what particles.B.force and the like mean, wherever a person writes one
sweeps/                   many variants of a model
scripts/                  scripted sessions and lessons
mods/ included/ checks.py extensions by others, ours that are written like theirs, and how to test them
force_method/             the guide through the force method
app.py                    the window
preparation.py prepare.py compiling ahead of need, in another process
"""

from game.interrupts import quietly_interrupted

with quietly_interrupted():
    from game import included as _included  # noqa: F401 (registers what is written as mods are)
    from game.checks import SystemCheckError, check_system
    from game.editor.context import Context
    from game.session import Session
    from game.version import __version__

__all__ = ["Context", "Session", "SystemCheckError", "__version__", "check_system"]
