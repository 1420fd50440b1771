"""Wording: names and values as sentences quote them, cut, and without characters that do not print.

And what sentences say about a name that does not exist, with the nearest one that does.
"""

from __future__ import annotations

import difflib
import json
import re
import reprlib
from collections.abc import Collection, Mapping
from dataclasses import fields, is_dataclass
from keyword import iskeyword
from typing import Any
from unicodedata import normalize

from pinjoint.components.language import joined, tr

LONGEST = 60  # characters of a name or value in a sentence
_FEW = 50  # names; so few are listed: all keys of a rod are

_HALVES = "\ud800-\udfff"  # of characters, alone
# Controls, line separators, marks that turn the direction of a line, and halves.
UNPRINTABLE = re.compile(f"[\x00-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069{_HALVES}]")
_BROKEN = re.compile(f"[{_HALVES}]")
_VALUES = reprlib.Repr()
_VALUES.maxlevel, _VALUES.maxstring, _VALUES.maxother = 3, LONGEST, LONGEST


def is_identifier(name: str) -> bool:
    """Whether a name means the same in Python source, which compatible characters are replaced in: µ and μ, ﬁ and fi."""
    return name.isidentifier() and not iskeyword(name) and normalize("NFKC", name) == name


def is_broken(text: str) -> bool:
    """True if a text holds half of a character, a surrogate, which no file and no clipboard can hold."""
    return _BROKEN.search(text) is not None


def printable(text: str) -> str:
    """A text whose characters that do not print are written as Python writes them: \\x1b."""
    return UNPRINTABLE.sub(lambda found: ascii(found[0])[1:-1], text)


def cut(text: str) -> str:
    """A name, or another text that a person gave, as a part of a sentence."""
    return printable(text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…")


def quoted(value: Any) -> str:
    """A value of any type as a part of a sentence, as Python writes it."""
    try:
        return printable(_VALUES.repr(value))
    except (ValueError, RecursionError):  # numbers of thousands of digits; what contains itself
        return tr("a value of type {name}", name=type(value).__name__)


def as_json(value: Any) -> str:
    """A value that a JSON file holds as a part of a sentence, as the file writes it."""
    try:
        return cut(json.dumps(value, ensure_ascii=False))
    except RecursionError:
        return tr("a value nested too deeply")


def nearest(name: str, names: Collection[str], cutoff: float = 0.6) -> str | None:
    """The one of some names that comes nearest, whatever its capitals and the order of its words; None if none does."""
    words, folded = set(name.casefold().split("_")), {known.casefold(): known for known in names}
    found = [known for known in folded if set(known.split("_")) == words]
    found += difflib.get_close_matches(name[:LONGEST].casefold(), folded, n=1, cutoff=cutoff)
    return folded[found[0]] if found else None


def remedy(name: str, names: Collection[str]) -> str:
    """The end of a sentence about a name that is not among some: the nearest name, or all of them."""
    few = len(names) <= _FEW
    if near := nearest(name, names, cutoff=0.6 if few else 0.4):
        return tr("did you mean '{name}'?", name=cut(near))
    if not few:
        return tr("there are {count} to choose from.", count=len(names))
    return tr("choose one of {names}.", names=", ".join(map(cut, names))) if names else tr("there are none.")


def missing(group: str, name: str, names: Collection[str]) -> str:
    """The sentence that says that a name is not in a group, and which one comes nearest."""
    return tr(
        "There is no '{name}' among the {group}; {remedy}",
        name=cut(name),
        group=tr(group),
        remedy=remedy(name, names),
    )


def as_said(noun: str, name: str) -> str:
    """A name as it is read: one that nobody gave, such as "rod 7", in the present language."""
    its, _, number = name.rpartition(" ")
    return joined([tr(noun), number]) if its == noun and number.isdecimal() else name


def brief(result: Any) -> str:
    """The repr of a result that a script looks at: its fields in a line, and of arrays and the like only what they are."""

    def said(value: Any) -> str:
        if getattr(value, "shape", ()):
            return f"array {value.shape}"
        if isinstance(value, Mapping):
            return f"{{{', '.join(f'{key!r}: {said(of)}' for key, of in value.items())}}}"
        if isinstance(value, tuple):
            return f"({', '.join(map(said, value[:2]))}{', …' * (len(value) > 2)})"
        return brief(value) if is_dataclass(value) else repr(value)

    told = [f"{field.name}={said(getattr(result, field.name))}" for field in fields(result) if field.repr]
    return f"{type(result).__name__}({', '.join(told)})"
