"""Format: what documents consist of, by their keys, and what cannot stand in one."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, NoReturn

from pinjoint.components.clock import Clock
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import SAVED, Field
from pinjoint.components.grid import Grid
from pinjoint.components.handle import Handle
from pinjoint.components.language import joined, listed, tr
from pinjoint.components.load import Load
from pinjoint.components.mistake import Mistake
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.components.settings import Environment, Settings
from pinjoint.components.table import fields_of
from pinjoint.components.wording import is_broken, quoted

FORMAT = "pinjoint model"
VERSION = 1
BY_COLUMNS = "pinjoint model by columns"
SECTIONS: Mapping[str, type[Handle]] = MappingProxyType(
    {
        "environment": Environment,
        "settings": Settings,
        "particles": Particle,
        "rods": Rod,
        "loads": Load,
        "grids": Grid,
        "state": Clock,
    }
)
REQUIRED: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"particles": ("name", "position"), "rods": ("name", "between"), "loads": ("on",)}
)


class ModelError(Mistake, ValueError):
    """A model that cannot be read or written; the message says where, what is wrong and the remedy."""


def fail(path: str, problem: str, /, **values: Any) -> NoReturn:
    raise ModelError(joined([f"{path}:", tr(problem, **values)]))


def required(kind: type[Handle]) -> Sequence[str]:
    """The keys that every element of a kind must have."""
    if kind.table in REQUIRED or kind not in EXTENSIONS.kinds.values():
        return REQUIRED.get(kind.table, ())
    return [field.key for field in fields_of(kind) if field.name in kind.points or field.references]


def saved_fields(kind: type[Handle]) -> list[Field[Any]]:
    return [field for field in fields_of(kind) if field.role in SAVED]


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
