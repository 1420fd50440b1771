"""Card: what a lesson says and asks beside the model, for drawing and clicking."""

from __future__ import annotations

from dataclasses import dataclass

from pinjoint.components.toolbar import Tool


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
