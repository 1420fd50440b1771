"""Walls in the program: drawn, picked, moved, copied, undone, saved; impacts name them."""

import math
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components import FieldError, Handle
from pinjoint.components.camera import Viewport
from pinjoint.components.obstacles import obstacles
from pinjoint.components.view import Preview
from pinjoint.documents import models
from pinjoint.documents.format import ModelError
from pinjoint.systems.broad_phase import gaps
from pinjoint.systems.render.marks import Strokes
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.render.ui.thumbnails import thumbnail
from tests.reference.hits import push
from tests.reference.models import model

FRAME = 1.0 / 60.0


def room(*walls: dict[str, Any], particles: list[dict[str, Any]] | None = None, **rest: Any) -> Session:
    """Open a model with walls, and a ball of 1 kg 1 m above the origin."""
    ball = {"name": "ball", "position": [0, 1.05]}
    document = model(
        [ball] if particles is None else particles,
        [],
        environment={"acceleration": [0, -9.81]},
        settings={"restitution": 0.5},
        components={"walls.Wall": list(walls)},
    )
    session = Session.open(document | rest)
    session.view.camera.scale = 150.0
    session.view.camera.centre = (0.0, 0.5)
    return session


FLOOR = {"name": "floor", "start": [-1, 0], "end": [1, 0]}


def walls_of(session: Session) -> list[Any]:
    return list(session.table("walls"))


def test_a_wall_is_drawn_from_point_to_point_and_undone() -> None:
    session = room()
    session.point(-0.8, 0.1)
    session.press("w")
    session.point(0.9, 0.1)
    session.update_view()
    assert isinstance(session.view.preview, Preview)
    assert session.view.preview.label == "170 cm, 0°"
    session.press("w")
    [wall] = walls_of(session)
    assert (wall.name, wall.start, wall.end, wall.restitution) == ("wall 1", (-0.8, 0.1), (0.9, 0.1), None)
    assert session.selected == [wall]
    assert session.notice == "Wall 1: 170 cm, 0°"
    session.press("ctrl+z")
    assert walls_of(session) == []
    session.press("ctrl+y")
    assert [w.end for w in walls_of(session)] == [(0.9, 0.1)]


def test_the_button_takes_the_tool_up_and_drags_draw_one_after_the_other() -> None:
    session = room()
    session.resize(1280, 800)
    session.update_view()
    push(session, "walls.wall")
    assert session.view.tool == "walls.wall"
    session.drag((-1, 0), (1, 0))
    session.drag((1.01, 0.01), (1, 0.8))  # the new one begins where the other ends
    session.click(-1, 0.8)
    session.click(-1, 0)
    ends = [(wall.start, wall.end) for wall in walls_of(session)]
    assert ends == [((-1, 0), (1, 0)), ((1, 0), (1, 0.8)), ((-1, 0.8), (-1, 0))]
    session.press("escape")
    assert session.view.tool == ""


def test_it_snaps_to_the_grid_and_has_a_length() -> None:
    session = room(grids=[{"spacing": [0.5, 0.5]}])
    session.point(-0.49, 0.01)
    session.press("w")
    session.click(-0.5, 0)
    assert "begin and end at the same point" in session.notice
    session.click(1.01, 0.49)
    [wall] = walls_of(session)
    assert (wall.start, wall.end) == ((-0.5, 0.0), (1.0, 0.5))
    with pytest.raises(FieldError, match="its start and its end are the same point"):
        wall.end = (-0.5, 0.0)
    assert wall.end == (1.0, 0.5)


def test_what_the_pointer_is_over_is_picked_and_its_end_or_all_of_it_is_dragged() -> None:
    session = room(FLOOR)
    session.click(0.4, 0.02)
    [floor] = walls_of(session)
    assert session.selected == [floor]
    session.drag((1, 0), (1.2, 0.3))
    assert (floor.start, floor.end) == ((-1, 0), (1.2, 0.3))
    assert session.notice == "Wall floor, end: (120, 30) cm"
    session.press("ctrl+z")
    session.drag((0.3, 0), (0.4, -0.2))
    assert floor.start == pytest.approx((-0.9, -0.2))
    assert floor.end == pytest.approx((1.1, -0.2))
    session.press("ctrl+z")
    assert (floor.start, floor.end) == ((-1, 0), (1, 0))
    session.select(floor)
    session.press("up")
    assert floor.start[1] == floor.end[1] > 0


def test_a_box_selects_it_when_both_ends_are_inside() -> None:
    session = room(FLOOR)
    [floor] = walls_of(session)
    session.drag((-0.5, 0.3), (1.5, -0.3))
    assert session.selected == []
    session.drag((-1.3, 0.3), (1.5, -0.3))  # from beside the toolbar
    assert session.selected == [floor]
    session.press("ctrl+a")
    assert session.selected == [session.particles["ball"], floor]


