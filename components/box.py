"""Box: a titled text field of the properties, save and load screens."""

from __future__ import annotations

from typing import Any

from components.field import Field
from components.handle import Handle

NUMBER, WORD, TEXT, FILE_NAME = "number", "word", "text", "file name"


class Box(Handle):
    """What a person types into."""

    __slots__ = ()
    table, noun = "boxes", "box"

    section: Field[str] = Field(title="section", doc="The heading that it stands under.", default="", dtype=str)
    title: Field[str] = Field(title="title", doc="Shown above it.", default="", dtype=str)
    unit: Field[str] = Field(title="unit", doc="Of the number in it.", default="", dtype=str)
    explanation: Field[str] = Field(
        title="explanation", doc="Shown while it is selected.", default="", dtype=str
    )
    target: Field[str] = Field(
        title="target",
        doc='What its text is for: "rods.stiffness", "particles.force.x" or "name".',
        default="",
        dtype=str,
    )
    elements: Field[Any] = Field(
        title="elements", doc="A tuple of the elements that it is for.", default=None, dtype=object
    )
    accepts: Field[str] = Field(
        title="accepts",
        doc="What may be typed.",
        default=TEXT,
        dtype=str,
        choices=(NUMBER, WORD, TEXT, FILE_NAME),
    )
    words: Field[Any] = Field(
        title="words",
        doc="A tuple of words that it takes; besides numbers, or the only ones.",
        default=None,
        dtype=object,
    )
    text: Field[str] = Field(title="text", doc="What it contains.", default="", dtype=str)
    opened: Field[str] = Field(title="opened", doc="What it contained at first.", default="", dtype=str)
    held: Field[str] = Field(title="held", doc="What it contained when selected.", default="", dtype=str)
    note: Field[str] = Field(
        title="note", doc='Shown in it while unchanged: "mixed", "automatic".', default="", dtype=str
    )
    problem: Field[str] = Field(title="problem", doc="Why its text is refused.", default="", dtype=str)
    caret: Field[int] = Field(title="caret", doc="Characters before the caret.", default=0, dtype=int)
    marked: Field[bool] = Field(
        title="marked", doc="All of it is marked: typing replaces it.", default=False, dtype=bool
    )

    @property
    def changed(self) -> bool:
        """True if it says something else than at first; an empty box says nothing."""
        return self.text not in ("", self.opened)
