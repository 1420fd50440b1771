"""The language of the program: as --language says, PINJOINT_LANGUAGE, the person's choice, or else that of the system."""

from __future__ import annotations

import locale
import os
from collections.abc import Iterable, Sequence

from pinjoint.commands.arguments import Parser, UsageError
from pinjoint.components.language import ENGLISH, LANGUAGES, speak
from pinjoint.documents.preferences import preferred

VARIABLE = "PINJOINT_LANGUAGE"
_OF_SYSTEM = ("LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG")  # the first that is set counts, as for gettext


def speak_as_asked(words: Sequence[str]) -> list[str]:
    """Speak the language of the option --language CODE, which every command has, or else that of the person.

    Returns the other words. Raises UsageError for a language that there is not.
    """
    speak(asked_language() or preferred("language") or language_of_system())
    parser = Parser(add_help=False, allow_abbrev=False)
    parser.add_argument("--language", metavar="CODE")
    options, others = parser.parse_known_args(list(words))
    if options.language is not None:
        if not (code := _known([options.language])):
            raise UsageError(
                "--language {code}: there is no such language; write one of {languages}.",
                code=options.language,
                languages=", ".join(LANGUAGES),
            )
        os.environ[VARIABLE] = code  # for this process and those that it starts
        speak(code)
    return others


def asked_language() -> str:
    """The language that a person asked for this time, "" if none."""
    return _known([os.environ.get(VARIABLE, "")])


def language_of_system() -> str:
    """The first language of the system that there is a catalogue for; English if there is none."""
    said = next(filter(None, map(os.environ.get, _OF_SYSTEM)), None) or locale.getlocale()[0] or ""
    return _known(said.split(":")) or ENGLISH


def _known(codes: Iterable[str]) -> str:
    """The first language of ours among codes such as "pt_BR.UTF-8" or, on Windows, "Portuguese_Brazil"; else ""."""
    names = {"english": ENGLISH, "portuguese": "pt", "c": ENGLISH, "posix": ENGLISH}
    for code in codes:
        name = code.replace("-", "_").replace(".", "_").partition("_")[0].lower()
        if (name := names.get(name, name)) in LANGUAGES:
            return name
    return ""
