"""Lessons with tasks: every bundled one as its author meant it, other right answers, and wrong ones."""

import itertools
import re
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinjoint import Session
from pinjoint.components.form import Box
from pinjoint.components.language import spoken
from pinjoint.components.model import Model
from pinjoint.editor.scenes.form import FormScene
from pinjoint.lessons import progress
from pinjoint.lessons.checking import check_lesson
from pinjoint.lessons.course import Course, take_up_lesson
from pinjoint.lessons.judging import question
from pinjoint.lessons.tasks import Lesson
from pinjoint.scripts.lines import perform
from pinjoint.scripts.script import TO_DO, Script, ScriptError, lessons
from pinjoint.systems.render.marks import Text
from pinjoint.systems.render.picture import compose, compose_all
from pinjoint.systems.render.theme import load_theme
from tests.golden.scenes import Window
from tests.golden.test_texts import problems
from tests.reference.hits import hits_for, push

pytestmark = pytest.mark.usefixtures("config")


@pytest.fixture
def session() -> Session:
    return Session(Model())


def begun(session: Session, name: str, task: int = 1) -> Course:
    """A lesson, at one of its tasks."""
    course = taken_up(session, name)
    course.begin(task - 1)
    return course


def taken_up(session: Session, name: str) -> Course:
    """A lesson, where the person left it."""
    session.lesson = Script(name)
    take_up_lesson(session)
    assert session.course is not None
    return session.course


@pytest.mark.parametrize("name", lessons(TO_DO))
def test_a_lesson_is_as_its_author_means(name: str) -> None:
    script = Script(name)
    assert [str(failure) for failure in check_lesson(script)] == []
    assert script.description


def test_a_refused_selection_is_said_wholly_in_the_language(session: Session) -> None:
    with spoken("pt"):
        course = begun(session, "02_tension_or_compression", 2)
        session.select(session.rods["AB"])
        session.press("f5")
        assert "esforço axial" in course.said
        assert "axial force" not in course.said
        session.select(session.particles["A"])
        session.press("f5")
        assert "barras" in course.said
        assert "rods" not in course.said


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
    assert [str(failure) for failure in check_lesson(Script(path))] == []


# --- other right answers, and wrong ones -----------------------------------------------------------------


@pytest.mark.parametrize("rod", ["AB", "BC", "CD", "DA", "AC", "BD"])
def test_any_rod_of_the_square_may_be_released(session: Session, rod: str) -> None:
    course = begun(session, "06_statically_indeterminate", 3)
    session.select(session.rods[rod])
    session.press("delete")
    session.update_view()
    assert course.accepted


def test_what_leaves_a_mechanism_is_explained(session: Session) -> None:
    course = begun(session, "06_statically_indeterminate", 3)
    session.select(session.rods["AB"], session.rods["CD"])
    session.press("delete")
    session.press("f5")
    assert not course.accepted
    assert "mechanism" in course.said
    session.press("ctrl+z")
    session.select(session.rods["CD"])
    session.press("delete")
    session.update_view()
    assert course.accepted


@pytest.mark.parametrize(
    "lines",
    [
        [{"press": "l", "over": [2, 0]}, {"click": [0, 2]}],  # the other diagonal
        [{"set": "particles.C.fixed=true,false"}],
        [{"set": "particles.D.fixed=true,false"}],
        [  # by a joint in the middle
            {"press": "p", "over": [1, 1]},
            {"press": "l", "over": [1, 1]},
            {"click": [0, 0]},
            {"press": "l", "over": [1, 1]},
            {"click": [2, 2]},
            {"press": "l", "over": [1, 1]},
            {"click": [0, 2]},
        ],
    ],
)
def test_a_square_is_braced_in_any_way(session: Session, lines: list[dict[str, Any]]) -> None:
    course = begun(session, "03_stable_or_mechanism", 2)
    for line in lines:
        assert list(perform(session, line)) == []
    session.update_view()
    assert course.accepted, course.said


