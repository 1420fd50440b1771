"""Form: a screen of boxes to type into, results to read and tiles to choose from, as plain data."""

from __future__ import annotations

import unicodedata
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from pinjoint.components.handle import Handle
from pinjoint.components.language import decimals, tr, tr_in

NUMBER, WORD, TEXT, FILE_NAME = "number", "word", "text", "file name"
NAME = "name"  # one of some words, or a text of a form that is known


def fits_file_names(character: str) -> bool:
    """True for letters, digits, marks that combine with them (accents, vowels of Indian scripts), and a few more."""
    return character.isalnum() or character in " -._" or unicodedata.category(character).startswith("M")


@dataclass(eq=False)
class Box:
    """A titled field that a person types into.

    target: what its text is for: "rods.stiffness", "particles.force.x" or "name". section: the heading that it stands
    under. unit: of the number in it. explanation: shown while it is selected. elements: that it is for. accepts: what may
    be typed. words: that it takes; besides numbers, or the only ones. opened: what it contained at first. held: when
    selected. note: shown in it while unchanged: "mixed", "automatic". problem: why its text is refused. caret: characters
    before it. marked: typing replaces all of its text. across: how many boxes share its row; 0: as their titles have room.
    """

    title: str
    target: str
    text: str = ""
    opened: str = ""
    section: str = ""
    unit: str = ""
    explanation: str = ""
    elements: tuple[Handle, ...] = ()
    accepts: str = TEXT
    words: tuple[str, ...] = ()
    held: str = ""
    note: str = ""
    problem: str = ""
    caret: int = 0
    marked: bool = False
    across: int = 0

    @property
    def said_title(self) -> str:
        """Its title in the present language, with the part that it is for, if it is for one, such as "force x"."""
        part = self.target.split(".")[2:]
        if not part or not self.title.endswith(f" {part[0]}"):
            return tr(self.title)
        quantity = self.title.removesuffix(f" {part[0]}")
        return tr("{quantity} {part}", quantity=tr(quantity), part=tr(part[0]))

    @property
    def vector(self) -> str:
        """The vector that it is a part of, whose boxes share a row, such as "particles.force", or ""."""
        vector = self.target.rpartition(".")[0]
        return vector if "." in vector else ""

    @property
    def said_text(self) -> str:
        """What it contains in the present language: one of its words, or a number with the decimal sign of that."""
        if self.text in self.words:
            return self.said_word(self.text)
        return decimals(self.text) if self.accepts == NUMBER else self.text

    def said_word(self, word: str) -> str:
        """One of its words in the present language; "none" agrees with what there is none of."""
        return tr_in("section", "none") if (self.target, word) == ("rods.section", "none") else tr(word)

    @property
    def changed(self) -> bool:
        """True if it says something else than at first; an empty box says nothing."""
        return self.text not in ("", self.opened)


@dataclass(eq=False)
class Tile:
    """A file, as a picture to choose.

    section: the heading that it stands under. title, caption: below the picture. file: the name that a person types.
    source: what it opens: a path, a name or a document. explanation: shown while it is chosen. symbol: a sign in place of
    a picture. rest: it stands for those of its section for which one row has no room. picture: the model to draw; None: not
    read yet. hidden: filtered out.
    """

    section: str
    title: str
    caption: str
    file: str
    source: Any
    explanation: str = ""
    symbol: str = ""
    rest: bool = False
    picture: Any = None
    hidden: bool = False


@dataclass(frozen=True)
class Reading:
    """A result, to be read beside what is set: its section, what it is, its value with its unit, and what is said of it."""

    section: str
    title: str
    text: str
    explanation: str


@dataclass(eq=False)
class Form:
    """The boxes, readings and tiles of one screen, apart from the undo log and the run of the model.

    check: why a box's text is refused, or "". accept: the title of the button that does what Return does; "": none.
    message: what is wrong or asked. first: the first row in sight. selected: the box that is typed into. chosen: the tile
    that Return opens.
    """

    heading: str
    check: Callable[[Box], str] = lambda box: ""
    accept: str = ""
    message: str = ""
    first: int = 0
    boxes: list[Box] = field(default_factory=list)
    readings: list[Reading] = field(default_factory=list)
    tiles: list[Tile] = field(default_factory=list)
    selected: Box | None = None
    chosen: Tile | None = None

    @property
    def looks(self) -> tuple[object, ...]:
        """All that is shown, to be compared with what was."""
        items = (tuple(vars(item).values()) for item in (*self.boxes, *self.readings, *self.tiles))
        return self.heading, self.message, self.first, self.selected, self.chosen, *items
