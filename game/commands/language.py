"""The language of the program: as --language says, PINJOINT_LANGUAGE, the person's choice, or else that of the system."""

from __future__ import annotations

import locale
import os
from collections.abc import Iterable, Sequence

from pinjoint.commands.arguments import Parser, UsageError
from pinjoint.components.field import FieldError
from pinjoint.components.language import ENGLISH, LANGUAGES, several, speak
from pinjoint.components.mistake import wrong_variable
from pinjoint.components.units import show_in
from pinjoint.documents.preferences import preferred

VARIABLE, UNITS = "PINJOINT_LANGUAGE", "PINJOINT_UNITS"


def speak_as_asked(words: Sequence[str]) -> list[str]:
    """Speak the language of the option --language CODE, which every command has, or else that of the person.

    Likewise numbers are shown in the units of --units. Returns the other words. Raises UsageError for what there is not.
    """
    speak(asked_language() or preferred("language") or language_of_system())
    if os.environ.get(VARIABLE) and not asked_language():
        raise wrong_variable(VARIABLE, several(LANGUAGES))
    parser = Parser(add_help=False, allow_abbrev=False)
    parser.add_argument("--language", metavar="CODE")
    parser.add_argument("--units")
    options, others = parser.parse_known_args(list(words))
    if units := options.units or asked_units():
        try:
            show_in(units)
        except FieldError as error:
            option = "--units" if options.units else UNITS
            raise UsageError(
                "{option} {units}: {reason}", option=option, units=units, reason=str(error)
            ) from None
        os.environ[UNITS] = units
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


def asked_units() -> str:
    """The units on screen that a person asked for this time, "" if none."""
    return os.environ.get(UNITS, "")


def asked_language() -> str:
    """The language that a person asked for this time, "" if none."""
    return _known([os.environ.get(VARIABLE, "")])


def language_of_system() -> str:
    """The first language of the system that there is a catalogue for; English if there is none."""
    in_order = "LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG"  # as for gettext
    said = next(filter(None, map(os.environ.get, in_order)), None) or locale.getlocale()[0] or ""
    return _known(said.split(":")) or ENGLISH


def _known(codes: Iterable[str]) -> str:
    """The first language of ours among codes such as "pt_BR.UTF-8" or, on Windows, "Portuguese_Brazil"; else ""."""
    names = {"english": ENGLISH, "portuguese": "pt", "c": ENGLISH, "posix": ENGLISH}
    for code in codes:
        name = code.replace("-", "_").replace(".", "_").partition("_")[0].lower()
        if (name := names.get(name, name)) in LANGUAGES:
            return name
    return ""
