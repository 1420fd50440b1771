"""Playing: the lines of a script performed in a session; and recording, which writes such lines."""

from __future__ import annotations

import json
import logging
import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, TextIO

from components.field import Vector
from components.language import ENGLISH, joined, language, spoken, tr
from components.wording import as_json, cut, is_broken
from game.documents.format import ModelError
from game.editor.context import FAULTS
from game.mods.loading import MODS
from game.mods.mod import INCLUDED, ModError
from game.paths import apply_override
from game.scripts.expectation import check
from game.scripts.script import HEADER, Script, ScriptError
from game.session import Session

LOG = logging.getLogger("pinjoint.recording")


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


def session_of(script: Script) -> Session:
    """The session that the header of a script asks for; its notice says what differs. Raises ScriptError."""
    different = check_mods(script)
    try:
        session = Session.open(script.source)
    except ModelError as error:
        raise ScriptError(
            tr("{file} line {line}: {error}", file=script.path, line=script.lines[0][0], error=error)
        ) from None
    session.notice = joined((session.notice, different))
    return session


def check_mods(script: Script) -> str:
    """How the mods that are loaded differ from those that a script was recorded with, as a sentence; "" if they don't.

    Raises ScriptError if one is missing.
    """
    if script.mods is None:
        return ""
    here = _loaded_mods()
    if missing := [f"{name} {version}" for name, version in script.mods.items() if name not in here]:
        raise ScriptError(
            tr(
                "{file} was recorded with mods that are not loaded: {mods}. Name their folder: --mods FOLDER.",
                file=script.path,
                mods=", ".join(missing),
            )
        )
    others = [f"{name} {version}" for name, version in here.items() if version != script.mods.get(name)]
    if not others:
        return ""
    return tr(
        "{file} was recorded without the mods {mods} that are loaded now, so it may run differently.",
        file=script.path,
        mods=", ".join(others),
    )


def _loaded_mods() -> dict[str, str]:
    """Versions of the mods that act now, those that come with the program apart, by name."""
    return {mod.name: mod.version for mod in MODS if mod.loaded and not mod.off and mod.source != INCLUDED}


def play(script: Script, session: Session | None = None) -> list[Failure]:
    """Play all lines in a session (None: that of the header); returns failed expectations. Raises ScriptError."""
    session = session or session_of(script)
    with spoken(script.language or language()):
        return [
            failure
            for number, entry in script.lines[1:]
            for failure in play_line(script, number, entry, session)
        ]


def play_line(script: Script, number: int, entry: Mapping[str, Any], session: Session) -> list[Failure]:
    """Do what one line of a script says; returns the expectations that did not hold. Raises ScriptError.

    One of every line is that no mod fails.
    """
    known, failures = len(FAULTS), list[Failure]()
    try:
        failures += [Failure(number, *wrong) for wrong in perform(session, entry)]
    except ModError:
        pass  # it is among FAULTS
    except (ValueError, LookupError, TypeError) as error:
        reason = error.args[0] if error.args else error
        raise ScriptError(
            tr("{file} line {line}: {error}", file=script.path, line=number, error=reason)
        ) from error
    return failures + [Failure(number, tr("mods that work"), fault) for fault in FAULTS[known:]]


_EXAMPLES: dict[str, Any] = {  # by key of a line: a value of the required shape
    "press": "space",
    "over": [1.0, 1.0],
    "click": [1.0, 1.0],
    "drag": [[0.0, 0.0], [1.0, 1.0]],
    "button": "ctrl+click",
    "type": "200000",
    "box": "stiffness",
    "set": "particles.B.force=120,-160",
    "action": "undo",
    "divide": ["AB", 4],
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
    "within": 0.5,
}
_SIZES = ("resize", "window")


