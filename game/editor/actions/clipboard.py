"""Actions that copy, cut, paste and duplicate elements."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from components.field import Vector
from components.handle import Handle
from game.editor.actions.registry import action
from game.editor.clipboard import Part, chosen, parsed, paste, taken, written
from systems.edit.placing import snapped
from systems.edit.rods import delete

if TYPE_CHECKING:
    from game.session import Session

BESIDE = 30.0  # points to the right and down, where a duplicate appears


@action("copy")
def _copy(session: Session, pixel: Vector) -> None:
    _take_along(session)
    session.notice = "Copied; Ctrl+V pastes it at the pointer."


@action("cut")
def _cut(session: Session, pixel: Vector) -> None:
    _take_along(session)
    delete(session.model, session.selected)
    session.notice = "Cut; Ctrl+V pastes it at the pointer."


@action("paste")
def _paste(session: Session, pixel: Vector) -> None:
    """With the middle at the pointer, from the toolbar in the middle; the first place snaps to the grid."""
    if session.view.strip.contains(pixel):
        pixel = session.view.canvas.middle
    source = _taken_along(session)
    position = source.position
    middle = 0.5 * (position.min(axis=0) + position.max(axis=0))
    x, y = (position[0] + session.view.camera.to_model(pixel) - middle).tolist()
    offset = np.subtract(snapped(session.model, session.view, (x, y)), position[0]).tolist()
    _show(session, paste(session.model, source, (offset[0], offset[1])), "Pasted")


@action("duplicate")
def _duplicate(session: Session, pixel: Vector) -> None:
    view = session.view
    beside = BESIDE * view.pixel_ratio / view.camera.scale
    source = taken(session.model, chosen(session.model))
    _show(session, paste(session.model, source, snapped(session.model, view, (beside, -beside))), "Duplicated")


def _take_along(session: Session) -> None:
    rows = chosen(session.model)
    session.clipboard = text = written(session.model, rows)
    session.copied = text, taken(session.model, rows)


def _taken_along(session: Session) -> Part:
    """What is on the clipboard; it is read only if it is not what was copied here last."""
    text, copied = session.clipboard, session.copied
    return copied[1] if copied is not None and copied[0] == text else parsed(text)


def _show(session: Session, made: list[Handle], done: str) -> None:
    session.select(*made)
    session.notice = f"{done}: {len(made)} elements; drag them where they belong."
