"""Statics at its limits: either the answer is right, or it is said why there is none."""

import copy
from typing import Any

import numpy as np
import pytest

from pinjoint.documents import models
from pinjoint.systems.statics.settle import settle
from tests.reference import closed_forms
from tests.reference.elements import Model as Document
from tests.reference.models import (
    model,
    particle,
    random_truss,
    rod,
    three_bar_truss,
    triangle,
    von_mises_truss,
)

SOFT = 1e5  # kN


def in_series(first: float, second: float, force: float = 10.0) -> Document:
    """Two rods of length 1 one behind the other, pulled at the end: u_B = F/k₁, u_C = F/k₁ + F/k₂."""
    return model(
        [
            particle("A", 0, 0, fixed=[True, True]),
            particle("B", 1, 0, fixed=[False, True]),
            particle("C", 2, 0, fixed=[False, True], force=[force, 0]),
        ],
        [rod("A", "B", stiffness=first), rod("B", "C", stiffness=second)],
    )


@pytest.mark.parametrize("ratio", [1e3, 1e6, 1e9, 1e12, 1e15])
def test_a_soft_rod_at_the_end_of_a_stiff_one(ratio: float) -> None:
    found = settle(models.load(in_series(ratio * SOFT, SOFT))).final
    assert found.status == "equilibrium"
    assert found.axial_force == pytest.approx([10.0, 10.0], rel=1e-12)
    assert found.displacement[:, 0] == pytest.approx(
        [0, 10 / ratio / SOFT, 10 / ratio / SOFT + 10 / SOFT], rel=1e-12
    )


@pytest.mark.parametrize("ratio", [1e3, 1e6, 1e9, 1e12, 1e15])
def test_a_stiff_rod_at_the_end_of_a_soft_one(ratio: float) -> None:
    """Its elongation is the difference of two nearly equal displacements: an error of ε × ratio, which is said."""
    found = settle(models.load(in_series(SOFT, ratio * SOFT))).final
    if ratio >= 1e12:
        assert found.status == "limit reached"
        assert "do not have enough digits for this model" in found.message
        return
    assert found.status == "equilibrium"
    assert found.axial_force == pytest.approx([10.0, 10.0], rel=1e-15 * ratio)
    assert found.displacement[1:, 0] == pytest.approx(
        [10 / SOFT, 10 / SOFT + 10 / SOFT / ratio], rel=1e-15 * ratio
    )
    assert ("digits of the results are certain" in found.message) == (ratio == 1e9)


def test_a_strut_that_is_crushed_by_a_tenth_is_a_collapse() -> None:
    """A soft tie still holds the load, F = S + k u, but no metal is crushed by as much as u = 0.1."""
    ends = [particle("A", 0, 0, fixed=[True, True]), particle("C", 0, 2, fixed=[True, True])]
    loaded = particle("B", 0, 1, fixed=[True, False], force=[0, -15])
    rods = [rod("A", "B", stiffness=1e4, compressive_strength=1.0), rod("B", "C", stiffness=10.0)]
    found = settle(models.load(model([*ends, loaded], rods)))
    assert found.status == "collapse"
    assert "rod AB yields by more than a tenth of its length" in found.message
    assert found.final.load_factor == pytest.approx((1.0 + 10.0 * 0.1001) / 15.0, rel=1e-9)


@pytest.mark.parametrize("height", [1e-1, 1e-2, 1e-3, 1e-5, 1e-8, 0.0])
@pytest.mark.parametrize("load", [1e-3, 1.0, 100.0])
def test_nearly_collinear_rods(height: float, load: float) -> None:
    """The crown ends where P = 2 EA (H − δ)(1/L − 1/L₀), on the far side if it had to snap through."""
    found = settle(models.load(von_mises_truss(height, 1.0, 1e4, -load)))
    assert found.status == "equilibrium"
    deflection = -float(found.final.displacement[1, 1])
    force = closed_forms.von_mises_force(deflection, height, 1.0, 1e4)
    rounding = 2e-16 * 1e4 / load * max(height, deflection)  # of a force 2 EA (…) in which 1/L₀ − 1/L cancels
    assert force == pytest.approx(load, rel=1e-9 + rounding)
    limit, _ = closed_forms.von_mises_limit(height, 1.0, 1e4) if height > 1e-6 else (0.0, 0.0)
    assert (deflection > 2 * height) == (load > limit)


