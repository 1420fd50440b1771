"""Lines of a script, performed in a session one at a time."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import Vector
from pinjoint.components.language import tr
from pinjoint.components.mistake import WrongValue
from pinjoint.components.wording import as_json, cut, remedy
from pinjoint.mods.declared import fits
from pinjoint.mods.mod import ModError
from pinjoint.paths import apply_override
from pinjoint.scripts.expectation import check
from pinjoint.scripts.script import Script

Session = Any  # pinjoint.session.Session, which plays lessons by these lines


@dataclass(frozen=True)
class Failure:
    """An expectation that did not hold."""

    line: int
    expected: str
    got: Any

    def __str__(self) -> str:
        return tr(
            "line {line}: expected {expected}, got {got}",
            line=self.line,
            expected=self.expected,
            got=str(self.got),
        )


def play_line(script: Script, number: int, entry: Mapping[str, Any], session: Session) -> list[Failure]:
    """Do what one line of a script says; returns the expectations that did not hold. Raises ScriptError.

    One of every line is that no mod fails.
    """
    known, failures = len(EXTENSIONS.faults), list[Failure]()
    try:
        failures += [Failure(number, *wrong) for wrong in perform(session, entry)]
    except ModError:
        pass  # it is among EXTENSIONS.faults
    except (ValueError, LookupError, TypeError) as error:
        reason = error.args[0] if error.args else error
        raise script.error(number, reason) from error
    return failures + [Failure(number, tr("mods that work"), fault) for fault in EXTENSIONS.faults[known:]]


class Shape(NamedTuple):
    """What may stand under a key. kind: its type. suits: whether a value of that type will do."""

    kind: Any
    example: Any
    suits: Callable[[Any], bool] = lambda value: True


def check_shapes(entry: Mapping[str, Any], shapes: Mapping[str, Shape]) -> None:
    """Raise WrongValue unless every key is known, and every value has its shape and is finite."""
    for key, value in entry.items():
        if key not in shapes:
            near = remedy(key, shapes)
            raise WrongValue("there is no key '{key}' here; {remedy}", key=cut(key), remedy=near)
        kind, example, suits = shapes[key]
        if not (fits(value, kind) and _is_finite(value) and suits(value)):
            form = json.dumps({key: example})
            raise WrongValue(
                "{key} is {value}; write it like {form}.", key=key, value=as_json(value), form=form
            )


def _is_finite(value: Any) -> bool:
    if isinstance(value, list | tuple):
        return all(map(_is_finite, value))
    return not isinstance(value, float) or math.isfinite(value)


_SHAPES = {
    "press": Shape(str, "space"),
    "over": Shape(Vector, [1.0, 1.0]),
    "click": Shape(Vector, [1.0, 1.0]),
    "drag": Shape(tuple[Vector, Vector], [[0.0, 0.0], [1.0, 1.0]]),
    "button": Shape(str, "ctrl+click"),
    "type": Shape(str, "200000"),
    "box": Shape(str, "stiffness"),
    "set": Shape(str, "particles.B.force=120,-160"),
    "action": Shape(str, "undo"),
    "divide": Shape(tuple[str, int], ["AB", 4]),
    "run": Shape(float | Literal["rest"], 0.5),
    "steps": Shape(int, 128),
    "expect": Shape(str, "scene = pause"),
    "input": Shape(str, "click"),
    "pixel": Shape(Vector, [512.0, 300.0]),
    "resize": Shape(tuple[float, float, float], [1280.0, 800.0, 1.0], lambda size: min(size) > 0.0),
    "window": Shape(Vector, [1280.0, 800.0], lambda size: min(size) > 0.0),
    "say": Shape(str, "Press Space."),
    "answer": Shape(Any, "Tension"),
    "clipboard": Shape(str, ""),
    "at": Shape(int, 128),
    "within": Shape(float, 0.5),
}


def perform(session: Session, entry: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Do what one line says; yields (expected, got) of a failed expectation. Raises ValueError."""
    check_shapes(entry, _SHAPES)
    rest = dict(entry)
    if "window" in rest:
        width, height = rest.pop("window")
        session.resize(int(width), int(height))
        session.view.fit(session.model)
    if "at" in rest or "within" in rest:
        moment = rest.pop("at", session.simulation.moment[0]), rest.pop("within", None)
        if moment != session.simulation.moment:
            with session.running() as simulation:
                simulation.go_to(*moment)
    if "over" in rest:
        session.point(*rest.pop("over"))
    if "clipboard" in rest:
        session.clipboard = rest.pop("clipboard")
    button, pixel = rest.pop("button", "click"), rest.pop("pixel", None)
    if len(rest) > 1:
        raise WrongValue(
            "a line can do one thing only, but this one has {keys}; write several lines.",
            keys=", ".join(map(cut, rest)),
        )
    for verb, value in rest.items():
        if verb == "expect":
            yield from check(session, value)
        elif verb == "input":
            session.update_view()  # a person acts on what a frame has shown
            if pixel and value != "drag middle":  # of which it is how far
                session.view.pointer = tuple(pixel)
            session.press(value, tuple(pixel) if pixel else None)
        elif verb in ("click", "drag"):
            _VERBS[verb](session, (*value, button))
        else:
            _VERBS[verb](session, value)


def _answer(session: Session, value: Any) -> None:
    """Answer the task of a lesson: names of elements to select, a number, or the text of a choice."""
    if session.course is None:
        raise WrongValue("There is no lesson to answer; begin one from the start page.")
    session.course.answer(value)


_VERBS: dict[str, Callable[[Session, Any], Any]] = {
    "press": lambda session, key: session.press(key),
    "click": lambda session, value: session.click(*value),
    "drag": lambda session, value: session.drag(tuple(value[0]), tuple(value[1]), value[2]),
    "type": lambda session, text: session.type(text),
    "box": lambda session, title: session.click_box(title),
    "set": lambda session, text: apply_override(session.model, text),
    "action": lambda session, name: session.act(name),
    "divide": lambda session, value: session.divide(*value),
    "run": lambda session, time: session.run(until="rest") if time == "rest" else session.run(time=time),
    "steps": lambda session, count: session.run(steps=count),
    "say": lambda session, text: None,
    "answer": _answer,
    "resize": lambda session, size: session.resize(int(size[0]), int(size[1]), float(size[2])),
}
