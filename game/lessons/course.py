"""Course: a lesson in a session, its tasks one after the other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from pinjoint.components.field import FieldError
from pinjoint.components.language import decimals, joined, tr
from pinjoint.components.mistake import WrongValue
from pinjoint.components.settings import PAUSE, STATICS
from pinjoint.components.theory import FIRST_ORDER
from pinjoint.components.toolbar import Tool
from pinjoint.components.units import USUAL, number_and_unit, show_in, units_on_screen
from pinjoint.components.view import Card, Shape, View
from pinjoint.documents.document import document
from pinjoint.documents.models import ModelError, load
from pinjoint.documents.open_documents import ModelFile
from pinjoint.editor.gestures.drawing import Drawing
from pinjoint.editor.view_model import offer_tools
from pinjoint.lessons import progress
from pinjoint.lessons.judging import Answer, Document, Verdict, filled, judge, named, question, said_of
from pinjoint.lessons.tasks import CHOICES, NUMBER, SELECT, UNTIL, Lesson, Line, Task
from pinjoint.scripts.lines import play_line
from pinjoint.scripts.script import ScriptError
from pinjoint.systems.edit.typed import BEGINS, MOST
from pinjoint.systems.edit.typed import number as number_of

RIGHT, WRONG, HINT = "right", "wrong", "hint"  # moods of what is said
MOST_LINES = 40  # by which a card is scrolled
_UNITS = {"statics.frequency": "Hz", "time": "s"}  # of what has no Field


class Course:
    """A lesson that a person is in.

    view: of its card, in the part of the window that it takes. at: the number of the task, from 0. accepted: it is done.
    choice, typed: the choice that was made, or what was typed. writes: keys are part of that, until it is checked or
    something is clicked. home, units: the mode and the units on screen from which it was begun.
    """

    def __init__(self, session: Any, lesson: Lesson) -> None:
        self._session, self.lesson = session, lesson
        self.units = units_on_screen() if session.course is None else session.course.units
        show_in(USUAL)  # which the texts of lessons name
        self.home = session.scenes.hub if session.course is None else session.course.home
        self.view = View()
        self.at = 0
        self.accepted = False
        self.choice: str | None = None
        self.typed, self.writes = "", False
        self.said = ""
        self.mood = ""
        self.first = 0
        self._hints = 0  # that were shown
        self._begun: Document = {}
        self._opened = ""  # the name of its model
        self._unit = ""
        self._seen: object = None
        self._judged: tuple[str, ...] = ()  # what was selected then
        self._scored = ""
        self._shown = False  # the solution was
        self._done = progress.done(lesson.name)

    # --- tasks -------------------------------------------------------------------------------------

    @property
    def task(self) -> Task:
        """The present task."""
        return self.lesson.tasks[self.at]

    @property
    def awaits_number(self) -> bool:
        """True while digits that are typed belong to the answer."""
        return self.task.kind == NUMBER and not self.accepted

    @property
    def takes_return(self) -> bool:
        """True while Return checks what was typed or chosen, or says what is asked where it would open nothing selected."""
        asks = self.task.kind in (NUMBER, CHOICES) and not self._session.selected
        return bool(self.typed or self.choice or asks) and not self.accepted

    @property
    def awaits_choice(self) -> bool:
        """True while a digit that is pressed is an answer."""
        return self.task.kind == CHOICES and not self.accepted

    def begin(self, at: int | None = None) -> None:
        """Begin a task; None: the first that was not done. One that goes on from those before has them solved first.

        Raises ScriptError if its model or its lines cannot be used.
        """
        resumes = False
        if at is None:
            done = progress.done(self.lesson.name).tasks
            at = next((n for n in range(len(self.lesson.tasks)) if n + 1 not in done), 0)
            resumes = at > 0
        first = at
        while first > 0 and self.lesson.tasks[first].model is None:
            first -= 1
        for number in range(first, at):
            self._enter(number)
            self._shown = True
            self.perform(self.task.solution)
        self._enter(at)
        if resumes:
            self.mood = HINT
            self.said = tr("You go on where you stopped; the dots above lead back to any task.")

    def _enter(self, at: int) -> None:
        """Show a task and what it begins with; the model of the one before stays if it has none."""
        self.at = at
        task, session = self.task, self._session
        if task.model is not None:
            try:
                self._open(load(task.model), task.model if isinstance(task.model, str) else "")
            except ModelError as error:
                raise self.lesson.script.error(task.line, error) from None
        else:
            session.model.settings.theory = self._begun.get("settings", {}).get("theory", FIRST_ORDER)
            session.scenes.begin(session)
        session.leave_gesture()
        session.view.tool = ""  # that was in hand
        self.perform(task.setup)
        session.document.shapes.hide()
        session.notice = ""
        self._forget()
        session.select()
        self._begun = document(session.model)
        path = task.asked[0] if task.kind == NUMBER else ""
        self._unit = said_of(session, path)[0] or _UNITS.get(path, "") if path else ""
        offer_tools(session)

    def _forget(self) -> None:
        """Begin to answer anew."""
        self.accepted, self.choice, self.typed, self.writes = False, None, "", False
        self.said = self.mood = self._scored = ""
        self._hints = self.first = 0
        self._shown = False
        self._seen = self._looks()

    def _open(self, model: Any, name: str) -> None:
        """Open a model of the lesson, which is nobody's work; the person's own stays open below it."""
        session = self._session
        if session.scene != "pause":
            session.scenes.request("pause")
            session.scenes.apply(session)
        own = not session.document.practice and session.model.particles.count > 0
        session.view.rigid = False  # of an empty model, which is not to depend on what was drawn before
        session.documents.open(model, ModelFile(None, name), keep=own)
        self._opened = name
        session.document.practice = True
        session.scenes.begin(session)
        session.notice = ""

    def perform(self, lines: Sequence[Line]) -> None:
        """Perform lines of the lesson. Raises ScriptError."""
        script = self.lesson.script
        for number, entry in lines:
            for failure in play_line(script, number, entry, self._session):
                raise ScriptError(joined([str(script.path), str(failure)]))

    def again(self) -> None:
        """Begin the task anew, from the model with which it began."""
        self._open(load(self._begun), self._opened)
        self._forget()

    def next(self) -> bool:
        """Go on to the next task; False if this was the last one."""
        if self.at + 1 == len(self.lesson.tasks):
            return False
        if self.accepted or self.lesson.tasks[self.at + 1].model is not None:
            self._enter(self.at + 1)
        else:
            self.begin(self.at + 1)
        return True

    # --- answers -----------------------------------------------------------------------------------

    def answer(self, value: Any) -> None:
        """Give an answer as a script does: names of elements, a number, or the text of a choice. Raises ValueError."""
        task, session = self.task, self._session
        if task.kind == SELECT and isinstance(value, list):
            table = session.model.tables[task.table]
            session.select(*(table[name] for name in value))
        elif task.kind == NUMBER and isinstance(value, int | float):
            self.typed = str(value)
        elif task.kind == CHOICES and isinstance(value, str):
            self.choice = value
        else:
            raise WrongValue("the task asks for {kind}, not for {value}.", kind=task.kind, value=value)
        self.check()

    def choose(self, number: int) -> None:
        """Choose an answer by its number, from 0."""
        if self.task.kind == CHOICES and not self.accepted and number < len(self.task.choices):
            self.choice, self.said, self.mood = self.task.choices[number].text, "", ""

    def type(self, text: str) -> None:
        """Type a part of a number or of its unit; what begins as no number is passed over."""
        before = "" if self.mood == WRONG else self.typed  # after a wrong answer, another one begins
        if (before and self.writes) or text[:1] in BEGINS:
            self.typed, self.writes = (before + text)[:MOST], True
            self.said = self.mood = ""

    def erase(self, *, whole: bool = False) -> None:
        """Take back the last character that was typed, or all."""
        self.typed = "" if whole else self.typed[:-1]
        self.writes = bool(self.typed)
        self.said = self.mood = ""

    def _given(self) -> Answer:
        """The answer that stands there now. Raises FieldError if it is no number, or in a unit of another kind."""
        task = self.task
        if task.kind == CHOICES:
            return self.choice
        if task.kind == SELECT:
            return self._selected()
        if not self.typed:
            return None
        return number_of(self.typed, self._unit, self._unit)

    def _selected(self) -> tuple[str, ...]:
        """The names of the selected elements."""
        return tuple(map(named, self._session.selected))

    def check(self) -> None:
        """Judge the task, and say why it is right or wrong."""
        if self.accepted:
            return
        try:
            answer = self._given() if self.task.kind != UNTIL else None
        except FieldError as error:
            if plain := not self._unit and number_and_unit(self.typed)[1]:
                asked = tr("Type a number without a unit."), question(self._session, self.task.asked[0])
            self.mood = WRONG
            self.said = joined(asked) if plain else tr("The answer {reason}.", reason=str(error))
            return
        finally:
            self.writes, self._judged = False, self._selected()
        self._judge(answer)

    def _judge(self, answer: Answer, *, aloud: bool = True) -> None:
        """Judge the task; aloud: say also why it is wrong."""
        try:
            found = judge(self._session, self.task, self._begun, answer)
        except (ValueError, LookupError) as error:  # such as of a rod that was removed
            found = Verdict(False, str(error.args[0]) if error.args else str(error))
        if found.right:
            self._accept(found)
        elif aloud or self.accepted:
            self.mood, self.said, self._scored, self.first = WRONG, found.said, "", 0

    def _accept(self, found: Verdict) -> None:
        again = self.accepted  # a state that is reached anew
        self.accepted, self.mood, self.said, self.first = True, RIGHT, found.said, 0
        if not again:
            self.perform(self.task.then)
        if self._shown:
            return
        number, name = self.at + 1, self.lesson.name
        progress.keep(name, number, found.score[0] if found.score is not None else None)
        self._done = progress.done(name)
        if found.score is not None:
            self._scored = (
                tr(
                    "Your score: {score}, your best so far. Less is better: try again, or go on.",
                    score=found.score[1],
                )
                if found.score[0] <= self._done.best.get(number, math.inf)
                else tr("Your score: {score}. Your best score is better: less is better.", score=found.score[1])
            )

    def hint(self) -> None:
        """Show the next hint; after the last one, the first again."""
        hints = self.task.hints
        if hints and not self.accepted:
            self.mood, self.said, self.first = HINT, filled(hints[self._hints % len(hints)], self._session), 0
            self._hints += 1

    def solve(self) -> None:
        """Do the task as its author does. Raises ScriptError."""
        self.show()
        self.perform(self.task.solution)
        self.look()

    def show(self) -> None:
        """Begin the task anew, for its solution to be shown; it is not counted as done then."""
        self.again()
        self._shown = True

    def look(self) -> None:
        """Accept a state as soon as it is reached and nobody is in the middle of something, or say anew what is wrong."""
        session, task = self._session, self.task
        apart = task.after or session.settings.opens_in == STATICS
        drags = session.gesture is not None and not isinstance(session.gesture, Drawing)
        if drags or session.footer is not None or (session.busy and apart):
            return
        seen = self._looks()
        if seen == self._seen or (self.accepted and not task.score):
            return
        self._seen = seen
        if task.kind == UNTIL:
            self._judge(None, aloud=self.mood == WRONG)
        elif task.kind == SELECT and self.mood == WRONG and self._selected() != self._judged:
            self.mood = self.said = ""

    def _looks(self) -> object:
        """What changes whenever the task may have been done."""
        session = self._session
        seen = [
            value
            for value in vars(session.view).values()
            if isinstance(value, bool | str | Shape | frozenset | None)
        ]
        chosen = self._selected() if self.task.kind == SELECT else ()
        return id(session.document), session.model.revision, session.simulation.halted, seen, chosen

    def scroll(self, lines: int) -> None:
        """Move what is said on the card up by some lines, down if negative."""
        self.first = min(max(self.first + lines, -MOST_LINES), MOST_LINES)

    # --- the card ----------------------------------------------------------------------------------

    def show_card(self) -> None:
        """Bring the card up to date."""
        self.look()
        self.view.card, self.view.pointer = self._card(), self._session.view.pointer

    def _card(self) -> Card:
        """The task as it stands."""
        task, count = self.task, len(self.lesson.tasks)
        shown = [str(entry["say"]) for _, entry in task.setup if "say" in entry]
        said = tuple(text for text in (self.said, self._scored) if text)
        last = self.at + 1 == count
        if self.accepted and self._shown:
            how = tr(
                "That was one way to do it. Now try it: “Again” starts the task once more; “Next” goes on."
            )
            said += (how,)
        elif self.accepted and last:
            said += (tr("This lesson is done: “Next” goes on to another one."),)
        return Card(
            title=tr(self.lesson.title),
            progress=tr("Task {number} of {count}", number=self.at + 1, count=count),
            count=count,
            at=self.at,
            done=frozenset(number - 1 for number in self._done.tasks),
            paragraphs=(*map(tr, shown), tr(task.text)),
            choices=tuple((tr(choice.text), choice.text == self.choice) for choice in task.choices),
            entry=self._entry(),
            said=said,
            mood=self.mood,
            buttons=self._buttons(),
            first=self.first,
        )

    def _entry(self) -> str | None:
        """What was typed or selected so far."""
        if self.task.kind == SELECT:
            return tr("Selected: {names}", names=", ".join(self._selected()) or "–")
        if self.task.kind != NUMBER:
            return None
        unit = "" if number_and_unit(self.typed)[1] else self._unit
        return f"{decimals(self.typed)}{'' if self.accepted else '|'} {unit}".rstrip()

    def _buttons(self) -> tuple[Tool, ...]:
        return (
            Tool("check answer", tr("Check"), "F5", enabled=not self.accepted),
            Tool("next task", tr("Next"), "F10", enabled=self.accepted),
            Tool("hint", tr("Hint"), "F6", enabled=bool(self.task.hints) and not self.accepted),
            Tool("show solution", tr("Show me"), "F7", enabled=not self.accepted),
            Tool("task again", tr("Again"), "F8"),
            Tool("leave lesson", tr("Leave"), "F9"),
        )


def take_up_lesson(session: Any) -> None:
    """Begin the lesson with tasks that a person chose, where it was left; one to watch puts away that which is there."""
    script = session.lesson
    if script is None or not (script.task_count or script.name):
        return
    if not script.task_count:
        _seat(session, None)
        return
    session.lesson = None
    try:
        _seat(session, Course(session, Lesson(script)))
        session.course.begin()
        session.course.show_card()
    except ScriptError as error:
        leave_lesson(session)
        session.notice = str(error)


def leave_lesson(session: Any) -> None:
    """Leave the lesson for the document that was open before it."""
    home = PAUSE if session.course is None else session.course.home
    if session.course is not None:
        show_in(session.course.units)
    _seat(session, None)
    session.scenes.request_from_pause(PAUSE)
    session.scenes.apply(session)
    session.leave_gesture()
    documents = session.documents
    while session.document.practice and documents.can_move(-1):
        documents.move(-1)
    documents.on_begin()
    session.scenes.request_from_pause(home)
    session.scenes.apply(session)


def _seat(session: Any, course: Course | None) -> None:
    """Let the window have room for the card of a course, or for none."""
    if session.course is not course:
        session.course = course
        session.resize(*session.extent, session.view.pixel_ratio)
