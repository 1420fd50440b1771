"""The register of named actions: the only way in, for keys, mouse, scripts and mods."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from components.field import Vector

if TYPE_CHECKING:
    from game.session import Session

Action = Callable[["Session", Vector], None]

ACTIONS: dict[str, Action] = {}


def action(name: str) -> Callable[[Action], Action]:
    """Register a function(session, pixel) as a named action; `pixel` is where the pointer is."""

    def register(function: Action) -> Action:
        if name in ACTIONS:
            raise ValueError(f"There is an action '{name}' already.")
        ACTIONS[name] = function
        return function

    return register