@given(
    place=st.tuples(st.integers(-9, 9), st.integers(-9, 9)),
    mirrored=st.booleans(),
    order=st.permutations(range(3)),
)
@settings(max_examples=12)
def test_a_first_structure_may_be_drawn_anywhere_in_any_order(
    place: tuple[int, int], mirrored: bool, order: list[int]
) -> None:
    session = Session(Model())
    with progress.not_kept():
        course = begun(session, "01_first_structure")
        x, y = place
        way = -1 if mirrored else 1
        corners = [(x, y), (x + 2 * way, y), (x + way, y + 2)]
        left, right, top = corners
        for number in order:
            session.press("p", session.point(*corners[number]))
        session.update_view()
        assert course.accepted
        session.press("f10")
        session.press("home")
        for number in order:
            session.press("l", session.point(*corners[number]))
            session.click(*corners[(number + 1) % 3])
        session.update_view()
        assert course.accepted
        session.press("f10")
        session.press("c", session.point(*right))
        session.press("c", session.point(*left))
        session.press("c", session.point(*left))
        session.update_view()
        assert course.accepted, course.said
        session.press("f10")
        session.press("f", session.point(*top))
        session.click(top[0], top[1] - 1.0)
        session.update_view()
        assert course.accepted, course.said
        session.press("f10")
        assert session.scene == "statics"
        course.answer("They are squeezed and push on their joints")
        assert course.accepted, course.said


def test_choices_are_made_by_key_mouse_and_script(session: Session) -> None:
    course = begun(session, "02_tension_or_compression", 1)
    session.press("2")
    assert (course.choice, course.mood) == ("Compression: A and C are pushed together", "")
    session.press("return")
    assert (course.accepted, course.mood) == (False, "wrong")
    session.update_view()
    push(session, "answer 1")
    assert (course.accepted, course.said) == (False, "")
    session.press("f5")
    assert course.accepted
    assert "ties A to C" in course.said


@pytest.mark.parametrize("typed", ["30", "30.2", "29,9", "+30"])
def test_numbers_are_typed_beside_the_model(session: Session, typed: str) -> None:
    course = begun(session, "04_supports_and_reactions", 1)
    session.type(typed)
    session.press("return")
    assert course.accepted


def test_a_wrong_number_is_explained_and_typed_anew(session: Session) -> None:
    course = begun(session, "04_supports_and_reactions", 1)
    for typed, said in (
        ("90", "reaction at A"),
        ("-30", "but not the sign"),
        ("-20", "Neither the sign nor the size"),
        ("1000", "too large"),
        ("--", "must be a number"),
    ):
        session.type(typed)
        session.press("return")
        assert not course.accepted
        assert said in course.said
    session.type("3e1")
    session.press("return")
    assert course.accepted


def keyed(session: Session, text: str) -> None:
    """Type a text as a keyboard does: each key, and what it types."""
    for character in text:
        session.press("space" if character == " " else character)
        session.type(character)


@pytest.mark.parametrize(
    ("name", "task", "typed"),
    [
        ("11_collisions", 1, "3 m/s"),
        ("11_collisions", 1, "10,8 km/h"),
        ("04_supports_and_reactions", 1, "30 kN"),
        ("04_supports_and_reactions", 1, "30000N"),
        ("05_stiffness", 1, "−29.3 mm"),
        ("05_stiffness", 1, "-.0293 m"),
        ("13_vibration", 1, "1.229 Hz"),
        ("12_frames", 1, "3"),
    ],
)
def test_an_answer_takes_all_keys_and_units(session: Session, name: str, task: int, typed: str) -> None:
    course = begun(session, name, task)
    before = session.scene
    keyed(session, typed)
    assert (session.scene, course.typed) == (before, typed)
    assert not session.view.wanted
    session.press("return")
    assert course.accepted, course.said


def test_an_answer_is_a_text_box_while_it_is_written(session: Session) -> None:
    course = begun(session, "11_collisions", 1)
    keyed(session, "4 kg")
    for key in ("ctrl+a", "delete"):
        session.press(key)
    assert (session.particles.count, course.typed) == (2, "")
    keyed(session, "3 m")
    session.press("return")
    assert (course.accepted, course.said) == (False, "The answer must be in m/s, km/h, not in m.")
    keyed(session, "2 m/s")
    session.press("escape")
    assert course.typed == ""
    keyed(session, "2")
    session.click(0.0, 0.5)
    keyed(session, "b")
    assert (course.typed, session.view.shape is not None or bool(session.notice)) == ("2", True)


