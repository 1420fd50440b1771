"""COMPOSITION: the program. `Session` drives it from scripts, without a window."""

from game.checks import SystemCheckError, check_system
from game.session import Session

__all__ = ["Session", "SystemCheckError", "__version__", "check_system"]

__version__ = "0.1.0"
