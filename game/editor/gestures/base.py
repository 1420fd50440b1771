"""What a gesture is: something that a person draws or drags with the pointer, from a start to an end."""

from __future__ import annotations

from typing import TYPE_CHECKING

from components.field import Vector
from components.view import Preview

if TYPE_CHECKING:
    from game.session import Session


class Gesture:
    """One drag, or one use of a tool. Pixels are where the pointer is.

    hint: the next possible step, for the status line.
    """

    hint = "let go to finish     Esc cancel"

    def move(self, session: Session, pixel: Vector) -> None:
        """The pointer was dragged to a pixel."""

    def drop(self, session: Session, pixel: Vector) -> None:
        """Finish at a pixel. Raises Refusal or FieldError if that cannot be; then nothing has changed."""

    def cancel(self, session: Session) -> None:
        """End it as if it had never begun."""

    def leave(self, session: Session) -> None:
        """Something else was begun before it was finished."""
        self.cancel(session)

    def preview(self, session: Session, pixel: Vector) -> Preview | None:
        """What is drawn while it goes on, with the pointer at a pixel."""
        return None
