"""Tables of results: their numbers are those of hand calculations and of the model's columns."""

import math
from typing import Any

import pytest

from pinjoint import Session
from pinjoint.components.language import spoken
from pinjoint.documents import models
from pinjoint.results import Results
from pinjoint.tables import Table
from tests.game.force_method_models import panels
from tests.systems.render.frame_models import CLAMPED, PINNED, ROLLER, frame

LIGHT = 1e-4  # kN/m: so small that exact geometry is first-order theory to 1e-7


def settled(source: Any) -> Results:
    session = Session.open(source)
    session.settle()
    return Results.of(session.model)


def column(table: Table, key: str) -> list[float]:
    [found] = [one for one in table.columns if one.key == key]
    return found.values.tolist()


def beam(left: dict[str, object], right: dict[str, object]) -> Results:
    """A beam of 6 m and EI = 20 000 under a uniform load."""
    particles = {"A": (0.0, 0.0, left), "B": (6.0, 0.0, right)}
    rods = {"A B": {"distributed_force": [0.0, -LIGHT], "bending_stiffness": 2e4}}
    return settled(frame(particles, rods))


def test_a_simple_beam() -> None:
    found = beam(PINNED, ROLLER)
    expected = {
        "shear_start": 3.0 * LIGHT,
        "shear_end": -3.0 * LIGHT,
        "bending_moment_start": 0.0,
        "bending_moment_end": 0.0,
        "largest_moment": LIGHT * 36.0 / 8.0,
        "largest_moment_at": 300.0,
        "least_moment": 0.0,
        "deflection": 100.0 * 5.0 * LIGHT * 6.0**4 / (384.0 * 2e4),
    }
    for key, value in expected.items():
        assert column(found.rods, key) == pytest.approx([value], rel=1e-6, abs=1e-12)
    assert math.isnan(column(found.rods, "least_moment_at")[0])  # 0 all along the supports


def test_a_propped_cantilever() -> None:
    found = beam(CLAMPED, ROLLER)
    assert column(found.rods, "bending_moment_start") == pytest.approx([-LIGHT * 36.0 / 8.0], rel=1e-6)
    assert column(found.rods, "least_moment_at") == [0.0]
    assert column(found.rods, "largest_moment") == pytest.approx([9.0 / 128.0 * LIGHT * 36.0], rel=1e-6)
    assert column(found.rods, "largest_moment_at") == pytest.approx([100.0 * 0.625 * 6.0], rel=1e-6)
    x = 6.0 * (1.0 + math.sqrt(33.0)) / 16.0  # from the roller
    deflection = 100.0 * LIGHT * x / (48.0 * 2e4) * (6.0**3 - 3.0 * 6.0 * x**2 + 2.0 * x**3)
    assert column(found.rods, "deflection") == pytest.approx([deflection], rel=1e-6)
    assert column(found.particles, "reaction_y") == pytest.approx([3.75 * LIGHT, 2.25 * LIGHT], rel=1e-6)
    moment, none = column(found.particles, "reaction_moment")
    assert moment == pytest.approx(4.5 * LIGHT, rel=1e-6)
    assert math.isnan(none)


@pytest.mark.parametrize("name", ["portal", "two_storey_frame", "isostatic", "gerber_beam", "lees_frame"])
def test_loads_and_reactions_add_up_to_nothing(name: str) -> None:
    found = settled(name)
    assert found.sums[-1] == ("Σ", "0", "0", "0")
    loads, reactions = zip(*(one.values for one in found.sums.columns), strict=True)
    assert any(loads)
    assert reactions == pytest.approx([-load for load in loads], rel=1e-9, abs=1e-9)


def test_under_moments_alone_forces_are_rounding() -> None:
    """Of a cantilever under a moment, shears were told as multiples of 10⁻²⁸ kN."""
    found = settled("rolled_cantilever")
    assert not any(column(found.rods, "shear_start") + column(found.rods, "end_axial_force_start"))
    assert column(found.rods, "bending_moment_start")[0] == pytest.approx(4.0 * math.pi)


def test_a_truss_has_axial_forces_alone() -> None:
    session = Session.open(models.document(panels()))
    session.settle()
    model, found = session.model, Results.of(session.model)
    assert [one.key for one in found.rods.columns] == ["axial_force"]
    assert column(found.rods, "axial_force") == model.rods.axial_force.tolist()
    keys = [one.key for one in found.particles.columns]
    assert keys == ["displacement_x", "displacement_y", "reaction_x", "reaction_y"]
    assert found.particles.names == model.particles.names


def test_as_it_is_read_and_as_it_is_saved() -> None:
    found = settled("portal")
    assert found.rods[0][:4] == ("rod", "N start (kN)", "N end (kN)", "V start (kN)")
    assert found.rods[1][:4] == ("AB", "−49.90", "−49.90", "2.741")
    assert found.particles[2] == ("B", "1.134", "−0.01421", "−5.061", "", "", "")
    heads, first, *_ = found.rods.rows()
    assert heads[:8] == found.rods[0][:8]
    assert (heads[8], found.rods[0][8]) == ("M max at x (cm)", "at x (cm)")
    assert first[1] == column(found.rods, "end_axial_force_start")[0]
    *_, last = next(row for row in found.particles.rows() if row[0] == "B")
    assert last is None
    with spoken("pt"):
        assert found.rods[1][1] == "−49,90"
        assert Results.of(models.load("portal")).rods[0][1] == "N início (kN)"


def test_an_empty_model_has_empty_tables() -> None:
    found = Results.of(models.load({"format": "pinjoint model", "version": 1}))
    assert (len(found.rods), len(found.particles), len(found.sums)) == (1, 1, 4)
