"""Selecting by dragging a box."""

from __future__ import annotations

from typing import TYPE_CHECKING

from components.field import Vector
from components.view import Preview
from game.editor.gestures.base import Gesture
from systems.edit.selecting import inside

if TYPE_CHECKING:
    from game.session import Session


class BoxSelect(Gesture):
    """Selects what lies inside a box; `adding`: besides what was selected before."""

    hint = "let go to select what is inside     Esc cancel"

    def __init__(self, session: Session, pixel: Vector, *, adding: bool) -> None:
        self._corner = session.view.camera.to_model(pixel)
        self._adding = adding

    def drop(self, session: Session, pixel: Vector) -> None:
        found = inside(session.model, self._corner, session.view.camera.to_model(pixel))
        session.select(*(session.selected if self._adding else ()), *found)

    def preview(self, session: Session, pixel: Vector) -> Preview | None:
        return Preview("box", self._corner, session.view.camera.to_model(pixel))
