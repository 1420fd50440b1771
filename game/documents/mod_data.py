"""Data of mods in documents: by which versions of the mods it was written, and how a mod brings it up to date."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from typing import Any

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.mistake import WrongValue
from pinjoint.components.wording import quoted

DATA = "components"  # the key of the data of mods, at elements and in the document
MODS = "mods"  # the key of the versions of the mods whose data a document holds

# Changes a document; given the version of the mod that wrote it.
Upgrade = Callable[[dict[str, Any], str], None]


def known_versions(kept: Mapping[str, str]) -> dict[str, str]:
    """The versions of mods that are loaded, and those `kept` of mods that are not."""
    return {**kept, **EXTENSIONS.versions}


def versions_in(document: Mapping[str, Any], known: Mapping[str, str]) -> dict[str, str]:
    """The versions of the mods whose data a document holds, of those that are known."""
    return {name: known[name] for name in sorted(_mods_in(document)) if name in known} if known else {}


def upgraded(document: Mapping[str, Any]) -> Mapping[str, Any]:
    """The document with the data of mods as their present versions have it.

    A mod is asked where the document holds data of it that another, older version wrote, or one that is not told ("").
    Raises ValueError for a version that is none.
    """
    stated = document.get(MODS, {})
    _check(stated)
    waiting = [
        name
        for name in EXTENSIONS.upgrades
        if _is_older(stated.get(name, ""), EXTENSIONS.versions.get(name, ""))
    ]
    if not waiting:
        return document
    present = _mods_in(document)
    made: dict[str, Any] | None = None
    for name in waiting:
        if name in present:
            made = copy.deepcopy(dict(document)) if made is None else made
            EXTENSIONS.upgrades[name](made, stated.get(name, ""))
    return document if made is None else made


def _mods_in(document: Mapping[str, Any]) -> set[str]:
    """Names of the mods whose data a document holds."""
    return {
        str(name).partition(".")[0]
        for section in (*document.values(), document)
        for element in (section if isinstance(section, list | tuple) else (section,))
        if isinstance(element, Mapping) and isinstance(element.get(DATA), Mapping)
        for name in element[DATA]
    }


def _check(stated: Any) -> None:
    if not isinstance(stated, Mapping):
        raise WrongValue("it must be an object such as {form}.", form='{"wind": "1.0"}')
    for name, version in stated.items():
        if not isinstance(version, str) or not _is_version(version):
            raise WrongValue(
                'the version of {name} is {version}; write it like "1.0".', name=name, version=quoted(version)
            )


def _is_version(text: str) -> bool:
    from packaging.version import InvalidVersion, Version  # only where there is a mod

    try:
        Version(text)
    except InvalidVersion:
        return False
    return True


def _is_older(stated: str, present: str) -> bool:
    from packaging.version import Version

    return not stated or not present or Version(stated) < Version(present)
