"""Lessons with tasks: every bundled one as its author meant it, other right answers, and wrong ones."""

from __future__ import annotations

from pathlib import Path

import pytest

from components.model import Model
from game import Session
from game.documents import preferences
from game.lessons.checking import check_lesson
from game.lessons.course import Course
from game.scripts.script import Script, lessons_with_tasks


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder for what is kept."""
    monkeypatch.setenv(preferences.CONFIG_VARIABLE, str(tmp_path / "config"))
    return tmp_path / "config"


@pytest.fixture
def session() -> Session:
    return Session(Model())


def begun(session: Session, name: str, task: int = 1) -> Course:
    """A lesson, at one of its tasks."""
    session.begin_lesson(Script(name))
    assert session.course is not None
    session.course.begin(task - 1)
    return session.course


@pytest.mark.parametrize("name", lessons_with_tasks())
def test_a_lesson_is_as_its_author_means(name: str) -> None:
    script = Script(name)
    assert [str(failure) for failure in check_lesson(script, lambda: Session(Model()))] == []
    assert script.description


def test_any_triangle_is_a_first_structure(session: Session) -> None:
    course = begun(session, "01_first_structure")
    for x, y in ((5, 5), (-3, 2), (1, -4), (0, 0)):
        session.press("p", session.point(x, y))
    session.update_view()
    assert course.accepted
    session.press("f5")
    assert course.at == 1


def test_predictions_do_not_depend_on_what_was_tried(session: Session) -> None:
    course = begun(session, "02_tension_or_compression", 2)
    session.press("e")
    session.select(session.rods["AB"])
    session.press("f5")
    assert not course.accepted
    assert "Rod AB does not belong" in course.said


def test_the_example_for_teachers_is_a_lesson(tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "assets" / "lessons" / "README.md").read_text(encoding="utf-8")
    example = page.partition("```jsonl\n")[2].partition("```")[0]
    path = tmp_path / "example.jsonl"
    path.write_text(example, encoding="utf-8")
    assert [str(failure) for failure in check_lesson(Script(path), lambda: Session(Model()))] == []
