"""Errors whose sentences are for the person: where the mistake is, what it is, and the remedy."""

from __future__ import annotations

import os
from typing import Any

from pinjoint.components.language import tr


class Explained(Exception):
    """An error that says a sentence, filled in with values, in the language that is present when it is shown.

    The sentence is one of the catalogues, which find it by the name of the class: see [tool.babel] in pyproject.toml.
    """

    def __init__(self, message: str, /, **values: Any) -> None:
        super().__init__(tr(message, **values))

    def __str__(self) -> str:
        return tr(self.args[0])


class Mistake(Explained):
    """What a person can put right.

    The command line says it as it is; anything else that is raised is a fault of the program.
    """


def wrong_variable(variable: str, remedy: str) -> Mistake:
    """What is wrong with a variable of the environment; remedy: to what it can be set."""
    return Mistake(
        "{variable} is '{value}'; set it to {remedy}, or leave it out.",
        variable=variable,
        value=os.environ[variable],
        remedy=remedy,
    )


def reason_of(error: Exception) -> str:
    """Why a file cannot be read or written, in the words of the system where it has some."""
    return getattr(error, "strerror", None) or str(error) or type(error).__name__


class WrongValue(Explained, ValueError):
    """A value that cannot be taken."""


class NotFound(Explained, LookupError):
    """Something that is asked for and is not there."""