def test_neither_check_nor_return_skips_an_explanation(session: Session) -> None:
    course = begun(session, "05_stiffness", 1)
    for typed, said in (("-4", "size of −4 is too large"), ("-2", "size of −2 is too small")):
        session.type(typed)
        session.press("return")
        assert said in course.said
    session.type("-2.93")
    session.press("return")
    assert course.accepted
    session.press("f5")
    assert course.at == 0
    assert course.said
    session.press("f10")
    assert (course.at, session.scene) == (1, "statics")
    session.select(session.rods[0])
    session.press("return")
    session.scenes.apply(session)
    assert session.scene == "properties", "a key of the program again"


@pytest.mark.parametrize(
    ("name", "task", "lines", "said"),
    [
        ("04_supports_and_reactions", 5, [], "still stable"),
        ("01_first_structure", 1, [], "no particle yet"),
        ("01_first_structure", 2, [{"action": "undo"}], "three particles"),
        ("01_first_structure", 4, [{"set": "particles.*.fixed=false,false"}], "no load yet"),
        ("02_tension_or_compression", 3, [{"select": "rods.AB"}], "axial force is"),
        ("04_supports_and_reactions", 3, [{"select": "particles.C"}], "its reaction x is 0 kN"),
        ("06_statically_indeterminate", 2, [{"set": "particles.C.force=0,-300"}], "stay 100 kN"),
    ],
)
def test_a_wrong_answer_is_explained_by_what_is_the_case(
    session: Session, name: str, task: int, lines: list[dict[str, Any]], said: str
) -> None:
    course = begun(session, name, task)
    for line in lines:
        if "select" in line:
            table, _, element = line["select"].partition(".")
            session.select(session.model.tables[table][element])
        else:
            assert list(perform(session, line)) == []
    session.press("f5")
    assert not course.accepted
    assert said in course.said


@pytest.mark.parametrize("release", ["particles.A.fixed_rotation=false", "particles.B.fixed=false,false"])
def test_any_unknown_of_the_propped_beam_may_be_released(session: Session, release: str) -> None:
    course = begun(session, "07_force_method", 2)
    assert list(perform(session, {"set": release})) == []
    session.update_view()
    assert course.accepted, course.said


@pytest.mark.parametrize(
    "lines",
    [
        [
            {"click": [3, 0]},
            {"press": "l", "over": [3, 0]},
            {"click": [6, 0]},
            {"set": "rods.*.bending_stiffness=1e5"},
        ],
        [
            {"set": "particles.M.position=3,1"},
            {"click": [3, 1]},
            {"press": "l", "over": [3, 1]},
            {"click": [6, 0]},
            {"press": "l", "over": [0, 0]},
            {"click": [6, 0]},
        ],
    ],
)
def test_the_lightest_bridge_is_not_won_by_other_means(session: Session, lines: list[dict[str, Any]]) -> None:
    course = begun(session, "15_lightest_bridge", 2)
    for line in ({"press": "l", "over": [0, 0]}, *lines):
        assert list(perform(session, line)) == []
    session.update_view()
    session.press("f5")
    assert not course.accepted, course.said


def test_a_task_begins_undeformed_and_without_a_mode(session: Session) -> None:
    course = begun(session, "04_supports_and_reactions", 1)
    session.press("e")
    session.press("b")
    session.course.answer(30)
    session.press("f10")
    session.update_view()
    assert course.at == 1
    assert session.view.shape is None
    session.press("q")
    assert not session.particles.displacement.any()
    assert session.notice == ""


