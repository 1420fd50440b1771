"""COMPOSITION: the program. `Session` drives it from scripts, without a window."""

from game.interrupts import unheard

with unheard():
    from game import included as _included  # noqa: F401 (registers what is written as mods are)
    from game.checks import SystemCheckError, check_system
    from game.session import Session
    from game.version import __version__

__all__ = ["Session", "SystemCheckError", "__version__", "check_system"]
