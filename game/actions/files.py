"""Actions on files: saving again, and a new model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from components.field import Vector
from game.actions.registry import action
from game.models import ModelError
from game.scenes.properties import Properties

if TYPE_CHECKING:
    from game.session import Session


def _to_pause_and(session: Session, scene: str) -> None:
    session.scenes.request(*(("pause", scene) if session.scene == "simulation" else (scene,)))


@action("save")
def _save(session: Session, pixel: Vector) -> None:
    _to_pause_and(session, "save")


@action("load")
def _load(session: Session, pixel: Vector) -> None:
    _to_pause_and(session, "load")


@action("save again")
def _save_again(session: Session, pixel: Vector) -> None:
    """Under the same name; a model without one is given it first."""
    if session.file.path is None:
        _to_pause_and(session, "save")
        return
    try:
        session.save_as(session.file.path)
    except ModelError as error:
        session.notice = str(error)


@action("new")
def _new(session: Session, pixel: Vector) -> None:
    session.open_here(None)


@action("properties")
def _properties(session: Session, pixel: Vector) -> None:
    """Of the selected elements, or the environment; leaving goes back to where it was opened."""
    properties = session.scenes["properties"]
    assert isinstance(properties, Properties)
    properties.opened_from(session.scene)
    _to_pause_and(session, "properties")
