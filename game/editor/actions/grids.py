"""Actions on grids."""

from __future__ import annotations

from typing import TYPE_CHECKING

from components.field import Vector
from components.grid import Grid
from game.editor.actions.registry import action

if TYPE_CHECKING:
    from game.session import Session


@action("new grid")
def _new_grid(session: Session, pixel: Vector) -> None:
    with session.model.transaction("new grid"):
        for grid in session.model.grids:
            if grid.shown:
                grid.shown = False
        session.model.create(Grid)


@action("next grid")
def _next_grid(session: Session, pixel: Vector) -> None:
    """The one after the shown grid; after the last, none; after none, the first."""
    grids = list(session.model.grids)
    shown = [index for index, grid in enumerate(grids) if grid.shown]
    following = shown[-1] + 1 if shown else 0
    with session.model.transaction("next grid"):
        for index, grid in enumerate(grids):
            if grid.shown != (index == following):
                grid.shown = index == following
