"""Format: what documents consist of, by their keys, what cannot stand in one, and how mods bring their data up to date."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NoReturn

from pinjoint.components.clock import Clock
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.grid import Grid
from pinjoint.components.handle import Handle
from pinjoint.components.language import joined, listed, tr
from pinjoint.components.load import Load, SpanLoad
from pinjoint.components.mistake import Mistake, WrongValue
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.settings import Environment, Settings
from pinjoint.components.table import fields_of
from pinjoint.components.wording import is_broken, quoted

FORMAT = "pinjoint model"
VERSION = 1
FOREIGN = "components"  # the key of the data of mods, at elements and in the document
MODS = "mods"  # the key of the versions of the mods whose data a document holds
SECTIONS: Mapping[str, type[Handle]] = {
    "environment": Environment,
    "settings": Settings,
    "particles": Particle,
    "rods": Rod,
    "loads": Load,
    "span_loads": SpanLoad,
    "grids": Grid,
    "state": Clock,
}
_REQUIRED: Mapping[str, tuple[str, ...]] = {
    "particles": ("name", "position"),
    "rods": ("name", "between"),
    "loads": ("on",),
    "span_loads": ("rod",),
}

# Changes a document; given the version of the mod that wrote it.
Upgrade = Callable[[dict[str, Any], str], None]


class ModelError(Mistake, ValueError):
    """A model that cannot be read or written; the message says where, what is wrong and the remedy."""


def fail(path: str, problem: str, /, **values: Any) -> NoReturn:
    raise ModelError(joined([f"{path}:", tr(problem, **values)]))


def required(kind: type[Handle]) -> Sequence[str]:
    """The keys that every element of a kind must have."""
    if kind.table in _REQUIRED or kind not in EXTENSIONS.kinds.values():
        return _REQUIRED.get(kind.table, ())
    return [field.key for field in fields_of(kind) if field.name in kind.points or field.references]


def copied(value: Any, where: str) -> Any:
    """A copy of a value that JSON can hold."""
    if isinstance(value, Mapping) and all(isinstance(key, str) and not is_broken(key) for key in value):
        return {key: copied(item, where) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [copied(item, where) for item in value]
    if isinstance(value, str) and is_broken(value):
        fail(where, "{value!a} contains a damaged character, which a file cannot hold.", value=value)
    if value is None or isinstance(value, str | int) or (isinstance(value, float) and math.isfinite(value)):
        return value
    fail(where, "a model file cannot hold {value}.", value=quoted(value))


def missing_mods(model: Model) -> str:
    """The sentence about mods, not loaded, whose data a model keeps; "" if there are none."""
    kept = [*model.foreign.values(), model.foreign_kinds]
    names = sorted({name.partition(".")[0] for part in kept for name in part})
    said = tr(
        "This model uses mods that are not loaded: {mods}. Their data is kept and saved again, but has no effect.",
        mods=listed(names),
    )
    return said if names else ""


# --- data of mods ---------------------------------------------------------------------------------------


def upgraded(document: Mapping[str, Any]) -> Mapping[str, Any]:
    """The document with the data of mods as their present versions have it.

    A mod is asked where the document holds data of it that another, older version wrote, or one that is not told ("").
    Raises ValueError for a version that is none.
    """
    stated = document.get(MODS, {})
    _check(stated)
    versions = EXTENSIONS.versions
    older = [name for name in EXTENSIONS.upgrades if _is_older(stated.get(name, ""), versions.get(name, ""))]
    present = mods_in(document) if older else ()
    waiting = [name for name in older if name in present]
    if not waiting:
        return document
    made = copy.deepcopy(dict(document))
    for name in waiting:
        EXTENSIONS.upgrades[name](made, stated.get(name, ""))
    return made


def mods_in(document: Mapping[str, Any]) -> set[str]:
    """Names of the mods whose data a document holds."""
    return {
        str(name).partition(".")[0]
        for section in (*document.values(), document)
        for element in (section if isinstance(section, list | tuple) else (section,))
        if isinstance(element, Mapping) and isinstance(element.get(FOREIGN), Mapping)
        for name in element[FOREIGN]
    }


def _check(stated: Any) -> None:
    if not isinstance(stated, Mapping):
        raise WrongValue("it must be an object such as {form}.", form='{"wind": "1.0"}')
    for name, version in stated.items():
        from packaging.version import InvalidVersion, Version  # only where there is a mod

        try:
            Version(version)
        except (InvalidVersion, TypeError):
            raise WrongValue(
                'the version of {name} is {version}; write it like "1.0".', name=name, version=quoted(version)
            ) from None


def _is_older(stated: str, present: str) -> bool:
    from packaging.version import Version

    return not stated or not present or Version(stated) < Version(present)
