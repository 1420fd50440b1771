"""A person at a session: what they press, and what they see."""

from collections.abc import Iterable
from typing import Any

from pinjoint import Session
from pinjoint.components.snapshot import Snapshot
from pinjoint.components.view import Preview
from pinjoint.documents import models
from pinjoint.documents.document import document

EMPTY = {"format": "pinjoint model", "version": 1}
FRAME = 1.0 / 60.0


def opened(**settings: Any) -> Session:
    content = document(models.load("isostatic"))
    session = Session.open(content | {"settings": content["settings"] | {"displacement_scale": 1.0} | settings})
    session.view.camera.scale = 100.0
    return session


def press_at(session: Session, key: str, x: float, y: float) -> None:
    session.point(x, y)
    session.press(key)


def run_frames(session: Session, frames: int = 30) -> None:
    """Let time pass in the window's way; the first frame may only announce that it compiles."""
    for _ in range(frames):
        session.frame(FRAME)


def names(handles: Iterable[Any]) -> list[str]:
    """What elements are called."""
    return [handle.name for handle in handles]


def preview(session: Session) -> Preview:
    session.frame(0.0)
    assert session.view.preview is not None
    return session.view.preview


def assert_same_state(session: Session, expected: Snapshot) -> None:
    for name, column in Snapshot.take(session.model).columns.items():
        assert column.tobytes() == expected.columns[name].tobytes(), name
