"""Settling and curves of structures drawn by lot: yields, unloading, cables, mechanisms, rods that become straight."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinjoint import Session
from pinjoint.components.model import Model
from pinjoint.documents import models
from pinjoint.systems.statics.path import Curve, Goal
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.state import StaticState
from tests.reference.elements import Model as Document
from tests.reference.models import model, particle, random_structure, rod
from tests.reference.straightening import A_CABLE_TRUSS, A_YIELDING_TRUSS, straightening
from tests.verification.test_settling import plastic_truss

FACTORS = [1.0, 0.0, -0.7]


def check_laws(found: Model, state: StaticState) -> None:
    """Forces in balance, none beyond a strength or compressive in a cable, by the fields alone."""
    rods, force = found.rods, state.axial_force
    size = max(float(np.abs(force).max()), float(np.abs(found.particles.force).max()))
    place = found.particles.position + state.displacement
    way = place[rods.between[:, 1]] - place[rods.between[:, 0]]
    length = np.hypot(*way.T)
    pull = force[:, None] * way / np.where(length > 0.0, length, 1.0)[:, None]
    left = state.load_factor * found.particles.force + found.particles.mass[:, None] * (
        found.particles.acceleration / 1000.0
    )
    np.add.at(left, rods.between[:, 0], pull)
    np.add.at(left, rods.between[:, 1], -pull)
    assert np.abs(np.where(found.particles.fixed, 0.0, left)).max() <= 1e-9 * size
    assert (force <= rods.tension_limit + 1e-9 * size).all()
    assert (force >= np.where(rods.tension_only, 0.0, -rods.compression_limit) - 1e-9 * size).all()
    elastic = rods.stiffness * ((length - rods.rest_length) / rods.rest_length - state.plastic_strain)
    assert np.abs(np.where(rods.tension_only, np.maximum(elastic, 0.0), elastic) - force).max() <= 1e-9 * size


@pytest.mark.parametrize("tables", [A_YIELDING_TRUSS, A_CABLE_TRUSS])
def test_bent_rods_become_straight_once(tables: tuple[list[object], list[object]]) -> None:
    """They were bent to one side and the other thousands of times, at a load that grew no more."""
    document = straightening(tables)
    loaded = models.load(document)
    found = settle(loaded)
    assert found.final.balanced
    assert found.final.load_factor == 1.0
    assert len(found.events) < 5
    check_laws(loaded, found.final)


def bent_tie(strength: float = 0.0) -> Document:
    """A tie AC beside two rods ABC that bear nothing until they are straight: u = 2 (√(1 + h²) − 1)."""
    limits = {"tensile_strength": strength, "compressive_strength": strength}
    return model(
        [
            particle("A", 0, 0, fixed=[True, True]),
            particle("B", 1, 0.1),
            particle("C", 2, 0, fixed=[False, True], force=[300.0, 0.0]),
        ],
        [rod("A", "B", stiffness=1e4), rod("B", "C", stiffness=1e4), rod("A", "C", stiffness=1e4, **limits)],
    )


@pytest.mark.parametrize("strength", [0.0, 100.0])
def test_to_become_straight_is_no_jump(strength: float) -> None:
    """Straight, both share in the load: N = EA u / 2 − …, in parallel; nothing happens at an instant."""
    loaded = models.load(bent_tie(strength))
    found = settle(loaded)
    assert not [event for event in found.events if event.kind in ("bifurcation", "snap-through")]
    pulled = strength or 10_000.0 * found.final.displacement[2, 0] / 2.0
    assert found.final.axial_force == pytest.approx([300.0 - pulled, 300.0 - pulled, pulled], rel=1e-9)
    check_laws(loaded, found.final)
    curve = Curve.of(loaded, Goal(1.0))
    assert curve.complete
    assert curve.axial_force[-1] == pytest.approx(found.final.axial_force, rel=1e-9)


def test_a_curve_passes_a_plateau_and_rods_that_become_straight_on_it() -> None:
    """At 20 kN the tie yields, and the load cannot grow until the bent rods are straight and take it."""
    loaded = models.load(bent_tie(20.0))
    curve = Curve.of(loaded, Goal(1.0))
    assert curve.complete
    assert curve.axial_force[-1] == pytest.approx([280.0, 280.0, 20.0], rel=1e-9)
    hanging = model(
        [particle("A", 0, 0, fixed=[True, True]), particle("B", 0, -1, force=[0, -1.0])],
        [rod("A", "B", stiffness=100.0, tensile_strength=0.4)],
    )
    curve = Curve.of(models.load(hanging), Goal(-1.3, (1, 1)))
    assert curve.complete
    assert curve.load_factor[-1] == pytest.approx(0.4, rel=1e-9)


@settings(max_examples=8)
@given(seed=st.integers(0, 10_000))
def test_random_structures_settle_or_it_is_said_why(seed: int) -> None:
    loaded = models.load(random_structure(seed))
    found = settle(loaded, FACTORS)
    assert found.final.balanced or found.status in ("mechanism", "collapse")
    assert len(found.events) < 60
    for state in found.states:
        check_laws(loaded, state)


@settings(max_examples=4)
@given(seed=st.integers(0, 10_000))
def test_curves_of_yielding_trusses_do_not_end_early(seed: int) -> None:
    """One rod begins to yield, or ceases to, while others unload: some motion always goes on."""
    curve = Curve.of(models.load(plastic_truss(seed)), Goal(1e9), points=50)
    assert len(curve.load_factor) == 50


def dangling(**properties: object) -> Document:
    """A triangle under load, from which a rod BD hangs that bears nothing."""
    nodes = [particle("A", 0, 0, fixed=[True, True]), particle("C", 2, 0, fixed=[False, True])]
    nodes += [particle("B", 1, 1, force=[10.0, -20.0]), particle("D", 1, 2, **properties)]
    return model(nodes, [rod(*pair) for pair in ("AB", "BC", "CA", "BD")])


def test_a_place_that_nothing_holds_is_a_status_of_its_own(answer: Any) -> None:
    """Forces are certain, the place of D is not; under the least weight it hangs, and is certain, too."""
    run = answer("run", dangling(), "--static", "--load-factors", "0.5,1", status=1)
    assert run["status"] == "neutral equilibrium"
    assert [state["load_factor"] for state in run["states"]] == [0.5, 1.0]
    assert run["states"][-1]["rods"]["BD"]["axial_force"] == pytest.approx(0.0, abs=1e-9)
    assert Session.open(dangling()).settle() == "neutral equilibrium"
    assert Session.open(dangling(force=[0.0, 0.01])).settle() == "equilibrium"


def test_a_place_on_a_slack_cable_is_neutral() -> None:
    found = settle(models.load(straightening(A_CABLE_TRUSS)))
    assert found.status == "neutral equilibrium"
    assert "nothing resists moving n6" in found.message
