"""Mod: one extension of the program, read from its mod.toml, and what became of it."""

from __future__ import annotations

import logging
import math
import os
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pinjoint.components import written
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import english, joined, tr
from pinjoint.components.mistake import Mistake, reason_of
from pinjoint.components.wording import is_identifier, printable, quoted
from pinjoint.interrupts import is_persons
from pinjoint.mods.declared import check, check_has_run, fits
from pinjoint.mods.limit import T, within

if TYPE_CHECKING:  # a command without a run does not need it
    from pinjoint.systems.run.simulation import Simulation

LOG = logging.getLogger("pinjoint.mods")
LOG.setLevel(logging.DEBUG)  # tracebacks are for those who listen, such as mods.log
_INCLUDED = "Pinjoint"  # the source of the mods that come with the program
MANIFEST = "mod.toml"
LONGEST = 400  # characters of a text of a mod, such as what an error says
PATIENCE = 10.0  # s that whatever a mod is asked may take, the compilation of functions of its own included

# Of a manifest, and their types.
_KEYS = {"name": str, "version": str, "description": str, "requires": list[str]}


class ModError(Mistake, ValueError):
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
    source: str = _INCLUDED
    problem: str = ""
    notes: list[str] = field(default_factory=list)
    withdraw: Callable[[], None] | None = None  # takes everything back that it registered

    @property
    def included(self) -> bool:
        """True if it comes with the program."""
        return self.source == _INCLUDED

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
        self.switch_off(tr("{what} failed: {error}", what=what, error=self.describe(error)), error)

    def switch_off(self, reason: str, error: BaseException | None = None) -> None:
        """Switch the mod off, unless it is already: from now on `call` calls nothing of it."""
        if self.off:
            return
        self.problem = reason
        sentence = tr(
            "The mod '{name}' was switched off: {reason} Your model is as it was before.",
            name=self.name,
            reason=reason,
        )
        EXTENSIONS.faults.append(sentence)
        LOG.error(english(sentence))
        if error is not None:  # without its message, which is code of the mod
            places = "".join(traceback.format_tb(error.__traceback__)).rstrip()
            LOG.debug("Traceback of the mod '%s':\n%s", self.name, places)

    @contextmanager
    def aside(self) -> Iterator[None]:
        """As if it were switched off, inside the `with`."""
        before, self.problem = self.problem, "aside"
        try:
            yield
        finally:
            self.problem = before

    def describe(self, error: BaseException) -> str:
        """An error with the file and the line of this mod in which it happened."""
        place, message = self.place_of(error), self._message(error)
        said = message if isinstance(error, ModError) else f"{type(error).__name__}: {message}"
        return f"{said.rstrip('.: ')}{f' ({place})' if place else ''}."

    def _message(self, error: BaseException) -> str:
        """What an error says, in one line; its class may be the mod's, and do whatever it likes when it is asked."""

        def read() -> str:
            said = error.msg if isinstance(error, SyntaxError) else error
            return printable(" ".join(str(said).split()))[:LONGEST]

        try:
            return self.within(PATIENCE, read)
        except BaseException as other:  # of code that is not ours
            if is_persons(other):
                raise
            return tr("its message cannot be read")

    def place_of(self, error: BaseException) -> str:
        """The file and the line of this mod in which an error happened; "" if in none."""
        if isinstance(error, SyntaxError) and isinstance(error.filename, str):
            return tr("{file}, line {line}", file=_short(error.filename), line=error.lineno)
        frames = traceback.extract_tb(error.__traceback__)
        own = [f for f in frames if self.folder is not None and Path(f.filename).is_relative_to(self.folder)]
        return tr("{file}, line {line}", file=_short(own[-1].filename), line=own[-1].lineno) if own else ""

    def call(
        self,
        what: str,
        function: Callable[..., Any],
        *arguments: Any,
        otherwise: Any = None,
        declared: Any = None,
        patience: float = PATIENCE,
        mistakes: tuple[type[BaseException], ...] = (),
    ) -> Any:
        """What a function of the mod returns; all that the mod does passes here.

        It is `otherwise` if the mod is off, or if the function raises anything (SystemExit and KeyboardInterrupt
        included; only Ctrl+C goes on), runs longer than `patience` (s) or returns what is not of the type `declared`,
        if one is, which switches the mod off. mistakes: errors that tell a person what to correct; they are raised.
        """

        def called() -> Any:
            made = function(*arguments)
            if declared is None:
                check_has_run(made, tr("what it returned"))
            else:
                check(made, declared, tr("what it returned"))
            return made

        if self.off:
            return otherwise
        try:
            if self.included:
                return function(*arguments)
            return self.within(patience, called)
        except mistakes:
            raise
        except BaseException as error:  # of code that is not ours
            if is_persons(error):
                raise
            self.fail(what, error)
            return otherwise

    def guarded(self, what: str, function: Callable[..., Any], **how: Any) -> Callable[..., Any]:
        """A function of the mod, to be called as if it were ours: see `call`."""
        return lambda *given: self.call(what, function, *given, **how)

    def within(self, patience: float, function: Callable[[], T]) -> T:
        """The result of a function; after `patience` TooLong is raised in the mod's code, or in a library that it calls."""
        if not math.isfinite(patience) or self.folder is None:
            return function()
        return within(patience, f"{self.folder}{os.sep}", function)


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
        raise ModError("{file} cannot be read: {reason}.", file=MANIFEST, reason=reason_of(error)) from None
    except RecursionError:
        raise ModError("{file} is nested too deeply; write it simpler.", file=MANIFEST) from None
    except tomllib.TOMLDecodeError as error:
        raise ModError("{file} is not TOML: {error}.", file=MANIFEST, error=error) from None