def test_it_is_copied_duplicated_and_deleted_with_and_without_particles() -> None:
    session = room(FLOOR | {"restitution": 0.25})
    [floor] = walls_of(session)
    session.select(floor)
    session.press("ctrl+d")
    assert [wall.name for wall in walls_of(session)] == ["floor", "wall 1"]
    copy = walls_of(session)[1]
    assert copy.restitution == 0.25
    assert np.subtract(copy.end, copy.start) == pytest.approx((2, 0))
    session.press("ctrl+a")
    session.press("ctrl+c")
    session.point(3, 3)
    session.press("ctrl+v")
    assert (session.particles.count, len(walls_of(session))) == (2, 4)
    session.press("delete")
    session.select(floor)
    session.press("delete")
    assert [wall.name for wall in walls_of(session)] == ["wall 1"]
    session.press("ctrl+z")
    assert [wall.name for wall in walls_of(session)] == ["floor", "wall 1"]
    assert floor.exists


def test_its_properties_are_boxes() -> None:
    session = room(FLOOR)
    session.select(*walls_of(session))
    session.press("return")
    assert session.boxes["restitution"] == "automatic"
    session.click_box("restitution")
    session.type("0.25")
    session.click_box("end x")
    session.type("150")
    session.press("return")
    session.press("escape")
    [floor] = walls_of(session)
    assert (floor.restitution, floor.end) == (0.25, (1.5, 0.0))


def test_small_pictures_show_it() -> None:
    """Those from which a model is chosen: the stairs without steps were only a ball."""
    shown = thumbnail(models.load("staircase"), Viewport(0, 0, 180, 108), 1.0, load_theme("light"))
    ends = np.concatenate([mark.end for mark in shown if isinstance(mark, Strokes)])
    walls = Session.open("staircase").table("walls")
    assert len(walls) > 1
    assert len(ends) >= len(walls)


def test_impacts_name_it_and_a_ball_comes_to_rest_on_it() -> None:
    session = room(FLOOR)
    assert session.run(until="rest") == "at rest"
    assert session.particles["ball"].displacement == pytest.approx((0, -1), abs=1e-8)
    lines = session.impacts.as_csv().splitlines()
    assert lines[1].startswith("0.45152364098573")
    assert lines[1].split(",")[1:3] == ["ball", "floor"]
    assert session.energy.imbalance == pytest.approx(0, abs=1e-9)
    assert session.particles["ball"].applied_force == pytest.approx((0, 0), abs=1e-9)


def test_a_structure_falls_on_it_and_stays() -> None:
    """Its nodes are driven by a rod, so that its steps end at the impacts; the floor's own restitution counts."""
    particles = [
        {"name": "A", "position": [0, 0.55], "mass": 1},
        {"name": "B", "position": [0.5, 0.75], "mass": 1},
    ]
    rods = [{"name": "AB", "between": ["A", "B"], "stiffness": 10, "damping": 0.05}]
    session = room(FLOOR | {"restitution": 0.2}, particles=particles, rods=rods)
    assert session.run(until="rest") == "at rest"
    for particle in session.particles:
        assert particle.position[1] + particle.displacement[1] == pytest.approx(0.05, abs=1e-8)
    energy = session.energy
    assert abs(energy.imbalance) < 1e-6 * energy.work
    pairs = np.array([[0, 2], [1, 2]])
    discs = session.model.particles
    _, normal = gaps(discs.position + discs.displacement, discs.radius, pairs, obstacles(session.model))
    assert normal == pytest.approx(np.array([[0, -1], [0, -1]]))


def test_particles_that_lie_on_it_are_moved_off() -> None:
    session = room(FLOOR, particles=[{"name": "ball", "position": [0, 0.02]}])
    session.run(time=0.01)
    assert "overlap" in session.message
    ball = session.particles["ball"]
    assert ball.position[1] + ball.displacement[1] == pytest.approx(0.05, abs=1e-9)


def test_files_keep_it_even_without_the_mod() -> None:
    session = room(FLOOR | {"restitution": 0.25}, {"name": "side", "start": [1, 0], "end": [1, 1]})
    saved = models.document(session.model)
    assert saved["components"]["walls.Wall"][0] == {**FLOOR, "restitution": 0.25}
    assert models.document(models.load(saved)) == saved
    stranger = saved | {"components": {**saved["components"], "gates.Gate": [{"name": "g", "width": 2}]}}
    opened = Session.open(stranger)
    assert "gates" in opened.message
    assert models.document(opened.model) == stranger


@pytest.mark.parametrize(
    ("components", "problem"),
    [
        (
            {"walls.Wall": [{"name": "a", "start": [0, 0]}]},
            r"\$.components.walls.Wall\[0\] \(wall a\): its 'end'",
        ),
        ({"walls.Wall": [{"start": [0, 0], "end": [0, 0]}]}, r"\$.components.walls.Wall\[0\]: .* same point"),
        ({"walls.Wall": [{"start": [0, 0], "end": [1, 0], "size": 1}]}, "there is no key 'size' here"),
        ({"walls.Wall": [{"start": [0, 0], "end": [1, 0], "restitution": 2}]}, "restitution is 2"),
        ({"walls.Wall": {"start": [0, 0]}}, 'must have the form "mod.Kind"'),
        ({"walls": []}, 'must have the form "mod.Kind"'),
        ({"walls.walls": []}, "the mod 'walls' has no 'walls.walls' here; did you mean 'walls.Wall'"),
        ([], "it must be an object"),
    ],
)
def test_mistakes_in_files_are_explained(components: Any, problem: str) -> None:
    with pytest.raises(ModelError, match=problem):
        models.load({"format": "pinjoint model", "version": 1, "components": components})


