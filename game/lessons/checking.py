"""Checking: a lesson played without a window, with the solutions and the wrong answers that its file gives."""

from __future__ import annotations

import re
from collections.abc import Iterator

from pinjoint.components.language import tr
from pinjoint.components.model import Model
from pinjoint.lessons import progress
from pinjoint.lessons.course import Course
from pinjoint.lessons.judging import filled
from pinjoint.lessons.tasks import CHOICES, UNTIL, Lesson
from pinjoint.scripts.lines import Failure
from pinjoint.scripts.script import Script
from pinjoint.session import Session


def check_lesson(script: Script) -> list[Failure]:
    """Play all tasks; what is wrong with each. Raises ScriptError.

    A task must not be done before anything was; its solution must be accepted; every wrong answer must be refused, and
    explained by its own sentence; and of choices at least one must be wrong, and the hints must be readable.
    """
    lesson = Lesson(script)
    with progress.not_kept():
        return [
            Failure(task.line, *failure)
            for number, task in enumerate(lesson.tasks)
            for failure in _failures(lesson, number, Session(Model()))
        ]


def _failures(lesson: Lesson, number: int, session: Session) -> Iterator[tuple[str, str]]:
    """(expected, got) of what is wrong with one task."""
    course = Course(session, lesson)
    session.course = course
    course.begin(number)
    task = course.task
    course.check()
    if course.accepted:
        yield tr("a task that is not done at its beginning"), tr("it is done already")
        return
    for text in task.hints:
        filled(text, session)
    for wrong in task.wrong:
        if not wrong.lines:
            continue
        course.again()
        course.perform(wrong.lines)
        course.check()
        if course.accepted:
            yield tr("a wrong answer that is refused: {say}", say=wrong.say), tr("it is accepted")
        elif not _is_filled(course.said, wrong.say):
            yield wrong.say, course.said
    for choice in task.choices if task.kind == CHOICES else ():
        course.again()
        course.choice = choice.text
        course.check()
        if choice.right is False and course.accepted:
            yield tr("a wrong choice that is refused: {text}", text=choice.text), tr("it is accepted")
    if task.kind == CHOICES and all(choice.right is True for choice in task.choices):
        yield tr("a choice that is wrong"), tr("all are right")
    course.again()
    course.perform(task.solution)
    if task.kind == UNTIL:
        course.check()
    if not course.accepted:
        yield tr("a solution that is accepted"), course.said or tr("nothing was answered")


def _is_filled(said: str, text: str) -> bool:
    """True if what was said is a text with any values in its places."""
    pattern = ".*".join(re.escape(part) for part in re.split(r"\{[^{}]*\}", tr(text)))
    return re.fullmatch(pattern, said) is not None
