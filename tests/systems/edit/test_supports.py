"""Supports, forces and velocities, by keys and arrows."""

import pytest

from pinjoint import Session
from pinjoint.components.field import Vector
from tests.systems.edit.hand import press_at, preview


def test_c_goes_through_the_supports(triangle: Session) -> None:
    seen = []
    for _ in range(4):
        press_at(triangle, "c", 1.0, 1.0)
        seen.append(triangle.particles["B"].fixed)
    assert seen == [(True, True), (False, True), (True, False), (False, False)]
    assert triangle.notice == "Particle B: free"


def test_c_supports_all_the_selected(two: Session) -> None:
    two.press("ctrl+a")
    press_at(two, "c", 5.0, 5.0)
    assert [particle.fixed for particle in two.particles] == [(True, True)] * 2
    two.press("escape")
    press_at(two, "c", 5.0, 5.0)  # where nothing is: with the clicks and drags that follow
    assert two.view.tool == "support"
    press_at(two, "c", 5.0, 5.0)
    assert two.view.tool == ""


@pytest.mark.parametrize(
    ("to", "fixed", "symbol"),
    [
        ((0.0, -0.5), (False, True), "roller"),
        ((0.1, 0.5), (False, True), "roller"),
        ((-0.5, 0.1), (True, False), "roller"),
        ((0.4, -0.4), (True, True), "pinned"),
    ],
)
def test_a_support_is_dragged_to_its_ground(
    two: Session, to: Vector, fixed: tuple[bool, bool], symbol: str
) -> None:
    press_at(two, "c", 5.0, 5.0)
    first, second = two.particles
    x, y = first.position
    two.press("drag", two.point(x, y))
    two.press("drag to", two.point(x + to[0], y + to[1]))
    assert preview(two).kind == symbol
    assert "held in" in two.view.status.hint
    assert first.fixed == (False, False)
    two.press("drop")
    assert first.fixed == fixed
    assert second.fixed == (False, False)
    assert two.view.tool == "support"
    two.press("ctrl+z")
    assert first.fixed == (False, False)


def test_a_support_dragged_back_or_hardly_is_the_next_kind_and_escape_leaves_it(two: Session) -> None:
    press_at(two, "c", 5.0, 5.0)
    first = next(iter(two.particles))
    x, y = first.position
    two.drag((x, y), (x + 0.02, y))
    assert first.fixed == (True, True)
    two.press("drag", two.point(x, y))
    two.press("drag to", two.point(x, y - 0.5))
    two.press("escape")
    assert first.fixed == (True, True)


def test_dragging_one_of_the_selected_supports_all_of_them(two: Session) -> None:
    two.press("ctrl+a")
    two.view.tool = "support"
    x, y = next(iter(two.particles)).position
    two.drag((x, y), (x, y - 0.5))
    assert [particle.fixed for particle in two.particles] == [(False, True)] * 2
    assert two.notice.endswith("and 1 more: roller: held in y")


def test_a_force_is_drawn_as_an_arrow_to_a_round_scale(triangle: Session) -> None:
    triangle.particles["B"].force = (0.0, 0.0)
    press_at(triangle, "f", 1.0, 1.0)
    triangle.point(1.6, 0.2)
    assert preview(triangle).label == "(60, −80) kN"  # 1 kN a pixel: 0.001 EA is 164.64 kN
    triangle.click(1.6, 0.2)
    assert triangle.particles["B"].force == (60.0, -80.0)
    assert triangle.notice == "Load on B: (60, −80) kN"


def test_a_force_along_an_axis_snaps_to_it_and_a_drop_on_the_particle_takes_it_away(triangle: Session) -> None:
    press_at(triangle, "f", -1.0, -1.0)
    triangle.drag((1.0, 1.0), (1.03, 0.2))
    assert triangle.particles["B"].force == (0.0, -80.0)
    triangle.drag((1.0, 1.0), (1.02, 1.02))
    assert triangle.particles["B"].force == (0.0, 0.0)
    assert triangle.view.tool == "force"
    triangle.press("f", (1.0, 1.0))
    assert triangle.view.tool == ""


def test_a_velocity_is_drawn_as_an_arrow_and_only_where_it_is_free(triangle: Session) -> None:
    press_at(triangle, "v", 0.0, 0.0)
    triangle.click(1.0, 0.5)
    assert triangle.particles["A"].velocity == (5.0, 0.0)  # on a roller; 100 px are 5 m/s
    press_at(triangle, "v", 2.0, 0.0)
    assert "held in x and y" in triangle.notice
    triangle.press("ctrl+z")
    assert triangle.particles["A"].velocity == (0.0, 0.0)
