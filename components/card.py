"""Card: what a lesson says and asks beside the model, for drawing and clicking."""

from __future__ import annotations

from dataclasses import dataclass

from pinjoint.components.toolbar import Tool

WIDE, COLUMN, WIDEST, COLUMN_SHARE = (
    860.0,
    270.0,
    380.0,
    0.27,
)  # points: from which width on it is a column; its width
STRIP, HIGHEST, STRIP_SHARE = 132.0, 230.0, 0.38  # points, and share of the height: of a strip below the model


@dataclass(frozen=True)
class Card:
    """A task as it stands.

    title: of the lesson. progress: which task of how many, and done: those that were done. paragraphs: the task.
    choices: (text, chosen) of possible answers, with the action of each in `answers`. entry: what was typed, with its unit;
    None: nothing is to be typed. said: what is said of the last check, or a hint, and its `mood`: "right", "wrong", "hint".
    buttons: the first is the next thing to do. first: by how many lines it is scrolled on, or back if negative.
    """

    title: str
    progress: str = ""
    count: int = 0
    at: int = 0
    done: frozenset[int] = frozenset()
    paragraphs: tuple[str, ...] = ()
    choices: tuple[tuple[str, bool], ...] = ()
    entry: str | None = None
    said: tuple[str, ...] = ()
    mood: str = ""
    buttons: tuple[Tool, ...] = ()
    first: int = 0


def share_of(width: int, height: int, unit: float) -> tuple[int, int]:
    """The pixels that a card takes of a window: of its width, at the right, or of its height, at the bottom."""
    if width >= WIDE * unit:
        return round(min(max(COLUMN * unit, COLUMN_SHARE * width), WIDEST * unit)), 0
    return 0, round(min(max(STRIP * unit, STRIP_SHARE * height), HIGHEST * unit, 0.6 * height))
