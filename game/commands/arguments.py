"""Arguments: the values of words on a command line, or one sentence that refuses a word."""

from __future__ import annotations

import argparse
import itertools
import math
import os
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn

from pinjoint.components.language import marked, tr
from pinjoint.components.mistake import Mistake
from pinjoint.streams import put

BAD_INPUT = 2
_OUTPUTS = ("output", "events", "report", "record", "plot")  # options of all commands that name a file to write


class UsageError(Mistake):
    """Bad usage or a bad model: one sentence for the person, and the exit status."""

    def __init__(self, message: str, status: int = BAD_INPUT, /, **values: Any) -> None:
        super().__init__(message, **values)
        self.status = status


argparse._ = tr  # type: ignore[attr-defined]  # what it looks its own words up with; these are:
_OF_ARGPARSE = (
    marked("usage: "),
    marked("positional arguments"),
    marked("options"),
    marked("show this help message and exit"),
    marked("show program's version number and exit"),
    marked("the following arguments are required: %s"),
    marked("unrecognized arguments: %s"),
    marked("argument %(argument_name)s: %(message)s"),
    marked("expected one argument"),
    marked("expected at least one argument"),
    marked("invalid choice: %(value)r (choose from %(choices)s)"),
    marked("invalid %(type)s value: %(value)r"),
    marked("not allowed with argument %s"),
    marked("ambiguous option: %(option)s could match %(matches)s"),
    marked("ignored explicit argument %r"),
    marked("one of the arguments %s is required"),
    marked("expected at most one argument"),
    marked("invalid choice: %(value)r, maybe you meant %(closest)r? (choose from %(choices)s)"),
)


class Parser(argparse.ArgumentParser):
    """The parser of a command, which refuses in one sentence; values of options may begin with a minus: -1,2."""

    def __init__(self, command: str = "", about: str = "", /, **options: Any) -> None:
        super().__init__(**{"prog": f"pinjoint {command}".rstrip(), "description": tr(about)} | options)
        self._negative_number_matcher = re.compile(r"-\.?\d")

    def parse_args(self, *args: Any, **options: Any) -> Any:
        """The options. Raises UsageError, also for one without effect, and if what is written would replace what is read."""
        found = super().parse_args(*args, **options)
        given = {name: one for one in self._actions if _is_given(one, found) for name in one.option_strings}
        for name, one in given.items():
            beside, apart = getattr(one, "beside", ""), getattr(one, "apart", ())
            if beside and beside not in given:
                raise UsageError(
                    "{option} works only together with {other}; add it.", option=name, other=beside
                )
            for other in filter(given.__contains__, apart):
                raise UsageError(
                    "{option} and {other} exclude each other; leave out one of the two.",
                    option=name,
                    other=other,
                )
        self.keep(vars(found))
        return found

    def keep(self, options: Mapping[str, Any]) -> None:
        """Raise UsageError if a file that options write is one that they, or others of these names, read."""
        files = [
            (name, Path(one))
            for name, value in options.items()
            for one in (value if isinstance(value, list) else [value])
            if isinstance(one, str | Path)
        ]
        for (name, path), (other, same) in itertools.permutations(files, 2):
            if name in _OUTPUTS and (other not in _OUTPUTS or name < other) and _is_one_file(path, same):
                self.error(
                    tr(
                        "--{option} {file} is {other} itself, which would be lost; choose another file",
                        option=name,
                        file=path,
                        other=same,
                    )
                )

    def exit(self, status: int = 0, message: str | None = None) -> NoReturn:
        """End the program once what was printed is written. Raises OSError if it cannot be."""
        put("")
        super().exit(status, message)

    def error(self, message: str) -> NoReturn:
        sentence = message[:1].upper() + message[1:]
        raise UsageError("{sentence}. See: {program} --help", sentence=sentence, program=self.prog)


def option(
    to: argparse._ActionsContainer,
    usage: str,
    about: str,
    kind: Callable[[str], Any] = str,
    *,
    beside: str = "",
    apart: Sequence[str] = (),
    **how: Any,
) -> None:
    """Add an option, or an argument, to a parser or a group of options.

    usage: how it is written, such as "--seed N". about: its sentence in --help, in the language of the person. kind: makes
    a value of what a person writes. beside, apart: the option without which, and those beside which, it has no effect.
    """
    name, _, value = usage.partition(" ")
    if "action" not in how or value:
        how = {"metavar": value or None, "type": kind} | how
    about = tr(about).replace("%", "%%")  # argparse takes % for a place to fill
    added = to.add_argument(name, help=about, **how)
    vars(added).update(beside=beside, apart=apart)


def flag(to: argparse._ActionsContainer, name: str, about: str, **how: Any) -> None:
    """Add an option without a value; how: as of `option`."""
    option(to, name, about, action="store_true", **how)


def _is_given(action: argparse.Action, found: argparse.Namespace) -> bool:
    """True if a person wrote an option, with another value than it has without."""
    value = getattr(found, action.dest, action.default)
    return bool(value == action.const if action.nargs == 0 else value != action.default)


def _is_one_file(one: Path, other: Path) -> bool:
    """True if two names are of one file, by links, too, or will be."""
    try:
        there = one.exists() and other.exists()
        return one.samefile(other) if there else os.path.realpath(one) == os.path.realpath(other)
    except (OSError, ValueError):  # names that no file can have
        return False


def positive(text: str) -> float:
    """A finite number above 0."""
    refusal = tr("{text} is not a number of seconds above 0", text=text)
    return _number(text, float, lambda value: 0.0 < value < math.inf, refusal)


def count(text: str, least: int = 2) -> int:
    """A whole number of at least `least`."""
    refusal = tr("{text} is not a whole number of at least {least}", text=text, least=least)
    return int(_number(text, int, lambda value: value >= least, refusal))


def finite(text: str) -> float:
    """A finite number."""
    return _number(text, float, math.isfinite, tr("{text} is not a finite number", text=text))


def _number(text: str, kind: type[float], fits: Callable[[float], bool], refusal: str) -> float:
    try:
        if fits(value := kind(text)):
            return value
    except ValueError:
        pass
    raise argparse.ArgumentTypeError(refusal)


def numbers(option: str, text: str) -> tuple[float, ...]:
    """Finite numbers separated by commas. Raises UsageError."""
    try:
        found = tuple(float(part) for part in text.split(","))
    except ValueError:
        message = tr(
            "{option} {text}: write numbers separated by commas, such as 0.1,0.5.", option=option, text=text
        )
        raise UsageError(message) from None
    if not all(map(math.isfinite, found)):
        raise UsageError("{option} {text}: write finite numbers.", option=option, text=text)
    return found


def times(text: str) -> tuple[float, ...]:
    """Ascending times (s) of at least 0. Raises UsageError."""
    found = numbers("--at", text)
    if found[0] < 0.0 or list(found) != sorted(found):
        raise UsageError(
            "--at {text}: write the times in ascending order, each at least 0 (in seconds).", text=text
        )
    return found