def test_scripts_and_the_command_line_set_it_by_its_name() -> None:
    from pinjoint.paths import apply_override

    session = room(FLOOR)
    apply_override(session.model, "walls.floor.restitution=0.75")
    apply_override(session.model, "walls.*.end.x=2")
    [floor] = walls_of(session)
    assert (floor.restitution, floor.end) == (0.75, (2.0, 0.0))
    with pytest.raises(KeyError, match="did you mean 'walls'"):
        session.table("wall")
    assert isinstance(session.table("walls")["floor"], Handle)


# --- what rods, drag or a hand drive -----------------------------------------------------------------------


def test_the_impact_of_what_drag_slows_down_is_found_in_the_step() -> None:
    """x = (v/c)(1 − exp(−c t)) reaches d at t = −ln(1 − c d/v)/c; then it goes back with e times its speed."""
    ball = {"name": "ball", "position": [0, 0.5], "velocity": [2, 0]}
    wall = {"name": "wall", "start": [1, 0], "end": [1, 1], "restitution": 0.75}
    session = room(wall, particles=[ball], environment={"drag": 0.5})
    session.run(time=0.7)
    distance = 1 - 0.05
    expected = -math.log(1 - 0.5 * distance / 2) / 0.5
    assert session.impacts.time == pytest.approx([expected], rel=1e-9)
    speed = -0.75 * (2 - 0.5 * distance) * math.exp(-0.5 * (0.7 - expected))
    assert session.particles["ball"].velocity[0] == pytest.approx(speed, rel=1e-8)


def test_no_node_of_a_fast_structure_gets_through() -> None:
    """Two nodes at 2000 m/s, that would cross ten walls in a step, stay between the two that are there."""
    particles = [
        {"name": name, "position": [x, 0.5], "velocity": [2000, 0], "mass": 1, "radius": 0.01}
        for name, x in (("A", 0.2), ("B", 0.5))
    ]
    sides = [{"name": f"side {x}", "start": [x, 0], "end": [x, 1]} for x in (0, 1)]
    rods = [{"name": "AB", "between": ["A", "B"], "stiffness": 1000, "damping": 0}]
    session = room(*sides, particles=particles, rods=rods, environment={}, settings={"time_step": 1e-4})
    for _ in range(20):
        session.run(time=5e-4)
        for particle in session.particles:
            assert 0.01 * (1 - 1e-9) <= particle.position[0] + particle.displacement[0] <= 0.99 * (1 + 1e-9)
    assert len(session.impacts) > 5


def test_a_hand_cannot_pull_a_ball_through_it() -> None:
    wall = {"name": "wall", "start": [1, 0], "end": [1, 1]}
    session = room(wall, particles=[{"name": "ball", "position": [0.5, 0.5]}], environment={})
    session.press("space")
    session.frame(FRAME)
    session.press("drag", session.point(0.5, 0.5))
    for k in range(40):
        session.press("drag to", session.point(0.5 + 0.05 * k, 0.5))
        session.frame(FRAME)
    ball = session.particles["ball"]
    assert ball.position[0] + ball.displacement[0] == pytest.approx(0.95, abs=1e-6)
    session.press("drop")


def test_a_saved_run_goes_on_bit_for_bit() -> None:
    sides = [((0, 0), (1, 0)), ((1, 0), (1, 1)), ((0, 1), (0, 0))]
    walls = [{"name": f"side {k}", "start": start, "end": end} for k, (start, end) in enumerate(sides)]
    particles = [{"name": f"p{k}", "position": [0.2 + 0.3 * k, 0.5], "velocity": [1 - k, 0]} for k in range(3)]
    first = room(*walls, particles=particles)
    first.run(time=0.5)
    second = Session.open(models.document(first.model))
    for session in (first, second):
        session.run(time=0.5)
    assert first.particles.displacement.tobytes() == second.particles.displacement.tobytes()
    assert first.particles.velocity.tobytes() == second.particles.velocity.tobytes()
    assert len(second.impacts) > 0


def test_editing_it_in_a_run_counts_from_then_on() -> None:
    session = room(FLOOR)
    session.run(until="rest")
    session.model.delete(walls_of(session))
    session.run(time=0.5)
    assert session.particles["ball"].displacement[1] == pytest.approx(-1 - 0.5 * 9.81 * 0.25, abs=1e-8)
    session.undo()
    session.undo()
    assert session.particles["ball"].displacement[1] == pytest.approx(-1, abs=1e-8)
    assert [wall.name for wall in walls_of(session)] == ["floor"]
