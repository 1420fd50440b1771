"""Scripted sessions: JSON lines that play a session through the real scenes and keys, and record one.

The first line is a header, {"format": "pinjoint session", "version": 1, "model": "isostatic"} (a bundled
name, a path relative to the script, or a whole document; left out: an empty model), perhaps with a "title" and
a "description". Every further line does one thing:

    {"press": "space"}                          a key; "over": [x, y] first moves the pointer there (m)
    {"click": [1.0, 1.0]}                       at a point of the model (m); "button": "ctrl+click"
    {"drag": [[0, 0], [1, 1]]}                  between points of the model (m); "button"
    {"type": "200000"}   {"box": "stiffness"}   typing, and selecting a box by its title
    {"set": "particles.B.force=120,-160"}       as --set of the command line
    {"action": "undo"}                          a named action
    {"run": "rest"}   {"run": 0.5}              until at rest; or by seconds
    {"steps": 128}                              by fixed steps
    {"expect": "rods.AB.axial_force ≈ -28.34 ± 0.01"}   also =, <, >, <=, >=; scene, time, count.rods, energy.…
    {"expect": "clock.collisions = 3"}          how many impacts there were
    {"expect": "message ≈ not found"}           what the window tells; of a text, ≈ asks for a part
    {"input": "click", "pixel": [512, 300]}     what a window recorded
    {"resize": [1280, 800, 2]}                  the window's pixels, and pixels per point
    {"say": "Press Space."}                     told to who watches it in a window; else nothing

"clipboard" says what was on the clipboard then.

"at": N on a line first lets time pass to the N-th fixed step, as it had in a recording; "window":
[width, height] sets the size of the view in pixels. Replaying gives the same bits.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

from components.field import Vector
from components.spelling import remedy
from game.documents.document import ModelError
from game.paths import apply_override
from game.scripts.expectation import check

if TYPE_CHECKING:
    from game.session import Session

HEADER = {"format": "pinjoint session", "version": 1}
_HEADER_KEYS = (*HEADER, "model", "title", "description")
EMPTY = {"format": "pinjoint model", "version": 1}


class ScriptError(ValueError):
    """A script that cannot be played; the message names the line, the reason and the remedy."""


@dataclass(frozen=True)
class Failure:
    """An expectation that did not hold."""

    line: int
    expected: str
    got: Any

    def __str__(self) -> str:
        return f"line {self.line}: expected {self.expected}, got {self.got}"


def lessons() -> list[str]:
    """Names of the scripts that come with the program, in the order in which they are to be seen."""
    names = sorted(entry.name for entry in files("assets").joinpath("lessons").iterdir())
    return [name.removesuffix(".jsonl") for name in names if name.endswith(".jsonl")]


def _found(source: str | Path) -> Path | Traversable:
    """The lesson of that name, or else a file."""
    if isinstance(source, str) and source in lessons():
        return files("assets").joinpath("lessons", f"{source}.jsonl")
    return Path(source)


class Script:
    """A script read from a file, or a lesson by its name, ready to be played in a session.

    title, description: what its header says of it, or "". has_data: whoever plays it chose a folder in which it
    saves and loads; else it must be kept away from what the person saved.
    """

    has_data = False

    def __init__(self, source: str | Path) -> None:
        self.path = _found(source)
        self.lines = list(self._read())
        if not self.lines or self.lines[0][1].get("format") != HEADER["format"]:
            raise ScriptError(
                f"{source}: its first line must be like {json.dumps({**HEADER, 'model': 'isostatic'})}."
            )
        if self.lines[0][1].get("version") != HEADER["version"]:
            raise ScriptError(
                f"{source}: version {self.lines[0][1].get('version')} is not known; update Pinjoint."
            )
        for key, value in self.lines[0][1].items():
            if key not in _HEADER_KEYS:
                raise ScriptError(
                    f"{source} line 1: there is no '{key}'; use one of {', '.join(_HEADER_KEYS)}."
                )
            if key == "model" and not isinstance(value, str | dict):
                raise ScriptError(f"{source} line 1: model is {json.dumps(value)}; write a name or a document.")
        self.title, self.description = (str(self.lines[0][1].get(key, "")) for key in ("title", "description"))

    def _read(self) -> Iterator[tuple[int, dict[str, Any]]]:
        try:
            text = self.path.read_text(encoding="utf-8-sig")
        except FileNotFoundError:
            reason = f"There is no file and no lesson '{self.path}'; {remedy(str(self.path), lessons())}"
            raise ScriptError(reason) from None
        except OSError as error:
            raise ScriptError(f"{self.path} cannot be read: {error.strerror}. Check its path.") from None
        except UnicodeDecodeError as error:
            raise ScriptError(f"{self.path} is no script in UTF-8: {error}.") from None
        for number, line in enumerate(text.splitlines(), start=1):
            if not line.strip() or line.lstrip().startswith("#"):
                continue
            try:
                entry = json.loads(line)
            except json.JSONDecodeError as error:
                raise ScriptError(f"{self.path} line {number}: this is not JSON ({error.msg}).") from None
            if not isinstance(entry, dict):
                raise ScriptError(f'{self.path} line {number}: write an object, such as {{"press": "space"}}.')
            yield number, entry

    @property
    def source(self) -> Any:
        """What the header names as the model to begin with."""
        source = self.lines[0][1].get("model", EMPTY)
        beside = self.path.parent / source if isinstance(self.path, Path) and isinstance(source, str) else None
        return beside if beside is not None and beside.is_file() else source

    def open(self) -> Session:
        """The session that the header asks for. Raises ScriptError."""
        from game.session import Session  # whose scenes know scripts

        try:
            return Session.open(self.source)
        except ModelError as error:
            raise ScriptError(f"{self.path} line {self.lines[0][0]}: {error}") from None

    def play(self, session: Session) -> list[Failure]:
        """Play all lines; returns the expectations that did not hold. Raises ScriptError."""
        return [failure for number, entry in self.lines[1:] for failure in self.perform(session, number, entry)]

    def perform(self, session: Session, number: int, entry: Mapping[str, Any]) -> list[Failure]:
        """Do what one of the lines says; returns the expectations that did not hold. Raises ScriptError."""
        try:
            return [Failure(number, *wrong) for wrong in perform(session, entry)]
        except (ValueError, LookupError, TypeError) as error:
            reason = error.args[0] if error.args else error
            raise ScriptError(f"{self.path} line {number}: {reason}") from error


_EXAMPLES: dict[str, Any] = {  # of what a line may say: the shape that each value has
    "press": "space",
    "over": [1.0, 1.0],
    "click": [1.0, 1.0],
    "drag": [[0.0, 0.0], [1.0, 1.0]],
    "button": "ctrl+click",
    "type": "200000",
    "box": "stiffness",
    "set": "particles.B.force=120,-160",
    "action": "undo",
    "run": 0.5,
    "steps": 128,
    "expect": "scene = pause",
    "input": "click",
    "pixel": [512.0, 300.0],
    "resize": [1280.0, 800.0, 1.0],
    "window": [1280.0, 800.0],
    "say": "Press Space.",
    "clipboard": "",
    "at": 128,
}
_SIZES = ("resize", "window")


def _check_line(entry: Mapping[str, Any]) -> None:
    """Raise ValueError unless every key is known and every value has the shape of its example."""
    for key, value in entry.items():
        if key not in _EXAMPLES:
            raise ValueError(f"there is no '{key}'; use one of {', '.join(_EXAMPLES)}.")
        example = _EXAMPLES[key]
        fits = _is_like(value, example) and not (key in _SIZES and min(value) <= 0)
        if not fits and (key, value) != ("run", "rest"):
            raise ValueError(f"{key} is {json.dumps(value)}; write it like {json.dumps({key: example})}.")


def _is_like(value: Any, example: Any) -> bool:
    if isinstance(example, list):
        alike = isinstance(value, list) and len(value) == len(example)
        return alike and all(map(_is_like, value, example))
    if isinstance(example, float):
        return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    return isinstance(value, type(example)) and not isinstance(value, bool)


def perform(session: Session, entry: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Do what one line says; yields (expected, got) if it expects something that is not so. Raises ValueError."""
    _check_line(entry)
    rest = dict(entry)
    if "window" in rest:
        width, height = rest.pop("window")
        session.resize(int(width), int(height))
        session.view.fit(session.model)
    if "at" in rest:
        _advance_to(session, rest.pop("at"))
    if "over" in rest:
        session.point(*rest.pop("over"))
    if "clipboard" in rest:
        session.clipboard = rest.pop("clipboard")
    button, pixel = rest.pop("button", "click"), rest.pop("pixel", None)
    if len(rest) > 1:
        raise ValueError(f"a line does one thing, this one says {', '.join(rest)}; split it.")
    for verb, value in rest.items():
        if verb == "expect":
            yield from check(session, value)
        elif verb == "input":
            session.press(value, tuple(pixel) if pixel else None)
        elif verb in ("click", "drag"):
            _VERBS[verb](session, (*value, button))
        else:
            _VERBS[verb](session, value)


