"""Actions on files: saving again, and a new model."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from components.field import Vector
from game.documents.models import ModelError
from game.documents.open_documents import stamp_of
from game.editor.actions.registry import action
from game.editor.scenes.properties import Properties
from systems.edit.refusal import Refusal

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
    """Under the same name; a model without one is given it first. What somebody else wrote there is asked for."""
    file = session.file
    if file.path is None:
        _to_pause_and(session, "save")
        return
    there = stamp_of(file.path)
    if there not in ((), file.stamp):
        session.desk.file = replace(file, stamp=there)
        raise Refusal(
            f"Another window or program has changed '{file.name}' since. Ctrl+S again replaces that; S asks for another"
            " name."
        )
    try:
        session.save_as(file.path)
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
