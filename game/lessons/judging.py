"""Judging: whether a task is done, found with the engine, and what to say to that."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np

from pinjoint.components import written
from pinjoint.components.handle import Handle
from pinjoint.components.language import begun, decimals, joined, listed, marked, tr
from pinjoint.components.mistake import NotFound, WrongValue
from pinjoint.components.settings import STATICS
from pinjoint.documents.document import document
from pinjoint.lessons.tasks import CHOICES, NUMBER, SELECT, UNTIL, Line, Task
from pinjoint.paths import PathError, locate, quantity, readable
from pinjoint.scripts.expectation import OVER_ALL, check, compared, each, parts_of, read
from pinjoint.scripts.lines import Failure, perform

Session = Any  # pinjoint.session.Session, which holds the lesson
Document = Mapping[str, Any]
Answer = str | float | tuple[str, ...] | None  # text of a choice; number; names of elements; not given yet

LEAST = 1e-9  # by which an answer may differ from 0
_PLACE = re.compile(r"\{([^{}:]+)(?::([^{}]*))?\}")  # in a text: a path, and perhaps a format
_RELATIONS = {
    "<": marked("wanted: less than {value}"),
    "<=": marked("wanted: {value} at most"),
    ">": marked("wanted: more than {value}"),
    ">=": marked("wanted: {value} at least"),
    "=": marked("wanted: {value}"),
    "≈": marked("wanted: {value}"),
    "~": marked("wanted: {value}"),
}
_SAID: dict[str, Mapping[bool, str]] = {  # of a state, by a path and whether it is more than 0 there
    "statics.equilibrium": {
        False: marked(
            "It is not in equilibrium yet: press E to find equilibrium, or Space to let it run until it rests."
        ),
        True: marked("It is in equilibrium."),
    },
    "statics.mechanisms": {
        False: marked("It is stable: nothing can move without a rod getting longer or shorter."),
        True: marked("It is a mechanism: parts can move without any rod getting longer. B shows how."),
    },
}
_NAMES = {
    "statics.degree": marked("The degree of static indeterminacy"),
    "statics.frequency": marked("The lowest natural frequency (Hz)"),
    "statics.buckling": marked("The lowest buckling load factor"),
    "statics.first_yield": marked("The load factor at first yield"),
    "statics.collapse": marked("The collapse load factor"),
    "statics.width": marked("The width of the structure (m)"),
    "count.particles": marked("The number of particles"),
    "count.rods": marked("The number of rods"),
    "count.loads": marked("The number of loads"),
    "time": marked("The time (s)"),
    "clock.collisions": marked("The number of collisions"),
}
_OVER_ALL = {
    "max": marked("The greatest {what}"),
    "min": marked("The least {what}"),
    "sum": marked("The sum of {what}"),
    "largest": marked("The largest {what}, whatever its sign,"),
}


class Verdict(NamedTuple):
    """Whether a task is done, and what is said of it. score: of one that has one, and as it is written."""

    right: bool
    said: str
    score: tuple[float, str] | None = None


def judge(session: Session, task: Task, beginning: Document, answer: Answer = None) -> Verdict:
    """Whether a task is done in a session, in which it began with a model. Raises ValueError, LookupError."""
    truth = session
    if task.kind == UNTIL:
        left = session.settings.opens_in == STATICS and session.model.solution is None
        if task.after or left:
            truth = copy_of(session, document(session.model), task.after)
        failed = next((text for text in task.asked if not holds(truth, text)), None)
        wrong = "" if failed is None else _explained(task, truth) or _lacking(truth, failed)
    elif answer is None or answer == ():
        wrong = tr(_NOTHING[task.kind])
    else:
        truth = copy_of(session, beginning, task.after)
        if isinstance(answer, tuple):
            wrong = _wrong_selection(truth, task, answer)
        elif isinstance(answer, str):
            wrong = _wrong_choice(truth, task, answer)
        else:
            wrong = _wrong_number(truth, task, answer)
    if wrong:
        return Verdict(False, wrong)
    scored = task.score if task.kind == UNTIL else ""
    score = (float(read(truth, scored)), shown(truth, scored)) if scored else None
    return Verdict(True, filled(task.right, truth), score)


_NOTHING = {  # what is said while there is no answer
    SELECT: marked("Nothing is selected: click an element; Ctrl+click adds another. Then check."),
    NUMBER: marked("Type a number first. Then check."),
    CHOICES: marked("Choose an answer first. Then check."),
}


def copy_of(session: Session, model: Document, lines: Iterable[Line]) -> Session:
    """A session of its own in which lines were performed, from the same model."""
    copy = type(session).open(model)
    copy.scenes.begin(copy)
    for number, entry in lines:
        for expected, got in perform(copy, entry):
            raise ValueError(str(Failure(number, expected, got)))
    return copy


def holds(session: Session, condition: str, answer: float | None = None) -> bool:
    """True if a condition holds, of the session or of the number that was typed. Raises ValueError, LookupError."""
    path, relation, value, slack = parts_of(condition)
    if path == "answer":
        return answer is not None and compared(answer, relation, value, slack)
    return not list(check(session, condition))


# --- what is wrong with an answer; "" if it is right -----------------------------------------------------------


def _wrong_selection(truth: Session, task: Task, answer: tuple[str, ...]) -> str:
    right, values = _asked_for(truth, task.asked[0])
    chosen = [handle for handle in values if named(handle) in answer]
    wrong = next((handle for handle in chosen if handle not in right), None)
    others = set(answer) - {named(handle) for handle in values}
    if wrong is not None:
        said = tr(
            "{what} does not belong: {value}.", what=begun(truth.model.describe(wrong)), value=values[wrong]
        )
        return joined([_explained(task, truth), said])
    if others or not chosen:
        kind = next(iter(values)).world.tables[next(iter(values)).table].name if values else ""
        return tr("Select only {kind}, not {names}.", kind=tr(kind), names=listed(sorted(others)))
    missing = len(right) - len(chosen)
    return tr("Right so far, but not all: {count} more to find.", count=missing) if missing else ""


def _wrong_number(truth: Session, task: Task, answer: float) -> str:
    wanted, given = _shown_number(truth, task.asked[0]), written.given(answer)
    if abs(answer - wanted) <= max(task.within * abs(wanted), LEAST):
        return ""
    if said := _explained(task, truth, answer):
        return said
    if wanted and abs(answer + wanted) <= task.within * abs(wanted):
        return tr("The size is right, but not the sign.")
    if answer * wanted < 0.0:
        return tr("Neither the sign nor the size is right yet.")
    said = tr(_SIZES[wanted < 0.0 and answer < 0.0, abs(answer) > abs(wanted)], answer=given)
    return joined([said, question(truth, task.asked[0])])


_SIZES = {  # by whether the answer is rightly negative, and larger in size than the truth
    (True, True): marked("The sign is right, but the size of {answer} is too large."),
    (True, False): marked("The sign is right, but the size of {answer} is too small."),
    (False, True): marked("{answer} is too large."),
    (False, False): marked("{answer} is too small."),
}


def _wrong_choice(truth: Session, task: Task, answer: str) -> str:
    choice = next((choice for choice in task.choices if choice.text == answer), None)
    if choice is None:
        texts = ", ".join(choice.text for choice in task.choices)
        raise NotFound("there is no choice '{text}'; use one of {texts}.", text=answer, texts=texts)
    if choice.right if isinstance(choice.right, bool) else all(holds(truth, one) for one in choice.right):
        return ""
    return filled(choice.say, truth) or tr(
        "No: “{text}” is not what the calculation gives.", text=tr(choice.text)
    )


def _asked_for(truth: Session, asked: str) -> tuple[list[Handle], dict[Handle, str]]:
    """The elements to be selected, and of all of that kind what is said of them, such as "axial force N is 70.7 kN"."""
    word, _, path = asked.partition(" ")
    if word in OVER_ALL and word != "sum":
        values = each(truth, path)
        sizes = [abs(value) if word == "largest" else value for _, value in values]
        best = OVER_ALL[word](sizes) if sizes else math.nan
        having = zip(values, sizes, strict=True)
        right = [handle for (handle, _), size in having if abs(size - best) <= 1e-6 * abs(best)]  # as large
        right = list(dict.fromkeys(right))  # of one with the same at both ends
    else:
        path, relation = parts_of(asked)[0], asked[len(parts_of(asked)[0]) :]
        values = each(truth, path)
        right = [handle for handle, _ in values if holds(truth, path.replace("*", named(handle), 1) + relation)]
    target, _ = locate(truth.model, path.strip(), readable)
    unit, factor = target.shown
    title = target.field.named(target.axis)
    written_values = {
        handle: tr(
            "its {title} is {value} {unit}", title=title, value=_number(factor * value), unit=unit
        ).rstrip()
        for handle, value in values
    }
    return right, written_values


# --- words -----------------------------------------------------------------------------------------------


def filled(text: str, session: Session, answer: float | None = None) -> str:
    """A text of a lesson in the present language, its paths in braces replaced by their values with units."""

    def value(match: re.Match[str]) -> str:
        path, form = match[1], match[2]
        if path == "answer" and answer is not None:
            return _number(answer)
        if form is None:
            return shown(session, path)
        return decimals(format(_shown_number(session, path), form)).replace("-", "−")

    return _PLACE.sub(value, tr(text)) if text else ""


def shown(session: Session, path: str) -> str:
    """The present value at a path as a person reads it, with its unit."""
    value = read(session, path)
    if isinstance(value, int | str | np.integer) or value is None:
        return str(value)
    unit, _, _ = said_of(session, path)
    return f"{_number(_shown_number(session, path))} {unit}".rstrip()


def said_of(session: Session, path: str) -> tuple[str, float, str]:
    """The unit on screen, the factor to it, and the name of the quantity at a path."""
    word, _, of_all = path.partition(" ")
    try:
        if word in OVER_ALL and of_all:
            target, _ = locate(session.model, of_all.strip(), readable)
            unit, factor = target.shown
            return unit, factor, tr(_OVER_ALL[word], what=target.field.named(target.axis))
        found = quantity(session.model, path)
    except PathError:
        return "", 1.0, tr(_NAMES[path]) if path in _NAMES else path
    return found.unit, found.factor, tr(_NAMES[path]) if path in _NAMES else begun(found.name)


def question(session: Session, path: str) -> str:
    """What the number at a path is, and its unit."""
    unit, _, name = said_of(session, path)
    name = name.removesuffix(",")  # of "whatever its sign,"
    return tr("Asked: {what}.", what=f"{name} ({unit})" if unit else name)


def _shown_number(session: Session, path: str) -> float:
    """The number at a path in the unit in which it is shown."""
    value = read(session, path)
    if not isinstance(value, int | float):
        raise WrongValue("{path} is {value}, not one number.", path=path, value=value)
    return float(value) * said_of(session, path)[1]


def _number(value: float) -> str:
    return written.number(value, nothing=LEAST)


def _explained(task: Task, session: Session, answer: float | None = None) -> str:
    """What the lesson says of a wrong state or answer; "" if nothing."""
    for wrong in task.wrong:
        held = False
        with suppress(ValueError, LookupError):  # of what cannot be tested here, such as a rod that was removed
            held = all(holds(session, condition, answer) for condition in wrong.conditions)
        if held:
            return filled(wrong.say, session, answer)
    return ""


def _lacking(session: Session, condition: str) -> str:
    """What is the case instead of a condition."""
    path, relation, value, _ = parts_of(condition)
    if path in _SAID:
        return tr(_SAID[path][bool(read(session, path))])
    try:
        present = shown(session, path)
    except (ValueError, LookupError) as error:
        return tr("Not yet: {reason}", reason=str(error.args[0]) if error.args else str(error))
    unit, factor, name = said_of(session, path)
    with_unit = f"{_written(value, factor)} {unit}".rstrip()
    wanted = tr(_RELATIONS[relation], value=with_unit)
    return tr("{name} is {present} now; {wanted}.", name=name, present=present, wanted=wanted)


def _written(value: str, factor: float) -> str:
    """A number of a condition in the unit on screen; other values as they are."""
    try:
        return written.given(factor * float(value))
    except ValueError:
        return value


def named(handle: Handle) -> str:
    """The name of an element; "" of what has none."""
    return str(getattr(handle, "name", ""))
