"""Actions that move between the modes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from components.field import Vector
from game.actions.registry import Action, action

if TYPE_CHECKING:
    from game.session import Session


@action("pause")
def _pause(session: Session, pixel: Vector) -> None:
    session.scenes.request("pause")


@action("back")
def _back(session: Session, pixel: Vector) -> None:
    session.scenes.request("pause")


@action("escape")
def _escape(session: Session, pixel: Vector) -> None:
    if session.selected:
        session.select()
    else:
        session.scenes.request("simulation")


@action("toggle run")
def _toggle_run(session: Session, pixel: Vector) -> None:
    session.scenes.request("pause" if session.scene == "simulation" else "simulation")


def _to(scene: str) -> Action:
    return lambda session, pixel: session.scenes.request(scene)


for _name in ("properties", "save", "load", "force method"):
    action(_name)(_to(_name))
