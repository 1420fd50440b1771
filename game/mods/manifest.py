"""Manifests: what a mod says about itself in its mod.toml."""

from __future__ import annotations

import keyword
from pathlib import Path
from typing import Any

from game.mods.mod import Mod, ModError

MANIFEST = "mod.toml"
_KEYS = ("name", "version", "description", "requires")


def read_manifest(folder: Path, source: str, name: str | None = None) -> Mod:
    """The mod in a folder, with its problem if the manifest is wrong; `name`: how it is known otherwise."""
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
    except tomllib.TOMLDecodeError as error:
        raise ModError(f"{MANIFEST} is not TOML: {error}.") from None


def _fill(made: Mod, entries: dict[str, Any], named: str | None) -> None:
    for key in entries:
        if key not in _KEYS:
            raise ModError(f"{MANIFEST} has the key '{key}'; the keys are {', '.join(_KEYS)}.")
    for key in ("name", "version", "description"):
        value = entries.get(key, "")
        if not isinstance(value, str):
            raise ModError(f'{MANIFEST}: {key} is {value!r}; it must be a text, such as {key} = "…".')
        if value or key != "name":
            setattr(made, key, value)
    made.module = named or made.name
    if not made.name.isidentifier() or keyword.iskeyword(made.name) or "__" in made.name:
        raise ModError(f"{MANIFEST}: the name '{made.name}' must be like a Python name, such as 'wind'.")
    if named is not None and made.name != named:
        raise ModError(f"{MANIFEST}: the name is '{made.name}', but the entry point calls it '{named}'.")
    requires = entries.get("requires", [])
    if not isinstance(requires, list) or not all(isinstance(entry, str) for entry in requires):
        raise ModError(f'{MANIFEST}: requires is {requires!r}; write a list like ["pinjoint>=0.1", "gusts"].')
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
