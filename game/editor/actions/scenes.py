"""Actions that move between the modes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from components.field import Vector
from game.editor.actions.drawing import put_away
from game.editor.actions.registry import action
from systems.edit.refusal import Refusal

if TYPE_CHECKING:
    from game.session import Session


@action("pause")
def _pause(session: Session, pixel: Vector) -> None:
    session.scenes.request("pause")


@action("back")
def _back(session: Session, pixel: Vector) -> None:
    session.scenes.request("pause")


@action("escape", while_drawing=True)
def _escape(session: Session, pixel: Vector) -> None:
    """Leave a drawing, else the tool, else the run or the selection; with nothing to leave, run."""
    if put_away(session):
        return
    if session.scene == "simulation":
        session.scenes.request("pause")
    elif session.selected:
        session.select()
    else:
        session.scenes.request("simulation")


@action("toggle run")
def _toggle_run(session: Session, pixel: Vector) -> None:
    session.scenes.request("pause" if session.scene == "simulation" else "simulation")


@action("force method")
def _force_method(session: Session, pixel: Vector) -> None:
    if session.model.particles.count == 0:
        raise Refusal("There is nothing to solve yet; draw a structure with P and L, or open one with D.")
    session.scenes.request("force method")
