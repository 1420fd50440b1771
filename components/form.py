"""Form: a screen of boxes to type into and tiles to choose from, in a world of its own."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

from components.box import Box
from components.field import Field
from components.handle import Handle
from components.table import Table
from components.tags import Selected
from components.world import World


class Heading(Handle):
    """What a form says besides its boxes and tiles. There is exactly one."""

    __slots__ = ()
    table, noun, single = "heading", "heading", True

    text: Field[str] = Field(title="text", doc="Such as the element's name.", default="", dtype=str)
    message: Field[str] = Field(title="message", doc="What is wrong or asked.", default="", dtype=str)
    first: Field[int] = Field(
        dtype=int, default=0, minimum=0, title="first", doc="The first row shown; the others are scrolled away."
    )


class Tile(Handle):
    """A file, as a picture to choose."""

    __slots__ = ()
    table, noun = "tiles", "tile"

    section: Field[str] = Field(title="section", doc="The heading that it stands under.", default="", dtype=str)
    title: Field[str] = Field(title="title", doc="Shown below the picture.", default="", dtype=str)
    caption: Field[str] = Field(title="caption", doc="Shown below the title.", default="", dtype=str)
    file: Field[str] = Field(title="file", doc="The name that a person types.", default="", dtype=str)
    explanation: Field[str] = Field(title="explanation", doc="Shown while chosen.", default="", dtype=str)
    source: Field[Any] = Field(
        title="source", doc="What it opens: a path, a name or a document.", default=None, dtype=object
    )
    picture: Field[Any] = Field(
        title="picture", doc="The model to draw; None: not read yet.", default=None, dtype=object
    )
    symbol: Field[str] = Field(title="symbol", doc="A sign in place of a picture.", default="", dtype=str)
    hidden: Field[bool] = Field(title="hidden", doc="Filtered out.", default=False, dtype=bool)


class Form(World):
    """The boxes and tiles of one screen.

    They are entities of a world of their own, apart from the undo log and the run of the model.
    check: why a box's text is refused, or "".
    """

    def __init__(self, text: str, check: Callable[[Box], str] = lambda box: "") -> None:
        super().__init__((Heading, Box, Tile))
        self.check = check
        self.heading.text = text

    @property
    def heading(self) -> Heading:
        return cast(Heading, self.tables["heading"][0])

    @property
    def boxes(self) -> Table[Box]:
        return self.tables["boxes"]

    @property
    def tiles(self) -> Table[Tile]:
        return self.tables["tiles"]

    @property
    def selected(self) -> Box | None:
        """The box that is typed into."""
        return next((handle for handle in self.tagged(Selected) if isinstance(handle, Box)), None)

    @property
    def chosen(self) -> Tile | None:
        """The tile that Return opens."""
        return next((handle for handle in self.tagged(Selected) if isinstance(handle, Tile)), None)

    def choose(self, tile: Tile | None) -> None:
        """Make this tile the chosen one."""
        for handle in self.tagged(Selected):
            if isinstance(handle, Tile) and handle is not tile:
                self.untag(handle, Selected)
        if tile is not None:
            self.tag(tile, Selected)