def test_frames_show_and_are_judged_by_what_a_hand_calculates(session: Session) -> None:
    """Of the portal M = 65.58 at C (exact: 65.86); of three hinges, one at B, (30·4 + 20·6²/2)/6 = 80 kN at D, so that the
    beam has 80·6 − 20·6²/2 = 120 kN·m at C."""
    course = begun(session, "12_frames", 2)
    assert session.scene == "statics"
    assert session.rods["BC"].bending_moment[1] == pytest.approx(-65.58, abs=0.01)
    session.course.answer(["BC", "CD"])
    assert "65.58 kN·m" in course.said
    session.press("f10")
    for line in course.task.solution:
        assert list(perform(session, line[1])) == []
    session.update_view()
    assert course.accepted
    assert "120.0 kN·m" in course.said
    assert abs(session.rods["BC"].bending_moment[1]) == pytest.approx(120.0, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "task", "lines", "rod", "by_hand"),
    [
        ("01_first_structure", 5, [{"set": "particles.particle 3.force=0,-82"}], "rod 3", 41.0),
        ("02_tension_or_compression", 4, [{"set": "particles.B.force=0,-50"}], "BE", 50.0),
        ("04_supports_and_reactions", 2, [{"set": "particles.B.position=2,1.5"}], "AC", 80.0),
        ("05_stiffness", 4, [{"set": "particles.B.position=0,3"}], "BC", 50.0 * 2**0.5),
        (
            *("06_statically_indeterminate", 2, [{"set": "rods.AC.stiffness=1646400"}]),
            *("AC", -50.0 * 2**0.5 / (2.0 + 1.1 * 2**0.5)),
        ),
        ("07_force_method", 6, [{"set": "particles.B.force=10,15"}], "AB", 10.0),
    ],
)
def test_lessons_about_forces_show_and_are_judged_by_what_a_hand_calculates(
    session: Session, name: str, task: int, lines: list[dict[str, Any]], rod: str, by_hand: float
) -> None:
    """In statics, first-order: 82/2 = 41.00 in the triangle's base. Judged so is also a person who has left it."""
    for leave in (False, True):
        course = begun(session, name, task)
        assert (session.scene, session.model.first_order) == ("statics", True)
        if leave:
            session.press("q")
        for line in lines:
            assert list(perform(session, line)) == []
        session.update_view()
        assert course.accepted or course.task.kind == "choices", course.said
        assert session.scene == ("pause" if leave else "statics")
    session.press("q")
    assert session.rods[rod].axial_force == pytest.approx(by_hand, rel=1e-9)
    session.press("z")
    assert name == "07_force_method" or abs(session.rods[rod].axial_force - by_hand) > 2e-4 * abs(by_hand)


def test_the_bracket_goes_down_by_what_a_hand_calculates(session: Session) -> None:
    """Σ N N̄ L/EA = 50 (10 √10 + 27) / EA = 2.931 cm; exact theory would say 2.932."""
    course = begun(session, "05_stiffness", 1)
    by_hand = -100.0 * 50.0 * (10.0 * 10.0**0.5 + 27.0) / 100_000.0
    assert 100.0 * session.particles["C"].displacement[1] == pytest.approx(by_hand, rel=1e-9)
    session.type("-2.931")
    session.press("return")
    assert course.accepted
    course.begin(1)
    course.answer("Half as large")
    assert course.accepted


def test_each_task_begins_in_its_mode(session: Session) -> None:
    """Where the forces of one are not to be seen before they were predicted, and where those of the next are to be."""
    course = begun(session, "04_supports_and_reactions", 1)
    session.press("q")
    course.answer(30)
    for scene in ("statics", "pause"):
        session.press("f10")
        assert session.scene == scene
        session.press("q")
        session.press("f8")
        assert session.scene == scene
        for line in course.task.solution:
            assert list(perform(session, line[1])) == []
        session.update_view()
        assert course.accepted, course.said


def test_a_first_structure_is_a_truss_whatever_was_drawn_before(session: Session) -> None:
    begun(session, "07_force_method")
    begun(session, "01_first_structure", 5)
    assert not session.rods.bending_stiffness.any()


def test_nothing_is_told_of_second_order_where_a_joint_went_back(session: Session) -> None:
    begun(session, "07_force_method", 6)
    session.particles["B"].force = (0.0, 15.0)
    assert abs(session.particles["B"].displacement[1]) < 1e-12
    assert session.document.statics.second_order() == ""


