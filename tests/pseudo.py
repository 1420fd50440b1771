"""A language for tests, with accents and a third longer: what is not translated or has no room is seen."""

import gettext
import re
from collections.abc import Iterator
from contextlib import contextmanager
from unittest.mock import patch

from pinjoint.components import language
from pinjoint.components.language import spoken

CODE = "pseudo"  # of its own: what is kept by language must not be taken for that of another
_LETTERS = str.maketrans(
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ",
    "áƀćđéƒğĥíĵķĺḿńóṕʠŕšťúṽŵẋýžÁƁĆĐÉƑĞĤÍĴĶĹḾŃÓṔɊŔŠŤÚṼŴẊÝŽ",
)
_KEPT = re.compile(r"(\{[^}]*\}|%\([a-z_]+\)[sr]|%[sr])")  # what is filled in
_VOWELS = re.compile("([áéíóú])")


class Pseudo(gettext.NullTranslations):
    """The catalogue of that language; it holds all messages there are."""

    def gettext(self, message: str) -> str:
        return accented(message)

    def pgettext(self, context: str, message: str) -> str:
        return accented(message)

    def ngettext(self, one: str, many: str, number: int) -> str:
        return accented(one if number == 1 else many)


def accented(message: str) -> str:
    """A message as it is in that language: vowels are doubled, and what is filled in stays."""
    parts = _KEPT.split(message)
    return "".join(
        part if number % 2 else _VOWELS.sub(r"\1\1", part.translate(_LETTERS))
        for number, part in enumerate(parts)
    )


@contextmanager
def pseudo() -> Iterator[None]:
    """Say everything in that language for a while; numbers as in Portuguese."""
    with spoken("pt"), patch.object(language, "_COMMA", (*language._COMMA, CODE)):
        language._SPOKEN.code, language._SPOKEN.catalogue = CODE, Pseudo()
        yield
