"""Overrides: what the command line changes in a model, `--set PATH=VALUE`."""

from __future__ import annotations

from typing import Any

import msgspec

from components.field import Field, FieldError
from components.model import Model
from game.paths.target import PathError, Target, locate, settable

FORM = "write it like particles.B.force=120,-160 or settings.restitution=0.5"

_FLAGS = {"true": True, "false": False}


class OverrideError(ValueError):
    """An override that cannot be applied; the message quotes it and says why and what to write."""


def apply_override(model: Model, override: str) -> None:
    """Give one key of one element, or of all of a table ("*"), the value that a person typed.

    override: `<table>.<name or *>.<key>=<value>`, `settings.<key>=<value>` or `environment.<key>=<value>`,
        with keys and units of model files; `<key>.x` and `<key>.y` are single components, `null` and
        `none` mean no value of its own. Names may contain dots, spaces and "=".

    One undoable command. Raises OverrideError.
    """
    try:
        target, rest = locate(model, override, settable)
        if not rest.startswith("="):
            raise PathError(f"it has no value; {FORM}.")
        model.assign(target.handles, target.field.name, _values(target, rest[1:].strip()))
    except (PathError, FieldError) as error:
        raise OverrideError(f"{override}: {error}") from None


def read_value(target: Target, text: str) -> Any:
    """The value that a text means for a fact; the text itself if none, for a check to refuse."""
    whole = target.field.shape and not target.axis
    return _vector(target.field, text) if whole else _scalar(target.field, text)


def _values(target: Target, text: str) -> list[Any]:
    """One value per element."""
    new = read_value(target, text)
    if not target.axis:
        return [new] * len(target.handles)
    old = [getattr(handle, target.field.name) for handle in target.handles]
    return [(new, y) if target.axis == "x" else (x, new) for x, y in old]


def _vector(field: Field[Any], text: str) -> tuple[Any, ...]:
    inside = text.removeprefix("[").removesuffix("]")
    return tuple(_scalar(field, part) for part in inside.split(","))


def _scalar(field: Field[Any], text: str) -> Any:
    """What a text means for a field; the text itself if nothing, for the field's check to refuse."""
    text = text.strip()
    if field.dtype is str:
        return text
    if text.lower() in ("null", "none"):
        return None
    if field.dtype is bool:
        return _FLAGS.get(text.lower(), text)
    try:
        return msgspec.json.decode(text) if field.dtype is object else field.dtype(text)
    except (ValueError, UnicodeEncodeError):
        return text
