"""Box: a titled text field of the properties, save and load screens."""

from __future__ import annotations

from components.field import Field
from components.world import Handle


class Box(Handle):
    """What a person types into; `target` names what its text is for."""

    __slots__ = ()
    table, noun = "boxes", "box"

    title: Field[str] = Field(title="title", doc="Shown above it.", default="", dtype=str)
    text: Field[str] = Field(title="text", doc="What it contains.", default="", dtype=str)
    target: Field[str] = Field(title="target", doc="The Field it edits, or 'name'.", default="", dtype=str)
