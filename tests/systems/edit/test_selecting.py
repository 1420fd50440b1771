"""Selecting, deleting and moving, as a person does it."""

import math

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.documents.document import document
from tests.systems.edit.hand import FRAME, names, preview


def selected_names(session: Session) -> set[str]:
    return set(names(session.selected))


def test_a_drag_on_empty_space_selects_in_a_box(triangle: Session) -> None:
    triangle.press("drag", triangle.point(-0.4, 1.3))
    triangle.press("drag to", triangle.point(1.2, -0.2))
    assert preview(triangle).kind == "box"
    triangle.press("drop")
    assert selected_names(triangle) == {"A", "B", "AB"}
    triangle.drag((1.8, 0.3), (2.3, -0.3), button="ctrl+click")
    assert selected_names(triangle) == {"A", "B", "C", "AB"}
    triangle.drag((-1.0, -1.0), (-0.5, -0.5))
    assert selected_names(triangle) == set()


def test_ctrl_click_adds_and_removes_ctrl_a_takes_all(triangle: Session) -> None:
    triangle.click(0.0, 0.0)
    triangle.click(2.0, 0.0, button="ctrl+click")
    assert selected_names(triangle) == {"A", "C"}
    triangle.click(0.0, 0.0, button="ctrl+click")
    assert selected_names(triangle) == {"C"}
    triangle.press("ctrl+a")
    assert selected_names(triangle) == {"A", "B", "C", "AB", "BC", "CA"}
    assert triangle.notice == "6 elements selected."


def test_what_a_click_would_hit_is_marked_before(triangle: Session) -> None:
    from pinjoint.components.tags import Hovered
    from pinjoint.systems.edit.hover import Hover

    session = Session(triangle.model, [Hover()])
    session.point(1.03, 1.0)
    session.frame(FRAME)
    assert names(session.model.tagged(Hovered)) == ["B"]


@pytest.mark.parametrize("key", ["delete", "backspace"])
def test_delete_removes_the_selected_with_what_depends_on_it_and_undo_brings_it_back(
    triangle: Session, key: str
) -> None:
    before = document(triangle.model)
    triangle.click(1.0, 1.0)
    triangle.press(key)
    assert [rod.name for rod in triangle.rods] == ["CA"]
    assert triangle.notice == "1 particle and 2 rods deleted."
    triangle.press("ctrl+z")
    assert document(triangle.model) == before
    assert names(triangle.selected) == ["B"]


def test_delete_of_a_shown_grid(empty: Session) -> None:
    empty.press("g")
    empty.click(0.2, 0.5)
    assert empty.selected == []
    empty.click(0.2, 0.5, "ctrl+click")
    empty.press("delete")
    assert empty.model.grids.count == 0


def test_nothing_selected_nothing_deleted(triangle: Session) -> None:
    triangle.press("delete")
    assert triangle.particles.count == 3
    assert triangle.notice.startswith("Nothing is selected")


def test_dragging_a_particle_in_pause_moves_its_original_position_as_one_entry(triangle: Session) -> None:
    triangle.press("drag", triangle.point(1.0, 1.0))
    for step in range(1, 9):
        triangle.press("drag to", triangle.point(1.0 + 0.05 * step, 1.0))
    triangle.press("drop")
    b = triangle.particles["B"]
    assert b.position == (1.4, 1.0)
    assert triangle.rods["AB"].rest_length == pytest.approx(math.hypot(1.4, 1.0), rel=1e-15)
    triangle.press("ctrl+z")
    assert b.position == (1.0, 1.0)
    triangle.press("ctrl+y")
    assert b.position == (1.4, 1.0)


def test_esc_puts_back_what_is_being_dragged(triangle: Session) -> None:
    triangle.press("drag", triangle.point(1.0, 1.0))
    triangle.press("drag to", triangle.point(1.5, 1.5))
    assert triangle.particles["B"].position == (1.5, 1.5)
    triangle.press("escape")
    triangle.press("drop")
    assert triangle.particles["B"].position == (1.0, 1.0)
    assert not triangle.document.history.can_undo


def test_a_drag_keeps_the_displacement(triangle: Session) -> None:
    triangle.run(until="rest")
    before = triangle.particles["B"].displacement
    forces = triangle.model.rods.axial_force.copy()
    triangle.click(1.0, 1.0)
    triangle.press("ctrl+a")
    triangle.drag((1.0, 1.0), (1.3, 1.2))
    assert triangle.particles["B"].displacement == before
    assert triangle.particles["A"].position == pytest.approx((0.3, 0.2), abs=1e-12)
    # A translation changes the forces by round-off of positions only: EA ulp(1 m) / 1 m.
    np.testing.assert_allclose(triangle.model.rods.axial_force, forces, atol=1e-9)


def test_a_selection_moves_together_and_a_rod_takes_its_ends(triangle: Session) -> None:
    triangle.click(0.0, 0.0)
    triangle.click(2.0, 0.0, button="ctrl+click")
    triangle.drag((0.0, 0.0), (0.0, -0.3))
    assert triangle.particles["A"].position == (0.0, -0.3)
    assert triangle.particles["C"].position == (2.0, -0.3)
    triangle.press("escape")
    triangle.drag((1.5, 0.35), (1.5, 0.45))  # rod BC
    assert triangle.particles["B"].position == pytest.approx((1.0, 1.1), abs=1e-12)
    assert triangle.particles["C"].position == pytest.approx((2.0, -0.2), abs=1e-12)


def test_a_dragged_particle_snaps_and_is_not_dropped_on_another(triangle: Session) -> None:
    triangle.press("g")
    triangle.drag((1.0, 1.0), (1.46, 1.2))
    assert triangle.particles["B"].position == (1.5, 1.2)
    triangle.press("drag", triangle.point(1.5, 1.2))
    triangle.press("drag to", triangle.point(2.0, 0.01))
    assert "C is here already" in triangle.notice
    triangle.press("drop")
    assert triangle.particles["B"].position == (1.5, 1.2)


def test_arrows_nudge_the_selection_by_a_pixel_and_with_shift_by_the_grid(triangle: Session) -> None:
    triangle.select(triangle.particles["B"])
    for key in ("right", "right", "up"):
        triangle.press(key)
    assert triangle.particles["B"].position == (1.02, 1.01)
    triangle.press("g")
    triangle.press("shift+left")
    assert triangle.particles["B"].position == (0.52, 1.01)
    assert triangle.time == 0.0
    for _ in range(3):
        triangle.press("ctrl+z")
    assert triangle.particles["B"].position == (1.0, 1.0)
    assert not triangle.document.history.can_undo


def test_arrows_go_through_time_once_there_is_a_run_and_ctrl_moves(triangle: Session) -> None:
    triangle.run(steps=10)
    triangle.select(triangle.particles["B"])
    triangle.press("right")
    assert (triangle.model.clock.steps, triangle.particles["B"].position) == (11, (1.0, 1.0))
    triangle.press("left")
    triangle.press("shift+right")
    assert triangle.model.clock.steps > 11
    triangle.press("up")
    assert "Ctrl with an arrow moves" in triangle.notice
    triangle.press("ctrl+up")
    assert triangle.particles["B"].position == (1.0, 1.01)
    triangle.press("ctrl+shift+left")
    assert triangle.particles["B"].position == (0.5, 1.01)
    triangle.press("r")
    triangle.press("right")
    assert (triangle.model.clock.steps, triangle.particles["B"].position) == (0, (0.51, 1.01))
    triangle.select()
    triangle.press("ctrl+right")
    assert triangle.notice.startswith("Nothing that can be moved is selected")
