"""Wording: names and values as sentences quote them, cut, and without characters that do not print."""

from __future__ import annotations

import json
import re
import reprlib
from keyword import iskeyword
from typing import Any
from unicodedata import normalize

from pinjoint.components.language import tr

LONGEST = 60  # characters of a name or value in a sentence

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
