"""Arrows that say which way particles are loaded and thrown."""

import numpy as np
import pytest

from pinjoint.components.load import Load
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.tags import DiagramShown
from pinjoint.components.view import Status
from pinjoint.session import Session
from pinjoint.systems.render.marks import Fills, Strokes
from pinjoint.systems.render.model.arrows import LONGEST, MOST, SHORTEST
from pinjoint.systems.render.picture import compose
from tests.systems.render.pictures import LIGHT, fill, marks_of, picture_of, triangle, view_of


def tips(model: Model, colour: tuple[int, ...] = LIGHT.load, **options: object) -> np.ndarray:
    """Where arrows of one colour end, in pixels."""
    heads = [mark.corners[:, 0] for mark in marks_of(picture_of(model, **options), Fills, colour)]
    return np.concatenate(heads) if heads else np.zeros((0, 2))


def reaches(model: Model, colour: tuple[int, ...] = LIGHT.load, **options: object) -> list[float]:
    """How long arrows of one colour are, in pixels."""
    picture = picture_of(model, **options)
    heads = [mark.corners[:, 0] for mark in marks_of(picture, Fills, colour)]
    shafts = [mark.start for mark in marks_of(picture, Strokes, colour) if mark.width == 2.0]
    return np.hypot(*(np.concatenate(heads) - np.concatenate(shafts)).T).tolist() if heads else []


def test_a_force_is_seen_without_its_diagram_and_only_then() -> None:
    model = triangle()
    assert len(tips(model)) == 0
    model.particles["B"].force = (120.0, -160.0)
    assert len(tips(model)) == 1
    assert "load (kN)" in picture_of(model).texts
    assert len(tips(model, all_diagrams=True)) == 2, "its parts"
    model.tag_only([model.particles["B"]], DiagramShown)
    assert len(tips(model)) == 2


def test_loads_say_their_size_in_statics_also_without_diagrams() -> None:
    session = Session.open("hyperstatic")
    session.particles["C"].force = (3.0, -4.0)
    session.update_view()
    (model, view), *_ = session.stages
    assert "5 kN" not in compose(model, view, LIGHT).texts
    for key in ("q", "i"):
        session.press(key)
    session.update_view()
    assert "5 kN" in compose(model, view, LIGHT).texts


def test_a_load_pushes_from_outside_where_rods_are_on_the_other_side() -> None:
    model = triangle()
    [load] = model.create(Load, 1, on=[1], force=[(0.0, -10.0)])
    (down,) = tips(model)
    load.force = (0.0, 10.0)
    (up,) = tips(model)
    [length] = reaches(model)
    assert up == pytest.approx(down - [0.0, length]), "both are above B, whose rods are below"


def test_arrows_grow_with_their_loads_and_all_can_be_seen() -> None:
    model = Model()
    forces = [(0.0, -10.0), (6.0, 8.0), (0.0, -5.0), (0.0, -1e-3)]
    model.create(Particle, 4, position=[(i, 0.0) for i in range(4)], force=forces)
    whole, slanted, half, tiny = reaches(model)
    assert whole == pytest.approx(LONGEST), "10 is a step of the scale"
    assert (slanted, half, tiny) == pytest.approx((whole, 0.5 * whole, SHORTEST))


def test_loads_and_reactions_differ_in_colour_and_name_and_share_a_scale() -> None:
    model = triangle()
    fill(model, "particles.applied_force", [(0, -10), (20, 0), (0, 0)])
    fill(model, "particles.reaction", [(0, 40), (0, 0), (-20, -30)])
    texts = picture_of(model, all_diagrams=True).texts
    assert {"load (kN)", "reaction (kN)"} <= set(texts)
    loads, reactions = (reaches(model, colour, all_diagrams=True) for colour in (LIGHT.load, LIGHT.reaction))
    assert len(loads) == 2
    assert len(reactions) == 3
    assert max(loads) == pytest.approx(0.5 * max(reactions))
    assert sorted(reactions)[0] == pytest.approx(max(loads)), "20 kN are 20 kN"


def test_a_load_and_a_reaction_along_one_line_stand_on_different_sides() -> None:
    for load in (-10.0, 10.0):
        model = triangle()
        fill(model, "particles.applied_force", [(0, load), (0, 0), (0, 0)])
        fill(model, "particles.reaction", [(0, 30), (0, 0), (0, 0)])
        [at], [answer] = (tips(model, colour, all_diagrams=True) for colour in (LIGHT.load, LIGHT.reaction))
        a = picture_place(model, "A")
        assert (at[1] < a[1]) != (answer[1] < a[1])


