"""COMPOSITION: the program. `Session` drives it from scripts, without a window.

__main__.py                 `pinjoint` and `python -m pinjoint`; interrupts.py lets Ctrl+C end it while it loads
commands/                   the command line and its reports
app.py                      the window: pygame around a session
headless.py                 Headless: a context in which scripts and commands let time pass
session.py                  Session: the same with scenes and a picture, as scripts and tests drive it
editor/                     Context, and what changes it: scenes, actions, gestures; what the view says of it
documents/                  models in files, open documents, undo and stepping back, autosave, preferences
scripts/                    scripted sessions and lessons: written, recorded, played
methods/                    the guides through the force and the displacement method
sweeps/                     many variants of a model
mods/ included/             extensions by others, and ours that are written like theirs
api.py                      what mods and scripts may rely on, in one place
checks.py                   check_system: a test of any system, for mods
paths.py                    what particles.B.force and the like mean, wherever a person writes one
completion.py               registering what is written as mods are, before the first model
preparation.py              what a window has compiled, and which models wait for that
elsewhere.py                compiling in another process, and loading what it made in a thread
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # each is loaded where it is asked for
    from pinjoint.checks import SystemCheckError, check_system
    from pinjoint.editor.context import Context
    from pinjoint.session import Session
    from pinjoint.version import __version__

__all__ = ["Context", "Session", "SystemCheckError", "__version__", "check_system"]

_HOMES = {
    "Context": "pinjoint.editor.context",
    "Session": "pinjoint.session",
    "SystemCheckError": "pinjoint.checks",
    "__version__": "pinjoint.version",
    "check_system": "pinjoint.checks",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'pinjoint' has no attribute '{name}'")
    if name != "__version__":
        import_module("pinjoint.completion").complete()
    return getattr(import_module(_HOMES[name]), name)