def test_the_task_without_a_load_shows_none(session: Session) -> None:
    begun(session, "06_statically_indeterminate", 5)
    assert not session.particles.force.any()


def test_the_lightest_bridge_keeps_its_best_score(session: Session) -> None:
    course = begun(session, "15_lightest_bridge", 2)
    for line in course.task.solution:
        assert list(perform(session, line[1])) == []
    session.update_view()
    assert course.accepted
    first = progress.done("15_lightest_bridge").best[2]
    session.particles["particle 1"].position = (3.0, 0.9437)  # 30 √(3² + h²)/h = 99.98 kN by hand
    session.update_view()
    assert course.accepted, course.said
    assert progress.done("15_lightest_bridge").best[2] < first
    session.particles["particle 1"].position = (3.0, 0.5)
    session.update_view()
    assert course.mood == "wrong"
    assert "100 kN are allowed" in course.said


def test_what_is_said_of_a_selection_stays_until_another_one_is_made(session: Session) -> None:
    begun(session, "02_tension_or_compression", 2)
    for pick, said in (((0.5, 0.5), "Rod AB does not belong"), ((0.0, 0.5), "Nothing is selected")):
        session.click(*pick)
        session.update_view()
        push(session, "check answer")
        for _ in range(3):
            session.view.pointer = session.point(1.0, 0.8)
            session.update_view()
            assert said in session.course.said
    session.click(1.5, 0.5)
    session.update_view()
    assert session.course.said == ""


def test_a_structure_begins_with_a_triangle_and_a_load_that_points_down(session: Session) -> None:
    course = begun(session, "01_first_structure")
    for point in ((0, 0), (1, 1), (2, 2)):
        session.press("p", session.point(*point))
    session.update_view()
    session.press("f5")
    assert "on one line" in course.said
    session.particles[1].position = (1.0, 0.0)
    session.update_view()
    assert course.accepted
    course.begin(3)
    session.press("f", session.point(1, 1))
    session.click(1, 2)
    session.update_view()
    session.press("f5")
    assert "points up" in course.said


def test_a_task_gives_back_the_tool_and_the_theory(session: Session) -> None:
    course = begun(session, "05_stiffness", 1)
    session.press("z")
    session.press("c", session.point(1.5, 2.0))
    assert (session.model.first_order, session.view.tool) == (False, "support")
    session.type("-2.93")
    session.press("f5")
    session.press("f10")
    assert (course.at, session.model.first_order, session.view.tool, session.gesture) == (1, True, "", None)


def test_a_number_without_a_unit_is_asked_for_as_such(session: Session) -> None:
    course = begun(session, "14_buckling", 1)
    session.type("61.7 kN")
    session.press("return")
    assert course.said == "Type a number without a unit. Asked: The lowest buckling load factor."


@pytest.mark.parametrize(
    ("path", "said", "translated"),
    [
        ("rods.AB.bending_moment.end", "Bending moment at the end of rod AB", "Momento fletor no fim da barra AB"),
        ("rods.BC.largest_moment.value", "Largest moment of rod BC", "Maior momento da barra BC"),
    ],
)  # fmt: skip
def test_what_is_asked_is_named_as_a_person_would(path: str, said: str, translated: str) -> None:
    session = Session.open("portal")
    assert question(session, path) == f"Asked: {said} (kN·m)."
    assert question(session, "largest rods.*.shear") == "Asked: The largest shear, whatever its sign (kN)."
    with spoken("pt"):
        assert question(session, path) == f"Pede-se: {translated} (kN·m)."


def test_the_box_that_a_lesson_speaks_of_is_in_sight_at_once(session: Session) -> None:
    session.resize(1000, 720)
    begun(session, "06_statically_indeterminate", 2)
    session.resize(*session.extent)
    session.select(session.rods["AC"])
    session.press("return")
    scene = session.scenes.active
    assert isinstance(scene, FormScene)
    titles = [place.item.title for place in scene.layout(session).places if isinstance(place.item, Box)]
    assert "stiffness" in titles


