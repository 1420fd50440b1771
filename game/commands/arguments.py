"""Arguments: the values of words on a command line, or one sentence that refuses a word."""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Callable
from typing import Any, NoReturn

from components.mistake import Mistake
from game.streams import put

BAD_INPUT = 2


class UsageError(Mistake):
    """Bad usage or a bad model: one sentence for the person, and the exit status."""

    def __init__(self, sentence: str, status: int = BAD_INPUT) -> None:
        super().__init__(sentence)
        self.status = status


class Parser(argparse.ArgumentParser):
    """A parser that refuses in one sentence; values of options may begin with a minus: -1,2."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self._negative_number_matcher = re.compile(r"-\.?\d")

    def exit(self, status: int = 0, message: str | None = None) -> NoReturn:
        """End the program once what was printed is written. Raises OSError if it cannot be."""
        put("")
        super().exit(status, message)

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message[:1].upper()}{message[1:]}. See: {self.prog} --help")


def positive(text: str) -> float:
    """A finite number above 0."""
    return _number(text, float, lambda value: 0.0 < value < math.inf, "a number of seconds above 0")


def count(text: str, least: int = 2) -> int:
    """A whole number of at least `least`."""
    return int(_number(text, int, lambda value: value >= least, f"a whole number of at least {least}"))


def finite(text: str) -> float:
    """A finite number."""
    return _number(text, float, math.isfinite, "a finite number")


def _number(text: str, kind: type[float], fits: Callable[[float], bool], wanted: str) -> float:
    try:
        if fits(value := kind(text)):
            return value
    except ValueError:
        pass
    raise argparse.ArgumentTypeError(f"{text} is not {wanted}")


def numbers(option: str, text: str) -> tuple[float, ...]:
    """Finite numbers separated by commas. Raises UsageError."""
    try:
        found = tuple(float(part) for part in text.split(","))
    except ValueError:
        raise UsageError(f"{option} {text}: write numbers separated by commas, such as 0.1,0.5.") from None
    if not all(map(math.isfinite, found)):
        raise UsageError(f"{option} {text}: write finite numbers.")
    return found


def times(text: str) -> tuple[float, ...]:
    """Ascending times (s) of at least 0. Raises UsageError."""
    found = numbers("--at", text)
    if found[0] < 0.0 or list(found) != sorted(found):
        raise UsageError(f"--at {text}: times must be at least 0 s and ascending.")
    return found
