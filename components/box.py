"""Box: a titled text field of the properties, save and load screens."""

from __future__ import annotations

from typing import Any

from components.field import Field
from components.handle import Handle

NUMBER, WORD, TEXT, FILE_NAME = "number", "word", "text", "file name"


def text_field(title: str, doc: str) -> Field[str]:
    """A text of a form, empty at first."""
    return Field(title=title, doc=doc, default="", dtype=str)


def object_field(title: str, doc: str) -> Field[Any]:
    """Any object, at first None."""
    return Field(title=title, doc=doc, default=None, dtype=object)


class Box(Handle):
    """A titled field that a person types into."""

    __slots__ = ()
    table, noun = "boxes", "box"

    section: Field[str] = text_field("section", "The heading that it stands under.")
    title: Field[str] = text_field("title", "Shown above it.")
    unit: Field[str] = text_field("unit", "Of the number in it.")
    explanation: Field[str] = text_field("explanation", "Shown while it is selected.")
    target: Field[str] = text_field(
        "target", 'What its text is for: "rods.stiffness", "particles.force.x" or "name".'
    )
    elements: Field[Any] = object_field("elements", "A tuple of the elements that it is for.")
    accepts: Field[str] = Field(
        title="accepts",
        doc="What may be typed.",
        default=TEXT,
        dtype=str,
        choices=(NUMBER, WORD, TEXT, FILE_NAME),
    )
    words: Field[Any] = object_field(
        "words", "A tuple of words that it takes; besides numbers, or the only ones."
    )
    text: Field[str] = text_field("text", "What it contains.")
    opened: Field[str] = text_field("opened", "What it contained at first.")
    held: Field[str] = text_field("held", "What it contained when selected.")
    note: Field[str] = text_field("note", 'Shown in it while unchanged: "mixed", "automatic".')
    problem: Field[str] = text_field("problem", "Why its text is refused.")
    caret: Field[int] = Field(title="caret", doc="Characters before the caret.", default=0, dtype=int)
    marked: Field[bool] = Field(
        title="marked", doc="All of it is marked: typing replaces it.", default=False, dtype=bool
    )

    @property
    def changed(self) -> bool:
        """True if it says something else than at first; an empty box says nothing."""
        return self.text not in ("", self.opened)
