"""Actions on the card of a lesson: check, hint, show me, again, next, leave, and answers."""

from __future__ import annotations

from typing import Any

from pinjoint.components.field import Vector
from pinjoint.lessons.course import Course, leave_lesson
from pinjoint.lessons.progress import after
from pinjoint.scripts.script import Script, ScriptError
from pinjoint.systems.edit import Refusal
from pinjoint.systems.input.actions import IN_LESSONS, actions_of

action = actions_of("Lessons", IN_LESSONS)

Session = Any  # pinjoint.session.Session, which holds the lesson


def _course(session: Session) -> Course:
    """The lesson that a person is in. Raises Refusal."""
    if session.course is None:
        raise Refusal("There is no lesson now: D opens the start page, where lessons stand at the top.")
    found: Course = session.course
    return found


action("check answer", "f5", "check the task of the lesson", while_drawing=True)(
    lambda session, pixel: _course(session).check()
)


@action("next task", "f10", "go on to the next task", while_drawing=True)
def _next(session: Session, pixel: Vector) -> None:
    """Go on: to the next task, the next lesson, or, after the last, to the start page."""
    course = _course(session)
    if not course.accepted:
        raise Refusal(
            "This task is not done yet: F5 checks it, F7 shows how it is done. A dot leads to any task."
        )
    try:
        if course.next():
            return
        following = after(course.lesson.script)
        if following is not None:
            session.lesson = following
            return
    except ScriptError as error:
        session.notice = str(error)
        return
    _leave(session, pixel)


action("hint", "f6", "show a hint for the task", while_drawing=True)(
    lambda session, pixel: _course(session).hint()
)


@action("show solution", "f7", "show how the task is done")
def _show(session: Session, pixel: Vector) -> None:
    """Do the task: before the person's eyes in a window, else at once."""
    course = _course(session)
    if course.accepted:
        return
    if session.window is None:
        course.solve()
        return
    course.show()
    session.lesson = Script.of_lines(course.lesson.title, course.task.solution)


action("task again", "f8", "begin the task again")(lambda session, pixel: _course(session).again())
action("task of dot")(lambda session, pixel: _course(session).begin(session.view.pressed.item))


@action("leave lesson", "f9", "leave the lesson")
def _leave(session: Session, pixel: Vector) -> None:
    """Back to the document that was open before; where there was none, to the start page."""
    _course(session)
    leave_lesson(session)
    if session.document.practice:
        session.scenes.request("load")


action("erase answer", while_drawing=True)(lambda session, pixel: _course(session).erase())
action("clear answer", while_drawing=True)(lambda session, pixel: _course(session).erase(whole=True))
for _number in range(9):  # each has a key
    action(f"answer {_number + 1}", while_drawing=True)(
        lambda session, pixel, number=_number: _course(session).choose(number)
    )
action("lesson up", while_drawing=True)(lambda session, pixel: _course(session).scroll(-2))
action("lesson down", while_drawing=True)(lambda session, pixel: _course(session).scroll(2))
