"""Dividing members: what the parts have, what stays as it was, and what is refused."""

import math

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.slider import Aim, SetSliders, Slider
from pinjoint.documents.document import document
from pinjoint.scripts.lines import perform
from pinjoint.systems.edit import Refusal
from tests.reference.frames import energy, forces
from tests.reference.models import model, particle, rod

MEMBER = {
    "stiffness": 6e5,
    "bending_stiffness": 4000.0,
    "damping": 30.0,
    "bending_damping": 0.5,
    "density": 22.0,
    "distributed_force": [0.5, -3.0],
    "temperature_change": 20.0,
    "temperature_gradient": 15.0,
    "tensile_strength": 600.0,
    "plastic_strain": 1e-4,
}


def beam(**properties: object) -> Session:
    """A clamped beam of 4 m with a hinge at its other end, on a roller there."""
    particles = [
        particle("A", 0, 0, fixed=[True, True], fixed_rotation=True),
        particle("B", 4, 0, fixed=[False, True]),
    ]
    return Session.open(model(particles, [rod("A", "B", **(MEMBER | properties))]))


def test_parts_have_what_the_rod_had_and_damp_as_it_did() -> None:
    session = beam(hinged=[False, True], rest_length=4.001)
    original = session.rods["AB"]
    session.model.execute(SetSliders((Slider((Aim("rods", original, "bending_stiffness"),), 100.0, 9000.0),)))
    parts = session.divide("AB", 4)
    assert [part.name for part in parts] == ["AB 1", "AB 2", "AB 3", "AB 4"]
    assert parts[0] is original, "what refers to the rod goes on with its first part"
    assert session.selected == parts
    rods = session.model.rods
    for field, factor in {"damping": 4.0, "bending_damping": 4.0, "rest_length": 0.25}.items():
        given = {"rest_length": 4.001, **MEMBER}[field]
        assert rods.column({"rest_length": "prescribed_rest_length"}.get(field, field)) == pytest.approx(
            given * factor
        )
    for field in set(MEMBER) - {"damping", "bending_damping", "stiffness"}:
        assert (rods.column(field) == MEMBER[field]).all(), field
    assert (rods.stiffness == 6e5).all()
    assert rods.hinged.tolist() == [[False, False]] * 3 + [[False, True]]
    assert session.model.particles.position[:, 0].tolist() == [0.0, 4.0, 1.0, 2.0, 3.0]
    assert not session.model.particles.displacement.any()
    assert not session.model.particles.rotation.any()
    session.model.assign([parts[0]], "bending_stiffness", 5000.0)
    assert len(session.model.sliders[0].aims) == 4


def test_undo_joins_the_parts_and_redo_divides_again() -> None:
    session = beam()
    before = document(session.model)
    session.divide("AB", 3)
    divided = document(session.model)
    assert session.undo() == "divide rod AB"
    assert document(session.model) == before
    session.redo()
    assert document(session.model) == divided


def test_the_state_is_that_of_the_bent_rod() -> None:
    """Of a cubic without loads between, parts bear the same end moments, and their energy nearly is that of the whole."""
    session = beam(distributed_force=[0, 0], temperature_change=0, temperature_gradient=0, plastic_strain=0)
    m = session.model
    angle = 0.7
    turned = np.array([4.0 * math.cos(angle) - 4.0, 4.0 * math.sin(angle)])
    m.writable("particles.displacement")[1] = turned
    m.writable("particles.rotation")[:] = [angle + 2e-4, angle - 3e-4]
    before, moments = energy(m, m.particles.displacement, m.particles.rotation), forces(m)[1]
    session.divide("AB", 4)
    after = energy(m, m.particles.displacement, m.particles.rotation)
    assert after == pytest.approx(before, rel=1e-3)
    assert forces(m)[1][:2] == pytest.approx(moments, rel=1e-3)
    assert np.abs(forces(m)[1][2:]).max() < 1e-3 * np.abs(moments).max()


@pytest.mark.parametrize("parts", [2, 3, 8])
@pytest.mark.parametrize("hinged", [[False, False], [False, True]])
@pytest.mark.parametrize("warmth", [0.0, 40.0])
def test_a_settled_beam_under_load_keeps_its_moments(parts: int, hinged: list[bool], warmth: float) -> None:
    """Parts begin on the axis as the load bends it, and it is said that this is no equilibrium of the parts."""
    session = beam(hinged=hinged, distributed_force=[0, -20], plastic_strain=0, temperature_gradient=warmth)
    session.model.particles["A"].fixed_rotation = False
    session.settle()
    before = session.rods["AB"].bending_moment
    largest = 20.0 * 4.0**2 / 8.0
    session.divide("AB", parts)
    found = [moment for rod in session.rods for moment in rod.bending_moment]
    shares = [share for k in range(parts) for share in (k / parts, (k + 1) / parts)]
    expected = [4.0 * largest * x * (1.0 - x) + before[0] * (1.0 - x) + before[1] * x for x in shares]
    assert found == pytest.approx(expected, abs=0.01 * largest)
    assert not session.document.assessment.balanced
    assert session.settle() == "equilibrium"
    assert [m for rod in session.rods for m in rod.bending_moment] == pytest.approx(
        expected, abs=2e-3 * largest
    )


@pytest.mark.parametrize("parts", [1, 0, -3, 2.5, True, "four", 100_000])
def test_a_wrong_number_of_parts_is_refused(parts: object) -> None:
    session = beam()
    with pytest.raises(Refusal, match="into 2 to 1000 equal parts"):
        session.divide("AB", parts)  # type: ignore[arg-type]
    assert session.model.rods.count == 1


def test_a_pinned_bar_is_refused_with_the_remedy() -> None:
    session = beam(bending_stiffness=0.0)
    with pytest.raises(Refusal, match=r"Rod AB does not bend.*join it rigidly"):
        session.divide("AB")
    assert session.model.particles.count == 2


def test_menus_and_scripts_divide() -> None:
    session = beam()
    session.select(session.rods["AB"])
    session.act("divide in two")
    assert session.notice == "Rod AB: divided into 2 parts"
    session.act("divide in four")
    assert session.notice == "2 rods: each divided into 4 parts"
    assert session.model.rods.count == 8
    assert "AB 2 4" in session.rods
    again = beam()
    assert list(perform(again, {"divide": ["AB", 3]})) == []
    assert again.model.rods.count == 3
