"""Particles and rods, as a person draws them."""

import math

import pytest

from pinjoint import Session
from pinjoint.components import written
from pinjoint.components.view import Preview
from tests.systems.edit.hand import FRAME, press_at, preview


def test_p_makes_a_free_particle_of_1_kg_under_the_pointer(empty: Session) -> None:
    press_at(empty, "p", 0.25, -0.5)
    [particle] = empty.particles
    assert particle.name == "particle 1"
    assert particle.position == (0.25, -0.5)
    assert (particle.mass, particle.fixed, particle.velocity) == (1.0, (False, False), (0.0, 0.0))
    assert empty.notice == "Particle 1: (25, −50) cm"


@pytest.mark.parametrize(
    ("at", "expected"),
    [
        ((0.46, 1.04), (0.5, 1.0)),  # both within 5 px of a line
        ((0.46, 1.2), (0.5, 1.2)),  # each axis by itself
        ((0.3, 0.97), (0.3, 1.0)),
        ((0.3, 0.2), (0.3, 0.2)),
        ((0.44, 0.06), (0.44, 0.06)),  # 6 px away
    ],
)
def test_it_snaps_to_lines_of_the_shown_grid_within_5_px(
    empty: Session, at: tuple[float, float], expected: tuple[float, float]
) -> None:
    empty.press("g")
    press_at(empty, "p", *at)
    assert empty.particles[0].position == expected


def test_without_a_shown_grid_it_does_not_snap(empty: Session) -> None:
    empty.press("g")
    empty.press("h")
    press_at(empty, "p", 0.46, 1.04)
    assert empty.particles[0].position == (0.46, 1.04)


def test_no_second_particle_at_the_same_place(empty: Session) -> None:
    press_at(empty, "p", 0.0, 0.0)
    press_at(empty, "p", 0.05, 0.0)
    assert empty.particles.count == 1
    assert empty.notice.startswith("Particle 1 is here already")


def test_particles_are_made_while_time_passes(triangle: Session) -> None:
    triangle.press("space")
    triangle.frame(FRAME)
    press_at(triangle, "p", 3.0, 3.0)
    triangle.frame(FRAME)
    assert triangle.scene == "simulation"
    assert triangle.particles.count == 4


@pytest.mark.parametrize("second", ["l", "click", "drag"])
def test_l_over_a_particle_then_l_or_a_click_over_another_or_a_drag_there(two: Session, second: str) -> None:
    press_at(two, "l", 0.0, 0.0)
    if second == "drag":
        two.drag((0.0, 0.0), (1.5, 0.0))
    else:
        press_at(two, second, 1.5, 0.0)
    [rod] = two.rods
    assert [end.name for end in rod.ends] == ["particle 1", "particle 2"]
    assert two.notice == "Rod 1: 150 cm"
    assert two.particles["particle 1"].mass == pytest.approx(6.15 * 1.5 / 2, rel=1e-15)
    assert two.gesture is None


def test_the_length_is_shown_before_the_rod_is_made(two: Session) -> None:
    press_at(two, "l", 0.0, 0.0)
    two.point(1.0, 1.0)
    assert preview(two) == Preview("rod", (0.0, 0.0), (1.0, 1.0), "141.4 cm, 45°")
    two.point(1.47, 0.03)  # snaps to the particle
    assert preview(two) == Preview("rod", (0.0, 0.0), (1.5, 0.0), "150 cm")


def test_esc_cancels_the_rod_and_stays_in_pause(two: Session) -> None:
    press_at(two, "l", 0.0, 0.0)
    two.press("escape")
    two.frame(FRAME)
    assert (two.scene, two.gesture, two.view.preview) == ("pause", None, None)
    press_at(two, "l", 1.5, 0.0)
    assert two.rods.count == 0


def test_a_rod_that_cannot_be_is_refused_and_the_tool_goes_on(two: Session) -> None:
    press_at(two, "l", 0.0, 0.0)
    press_at(two, "l", 0.0, 0.0)
    assert "two different particles" in two.notice
    press_at(two, "l", 1.5, 0.0)
    assert two.rods.count == 1
    press_at(two, "l", 1.5, 0.0)
    press_at(two, "l", 0.0, 0.0)
    assert two.rods.count == 1
    assert "Rod 1 already joins particle 2 and particle 1" in two.notice


def test_the_rod_tool_drags_from_particle_to_particle_until_it_is_put_away(two: Session) -> None:
    press_at(two, "p", 0.0, 1.0)
    press_at(two, "l", -1.0, -1.0)  # over nothing: the tool is in hand
    two.drag((0.0, 0.0), (1.5, 0.0))
    two.drag((1.5, 0.0), (0.0, 1.0))
    assert two.rods.count == 2
    two.click(0.0, 0.0)  # the chain goes on from where the last one ended
    assert two.rods.count == 3
    two.press("escape")
    two.drag((0.0, 1.0), (0.0, 1.3))
    assert two.rods.count == 3
    assert two.particles["particle 3"].position == (0.0, 1.3)