def _fill(made: Mod, entries: dict[str, Any], named: str | None) -> None:
    for key, value in entries.items():
        told = {"file": MANIFEST, "key": key, "value": quoted(value)}
        if key not in _KEYS:
            raise ModError(
                "{file} has the key '{key}', which means nothing; use only {keys}.",
                **told,
                keys=", ".join(_KEYS),
            )
        if not fits(value, _KEYS[key]) and key != "requires":
            raise ModError('{file}: {key} is {value}; it must be a text, such as {key} = "…".', **told)
        if not fits(value, _KEYS[key]):
            form = '["pinjoint>=0.1", "gusts"]'
            raise ModError("{file}: requires is {value}; write a list such as {form}.", **told, form=form)
        if value or key != "name":
            setattr(made, key, value if key != "requires" else tuple(value))
    made.module = named or made.name
    check_name(made.name)
    if named is not None and made.name != named:
        raise ModError(
            "{file}: the name is '{name}', but the entry point calls it '{other}'; use the same name.",
            file=MANIFEST,
            name=made.name,
            other=named,
        )
    _check_versions(made)


def check_name(name: str) -> None:
    """Raise ModError unless a mod may have this name."""
    if not is_identifier(name) or "__" in name:
        raise ModError("The name '{name}' must be a Python name without __, such as 'wind'.", name=name)


def _check_versions(made: Mod) -> None:
    from packaging.requirements import InvalidRequirement, Requirement
    from packaging.version import InvalidVersion, Version

    try:
        Version(made.version)
    except InvalidVersion:
        raise ModError(
            "{file}: the version is '{version}'; write it like '1.0'.", file=MANIFEST, version=made.version
        ) from None
    for entry in made.requires:
        try:
            Requirement(entry)
        except InvalidRequirement:
            raise ModError(
                "{file}: requires has '{entry}'; write it like 'pinjoint>=0.1,<2'.", file=MANIFEST, entry=entry
            ) from None


# --- what follows where a mod fails -------------------------------------------------------------------------


def switched_off() -> list[Mod]:
    """The mods that were loaded and failed since."""
    return [mod for mod in EXTENSIONS.mods if mod.loaded and mod.off]


def check_mods(known: list[Mod] | None = None, time: float | None = None) -> None:
    """Raise ModError if a mod failed, besides those that are known to. time: where a run stopped therefore (s)."""
    for mod in switched_off():
        if mod not in (known or []):
            said = tr("The mod '{name}' was switched off: {problem}", name=mod.name, problem=mod.problem)
            stopped = "" if time is None else tr("The run stopped at t = {time}.", time=written.time(time))
            raise ModError(joined([said, stopped]))


def blamed_on_mod(error: BaseException) -> bool:
    """Switch off the mod from whose code an error came past all guards; False if it came from no mod's."""
    for mod in EXTENSIONS.mods:
        if mod.loaded and not mod.off and mod.place_of(error):
            mod.fail(tr("code that the program called"), error)
            return True
    return False


@contextmanager
def heeding_mods(simulation: Simulation) -> Iterator[None]:
    """A run inside the `with` stops, by ModError, before the first step without a mod that failed meanwhile."""
    known = switched_off()

    def heed() -> int:
        check_mods(known, simulation.model.clock.time)
        return sys.maxsize

    simulation.before_steps.append(heed)
    try:
        yield
    finally:
        simulation.before_steps.remove(heed)
    heed()
