"""Declared: values of mods, checked against the types that are declared for them where they enter a table or a picture.

>>> check((1, 2.5), tuple[float, ...], "places")
>>> check((255, 0, 0), tuple[int, int, int, int], "colour")
Traceback (most recent call last):
    ...
TypeError: colour is (255, 0, 0); it must be of type tuple[int, int, int, int]
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from types import AsyncGeneratorType, CoroutineType, GeneratorType, MappingProxyType, UnionType
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np

from pinjoint.components.language import tr
from pinjoint.components.wording import quoted

_NUMBERS: Mapping[type, tuple[type, ...]] = {
    bool: (bool, np.bool_),
    int: (int, np.integer),
    float: (int, float, np.integer, np.floating),
}
_UNRUN: Mapping[type, str] = {GeneratorType: "yield", CoroutineType: "async", AsyncGeneratorType: "async"}
_KINDS = {"f": "fiu", "i": "iu", "u": "iu", "b": "b"}  # numpy's kinds that stand for each kind


def check(value: Any, declared: Any, called: str) -> None:
    """Raise TypeError, which says what the value is called and what it must be, if it is not of its declared type.

    Of classes that are plain data (frozen dataclasses and named tuples) each Field is checked.
    """
    if not fits(value, declared):
        said = declared.__name__ if isinstance(declared, type) else re.sub(r"\w[\w.]*\.", "", str(declared))
        told = {"called": called, "value": quoted(value), "type": said}
        raise TypeError(tr("{called} is {value}; it must be of type {type}", **told))


def check_fields(value: Any, kind: type, checked: Mapping[str, Any] = MappingProxyType({})) -> None:
    """Raise TypeError if a field of plain data is not of its type; those `checked` that are still the same are."""
    for name, hint in _fields(kind).items():
        field = getattr(value, name)
        if field is not checked.get(name, value) or type(field).__hash__ is None:
            check(field, hint, f"{kind.__name__}.{name}")


def check_has_run(value: Any, called: str) -> None:
    """Raise TypeError if a value is the rest of a function that has not run."""
    for kind, word in _UNRUN.items():
        if type(value) is kind:
            if isinstance(value, CoroutineType):
                value.close()  # or Python warns of it
            told = {"called": called, "kind": kind.__name__, "word": word}
            raise TypeError(
                tr("{called} is a {kind}, whose code has not run; write it without '{word}'", **told)
            )


def result_of(function: Callable[..., Any]) -> Any:
    """The declared type of what a function returns."""
    return inspect.signature(function, eval_str=True).return_annotation


# --- by type ---------------------------------------------------------------------------------------------


def fits(value: Any, declared: Any) -> bool:
    """Whether a value is of a type. Raises TypeError for a field of plain data."""
    kind, parts, plain = _parts(declared)
    if kind in (Any, object) or isinstance(kind, TypeVar):
        return True
    if kind in _NUMBERS:
        is_truth = isinstance(value, bool | np.bool_)
        return isinstance(value, _NUMBERS[kind]) and is_truth == (kind is bool)
    if kind is Union:
        exact = [part for part in parts if type(value) is part]
        return any(fits(value, part) for part in exact or parts)
    if kind is Literal:
        return value in parts
    if kind is tuple and parts[1:] != (...,):
        alike = isinstance(value, list | tuple) and len(value) == len(parts)
        return alike and all(map(fits, value, parts))
    if kind in (tuple, list, Sequence, Iterable):
        kinds = Iterable if kind is Iterable else Sequence | np.ndarray
        several = isinstance(value, kinds) and not isinstance(value, str)
        return several and (kind is Iterable or all(fits(entry, parts[0]) for entry in value))
    if kind is Mapping:
        return isinstance(value, Mapping) and all(
            fits(key, parts[0]) and fits(entry, parts[1]) for key, entry in value.items()
        )
    if kind is np.ndarray:
        number = get_args(parts[1])[0] if parts[1:] else Any
        letter = np.dtype(number).kind if isinstance(number, type) else ""
        return isinstance(value, np.ndarray) and value.dtype.kind in _KINDS.get(letter, "fiub")
    if kind is type:
        return isinstance(value, type) and issubclass(value, parts[0] if isinstance(parts[0], type) else object)
    if kind is Callable:
        return callable(value)
    if not isinstance(value, kind):
        return False
    if plain:
        check_fields(value, kind)
    return True


@cache
def _parts(declared: Any) -> tuple[Any, tuple[Any, ...], bool]:
    """What a type is, its parts, and whether it is plain data."""
    kind, parts = get_origin(declared) or declared, get_args(declared)
    meant = getattr(kind, "__value__", None)  # of an alias, as NDArray is since numpy 2.5
    if meant is not None:
        return _parts(meant[parts] if parts else meant)
    if kind is None:
        kind = type(None)
    if getattr(kind, "_is_protocol", False):
        kind = Any
    kind = {UnionType: Union, dict: Mapping}.get(kind, kind)
    parameters = getattr(kind, "__dataclass_params__", None)
    return kind, parts, (parameters is not None and parameters.frozen) or hasattr(kind, "_fields")


@cache
def _fields(kind: Any) -> dict[str, Any]:
    """The declared types of the fields of plain data, by name."""
    names = getattr(kind, "_fields", None) or kind.__dataclass_fields__
    hints = get_type_hints(kind)
    return {name: hints[name] for name in names}
