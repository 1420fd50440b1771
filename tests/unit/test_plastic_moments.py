"""Plastic moments and rotations: what a person gives, what follows from it, what is refused, and how it is kept."""

import json
from typing import Any

import numpy as np
import pytest

from pinjoint.components.field import FieldError
from pinjoint.components.model import Model
from pinjoint.components.rod import can_hinge
from pinjoint.documents.document import document, parse
from pinjoint.documents.format import ModelError
from pinjoint.paths import PathError, apply_override
from pinjoint.systems.edit.dividing import divide
from tests.reference import models


def rod(**facts: Any) -> Model:
    held = {"name": "A", "position": [0.0, 0.0], "fixed": [True, True], "fixed_rotation": True}
    member = {"name": "AB", "between": ["A", "B"], **facts}
    return parse(models.model([held, models.particle("B", 2.0, 0.0)], [member]))


@pytest.mark.parametrize(
    ("facts", "limits"),
    [
        ({}, (7.0, 7.0)),
        ({"hinged": [False, True]}, (7.0, np.inf)),
        ({"hinged": [True, True], "end_springs": [0.0, 9.0]}, (np.inf, 7.0)),
        ({"plastic_moment": None}, (np.inf, np.inf)),
    ],
)
def test_ends_that_moments_reach_have_the_limit(facts: dict[str, Any], limits: tuple[float, float]) -> None:
    model = rod(**{"bending_stiffness": 10.0, "plastic_moment": 7.0, **facts})
    assert tuple(model.rods.moment_limit[0]) == limits
    assert can_hinge(model) == (min(limits) < np.inf)
    model.settings.plasticity = False
    assert not can_hinge(model)


def test_they_are_saved_and_read_and_kept_by_a_division() -> None:
    model = rod(bending_stiffness=10.0, plastic_moment=7.0, plastic_rotation=[0.1, -0.2])
    saved = json.loads(json.dumps(document(model)))
    assert saved["rods"][0]["plastic_rotation"] == [0.1, -0.2]
    assert document(parse(saved)) == saved
    divide(model, [model.rods[0]], 3)
    assert model.rods.plastic_moment.tolist() == [7.0] * 3
    assert model.rods.plastic_rotation.tolist() == [[0.1, 0.0], [0.0, 0.0], [0.0, -0.2]]


def test_a_section_whose_strengths_were_taken_away_is_saved_so() -> None:
    model = rod(section="IPE 200")
    model.rods[0].tensile_strength = None
    again = parse(json.loads(json.dumps(document(model))))
    assert again.rods[0].tensile_strength is None
    assert again.rods[0].compressive_strength == model.rods[0].compressive_strength


def test_sections_have_plastic_moments_where_settings_say_so() -> None:
    """IPE 200 of S235: 220.6 cm³ × 235 MPa; a given one comes first, timber is brittle, what does not bend has none."""
    model = rod(section="IPE 200")
    assert not can_hinge(model)
    model.settings.plastic_hinges = True
    assert model.rods.moment_limit[0] == pytest.approx([51.84, 51.84], rel=1e-3)
    assert (
        parse(json.loads(json.dumps(document(model)))).rods.moment_limit.tolist()
        == model.rods.moment_limit.tolist()
    )
    model.rods[0].plastic_moment = 7.0
    assert model.rods.moment_limit.tolist() == [[7.0, 7.0]]
    model.rods[0].plastic_moment = None
    model.rods[0].material = "timber C24"
    assert not can_hinge(model)
    model.rods[0].material = "S355"
    assert model.rods.moment_limit[0] == pytest.approx([78.31, 78.31], rel=1e-3)
    model.rods[0].prescribed_bending_stiffness = 0.0
    assert not can_hinge(model)


def test_what_does_not_bend_has_none() -> None:
    told = r"does not bend, so that it has no plastic moment \(7 kN·m\); give it a bending stiffness above 0"
    with pytest.raises(ModelError, match=told):
        rod(plastic_moment=7.0)
    model = rod(bending_stiffness=10.0)
    apply_override(model, "rods.AB.plastic_moment=7")
    with pytest.raises(FieldError, match=told):
        model.rods[0].prescribed_bending_stiffness = 0.0
    with pytest.raises(PathError, match="must be greater than 0"):
        apply_override(model, "rods.AB.plastic_moment=0")
    assert (model.rods[0].bending_stiffness, model.rods[0].plastic_moment) == (10.0, 7.0)
