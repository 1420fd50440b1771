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
preparation.py              what a window has compiled, and which models wait for that
elsewhere.py prepare.py     compiling in another process, and loading what it made in a thread
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from game.interrupts import is_program, quietly_interrupted
from game.version import __version__

if TYPE_CHECKING:  # each is loaded where it is asked for
    from game.checks import SystemCheckError, check_system
    from game.editor.context import Context
    from game.session import Session

__all__ = ["Context", "Session", "SystemCheckError", "__version__", "check_system"]

_HOMES = {
    "Context": "game.editor.context",
    "Session": "game.session",
    "SystemCheckError": "game.checks",
    "check_system": "game.checks",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'game' has no attribute '{name}'")
    with quietly_interrupted():
        import_module("game.included")  # registers what is written as mods are
        return getattr(import_module(_HOMES[name]), name)


if not is_program():  # which loads what it needs
    __getattr__("Session")  # so that models can hold all, whatever part of the program a script begins with
