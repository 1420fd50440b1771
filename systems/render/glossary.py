"""Glossary: the terms of the program beside those of courses, each explained in plain sentences (assets/glossary.json)."""

from __future__ import annotations

import json
import unicodedata
from functools import cache
from importlib.resources import files
from typing import NamedTuple

from pinjoint.components.language import tr


class Term(NamedTuple):
    """A term, what it means, and perhaps what it is also called."""

    term: str
    meaning: str
    also: str = ""


@cache
def terms() -> list[Term]:
    """All terms, as the file has them."""
    held = json.loads((files("pinjoint.assets") / "glossary.json").read_text(encoding="utf-8"))
    return [Term(**entry) for entry in held]


def glossary() -> list[Term]:
    """All terms in the present language, in its alphabetical order."""
    said = [Term(*map(tr, entry)) for entry in terms()]
    return sorted(said, key=lambda entry: unicodedata.normalize("NFKD", entry.term.casefold()))
