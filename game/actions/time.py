"""Actions on time: stepping, restarting, pace, undo and redo."""

from __future__ import annotations

from typing import TYPE_CHECKING

from components.field import Vector
from game.actions.registry import action

if TYPE_CHECKING:
    from game.session import Session


PACE_STEP = 2.0


@action("step")
def _step(session: Session, pixel: Vector) -> None:
    session.run(steps=1)


@action("restart")
def _restart(session: Session, pixel: Vector) -> None:
    session.restart()


@action("faster")
def _faster(session: Session, pixel: Vector) -> None:
    session.clock.faster(PACE_STEP)


@action("slower")
def _slower(session: Session, pixel: Vector) -> None:
    session.clock.faster(1.0 / PACE_STEP)


@action("natural pace")
def _natural_pace(session: Session, pixel: Vector) -> None:
    session.clock.factor = 1.0


@action("undo")
def _undo(session: Session, pixel: Vector) -> None:
    session.undo()


@action("redo")
def _redo(session: Session, pixel: Vector) -> None:
    session.redo()