@pytest.mark.parametrize("length", [1e-3, 1e-6, 1e-9])
def test_rods_of_nearly_no_length(length: float) -> None:
    """A tiny triangle at B hands its load on; it rests, or it is said that few digits of the results are certain."""
    document = triangle((120, -160))
    document["particles"] += [particle("D", 1, 1 + length, force=[5, -7]), particle("E", 1 - length, 1)]
    document["rods"] += [rod("B", "D"), rod("D", "E"), rod("E", "B")]
    (reference,) = settle(models.load(triangle((125, -167)))).states
    found = settle(models.load(document)).final
    assert found.status == "equilibrium"
    exact = 1e-9 if length >= 1e-6 else 1e-6
    assert found.axial_force[:3] == pytest.approx(reference.axial_force, rel=1e-3, abs=0.1)  # B and D are apart
    assert found.reaction.sum(axis=0) == pytest.approx([-125.0, 167.0], rel=10 * exact)
    assert found.residual < exact or "Rounding leaves" in found.message


@pytest.mark.parametrize("excess", [-1e-9, 1e-9])
def test_just_below_and_just_beyond_the_collapse_load(excess: float) -> None:
    collapse = closed_forms.three_bar_collapse(3.0)
    found = settle(models.load(three_bar_truss(1.0, 3.0)), [collapse * (1 + excess)], "first-order")
    assert found.status == ("equilibrium" if excess < 0 else "collapse")


@pytest.mark.parametrize("excess", [-1e-10, 1e-10])
def test_just_below_and_just_beyond_snap_through(excess: float) -> None:
    limit, _ = closed_forms.von_mises_limit(1.0, 5.0, 1.28e6)
    found = settle(models.load(von_mises_truss()), [limit * (1 + excess)])
    assert found.status == "equilibrium"
    assert [event.kind for event in found.events] == ([] if excess < 0 else ["snap-through"])


def in_other_units(document: Document, length: float, force: float) -> Document:
    scaled: dict[str, Any] = copy.deepcopy(document)
    for element in scaled["particles"]:
        element["position"] = [length * x for x in element["position"]]
        element["force"] = [force * f for f in element.get("force", [0, 0])]
    for element in scaled["rods"]:
        for quantity in ("stiffness", "tensile_strength", "compressive_strength"):
            element[quantity] = force * element[quantity]
    return scaled


@pytest.mark.parametrize("length", [1e-9, 1e-3, 1e9])
@pytest.mark.parametrize("force", [1e-12, 1e12])
@pytest.mark.parametrize("seed", [3, 9])
def test_huge_and_tiny_units(seed: int, length: float, force: float) -> None:
    """The same truss, yielding and unloaded, in other units of length and force."""
    document = random_truss(seed)
    for element in document["rods"]:
        element["tensile_strength"] = element["compressive_strength"] = 150.0
    factors = [0.5, 0.0]
    here = settle(models.load(document), factors)
    there = settle(models.load(in_other_units(document, length, force)), factors)
    assert there.status == here.status
    assert [event.kind for event in there.events] == [event.kind for event in here.events]
    for one, other in zip(here.states, there.states, strict=True):
        largest = np.abs(here.states[0].axial_force).max()
        assert np.abs(other.axial_force / force - one.axial_force).max() <= 1e-9 * largest
        moved = np.abs(here.states[0].displacement).max()
        assert np.abs(other.displacement / length - one.displacement).max() <= 1e-9 * moved


@pytest.mark.filterwarnings("error")
def test_a_rod_whose_ends_are_at_the_same_place_has_no_direction_yet() -> None:
    """Compressed to nothing, it stands by chance: there is no equilibrium to follow, and nothing is divided by 0."""
    squeezed = model(
        [particle("A", 0, 0, fixed=[True, True]), particle("B", 0, 0, force=[1, 0])],
        [rod("A", "B", rest_length=1.0)],
    )
    assert settle(models.load(squeezed)).final.status == "limit reached"
