"""Mod: one extension of the program, read from its mod.toml, and what became of it."""

from __future__ import annotations

import keyword
import logging
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from components.wording import quoted
from game.editor.context import FAULTS

LOG = logging.getLogger("pinjoint.mods")
INCLUDED = "Pinjoint"  # the source of the mods that come with the program
MANIFEST = "mod.toml"

_KEYS = ("name", "version", "description", "requires")  # of a manifest


class ModError(ValueError):
    """A mod that cannot be used; the message says why and what helps."""


@dataclass(eq=False)
class Mod:
    """A mod and what became of it.

    folder: where its mod.toml is, if it has one. module: what is imported. source: where it was found.
    requires: requirements like "pinjoint>=0.1" and "gusts>=2". problem: why it was left out or switched
    off, or "". notes: further sentences for a person, such as keys that were taken.
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
        """Switch the mod off because `what` of it failed."""
        self.switch_off(f"{what} failed: {self.describe(error)}", error)

    def switch_off(self, reason: str, error: BaseException | None = None) -> None:
        """Switch the mod off: from now on `call` calls nothing of it."""
        self.problem = reason
        sentence = f"The mod '{self.name}' was switched off: {reason} Your model is as it was before."
        FAULTS.append(sentence)
        LOG.error(sentence, exc_info=error)

    def describe(self, error: BaseException) -> str:
        """An error with the file and the line of this mod in which it happened."""
        place = self._place(error)
        message = error.msg if isinstance(error, SyntaxError) else str(error)
        said = message if isinstance(error, ModError) else f"{type(error).__name__}: {message}"
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
        """The result of a function of the mod; `otherwise` if the mod is off or the function fails, which switches it off.

        mistakes: errors that tell a person what to correct; they are raised.
        """
        if self.off:
            return otherwise
        try:
            return function(*arguments)
        except mistakes:
            raise
        except Exception as error:  # any error of code that is not ours
            self.fail(what, error)
            return otherwise


def _short(path: str) -> str:
    """A path as its file and the folder that holds it."""
    return "/".join(Path(path).parts[-2:])


# --- manifests -----------------------------------------------------------------------------------------


def read_manifest(folder: Path, source: str, name: str | None = None) -> Mod:
    """The mod in a folder, with its problem if the manifest is wrong. name: what an entry point calls it."""
    made = Mod(name or folder.name, name or folder.name, folder=folder.resolve(), source=source)
    try:
        _fill(made, _entries(folder / MANIFEST), named=name)
    except ModError as error:
        made.problem = str(error)
    return made


def _entries(path: Path) -> dict[str, Any]:
    import tomllib  # only where there is a mod

    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
        raise ModError(f"{MANIFEST} cannot be read: {reason}.") from None
    except RecursionError:
        raise ModError(f"{MANIFEST} is nested too deeply.") from None
    except tomllib.TOMLDecodeError as error:
        raise ModError(f"{MANIFEST} is not TOML: {error}.") from None


def _fill(made: Mod, entries: dict[str, Any], named: str | None) -> None:
    for key in entries:
        if key not in _KEYS:
            raise ModError(f"{MANIFEST} has the key '{key}'; the keys are {', '.join(_KEYS)}.")
    for key in ("name", "version", "description"):
        value = entries.get(key, "")
        if not isinstance(value, str):
            raise ModError(f'{MANIFEST}: {key} is {quoted(value)}; it must be a text, such as {key} = "…".')
        if value or key != "name":
            setattr(made, key, value)
    made.module = named or made.name
    if not made.name.isidentifier() or keyword.iskeyword(made.name) or "__" in made.name:
        raise ModError(f"{MANIFEST}: the name '{made.name}' must be like a Python name, such as 'wind'.")
    if named is not None and made.name != named:
        raise ModError(f"{MANIFEST}: the name is '{made.name}', but the entry point calls it '{named}'.")
    requires = entries.get("requires", [])
    if not isinstance(requires, list) or not all(isinstance(entry, str) for entry in requires):
        raise ModError(
            f'{MANIFEST}: requires is {quoted(requires)}; write a list like ["pinjoint>=0.1", "gusts"].'
        )
    made.requires = tuple(requires)
    _check_versions(made)


def _check_versions(made: Mod) -> None:
    from packaging.requirements import InvalidRequirement, Requirement
    from packaging.version import InvalidVersion, Version

    try:
        Version(made.version)
    except InvalidVersion:
        raise ModError(f"{MANIFEST}: the version '{made.version}' must be like '1.0'.") from None
    for entry in made.requires:
        try:
            Requirement(entry)
        except InvalidRequirement:
            raise ModError(f"{MANIFEST}: requires '{entry}', which must be like 'pinjoint>=0.1,<2'.") from None