def _run(session: Session, value: Any) -> None:
    if value == "rest":
        session.run(until="rest")
    else:
        session.run(time=value)


_VERBS: dict[str, Callable[[Session, Any], Any]] = {
    "press": lambda session, key: session.press(key),
    "click": lambda session, value: session.click(*value),
    "drag": lambda session, value: session.drag(tuple(value[0]), tuple(value[1]), value[2]),
    "type": lambda session, text: session.type(text),
    "box": lambda session, title: session.click_box(title),
    "set": lambda session, text: apply_override(session.model, text),
    "action": lambda session, name: session.act(name),
    "run": _run,
    "steps": lambda session, count: session.run(steps=count),
    "say": lambda session, text: None,
    "resize": lambda session, size: session.resize(int(size[0]), int(size[1]), float(size[2])),
}


def _advance_to(session: Session, steps: int) -> None:
    left = steps - session.model.clock.steps
    if left > 0:
        session.run(steps=left)


# --- recording -------------------------------------------------------------------------------------------


class Recorder:
    """Writes what a person does in a window, line by line, so that it can be played again."""

    def __init__(self, session: Session, file: TextIO, model: Any) -> None:
        self._file = file
        self._session = session
        self._write({**HEADER, "model": model})
        self._resized()
        self._write({"action": "fit"})
        session.on_press, session.on_resize = self._pressed, self._resized

    def _resized(self) -> None:
        view = self._session.view
        window = view.camera.viewport
        size = [window.width, window.height, view.pixel_ratio]
        self._write({"at": self._session.model.clock.steps, "resize": size})

    def _pressed(self, key: str, pixel: Vector | None) -> None:
        entry: dict[str, Any] = {"at": self._session.model.clock.steps, "input": key}
        if pixel is not None:
            entry["pixel"] = list(pixel)
        if key == "ctrl+v":  # what comes from another program is not there when this is played
            entry["clipboard"] = self._session.clipboard
        self._write(entry)

    def _write(self, entry: Mapping[str, Any]) -> None:
        self._file.write(json.dumps(entry, ensure_ascii=False) + "\n")
        self._file.flush()
