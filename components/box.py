"""Box: a titled text field of the properties, save and load screens."""

from __future__ import annotations

import re
import unicodedata
from typing import Any

from pinjoint.components.field import Field
from pinjoint.components.handle import Handle
from pinjoint.components.language import decimals, tr, tr_in

NUMBER, WORD, TEXT, FILE_NAME = "number", "word", "text", "file name"
NAME = "name"  # one of some words, or a text of a form that is known
_WITH_UNIT = re.compile(r"(.*[\d.]) ?([^\d\s.eE].*)")


def fits_file_names(character: str) -> bool:
    """True for letters, digits, marks that combine with them (accents, vowels of Indian scripts), and a few more."""
    return character.isalnum() or character in " -._" or unicodedata.category(character).startswith("M")


def number_and_unit(text: str) -> tuple[str, str]:
    """What was typed into a box for a length, such as "1.5 m", as its number and its unit, which may be ""."""
    found = _WITH_UNIT.fullmatch(text)
    return (found[1], found[2].rstrip()) if found else (text, "")


def said_title(title: str, target: str) -> str:
    """The title of a box in the present language; target: of which part, such as "particles.force.x"."""
    part = target.split(".")[2:]
    if not part or not title.endswith(f" {part[0]}"):
        return tr(title)
    return tr("{quantity} {part}", quantity=tr(title.removesuffix(f" {part[0]}")), part=tr(part[0]))


class Box(Handle):
    """A titled field that a person types into."""

    __slots__ = ()
    table, noun = "boxes", "box"

    section: Field[str] = Field(dtype=str, doc="The heading that it stands under.")
    title: Field[str] = Field(dtype=str, doc="Shown above it.")
    unit: Field[str] = Field(dtype=str, doc="Of the number in it.")
    explanation: Field[str] = Field(dtype=str, doc="Shown while it is selected.")
    target: Field[str] = Field(
        dtype=str, doc='What its text is for: "rods.stiffness", "particles.force.x" or "name".'
    )
    elements: Field[Any] = Field(dtype=object, doc="A tuple of the elements that it is for.")
    accepts: Field[str] = Field(
        doc="What may be typed.", default=TEXT, dtype=str, choices=(NUMBER, WORD, TEXT, FILE_NAME, NAME)
    )
    words: Field[Any] = Field(
        dtype=object, doc="A tuple of words that it takes; besides numbers, or the only ones."
    )
    text: Field[str] = Field(dtype=str, doc="What it contains.")
    opened: Field[str] = Field(dtype=str, doc="What it contained at first.")
    held: Field[str] = Field(dtype=str, doc="What it contained when selected.")
    note: Field[str] = Field(dtype=str, doc='Shown in it while unchanged: "mixed", "automatic".')
    problem: Field[str] = Field(dtype=str, doc="Why its text is refused.")
    caret: Field[int] = Field(doc="Characters before the caret.", dtype=int)
    marked: Field[bool] = Field(doc="All of it is marked: typing replaces it.", dtype=bool)

    @property
    def said_title(self) -> str:
        """Its title in the present language."""
        return said_title(self.title, self.target)

    @property
    def said_text(self) -> str:
        """What it contains in the present language: one of its words, or a number with the decimal sign of that."""
        if self.text in (self.words or ()):
            return self.said_word(self.text)
        return decimals(self.text) if self.accepts == NUMBER else self.text

    def said_word(self, word: str) -> str:
        """One of its words in the present language; "none" agrees with what there is none of."""
        return tr_in("section", "none") if (self.target, word) == ("rods.section", "none") else tr(word)

    @property
    def changed(self) -> bool:
        """True if it says something else than at first; an empty box says nothing."""
        return self.text not in ("", self.opened)
