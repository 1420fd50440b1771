"""Tasks of a lesson, as a script says them."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

from pinjoint.components.language import tr
from pinjoint.components.suggestions import remedy
from pinjoint.components.wording import as_json, cut
from pinjoint.scripts.expectation import OVER_ALL
from pinjoint.scripts.script import Script, ScriptError

Line = tuple[int, Mapping[str, Any]]  # of a script: its number, and what it says

UNTIL, SELECT, NUMBER, CHOICES = KINDS = "until", "select", "number", "choices"


@dataclass(frozen=True)
class Choice:
    """A possible answer. right: whether it is, or conditions that decide it. say: why not, if it is wrong."""

    text: str
    right: bool | tuple[str, ...]
    say: str = ""


@dataclass(frozen=True)
class Wrong:
    """What is said of a wrong state or answer: the first whose conditions hold. lines: a way there, for checking."""

    conditions: tuple[str, ...]
    say: str
    lines: tuple[Line, ...] = ()


@dataclass(frozen=True)
class Task:
    """What a student is to do.

    line: its number in the file. model: what it begins with; None: how the task before ended. setup: lines that are
    performed then. kind: one of KINDS, and `asked`, its conditions or the path. after: lines performed in a copy before it
    is judged. within: of a number, the share by which an answer may differ. score: a path to make as small as possible.
    """

    line: int
    text: str
    model: Any
    setup: tuple[Line, ...]
    kind: str
    asked: tuple[str, ...]
    choices: tuple[Choice, ...]
    after: tuple[Line, ...]
    within: float
    hints: tuple[str, ...]
    right: str
    wrong: tuple[Wrong, ...]
    solution: tuple[Line, ...]
    score: str

    @property
    def table(self) -> str:
        """The table of the elements to be selected, such as "rods"."""
        word, _, of_all = self.asked[0].partition(" ")
        return (of_all if word in OVER_ALL else self.asked[0]).strip().partition(".")[0]


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


def _are_texts(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(text, str) for text in value)


def _are_conditions(value: Any) -> bool:
    return _is_text(value) or (_are_texts(value) and len(value) > 0)


def _are_objects(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(entry, dict) for entry in value)


def _is_share(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and 0.0 <= value < 1.0


_Shapes = Mapping[str, tuple[Callable[[Any], bool], Any]]  # by key: whether a value fits, and one that does
_CONDITION = "rods.CD.axial_force < 100"
_LINES = [{"press": "e"}]
_KEYS: _Shapes = {
    "task": (_is_text, "Make CD carry less than 100 kN."),
    "model": (lambda value: isinstance(value, str | dict), "isostatic"),
    UNTIL: (_are_conditions, _CONDITION),
    SELECT: (_is_text, "rods.*.axial_force = 0 ± 0.01"),
    NUMBER: (_is_text, "rods.CD.axial_force"),
    CHOICES: (_are_objects, [{"text": "Tension", "if": "rods.CD.axial_force > 0"}]),
    "after": (_are_objects, _LINES),
    "within": (_is_share, 0.01),
    "hints": (_are_texts, ["Look at joint C."]),
    "right": (_is_text, "Joint C has no load, so CD carries nothing."),
    "wrong": (_are_objects, [{"if": "statics.mechanisms > 0", "say": "That leaves a mechanism."}]),
    "solution": (_are_objects, _LINES),
    "score": (_is_text, "sum rods.*.original_length"),
}
_OF_CHOICE: _Shapes = {
    "text": (_is_text, "Tension"),
    "if": (_are_conditions, _CONDITION),
    "right": (lambda value: isinstance(value, bool), True),
    "say": (_is_text, "A compressed rod gets shorter."),
}
_OF_WRONG: _Shapes = {
    "if": (_are_conditions, _CONDITION),
    "say": (_is_text, "That leaves a mechanism."),
    "lines": (_are_objects, _LINES),
}


class Lesson:
    """The tasks of a script, in order. Raises ScriptError, which names the line, the key and the remedy."""

    def __init__(self, script: Script) -> None:
        self.script = script
        self.title, self.description = script.title, script.description
        self.tasks = tuple(_Reader(script).tasks())
        if not self.tasks:
            raise ScriptError("{file}: a lesson needs a line with a task.", file=script.path)

    @property
    def name(self) -> str:
        """By which progress is kept."""
        return self.script.name


class _Reader:
    """Reads the lines of a script from the second on."""

    def __init__(self, script: Script) -> None:
        self._script = script

    def tasks(self) -> Iterator[Task]:
        """All tasks; lines between them belong to the next one."""
        setup: list[Line] = []
        model: Any = self._script.source
        for number, entry in self._script.lines[1:]:
            if "task" not in entry:
                setup.append((number, entry))
                continue
            yield self._task(number, entry, entry.get("model", model), tuple(setup))
            setup, model = [], None
        if setup:
            self._fail(setup[0][0], tr("no task follows this line; put it before a task, or remove it."))

    def _task(self, line: int, entry: Mapping[str, Any], model: Any, setup: tuple[Line, ...]) -> Task:
        self._check(line, entry, _KEYS)
        kinds = [kind for kind in KINDS if kind in entry]
        if len(kinds) != 1:
            known, asked = ", ".join(KINDS), ", ".join(kinds)
            if not kinds:
                self._fail(line, tr("a task asks for one of {kinds}; this one asks for nothing.", kinds=known))
            said = tr("a task asks for one of {kinds}; this one has {asked}.", kinds=known, asked=asked)
            self._fail(line, said)
        for key in ("right", "solution"):
            if key not in entry:
                self._fail(line, tr("'{key}' is missing; every task needs it.", key=key))
        return Task(
            line=line,
            text=entry["task"],
            model=self._beside(model),
            setup=setup,
            kind=kinds[0],
            asked=() if kinds[0] == CHOICES else _listed(entry[kinds[0]]),
            choices=tuple(self._choice(line, choice) for choice in entry.get(CHOICES, ())),
            after=self._lines(line, entry.get("after", ())),
            within=float(entry.get("within", 0.01)),
            hints=tuple(entry.get("hints", ())),
            right=entry["right"],
            wrong=tuple(self._wrong(line, wrong) for wrong in entry.get("wrong", ())),
            solution=self._lines(line, entry["solution"]),
            score=entry.get("score", ""),
        )

    def _beside(self, model: Any) -> Any:
        """A model by its name, or a file beside the script."""
        return self._script.beside(model) if isinstance(model, str) else model

    def _choice(self, line: int, entry: Mapping[str, Any]) -> Choice:
        self._check(line, entry, _OF_CHOICE)
        if "text" not in entry or ("if" in entry) == ("right" in entry):
            self._fail(line, tr('a choice needs "text", and either "if" or "right".'))
        right = entry["right"] if "right" in entry else _listed(entry["if"])
        return Choice(entry["text"], right, entry.get("say", ""))

    def _wrong(self, line: int, entry: Mapping[str, Any]) -> Wrong:
        self._check(line, entry, _OF_WRONG)
        if not {"if", "say"} <= set(entry):
            self._fail(line, tr('a wrong answer needs "if" and "say".'))
        return Wrong(_listed(entry["if"]), entry["say"], self._lines(line, entry.get("lines", ())))

    def _lines(self, line: int, entries: Sequence[Mapping[str, Any]]) -> tuple[Line, ...]:
        return tuple((line, entry) for entry in entries)

    def _check(self, line: int, entry: Mapping[str, Any], shapes: _Shapes) -> None:
        for key, value in entry.items():
            if key not in shapes:
                said = tr("there is no key '{key}' here; {remedy}", key=cut(key), remedy=remedy(key, shapes))
                self._fail(line, said)
            fits, example = shapes[key]
            if not fits(value):
                said = tr(
                    "{key} is {value}; write it like {form}.",
                    key=key,
                    value=as_json(value),
                    form=json.dumps({key: example}),
                )
                self._fail(line, said)

    def _fail(self, line: int, reason: str) -> NoReturn:
        raise self._script.error(line, reason)


def _listed(value: str | list[str]) -> tuple[str, ...]:
    return (value,) if isinstance(value, str) else tuple(value)
