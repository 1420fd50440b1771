"""The command line: `pinjoint [MODEL]` opens the window; subcommands, each in a module here, work without one."""

from collections.abc import Callable
from typing import NamedTuple


class Command(NamedTuple):
    """A word after `pinjoint`: run gets the words after it and returns the exit status; about: one line for --help."""

    run: Callable[[list[str]], int]
    about: str
