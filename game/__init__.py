"""COMPOSITION: the program. `Session` drives it from scripts, without a window.

__main__.py                 `pinjoint` and `python -m game`; interrupts.py lets Ctrl+C end it while it loads
commands/                   the command line and its reports
app.py                      the window: pygame around a session
session.py                  Session: a context that scripts and tests drive
editor/                     Context, and what changes it: scenes, actions, gestures; what the view says of it
documents/                  models in files, open documents, undo and stepping back, autosave, preferences
scripts/                    scripted sessions and lessons: written, recorded, played
force_method/               the guide through the force method
sweeps/                     many variants of a model
mods/ included/             extensions by others, and ours that are written like theirs
api.py                      what mods and scripts may rely on, in one place
checks.py                   check_system: a test of any system, for mods
paths.py                    what particles.B.force and the like mean, wherever a person writes one
preparation.py prepare.py   compiling ahead of need, in another process
"""

from game.interrupts import quietly_interrupted

with quietly_interrupted():
    from game import included as _included  # noqa: F401 (registers what is written as mods are)
    from game.checks import SystemCheckError, check_system
    from game.editor.context import Context
    from game.session import Session
    from game.version import __version__

__all__ = ["Context", "Session", "SystemCheckError", "__version__", "check_system"]
