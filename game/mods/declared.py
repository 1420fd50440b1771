"""Declared: what mods hand over, checked against the types that are declared for it, and made plain.

>>> as_declared([1, 2.5], tuple[float, ...], "places")
(1.0, 2.5)
>>> as_declared((255, 0, 0), tuple[int, int, int, int], "colour")
Traceback (most recent call last):
    ...
TypeError: colour is (255, 0, 0); it must be 4 entries: int, int, int, int
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, wraps
from itertools import islice
from types import AsyncGeneratorType, CoroutineType, GeneratorType, NoneType, UnionType
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np

from pinjoint.components.language import Said, in_both, marked, tr
from pinjoint.components.mistake import WrongValue
from pinjoint.components.wording import quoted

C = TypeVar("C")
Made = Callable[[Any, str], Any]  # the plain value of a value that is called so; raises TypeError, ValueError

MOST = (
    1_000_000  # entries of anything but an array; an iterable may have no end, in code that nothing interrupts
)
_SEQUENCES = (list, Sequence, Iterable)
_NUMBERS: Mapping[type, tuple[type, ...]] = {
    bool: (bool, np.bool_),
    int: (int, np.integer),
    float: (int, float, np.integer, np.floating),
}
_UNRUN: Mapping[type, str] = {GeneratorType: "yield", CoroutineType: "async", AsyncGeneratorType: "async"}
_KINDS = {"f": "fiu", "i": "iu", "u": "iu", "b": "b"}  # numpy's kinds that become each kind


def as_declared(value: Any, declared: Any, called: str) -> Any:
    """A value as plain values of its declared type: no subclasses, no lists for tuples, no numbers of numpy.

    Classes that are plain data (frozen dataclasses and named tuples) are checked and made anew Field by Field.
    Raises TypeError or ValueError, which tells what the value is called and what it must be.
    """
    return _maker(declared)(value, called)


def check_fields(value: Any, kind: type) -> None:
    """Raise TypeError if a field of a dataclass that may change is not of its declared type."""
    for name, hint in _fields(kind).items():
        as_declared(getattr(value, name), hint, f"{kind.__name__}.{name}")


def result_of(function: Callable[..., Any]) -> Any:
    """The declared type of what a function returns."""
    return inspect.signature(function, eval_str=True).return_annotation


def checks_arguments(kind: type[C]) -> type[C]:
    """Let the public methods of a class check their arguments against their annotations."""
    for name, method in vars(kind).items():
        if inspect.isfunction(method) and not name.startswith("_"):
            setattr(kind, name, _checked(method))
    return kind


def _checked(method: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(method)
    def checked(*arguments: Any, **named: Any) -> Any:
        signature = inspect.signature(method, eval_str=True)
        bound = signature.bind(*arguments, **named)
        for name in bound.arguments.keys() - {"self"}:
            bound.arguments[name] = as_declared(
                bound.arguments[name], signature.parameters[name].annotation, name
            )
        return method(*bound.args, **bound.kwargs)

    return checked


# --- makers by type ------------------------------------------------------------------------------------


@cache
def _maker(declared: Any) -> Made:
    """What checks values of a type."""
    origin, arguments = get_origin(declared), get_args(declared)
    meant = getattr(origin or declared, "__value__", None)  # of an alias, as NDArray is since numpy 2.5
    if meant is not None:
        return _maker(meant[arguments] if arguments else meant)
    if declared in (Any, object, None) or isinstance(declared, TypeVar):
        return _anything
    if declared in _NUMBERS:
        return _number(declared)
    if declared is str:
        return _text
    if origin in (Union, UnionType):
        return _one_of(declared, arguments)
    if origin is Literal:
        return _choice(arguments)
    if origin is tuple:
        return _each(arguments[0]) if arguments[1:] == (...,) else _entries(arguments)
    if origin in _SEQUENCES:
        return _each(arguments[0])
    if origin in (dict, Mapping):
        return _mapping(*arguments)
    if origin is np.ndarray:
        return _array(*get_args(arguments[1]))
    return _instance(declared, origin, arguments)


_OF_TYPE = marked("{called} is {value}; it must be of type {type}")
_ONE_OF = marked("{called} is {value}; it must be one of {names}")


def _refused(value: Any, called: str, refusal: str, **told: Any) -> TypeError:
    return TypeError(tr(refusal, called=called, value=quoted(value), **told))


def _anything(value: Any, called: str) -> Any:
    """A value, unless it is the rest of a function that has not run."""
    for kind, word in _UNRUN.items():
        if type(value) is kind:
            if isinstance(value, CoroutineType):
                value.close()  # or Python warns of it
            raise TypeError(
                tr(
                    "{called} is a {kind}, whose code has not run; write it without '{word}'",
                    called=called,
                    kind=kind.__name__,
                    word=word,
                )
            )
    return value


def _number(kind: type) -> Made:
    def number(value: Any, called: str) -> Any:
        if type(value) is kind:
            return value
        if not isinstance(value, _NUMBERS[kind]) or (kind is not bool and isinstance(value, bool | np.bool_)):
            raise _refused(value, called, _OF_TYPE, type=kind.__name__)
        return kind(value)

    return number


def _text(value: Any, called: str) -> str:
    if type(value) is str:
        return value
    if type(value) is Said:
        return in_both(str.__str__(value), _text(value.english, called))
    if not isinstance(value, str):
        raise _refused(value, called, marked("{called} is {value}; it must be a text"))
    return str.__str__(value)  # of a class derived from it


def _one_of(declared: Any, options: Sequence[Any]) -> Made:
    def one(value: Any, called: str) -> Any:
        for option in options:
            if type(value) is option or (option is NoneType and value is None):
                return None if value is None else as_declared(value, option, called)
        refusals = []
        for option in options:
            try:
                return _maker(option)(value, called)
            except (TypeError, ValueError) as error:
                refusals.append(error)
                if isinstance(option, type) and isinstance(value, option):
                    raise
        raise _refused(value, called, _ONE_OF, names=", ".join(map(_said, options))) from refusals[-1]

    return one


def _choice(choices: Sequence[Any]) -> Made:
    def choice(value: Any, called: str) -> Any:
        if value not in choices:
            raise _refused(value, called, _ONE_OF, names=", ".join(map(repr, choices)))
        return choices[choices.index(value)]

    return choice


def _items(value: Any, called: str) -> list[Any]:
    if isinstance(value, str | bytes) or not isinstance(value, Iterable):
        raise _refused(value, called, marked("{called} is {value}; it must be a list or a tuple"))
    items = list(islice(value, MOST + 1))
    if len(items) > MOST:
        raise WrongValue("{called} has more than {count:,} entries; give fewer", called=called, count=MOST)
    return items


def _each(entry: Any) -> Made:
    make = _maker(entry)
    return lambda value, called: tuple(make(item, f"an entry of {called}") for item in _items(value, called))


def _entries(types: Sequence[Any]) -> Made:
    makers = [_maker(entry) for entry in types]
    plain = tuple(types) if {*types} <= {int, float, str} else ()

    def entries(value: Any, called: str) -> tuple[Any, ...]:
        if plain and type(value) is tuple and tuple(map(type, value)) == plain:
            return value  # as colours usually are, of which pictures hold many
        items = _items(value, called)
        if len(items) != len(makers):
            told = {"count": len(makers), "types": ", ".join(map(_said, types))}
            refusal = marked("{called} is {value}; it must have {count} entries: {types}")
            raise _refused(value, called, refusal, **told)
        return tuple(make(item, f"an entry of {called}") for make, item in zip(makers, items, strict=True))

    return entries


def _mapping(key: Any, entry: Any) -> Made:
    keys, entries = _maker(key), _maker(entry)

    def mapping(value: Any, called: str) -> dict[Any, Any]:
        if not isinstance(value, Mapping):
            raise _refused(value, called, marked("{called} is {value}; it must be a dictionary"))
        return {keys(k, f"a key of {called}"): entries(v, f"{called}[{quoted(k)}]") for k, v in value.items()}

    return mapping


def _array(number: Any = Any) -> Made:
    """Arrays of one type of numbers; of any, if that is not declared."""
    dtype = None if number is Any else np.dtype(number)

    def array(value: Any, called: str) -> Any:
        try:
            made = np.asarray(value)
        except ValueError:  # lists of unequal lengths
            raise _refused(value, called, marked("{called} is {value}; it must be an array")) from None
        if made.dtype.kind not in ("fiub" if dtype is None else _KINDS[dtype.kind]):
            raise _refused(value, called, marked("{called} is {value}; it must be an array of numbers"))
        return made if dtype is None else made.astype(dtype, copy=False)

    return array


def _instance(declared: Any, origin: Any, arguments: Sequence[Any]) -> Made:
    if origin is type:
        return lambda value, called: _is_class(value, arguments[0], called)
    kind = origin or declared
    if kind is Callable or getattr(kind, "_is_protocol", False):
        return lambda value, called: _is_function(value, called) if kind is Callable else value
    parameters = getattr(kind, "__dataclass_params__", None)
    plain = (parameters is not None and parameters.frozen) or hasattr(kind, "_fields")
    make = _data(kind) if plain else None

    def instance(value: Any, called: str) -> Any:
        if not isinstance(value, kind):
            raise _refused(value, called, _OF_TYPE, type=kind.__name__)
        return value if make is None else make(value)

    return instance


def _data(kind: Any) -> Callable[[Any], Any]:
    makers = {name: (_maker(hint), f"{kind.__name__}.{name}") for name, hint in _fields(kind).items()}

    def data(value: Any) -> Any:
        return kind(**{name: make(getattr(value, name), called) for name, (make, called) in makers.items()})

    return data


@cache
def _fields(kind: Any) -> dict[str, Any]:
    """The declared types of the fields of plain data, by name."""
    names = getattr(kind, "_fields", None) or kind.__dataclass_fields__
    hints = get_type_hints(kind)
    return {name: hints[name] for name in names}


def _is_class(value: Any, base: Any, called: str) -> Any:
    base = object if base is Any or isinstance(base, TypeVar) else base
    if not (isinstance(value, type) and issubclass(value, base)):
        refusal = marked(
            "{called} is {value}; it must be a class derived from {base}; give the class, not an object of it"
        )
        raise _refused(value, called, refusal, base=base.__name__)
    return value


def _is_function(value: Any, called: str) -> Any:
    if not callable(value):
        raise _refused(value, called, marked("{called} is {value}; it must be a function"))
    return value


def _said(declared: Any) -> str:
    if declared is NoneType:
        return "None"
    return declared.__name__ if isinstance(declared, type) else re.sub(r"[\w.]+\.", "", str(declared))
