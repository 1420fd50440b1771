"""Language: sentences in the language of the person, looked up in gettext catalogues.

Sentences are written in English where they are said, with names for what is filled in:

>>> tr("{rod} carries {force:.1f} kN.", rod="AB", force=-70.71)
'AB carries -70.7 kN.'

What is kept until it is shown, such as the titles of a table, is `marked` there and translated where it is shown. What
was said before, such as the title of an edit, `tr` says anew if the language has changed since.
Files, scripts and names of elements are the same in every language.
"""

from __future__ import annotations

import gettext
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from string import Formatter
from types import SimpleNamespace
from typing import Any

from pinjoint.components.extensions import EXTENSIONS

DOMAIN = "pinjoint"
LOCALE = Path(__file__).parents[1] / "assets" / "locale"
ENGLISH = "en"
LANGUAGES = {ENGLISH: "English", "pt": "Português"}  # by code, as they call themselves
_COMMA = ("pt",)  # languages that write 0,5


class Said(str):
    """A sentence in the present language, which can be said anew in another one.

    code: of that language. made: what says it again: a function, its arguments, and the values that are filled in.
    """

    __slots__ = ("code", "made")
    code: str
    made: tuple[Callable[..., str], tuple[Any, ...], dict[str, Any]]

    def __new__(cls, shown: str, say: Callable[..., str], /, *parts: Any, **values: Any) -> Said:
        said = super().__new__(cls, shown)
        said.code, said.made = _SPOKEN.code, (say, parts, values)
        return said

    def __str__(self) -> str:
        """The sentence itself: errors and text streams pass it on with what says it again."""
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        """Copies, also those of other processes, are only said again in English: the values may be of a model."""
        return Said, (str.__str__(self), marked, english(self))


_SPOKEN = SimpleNamespace(code=ENGLISH, catalogue=gettext.NullTranslations())  # the present language


def language() -> str:
    """The code of the present language: "en"."""
    found: str = _SPOKEN.code
    return found


def speak(code: str) -> None:
    """Say everything in a language from now on. Raises ValueError if there is no such language."""
    if code not in LANGUAGES:
        raise ValueError(
            tr(
                "There is no language '{code}'; use one of {languages}.",
                code=code,
                languages=", ".join(LANGUAGES),
            )
        )
    catalogue = gettext.NullTranslations()
    if code != ENGLISH:
        catalogue = gettext.translation(DOMAIN, LOCALE, languages=[code])
        for domain, folder in EXTENSIONS.catalogues.items():
            catalogue.add_fallback(gettext.translation(domain, folder, languages=[code], fallback=True))
    _SPOKEN.code, _SPOKEN.catalogue = code, catalogue


@contextmanager
def spoken(code: str) -> Iterator[None]:
    """Say everything in a language for a while; "": in the present one. Raises ValueError if there is no such language."""
    before = _SPOKEN.code, _SPOKEN.catalogue
    if code:
        speak(code)
    try:
        yield
    finally:
        _SPOKEN.code, _SPOKEN.catalogue = before


def marked(message: str) -> str:
    """A text as it is, for catalogues to hold: it is translated where it is shown."""
    return message


def tr(message: str, /, **values: Any) -> str:
    """A message in the present language, with values filled in as by `str.format`; without values, braces stay.

    A text that was said before is said anew.
    """
    if not message or isinstance(message, Said):  # of "" catalogues hold their own heading
        found: str = _anew(message)
        return found
    return Said(_filled(_SPOKEN.catalogue.gettext(message), values), tr, message, **values)


def tr_in(context: str, message: str, /, **values: Any) -> str:
    """As `tr`, for a word that has several meanings: the context, such as "support", tells them apart."""
    shown = _SPOKEN.catalogue.pgettext(context, message)
    return Said(_filled(shown, values), tr_in, context, message, **values)


def plural(one: str, many: str, count: int, /, **values: Any) -> str:
    """As `tr`, of two messages that which suits a number; {count} is filled in, too."""
    shown = _SPOKEN.catalogue.ngettext(one, many, count)
    return Said(_filled(shown, {"count": count, **values}), plural, one, many, count, **values)


def english(said: object) -> Any:
    """What was said, or an error says, in English, as scripts read it; other values as they are."""
    said = str(said) if isinstance(said, BaseException) else said
    if not isinstance(said, Said):
        return said
    with spoken(ENGLISH):
        return str.__str__(_anew(said))


def joined(parts: Iterable[str], separator: str = " ") -> str:
    """Sentences that are said one after the other, without those that are empty."""
    known = [part for part in parts if part]
    if len(known) < 2:
        return known[0] if known else ""
    return Said(separator.join(known), joined, known, separator)


def begun(text: str) -> str:
    """A text as a sentence begins with it: "Rod AB"."""
    return Said(text[:1].upper() + text[1:], begun, text)


def listed(names: Sequence[str]) -> str:
    """Names as a sentence lists them: "A, B and C"."""
    if len(names) < 2:
        return names[0] if names else ""
    return tr("{names} and {last}", names=joined(names[:-1], ", "), last=names[-1])


def decimals(text: str) -> str:
    """A number in English as it is written in the present language: with a comma for the point, or as it is."""
    if _SPOKEN.code not in _COMMA or "." not in text:
        return text
    return Said(text.replace(".", ","), decimals, text)


def several(numbers: Iterable[str]) -> str:
    """Numbers one after the other: "120, −160", or "120,5; −160" where commas are decimal signs."""
    parts = list(numbers)
    if _SPOKEN.code not in _COMMA:
        return ", ".join(parts)
    return Said("; ".join(parts), several, parts)


class _Filling(Formatter):
    """Fills in values; numbers are written as in the present language."""

    def format_field(self, value: Any, format_spec: str) -> str:
        text = format(value, format_spec)
        return decimals(text) if isinstance(value, float) else text


def _filled(shown: str, values: dict[str, Any]) -> str:
    if not values:
        return shown
    return shown.format(**values) if _SPOKEN.code == ENGLISH else _Filling().vformat(shown, (), values)


def _anew(value: Any) -> Any:
    """What was said in another language than the present one is said again in this; other values stay as they are."""
    if isinstance(value, list):
        return list(map(_anew, value))
    if not isinstance(value, Said) or value.code == _SPOKEN.code:
        return value
    say, parts, values = value.made
    return say(*map(_anew, parts), **{name: _anew(part) for name, part in values.items()})
