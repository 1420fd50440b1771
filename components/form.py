"""Form: a screen of boxes to type into and tiles to choose from, in a world of its own."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

from pinjoint.components.box import Box
from pinjoint.components.field import Field
from pinjoint.components.handle import Handle
from pinjoint.components.table import Table
from pinjoint.components.tags import Selected
from pinjoint.components.world import World


class Heading(Handle):
    """The heading and message of a form, and how far it is scrolled. There is exactly one."""

    __slots__ = ()
    table, noun, single = "heading", "heading", True

    text: Field[str] = Field(dtype=str, doc="Such as the element's name.")
    message: Field[str] = Field(dtype=str, doc="What is wrong or asked.")
    first: Field[int] = Field(dtype=int, minimum=0, doc="The first row shown; the others are scrolled away.")


class Tile(Handle):
    """A file, as a picture to choose."""

    __slots__ = ()
    table, noun = "tiles", "tile"

    section: Field[str] = Field(dtype=str, doc="The heading that it stands under.")
    title: Field[str] = Field(dtype=str, doc="Shown below the picture.")
    caption: Field[str] = Field(dtype=str, doc="Shown below the title.")
    file: Field[str] = Field(dtype=str, doc="The name that a person types.")
    explanation: Field[str] = Field(dtype=str, doc="Shown while chosen.")
    source: Field[Any] = Field(dtype=object, doc="What it opens: a path, a name or a document.")
    picture: Field[Any] = Field(dtype=object, doc="The model to draw; None: not read yet.")
    symbol: Field[str] = Field(dtype=str, doc="A sign in place of a picture.")
    hidden: Field[bool] = Field(doc="Filtered out.", dtype=bool)
    rest: Field[bool] = Field(doc="Stands for those of its section for which one row has no room.", dtype=bool)


class Reading(Handle):
    """A result, to be read beside what is set."""

    __slots__ = ()
    table, noun = "readings", "reading"

    section: Field[str] = Field(dtype=str, doc="The heading that it stands under.")
    title: Field[str] = Field(dtype=str, doc="What it is.")
    text: Field[str] = Field(dtype=str, doc="Its value with its unit.")
    explanation: Field[str] = Field(dtype=str, doc="Shown while the pointer is over it.")


class Form(World):
    """The boxes, readings and tiles of one screen.

    They are entities of a world of their own, apart from the undo log and the run of the model.
    check: why a box's text is refused, or "". accept: the title of the button that does what Return does; "": none.
    """

    def __init__(self, text: str, check: Callable[[Box], str] = lambda box: "", accept: str = "") -> None:
        super().__init__((Heading, Box, Tile, Reading))
        self.check, self.accept = check, accept
        self.heading.text = text

    @property
    def heading(self) -> Heading:
        return cast(Heading, self.tables["heading"][0])

    @property
    def boxes(self) -> Table[Box]:
        return self.tables["boxes"]

    @property
    def readings(self) -> Table[Reading]:
        return self.tables["readings"]

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
