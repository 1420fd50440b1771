"""Mod: one extension of the program, what became of it, and who is to blame when it fails."""

from __future__ import annotations

import logging
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

LOG = logging.getLogger("pinjoint.mods")
FAULTS: list[str] = []  # sentences about mods that failed while the program ran, the oldest first
INCLUDED = "Pinjoint"  # where the mods that come with the program are from


class ModError(ValueError):
    """A mod that cannot be used; the message says why and what helps."""


@dataclass(eq=False)
class Mod:
    """A mod and what became of it.

    folder: where its mod.toml is, if it has one. module: what is imported. source: where it was found.
    requires: requirements like "pinjoint>=0.1" and "gusts>=2". problem: why it was left out or switched
    off, or "". notes: what else a person should know, such as keys that were taken.
    """

    name: str
    module: str
    version: str = ""
    description: str = ""
    requires: tuple[str, ...] = ()
    folder: Path | None = None
    source: str = INCLUDED
    problem: str = ""
    notes: list[str] = field(default_factory=list)
    withdraw: Callable[[], None] | None = None  # takes everything back that it registered

    @property
    def off(self) -> bool:
        """True if it was left out or switched off."""
        return bool(self.problem)

    @property
    def loaded(self) -> bool:
        """True if it registered what it has, though it may have been switched off since."""
        return self.withdraw is not None

    def fail(self, what: str, error: BaseException) -> None:
        """Switch it off because something of it failed, and tell so."""
        self.switch_off(f"{what} failed: {self.describe(error)}", error)

    def switch_off(self, reason: str, error: BaseException | None = None) -> None:
        """Let nothing of it be called any more."""
        self.problem = reason
        sentence = f"The mod '{self.name}' was switched off: {reason} Your model is as it was before."
        FAULTS.append(sentence)
        LOG.error(sentence, exc_info=error)

    def describe(self, error: BaseException) -> str:
        """An error with the file and the line of this mod in which it happened."""
        place = self._place(error)
        said = str(error) if isinstance(error, ModError) else f"{type(error).__name__}: {_message(error)}"
        return f"{said.rstrip('.')}{f' ({place})' if place else ''}."

    def _place(self, error: BaseException) -> str:
        if isinstance(error, SyntaxError) and error.filename:
            return f"{_short(error.filename)}, line {error.lineno}"
        frames = traceback.extract_tb(error.__traceback__)
        own = [f for f in frames if self.folder is not None and Path(f.filename).is_relative_to(self.folder)]
        return f"{_short(own[-1].filename)}, line {own[-1].lineno}" if own else ""

    def call(
        self,
        what: str,
        function: Callable[..., Any],
        *arguments: Any,
        otherwise: Any = None,
        mistakes: tuple[type[Exception], ...] = (),
    ) -> Any:
        """What a function of the mod returns; `otherwise` if the mod is off, or fails, which switches it off.

        mistakes: errors by which it tells a person what to do otherwise; they are raised.
        """
        if self.off:
            return otherwise
        try:
            return function(*arguments)
        except mistakes:
            raise
        except Exception as error:  # whatever a stranger's code raises
            self.fail(what, error)
            return otherwise


def _message(error: BaseException) -> str:
    return error.msg if isinstance(error, SyntaxError) else str(error)


def _short(path: str) -> str:
    """The file and the folder it is in."""
    return "/".join(Path(path).parts[-2:])