def test_what_was_typed_counts_while_the_tool_goes_on(session: Session) -> None:
    course = begun(session, "18_draw_by_typing", 1)
    session.act("rod")
    for text in ("0; 0", "4 m; 0"):
        session.type(text)
        session.press("return")
    session.update_view()
    assert session.gesture is not None
    assert course.accepted


# --- progress, and the person's own work -----------------------------------------------------------------


def test_a_load_stays_when_its_tool_is_pressed_again_where_it_begins(session: Session) -> None:
    """As after Esc at a box with a refused unit: the arrow would have no length."""
    begun(session, "18_draw_by_typing", 3)
    session.particles["B"].force = (0.0, 15.0)
    at = session.point(4, 0)
    session.press("f", at)
    keyed(session, "-15 kN/m")
    session.press("return")
    session.press("escape")
    session.press("f", at)
    assert session.particles["B"].force == (0.0, 15.0)
    assert "no length" in session.notice
    keyed(session, "-15 kN")
    session.press("return")
    assert session.particles["B"].force == (0.0, -15.0)
    session.press("f", at)
    keyed(session, "0")
    session.press("return")
    assert session.particles["B"].force == (0.0, 0.0)


def test_a_unit_that_is_typed_is_shown_once(session: Session) -> None:
    course = begun(session, "04_supports_and_reactions", 1)
    for typed, shown in (("30", "30| kN"), (" N", "30 N|")):
        keyed(session, typed)
        session.update_view()
        assert course.view.card is not None
        assert course.view.card.entry == shown


def test_progress_survives_a_restart_and_a_damaged_file(session: Session) -> None:
    course = begun(session, "06_statically_indeterminate", 1)
    session.course.answer(1)
    again = Session(Model())
    assert taken_up(again, "06_statically_indeterminate").at == 1
    progress.path().write_text('{"06_statically_indeterminate": {"tasks": "all"', encoding="utf-8")
    third = taken_up(Session(Model()), "06_statically_indeterminate")
    assert third.at == 0
    third.answer(1)
    assert progress.done("06_statically_indeterminate").tasks == {1}
    assert progress.path().with_name("lessons-unreadable.json").is_file()
    assert course.accepted


def test_what_comes_before_a_task_is_not_counted_as_done(session: Session) -> None:
    begun(session, "07_force_method", 2)
    assert session.rods["AB"].exists
    assert progress.done("07_force_method").tasks == frozenset()


def test_own_work_is_kept_and_that_of_a_lesson_asks_for_nothing() -> None:
    session = Session.open("isostatic")
    session.particles["B"].force = (1.0, 2.0)
    mine = session.model
    taken_up(session, "03_stable_or_mechanism")
    session.press("f7")
    session.press("f10")
    session.press("l", session.point(0, 0))
    session.click(2, 2)
    assert not session.document.unsaved
    for _ in range(9):
        session.press("ctrl+z")
    assert session.model is not mine, "a lesson is left by its button"
    session.press("f9")
    assert session.model is mine
    assert session.course is None
    assert session.view.camera.viewport.width == session.extent[0]
    assert tuple(session.particles["B"].force) == (1.0, 2.0)


def test_return_asks_for_an_answer_and_two_quick_presses_give_two_hints(session: Session) -> None:
    """Return opened the properties of the model, and of a double click on Hint the second half was lost."""
    course = begun(session, "19_plastic_hinges", 0)
    session.press("return")
    assert session.scene == "statics"
    assert course.mood == "wrong"
    push(session, "hint")
    first = course.said
    push(session, "hint", "double click")
    assert (course.mood, first != course.said) == ("hint", True)


def test_the_last_task_leads_to_the_next_lesson(session: Session) -> None:
    course = begun(session, "08_first_yield", 3)
    course.solve()
    assert course.accepted
    assert progress.done("08_first_yield").tasks == frozenset(), "to be shown is not to have done it"
    session.press("f10")
    assert session.course is not None
    assert session.course.lesson.name == "09_collapse_and_unloading"