def _check_line(entry: Mapping[str, Any]) -> None:
    """Raise ValueError unless every key is known and every value has the shape of its example."""
    for key, value in entry.items():
        if key not in _EXAMPLES:
            raise ValueError(
                tr("there is no '{key}'; use one of {keys}.", key=cut(key), keys=", ".join(_EXAMPLES))
            )
        example = _EXAMPLES[key]
        fits = _is_like(value, example) and not (key in _SIZES and min(value) <= 0)
        if not fits and (key, value) != ("run", "rest"):
            raise ValueError(
                tr(
                    "{key} is {value}; write it like {form}.",
                    key=key,
                    value=as_json(value),
                    form=json.dumps({key: example}),
                )
            )


def _is_like(value: Any, example: Any) -> bool:
    if isinstance(example, list):
        alike = isinstance(value, list) and len(value) == len(example)
        return alike and all(map(_is_like, value, example))
    if isinstance(example, float):
        return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    return isinstance(value, type(example)) and not isinstance(value, bool)


def perform(session: Session, entry: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Do what one line says; yields (expected, got) of a failed expectation. Raises ValueError."""
    _check_line(entry)
    rest = dict(entry)
    if "window" in rest:
        width, height = rest.pop("window")
        session.resize(int(width), int(height))
        session.view.fit(session.model)
    if "at" in rest or "within" in rest:
        session.go_to(rest.pop("at", session.simulation.moment[0]), rest.pop("within", None))
    if "over" in rest:
        session.point(*rest.pop("over"))
    if "clipboard" in rest:
        session.clipboard = rest.pop("clipboard")
    button, pixel = rest.pop("button", "click"), rest.pop("pixel", None)
    if len(rest) > 1:
        raise ValueError(
            tr(
                "a line can do one thing only, but this one has {keys}; write several lines.",
                keys=", ".join(map(cut, rest)),
            )
        )
    for verb, value in rest.items():
        if verb == "expect":
            yield from check(session, value)
        elif verb == "input":
            session.press(value, tuple(pixel) if pixel else None)
        elif verb in ("click", "drag"):
            _VERBS[verb](session, (*value, button))
        else:
            _VERBS[verb](session, value)


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
    "resize": lambda session, size: session.resize(int(size[0]), int(size[1]), float(size[2])),
}


# --- recording -------------------------------------------------------------------------------------------


class Recorder:
    """Writes what a person does in a window as lines of a script; where that becomes impossible, it ends and says so."""

    def __init__(self, session: Session, file: TextIO, model: Any) -> None:
        self._file = file
        self._session = session
        session.on_press, session.on_resize = self._pressed, self._resized
        spoken = {"language": language()} if language() != ENGLISH else {}
        self._write({**HEADER, "model": model, "mods": _loaded_mods(), **spoken})
        self._resized()
        self._write({"action": "fit"})

    def _resized(self) -> None:
        view = self._session.view
        window = view.camera.viewport
        size = [window.width, window.height, view.pixel_ratio]
        self._write({**self._now, "resize": size})

    @property
    def _now(self) -> dict[str, Any]:
        """When, as the keys of a line."""
        steps, within = self._session.simulation.moment
        return {"at": steps} if within is None else {"at": steps, "within": within}

    def _pressed(self, key: str, pixel: Vector | None) -> None:
        entry: dict[str, Any] = {**self._now, "input": key}
        if pixel is not None:
            entry["pixel"] = list(pixel)
        if key == "ctrl+v":  # a text from another program will not be there when the script is played
            entry["clipboard"] = self._session.clipboard
        self._write(entry)

    def _write(self, entry: Mapping[str, Any]) -> None:
        if self._file.closed:
            return
        line = json.dumps(entry, ensure_ascii=False)
        try:
            self._file.write((json.dumps(entry) if is_broken(line) else line) + "\n")
            self._file.flush()
        except OSError as error:
            with suppress(OSError):
                self._file.close()  # else its end would try again
            self._session.on_press = self._session.on_resize = None
            said = tr(
                "The recording ends here: {file} cannot be written: {reason}.",
                file=self._file.name,
                reason=error.strerror,
            )
            self._session.notice = said
            LOG.warning(said)
