"""The register of named actions: the only way in, for keys, mouse, scripts and mods."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from components.field import Vector

if TYPE_CHECKING:
    from game.session import Session

Action = Callable[["Session", Vector], None]

ACTIONS: dict[str, Action] = {}
WHILE_DRAWING: set[str] = set()  # names of actions that what is being drawn or dragged survives


def action(name: str, *, while_drawing: bool = False) -> Callable[[Action], Action]:
    """Register a function(session, pixel) as a named action; `pixel` is where the pointer is.

    while_drawing: it goes on with what is being drawn or dragged, or only looks; all others end that first.
    """

    def register(function: Action) -> Action:
        if name in ACTIONS:
            raise ValueError(f"There is an action '{name}' already.")
        ACTIONS[name] = function
        if while_drawing:
            WHILE_DRAWING.add(name)
        return function

    return register
