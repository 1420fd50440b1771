"""Arrows that say which way particles are loaded and thrown."""

from __future__ import annotations

import numpy as np
import pytest

from components.load import Load
from components.model import Model
from components.particle import Particle
from components.tags import DiagramShown
from components.view import Status
from systems.render.arrows import LENGTH, MOST
from systems.render.marks import Fills
from tests.systems.render.pictures import LIGHT, marks_of, picture_of, triangle


def tips(model: Model, colour: tuple[int, ...] = LIGHT.force, **options: object) -> np.ndarray:
    """Where arrows of one colour end, in pixels."""
    heads = [mark.corners[:, 0] for mark in marks_of(picture_of(model, **options), Fills, colour)]
    return np.concatenate(heads) if heads else np.zeros((0, 2))


def test_a_force_is_seen_without_its_diagram_and_only_then() -> None:
    model = triangle()
    assert len(tips(model)) == 0
    model.particles["B"].force = (120.0, -160.0)
    assert len(tips(model)) == 1
    assert "load" in picture_of(model).texts
    assert len(tips(model, all_diagrams=True)) == 0
    model.tag(model.particles["B"], DiagramShown)
    assert len(tips(model)) == 0


def test_a_load_pushes_from_outside_where_rods_are_on_the_other_side() -> None:
    model = triangle()
    [load] = model.create(Load, 1, on=[1], force=[(0.0, -10.0)])
    (down,) = tips(model)
    load.force = (0.0, 10.0)
    (up,) = tips(model)
    assert up == pytest.approx(down - [0.0, LENGTH]), "both are above B, whose rods are below"


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


def test_velocities_are_seen_while_time_stands_still() -> None:
    model = triangle()
    model.create(Particle, 1, name=["ball"], position=[(0.0, 2.0)], velocity=[(1.0, 0.0)])
    model.particles["B"].velocity = (0.0, 1.0)
    assert len(tips(model, LIGHT.ink)) == 2
    assert len(tips(model, LIGHT.ink, status=Status(speed=1.0, state="running"))) == 0
    model.writable("clock.steps")[0] = 5
    assert len(tips(model, LIGHT.ink)) == 1, "nodes swing to and fro"


def test_very_many_arrows_are_left_out() -> None:
    model = Model()
    model.create(Particle, MOST + 1, position=[(i, 0.0) for i in range(MOST + 1)], force=(0.0, -1.0))
    assert len(tips(model)) == 0
    model.particles[0].force = (0.0, 0.0)
    assert len(tips(model)) == MOST
