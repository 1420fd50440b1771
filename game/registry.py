"""What mods add to the program, by kind; empty without mods. `game.mods.App` fills it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from components.view import Readout
    from game.editor.scenes.base import Scene
    from game.session import Session
    from systems.base import System

SYSTEMS: list[Callable[[], System]] = []  # frame systems, laws and commits; made anew for every session
SCENES: list[Callable[[], Scene]] = []  # made anew for every session
PANELS: list[Callable[[Session], Sequence[Readout]]] = []  # what stands beside the model now
COMMANDS: dict[str, Callable[[list[str]], int]] = {}  # of the command line, Pinjoint's own (game/commands) too
ABOUT: dict[str, str] = {}  # what a command does, for --help