def test_a_lesson_that_resumes_says_so_and_its_dots_lead_to_any_task(session: Session) -> None:
    begun(session, "06_statically_indeterminate", 1).answer(1)
    session = Session(Model())
    course = taken_up(session, "06_statically_indeterminate")
    assert (course.at, course.mood) == (1, "hint")
    assert "where you stopped" in course.said
    for task in (0, 3):
        session.update_view()
        session.press("click", hits_for(session, "task of dot")[task].middle)
        assert (course.at, course.said) == (task, "")


def test_a_motion_plays_after_the_answer_about_it(session: Session) -> None:
    course = begun(session, "11_collisions", 1)
    session.type("4")
    session.press("f5")
    assert "Asked: Velocity x of particle ball 2 (m/s)." in course.said
    assert session.scene == "pause"
    session.type("3")
    session.press("f5")
    assert (course.accepted, session.scene) == (True, "simulation")
    session.press("f10")
    assert (course.at, session.scene, session.time) == (1, "pause", 0.0)


def test_a_joint_without_rods_shows_its_load_in_statics(session: Session) -> None:
    begun(session, "15_lightest_bridge", 1)
    session.update_view()
    (model, view), *_ = session.stages
    texts = compose(model, view, load_theme("light")).texts
    assert "60 kN" in texts
    assert "No rods yet" in texts
    assert not any("exact" in text for text in texts)


# --- lessons of teachers ---------------------------------------------------------------------------------

HEADER = '{"format": "pinjoint session", "version": 1, "title": "Mine"}'


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ('{"task": "x", "untill": "time > 1"}', "line 2: there is no key 'untill' here; did you mean 'until'?"),
        ('{"task": 1}', "line 2: task is 1; write it like"),
        ('{"task": "x", "right": "y", "solution": []}', "asks for one of until, select, number, choices"),
        ('{"task": "x", "until": "time > 1", "solution": []}', "'right' is missing"),
        ('{"task": "x", "choices": [{"text": "a"}], "right": "y", "solution": []}', 'either "if" or "right"'),
        ('{"press": "e"}', "no task follows this line"),
        ('{"task": "x", "model": "nothing", "until": "time > 1", "right": "", "solution": []}', "line 2: "),
        (
            '{"task": "x", "until": "time > 1", "right": "", "solution": [{"pres": "e"}]}',
            "line 2: there is no key 'pres' here",
        ),
    ],
)
def test_what_is_wrong_with_a_file_is_said(tmp_path: Path, line: str, said: str) -> None:
    path = tmp_path / "mine.jsonl"
    extra = "" if "task" in line else '\n{"say": "x"}'
    path.write_text(f"{HEADER}\n{line}{extra}\n", encoding="utf-8")
    with pytest.raises(ScriptError, match=re.escape(said)):
        check_lesson(Script(path))


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ('{"task": "x", "until": "time >= 0", "right": "", "solution": []}', "not done at its beginning"),
        ('{"task": "x", "until": "time > 1", "right": "", "solution": []}', "a solution that is accepted"),
        (
            '{"task": "x", "until": "time > 1", "right": "", "solution": [{"run": 2}], "wrong": [{"if": "time < 1",'
            ' "say": "no", "lines": [{"run": 2}]}]}',
            "a wrong answer that is refused",
        ),
    ],
)
def test_what_is_wrong_with_a_lesson_is_found(tmp_path: Path, line: str, said: str) -> None:
    path = tmp_path / "mine.jsonl"
    header = HEADER.replace("}", ', "model": "isostatic"}')
    path.write_text(f"{header}\n{line}\n", encoding="utf-8")
    failures = [str(failure) for failure in check_lesson(Script(path))]
    assert len(failures) == 1
    assert said in failures[0]


def test_what_is_lacking_is_said_in_the_unit_on_screen_from_nothing_on(
    tmp_path: Path, session: Session
) -> None:
    path = tmp_path / "mine.jsonl"
    task = '{"task": "x", "until": "particles.B.displacement.y > 0.01", "right": "", "solution": []}'
    path.write_text(HEADER.replace("}", ', "model": "isostatic"}') + f"\n{task}\n", encoding="utf-8")
    session.course = Course(session, Lesson(Script(path)))
    session.course.begin(0)
    session.course.check()
    assert session.course.said == "Displacement y of particle B is 0 cm now; wanted: more than 1 cm."


