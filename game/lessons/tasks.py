"""Tasks of a lesson, as a script says them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NoReturn

from pinjoint.components.language import tr
from pinjoint.components.mistake import WrongValue
from pinjoint.scripts.expectation import OVER_ALL
from pinjoint.scripts.lines import Shape, check_shapes
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
    is judged. then: lines performed when it is done. within: of a number, the share by which an answer may differ.
    score: a path to make as small as possible.
    """

    line: int
    text: str
    model: Any
    setup: tuple[Line, ...]
    kind: str
    asked: tuple[str, ...]
    choices: tuple[Choice, ...]
    after: tuple[Line, ...]
    then: tuple[Line, ...]
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


_CONDITION = "rods.CD.axial_force < 100"
_LINES = [{"press": "e"}]
_CONDITIONS, _OBJECTS = str | list[str], list[dict[str, Any]]
_KEYS = {
    "task": Shape(str, "Make CD carry less than 100 kN."),
    "model": Shape(str | dict[str, Any], "isostatic"),
    UNTIL: Shape(_CONDITIONS, _CONDITION, bool),
    SELECT: Shape(str, "rods.*.axial_force = 0 ± 0.01"),
    NUMBER: Shape(str, "rods.CD.axial_force"),
    CHOICES: Shape(_OBJECTS, [{"text": "Tension", "if": "rods.CD.axial_force > 0"}]),
    "after": Shape(_OBJECTS, _LINES),
    "then": Shape(_OBJECTS, [{"press": "space"}]),
    "within": Shape(float, 0.01, lambda share: 0.0 <= share < 1.0),
    "hints": Shape(list[str], ["Look at joint C."]),
    "right": Shape(str, "Joint C has no load, so CD carries nothing."),
    "wrong": Shape(_OBJECTS, [{"if": "statics.mechanisms > 0", "say": "That leaves a mechanism."}]),
    "solution": Shape(_OBJECTS, _LINES),
    "score": Shape(str, "sum rods.*.original_length"),
}
_OF_CHOICE = {
    "text": Shape(str, "Tension"),
    "if": Shape(_CONDITIONS, _CONDITION, bool),
    "right": Shape(bool, True),
    "say": Shape(str, "A compressed rod gets shorter."),
}
_OF_WRONG = {
    "if": Shape(_CONDITIONS, _CONDITION, bool),
    "say": Shape(str, "That leaves a mechanism."),
    "lines": Shape(_OBJECTS, _LINES),
}


class Lesson:
    """The tasks of a script, in order. Raises ScriptError, which names the line, the key and the remedy."""

    def __init__(self, script: Script) -> None:
        self.script = script
        self.title, self.description = script.title, script.description
        self.tasks = tuple(self._tasks())
        if not self.tasks:
            raise ScriptError("{file}: a lesson needs a line with a task.", file=script.path)

    @property
    def name(self) -> str:
        """By which progress is kept."""
        return self.script.name

    def _tasks(self) -> Iterator[Task]:
        """All tasks; lines between them belong to the next one."""
        setup: list[Line] = []
        model: Any = self.script.source
        for number, entry in self.script.lines[1:]:
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
            model=self.script.beside(model) if isinstance(model, str) else model,
            setup=setup,
            kind=kinds[0],
            asked=() if kinds[0] == CHOICES else _listed(entry[kinds[0]]),
            choices=tuple(self._choice(line, choice) for choice in entry.get(CHOICES, ())),
            after=tuple((line, said) for said in entry.get("after", ())),
            then=tuple((line, said) for said in entry.get("then", ())),
            within=float(entry.get("within", 0.01)),
            hints=tuple(entry.get("hints", ())),
            right=entry["right"],
            wrong=tuple(self._wrong(line, wrong) for wrong in entry.get("wrong", ())),
            solution=tuple((line, said) for said in entry["solution"]),
            score=entry.get("score", ""),
        )

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
        lines = tuple((line, said) for said in entry.get("lines", ()))
        return Wrong(_listed(entry["if"]), entry["say"], lines)

    def _check(self, line: int, entry: Mapping[str, Any], shapes: Mapping[str, Shape]) -> None:
        try:
            check_shapes(entry, shapes)
        except WrongValue as error:
            self._fail(line, str(error))

    def _fail(self, line: int, reason: str) -> NoReturn:
        raise self.script.error(line, reason)


def _listed(value: str | list[str]) -> tuple[str, ...]:
    return (value,) if isinstance(value, str) else tuple(value)
