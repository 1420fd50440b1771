"""Installation: the version of Pinjoint and the mods that a sweep is of; its workers have the same."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from game import __version__
from game.mods import MODS, load
from game.mods.mod import INCLUDED
from game.sweeps.variation import SweepError


@dataclass(frozen=True)
class Needed:
    """A mod. folder: where it was found, "" if in an installed package."""

    name: str
    version: str
    folder: str


@dataclass(frozen=True)
class Installation:
    """version: of Pinjoint. mods: those that are loaded besides the ones that come with it."""

    version: str
    mods: tuple[Needed, ...]

    @classmethod
    def present(cls) -> Installation:
        """That of this process, as it is now."""
        mods = (mod for mod in MODS if mod.loaded and mod.source != INCLUDED)
        return cls(
            __version__,
            tuple(
                Needed(mod.name, mod.version, "" if mod.source.startswith("package ") else str(mod.folder))
                for mod in mods
            ),
        )

    def require(self) -> None:
        """Load the mods that this process lacks. Raises SweepError unless it has all that is needed then."""
        if self.version != __version__:
            raise SweepError(f"it has Pinjoint {__version__}, the sweep is of {self.version}")
        missing = set(self.mods) - set(Installation.present().mods)
        if missing:
            folders = [mod.folder for mod in self.mods if mod in missing and mod.folder]
            load(map(Path, folders), installed=len(folders) < len(missing))
            missing -= set(Installation.present().mods)
        for mod in sorted(missing, key=lambda mod: mod.name):
            raise SweepError(
                f"it lacks the mod '{mod.name}' {mod.version}{' in ' if mod.folder else ''}{mod.folder}"
            )
