"""Joining: rods that are drawn onto members or across them, the choice to cross them, and where they snap."""

import pytest

from pinjoint import Session
from pinjoint.scripts.script import NEW
from tests.reference.models import model, particle, rod
from tests.systems.edit.hand import preview


def beam(stiffness: float = 1000.0) -> Session:
    """A member from (0, 0) to (4, 0), and the tool for rods in hand."""
    session = Session.open(
        model([particle("A", 0, 0), particle("B", 4, 0)], [rod("A", "B", bending_stiffness=stiffness)])
    )
    session.press("l", (5.0, 5.0))
    return session


def lines(session: Session) -> set[frozenset[tuple[float, float]]]:
    places = [tuple(one) for one in session.model.particles.position.tolist()]
    return {frozenset((places[first], places[last])) for first, last in session.model.rods.between.tolist()}


def test_a_rod_that_ends_on_a_member_is_joined_to_it() -> None:
    session = beam()
    session.click(1.0, 2.0)
    session.point(1.0, 0.03)
    assert preview(session).joints == ((1.0, 0.0),)
    session.click(1.0, 0.03)  # near enough to be meant
    assert lines(session) == {
        frozenset({(0.0, 0.0), (1.0, 0.0)}),
        frozenset({(1.0, 0.0), (4.0, 0.0)}),
        frozenset({(1.0, 2.0), (1.0, 0.0)}),
    }
    assert "joined to a member" in session.notice
    session.undo()
    assert len(session.model.rods) == 1
    assert len(session.model.particles) == 2


def test_a_rod_that_begins_on_a_member_is_joined_to_it() -> None:
    session = beam()
    session.click(3.0, -0.02)
    session.type("2 m@90")
    session.press("return")
    assert frozenset({(3.0, 0.0), (3.0, 2.0)}) in lines(session)
    assert len(session.model.rods) == 3


def test_a_rod_across_members_is_joined_to_each() -> None:
    session = Session.open(
        model(
            [particle(name, x, y) for name, x, y in (("A", 0, 0), ("B", 4, 0), ("C", 0, 1), ("D", 4, 1))],
            [rod("A", "B", bending_stiffness=1.0), rod("C", "D", bending_stiffness=1.0)],
        )
    )
    session.press("l", (5.0, 5.0))
    session.click(2.0, -1.0)
    session.point(2.0, 2.0)
    assert preview(session).joints == ((2.0, 0.0), (2.0, 1.0))
    session.click(2.0, 2.0)
    assert len(session.model.rods) == 7
    assert {(2.0, 0.0), (2.0, 1.0)} <= {one.position for one in session.model.particles}


def test_the_choice_to_cross_is_shown_and_kept() -> None:
    session = beam()
    session.update_view()
    assert "joins members (Ctrl+T: crosses)" in session.view.status.hint
    session.press("ctrl+t")
    session.update_view()
    assert "crosses members (Ctrl+T: joins)" in session.view.status.hint
    session.click(1.0, 2.0)
    session.point(1.0, -2.0)
    assert preview(session).joints == ()
    session.click(1.0, -2.0)
    assert len(session.model.rods) == 2


def test_bars_that_do_not_bend_are_crossed() -> None:
    session = beam(0.0)
    session.update_view()
    assert "Ctrl+T" not in session.view.status.hint
    session.click(1.0, 2.0)
    session.click(1.0, -2.0)
    assert len(session.model.rods) == 2


def test_a_rod_between_ends_of_members_divides_none() -> None:
    session = beam()
    session.click(4.0, 0.0)
    session.click(4.0, 3.0)
    assert len(session.model.rods) == 2


@pytest.mark.parametrize("tool", ["p", "l"])
def test_a_mark_shows_where_a_click_will_act(tool: str) -> None:
    session = Session.open(NEW)
    session.press(tool, (5.0, 5.0))
    session.point(1.02, 0.53)
    shown = preview(session)
    assert (shown.kind, shown.start, shown.label) == ("hinge", (1.0, 0.5), "(100, 50) cm")
    session.click(1.02, 0.53)
    session.click(2.02, 0.53)
    assert [one.position for one in session.model.particles] == [(1.0, 0.5), (2.0, 0.5)]


def test_a_new_model_has_a_grid() -> None:
    session = Session.open("isostatic")
    session.press("ctrl+n")
    [grid] = session.model.grids
    assert grid.shown
    assert grid.spacing == (0.5, 0.5)