def test_with_the_tool_in_hand_rods_follow_one_another_until_the_chain_is_ended(empty: Session) -> None:
    """By clicks on nothing: particles are made, on the grid if near it."""
    empty.press("g")
    empty.act("rod", (5.0, 5.0))
    assert empty.view.tool == "rod"
    for x, y in ((0.0, 0.0), (0.98, 0.03), (0.5, 1.0), (0.0, 0.0)):
        empty.click(x, y)
    assert empty.particles.position.tolist() == [[0.0, 0.0], [1.0, 0.0], [0.5, 1.0]]
    assert empty.model.rods.between.tolist() == [[0, 1], [1, 2], [2, 0]]
    empty.point(0.2, 0.4)
    assert preview(empty).start == (0.0, 0.0)
    empty.press("double click", empty.point(0.0, 0.0))
    assert (empty.gesture, empty.view.tool) == (None, "rod")
    empty.click(2.0, 0.0)
    empty.click(2.0, 1.0)
    assert empty.rods.count == 4
    empty.press("right click")
    assert (empty.gesture, empty.view.tool, empty.view.menu) == (None, "", None)
    empty.press("ctrl+z")  # the last rod with the two particles that it brought
    assert (empty.particles.count, empty.rods.count) == (3, 3)


def test_a_rod_that_is_nearly_level_or_upright_is_so(empty: Session) -> None:
    press_at(empty, "l", 5.0, -3.0)
    for x, y in ((0.0, 0.0), (2.0, 0.04), (2.03, -1.5), (1.0, -1.6)):
        empty.click(x, y)
    places = [particle.position for particle in empty.particles]
    assert places == [(0.0, 0.0), (2.0, 0.0), (2.0, -1.5), (1.0, -1.6)]


def test_a_drag_over_nothing_with_the_rod_tool_makes_both_ends(empty: Session) -> None:
    empty.act("rod", (5.0, 5.0))
    empty.drag((0.0, 0.0), (1.0, 1.0))
    assert (empty.particles.count, empty.rods.count) == (2, 1)
    empty.press("escape")  # of the rod that would follow, and of the tool
    assert (empty.gesture, empty.view.tool) == (None, "")


def test_a_rod_between_displaced_particles_has_their_distance_at_creation(two: Session) -> None:
    two.particles["particle 2"].displacement = (0.0, 0.2)
    press_at(two, "l", 0.0, 0.0)
    press_at(two, "l", 1.5, 0.2)
    [rod] = two.rods
    assert rod.rest_length == math.hypot(1.5, 0.2)
    assert abs(rod.axial_force) < 1e-9


def test_attaching_and_deleting_a_rod_recomputes_masses_as_one_entry(two: Session) -> None:
    two.particles["particle 1"].mass = 50.0
    press_at(two, "l", 0.0, 0.0)
    press_at(two, "l", 1.5, 0.0)
    assert two.particles["particle 1"].mass == pytest.approx(4.6125, rel=1e-15)
    two.particles["particle 2"].mass = 70.0
    two.select(two.rods[0])
    two.press("delete")
    assert [particle.mass for particle in two.particles] == [1.0, 1.0]
    two.press("ctrl+z")
    assert two.particles["particle 2"].mass == 70.0
    two.press("ctrl+z")
    two.press("ctrl+z")
    assert two.rods.count == 0
    assert two.particles["particle 1"].mass == 50.0


# --- arrows ------------------------------------------------------------------------------------------


def arrow(session: Session, points: float, name: str) -> tuple[float, float]:
    """The force of an arrow so many points up from a particle."""
    x, y = session.view.camera.to_pixels(session.particles[name].position).tolist()
    session.press("f", (x, y))
    session.press("f", (x, y - points))
    force: tuple[float, float] = session.particles[name].force
    return force


def test_all_arrows_of_a_model_are_drawn_to_one_scale_that_is_told(two: Session) -> None:
    press_at(two, "l", 0.0, 0.0)
    press_at(two, "l", 1.5, 0.0)
    first = arrow(two, 75.0, "particle 1")
    two.view.camera.zoom(2.0, two.view.camera.middle)
    two.press("f", two.point(*two.particles["particle 2"].position))
    two.update_view()
    said = f"10 px = {written.given(10.0 * first[1] / 75.0)} kN"
    assert said in two.view.status.hint
    two.press("escape")
    assert arrow(two, 75.0, "particle 2") == first


def test_the_arrow_of_a_load_is_dragged_in_steps_by_its_scale(two: Session) -> None:
    press_at(two, "l", 0.0, 0.0)
    press_at(two, "l", 1.5, 0.0)
    _, up = arrow(two, 75.0, "particle 1")
    two.update_view()
    x, y = two.view.camera.to_pixels(two.particles["particle 1"].position).tolist()
    tail = x, y + 40.0  # it points to its particle, from below
    two.press("drag", tail)
    two.press("drag to", (tail[0] + 2.0, tail[1] + 18.0))
    assert two.particles["particle 1"].force == (0.0, pytest.approx(up * 95.0 / 75.0))
    two.press("shift+drag to", (tail[0], tail[1] + 33.0))
    assert two.particles["particle 1"].force == (0.0, pytest.approx(up * 108.0 / 75.0))
    two.press("drag to", (tail[0], tail[1] + 31.0))
    two.press("drop", (tail[0], tail[1] + 31.0))
    assert two.particles["particle 1"].force == (0.0, pytest.approx(up * 105.0 / 75.0))
    two.undo()
    assert two.particles["particle 1"].force == (0.0, up)


def test_escape_gives_a_dragged_load_back(two: Session) -> None:
    press_at(two, "l", 0.0, 0.0)
    press_at(two, "l", 1.5, 0.0)
    down = -arrow(two, 75.0, "particle 1")[1]
    two.particles["particle 1"].force = (0.0, down)
    two.update_view()
    x, y = two.view.camera.to_pixels(two.particles["particle 1"].position).tolist()
    tail = x, y - 40.0
    two.press("drag", tail)
    two.press("drag to", (tail[0], tail[1] - 20.0))
    assert two.particles["particle 1"].force == (0.0, pytest.approx(down * 95.0 / 75.0))
    two.press("escape")
    assert two.particles["particle 1"].force == (0.0, down)