def test_own_lessons_stand_on_the_start_page(session: Session, data: Path) -> None:
    (data / "lessons").mkdir(parents=True)
    task = '{"task": "x", "until": "time > 1", "right": "", "solution": [{"run": 2}], "model": "isostatic"}'
    (data / "lessons" / "mine.jsonl").write_text(f"{HEADER}\n{task}\n", encoding="utf-8")
    (data / "lessons" / "broken.jsonl").write_text("{", encoding="utf-8")
    session.press("d")
    assert "Mine" in [tile.title for tile in session.scenes.active.form.tiles]  # type: ignore[attr-defined]
    session.type("mine")
    session.press("return")
    assert session.course is not None
    assert session.course.lesson.title == "Mine"


def test_the_start_page_offers_to_continue_what_was_begun(session: Session) -> None:
    def first() -> Any:
        session.press("d")
        titles = [tile.title for tile in session.scenes.active.form.tiles]  # type: ignore[attr-defined]
        session.press("escape")
        return next(title for title in titles if title.startswith(("Learn: ", "Continue: ")))

    names = lessons(TO_DO)
    assert first() == "Learn: 1 Draw a structure"
    progress.keep(names[4], 1)
    assert first() == "Learn: 1 Draw a structure"
    progress.keep(names[0], 1)
    assert first() == "Continue: 1 Draw a structure"
    for number in range(2, 6):
        progress.keep(names[0], number)
    assert first() == "Continue: 2 Tension or compression"


# --- the card --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", lessons(TO_DO))
def test_every_task_is_legible_in_windows_of_all_sizes(session: Session, name: str) -> None:
    course, sizes = begun(session, name), ((640, 480), (1280, 800))
    for task, size in itertools.product(range(len(course.lesson.tasks)), sizes):
        session.resize(*size)
        if size == sizes[0]:
            course.begin(task)
            session.press("f6")
        session.update_view()
        main, card = session.view.camera.viewport, course.view.camera.viewport
        assert main.width * main.height + card.width * card.height == size[0] * size[1]
        shown = compose(Model(), course.view, load_theme("light"))
        assert not list(problems([shown], Window(*size)))
        assert course.view.card is not None
        for button in course.view.card.buttons:
            [place] = hits_for(session, button.action)
            assert card.left <= place.left < place.right <= card.right, button
            assert card.top <= place.top < place.bottom <= card.bottom, button


@pytest.mark.parametrize("size", [(1024, 640), (1280, 800)])
@pytest.mark.parametrize("name", ["02_tension_or_compression", "04_supports_and_reactions", "12_frames"])
def test_every_joint_that_a_task_speaks_of_has_its_name_on_the_picture(
    name: str, size: tuple[int, int]
) -> None:
    session = Session(Model())
    session.resize(*size)
    course = begun(session, name)
    for number in range(len(course.lesson.tasks)):
        course.begin(number)
        session.update_view()
        pictures = compose_all(session.stages, load_theme("light"))
        texts = {mark.text for picture in pictures for mark in picture.marks if isinstance(mark, Text)}
        task = course.lesson.tasks[number]
        said = " ".join((task.text, task.right, *task.hints, *(choice.text for choice in task.choices)))
        called = set(re.findall(r"\b(?:about|and|at|corner|from|of|over|[Dd]rag|joint|by) ([A-Z])\b", said))
        assert texts >= called & {particle.name for particle in session.particles}, number + 1


def test_a_film_puts_a_lesson_away_but_not_its_solution(session: Session) -> None:
    course = begun(session, "03_stable_or_mechanism", 2)
    session.lesson = Script.of_lines("how", course.task.solution)
    take_up_lesson(session)
    assert session.course is course
    session.lesson = Script("2_yield_and_unload")
    take_up_lesson(session)
    assert session.course is None
    assert session.view.camera.viewport.width == session.extent[0]
