"""COMPOSITION: the program. `Session` drives it from scripts, without a window."""

from game.session import Session

__all__ = ["Session", "__version__"]

__version__ = "0.1.0"