def picture_place(model: Model, name: str) -> np.ndarray:
    """Where a particle is in the picture, in pixels."""
    return np.asarray(view_of(model).camera.to_pixels(model.particles[name].position))


def test_a_scale_stays_while_it_fits() -> None:
    """A reaction that swings does not let the arrow of a steady load grow and shrink."""
    model, placed, seen = triangle(), {}, set()
    view = view_of(model, all_diagrams=True)
    model.particles["B"].force = (0.0, -100.0)
    fill(model, "particles.applied_force", [(0, 0), (0, -100), (0, 0)])
    for swing in (250.0, 120.0, 30.0, 180.0, 0.0, 250.0):
        fill(model, "particles.reaction", [(0, swing), (0, 0), (0, 0)])
        [mark] = marks_of(compose(model, view, LIGHT, placed), Strokes, LIGHT.load)
        seen.add(round(float(np.hypot(*(mark.end - mark.start).T)[0]), 6))
    assert len(seen) == 1


def test_pictures_beside_each_other_share_a_scale() -> None:
    model = Model()
    model.create(Particle, 1, force=[(0.0, -10.0)])
    assert reaches(model, largest_force=20.0) == pytest.approx(
        [0.5 * r for r in reaches(model, largest_force=10.0)], rel=0.1
    )


def test_a_force_too_small_for_squares_still_has_a_direction() -> None:
    model = Model()
    model.create(Particle, 1, force=[(3e-200, 4e-200)])
    (tip,) = tips(model)
    place = np.array([300.0, 300.0])
    assert (tip - place) / np.hypot(*(tip - place)) == pytest.approx([-0.6, 0.8]), "it pushes"


def test_an_arrow_at_a_rim_beyond_all_pixels_is_not_drawn() -> None:
    model = Model()
    model.create(
        Particle, 2, position=[(0.0, 0.0), (1.0, 0.0)], force=[(1.0, 0.0), (0.0, 1.0)], radius=[1e30, 0.01]
    )
    assert len(tips(model)) == 1


def test_velocities_of_free_particles_are_seen_and_those_of_nodes_before_the_run() -> None:
    model = triangle()
    model.create(Particle, 1, name=["ball"], position=[(0.0, 2.0)], velocity=[(1.0, 0.0)])
    model.particles["B"].velocity = (0.0, 1.0)
    assert len(tips(model, LIGHT.ink)) == 2
    model.writable("clock.steps")[0] = 5
    running = Status(speed=1.0, state="running")
    for status in (Status(), running):
        assert len(tips(model, LIGHT.ink, status=status)) == 1, "nodes swing to and fro"
    model.writable("clock.energy_scale")[0] = 1e4 * model.particles.mass.sum()  # the usual speed is 141 m/s
    assert len(tips(model, LIGHT.ink)) == 1
    assert len(tips(model, LIGHT.ink, status=running)) == 0, "it creeps"


def test_what_is_at_rest_has_no_velocity_though_rounding_leaves_some() -> None:
    session = Session.open("ball_on_truss")
    assert len(tips(session.model, LIGHT.ink)) == 0
    session.run(time=0.3)
    assert len(tips(session.model, LIGHT.ink)) == 1, "the ball falls"
    session.run(until="rest")
    assert session.particles["ball"].velocity[1] != 0.0
    assert len(tips(session.model, LIGHT.ink)) == 0


def test_velocities_have_a_scale_of_their_own_which_motion_that_fades_does_not_change() -> None:
    model = Model()
    model.create(
        Particle,
        2,
        position=[(0.0, 0.0), (1.0, 0.0)],
        velocity=[(1.0, 0.0), (0.5, 0.0)],
        force=[(500.0, 0.0), (0.0, 0.0)],
    )
    fast, slow = reaches(model, LIGHT.ink)
    assert (fast, slow) == pytest.approx((LONGEST, 0.5 * LONGEST))
    model.writable("clock.steps")[0] = 5
    model.writable("clock.energy_scale")[0] = 0.5 * model.particles.mass.sum()
    model.writable("particles.velocity")[...] = [(0.5, 0.0), (1e-8, 0.0)]
    [fading] = reaches(model, LIGHT.ink)
    assert fading < 0.6 * LONGEST


def test_very_many_arrows_are_left_out() -> None:
    model = Model()
    model.create(Particle, MOST + 1, position=[(i, 0.0) for i in range(MOST + 1)], force=(0.0, -1.0))
    assert len(tips(model)) == 0
    model.particles[0].force = (0.0, 0.0)
    assert len(tips(model)) == MOST
