"""Members that bend: what a person gives, what follows from it, and how it is kept."""

import json
from typing import Any

import numpy as np
import pytest

from pinjoint.components.field import FieldError
from pinjoint.components.model import Model
from pinjoint.documents.document import document, parse
from pinjoint.paths import PathError, apply_override, locate_one
from tests.reference import models

EI, EA, LENGTH, DENSITY = 10.0, 2e4, 2.0, 6.15


def rod(**facts: Any) -> Model:
    """A rod from a clamp at A along x to B, with these facts."""
    held = {"name": "A", "position": [0.0, 0.0], "fixed": [True, True], "fixed_rotation": True}
    member = {"name": "AB", "between": ["A", "B"], "stiffness": EA, "bending_stiffness": EI, **facts}
    return parse(
        models.model(
            [held, models.particle("B", LENGTH, 0.0)],
            [member],
            loads=[{"name": "p", "on": "B", "force": [0.0, -1.0], "moment": 3.0}],
        )
    )


@pytest.mark.parametrize(
    ("hinged", "stiffness", "bowing", "shares"),
    [
        ((False, False), (4, 2, 4), (4 / 30, -1 / 30, 4 / 30), (0.5, 0.5)),
        ((True, False), (0, 0, 3), (0, 0, 0.2), (0, 1)),
        ((False, True), (3, 0, 0), (0.2, 0, 0), (1, 0)),
        ((True, True), (0, 0, 0), (0, 0, 0), (0, 0)),
    ],
)
def test_hinges_are_coefficients(hinged: Any, stiffness: Any, bowing: Any, shares: Any) -> None:
    model = rod(hinged=hinged)
    assert model.rods.end_stiffness[0] == pytest.approx(np.multiply(stiffness, EI / LENGTH))
    assert model.rods.bowing[0] == pytest.approx(bowing)
    assert model.rods.turning_shares[0] == pytest.approx(shares)
    damping = 100.0 * EI / EA  # of the same relaxation time as the axis
    assert model.rods.end_damping[0] == pytest.approx(np.multiply(stiffness, damping))


def test_a_bar_has_none_and_no_rotation_takes_part() -> None:
    model = rod(bending_stiffness=0.0)
    assert not model.rods.end_stiffness.any()
    assert not model.particles.inertia.any()
    assert not model.particles.turning.any()


@pytest.mark.parametrize(("bending", "radius"), [(EI, 1.5 * EI / EA), (1e4, LENGTH**2 / 24.0)])
def test_inertia_needs_no_smaller_steps(bending: float, radius: float) -> None:
    model = rod(bending_stiffness=bending)
    assert model.particles.inertia == pytest.approx(DENSITY * LENGTH * radius)
    assert model.particles.turning[0] == 0.0
    assert model.particles.turning[1] == pytest.approx(1000.0 / model.particles.inertia[1])
    model.particles["B"].inertia = 7.0
    assert model.particles["B"].turning == 1000.0 / 7.0


def test_without_density_inertia_follows_from_the_masses() -> None:
    model = rod(density=0.0)
    model.particles.mass = 3.0
    assert model.particles.inertia == pytest.approx(2.0 * 3.0 * 1.5 * EI / EA)


def test_a_distributed_force_acts_half_on_each_end() -> None:
    model = rod(distributed_force=[1.0, -2.0], rest_length=3.0)
    assert model.particles.constant_force.tolist() == [[1.5, -3.0], [1.5, -4.0]]
    held = np.array([1.0, -2.0, 0.0]) * 9.0 / 12.0
    assert model.rods.span_load[0] == pytest.approx([*held, *-held, 0.0])
    assert model.particles.constant_moment.tolist() == [0.0, 3.0]


def test_files_keep_every_fact_and_write_no_defaults() -> None:
    facts = {
        "hinged": [True, False],
        "distributed_force": [0.5, -1.0],
        "temperature_gradient": 12.0,
        "bending_damping": 0.25,
    }
    model = rod(**facts)
    model.particles["B"].rotation, model.particles["B"].angular_velocity = 7.5, -2.0
    model.particles["B"].moment, model.particles["B"].inertia = 4.0, 5.0
    saved = json.loads(json.dumps(document(model)))
    assert saved["rods"][0] | facts == saved["rods"][0]
    moved = {"rotation": 7.5, "angular_velocity": -2.0, "moment": 4.0, "inertia": 5.0}
    assert saved["particles"][1] | moved == saved["particles"][1]
    assert document(parse(saved)) == saved
    plain = document(rod(bending_stiffness=None))
    assert set(plain["rods"][0]) == {"name", "between", "stiffness"}
    assert set(plain["particles"][1]) == {"name", "position"}


def test_a_clamped_particle_does_not_spin() -> None:
    model = rod()
    with pytest.raises(FieldError, match="angular velocity is 2 rad/s, but it is clamped; set the"):
        model.particles["A"].angular_velocity = 2.0
    model.particles["B"].angular_velocity = 2.0
    model.particles["B"].fixed_rotation = True
    assert model.particles["B"].angular_velocity == 0.0


def test_paths_name_ends() -> None:
    model = rod()
    apply_override(model, "rods.AB.hinged.end=true")
    assert model.rods["AB"].hinged == (False, True)
    assert locate_one(model, "rods.AB.bending_moment.start").axis == "start"
    with pytest.raises(PathError, match=r"write one of hinged\.start, hinged\.end"):
        apply_override(model, "rods.AB.hinged.x=true")
