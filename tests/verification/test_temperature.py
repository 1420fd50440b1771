"""Rods that warm up or do not fit, and supports that settle: in statics, in motion and in linear theory."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.field import FieldError
from pinjoint.documents import models
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.theory import linear, self_stress
from tests.reference import physics, statics
from tests.reference.elements import Model as Document
from tests.reference.models import model, particle, rod, square, triangle

EA, ALPHA = 164640.0, 1.2e-5


def between_walls(**properties: float) -> Document:
    """A rod between two fixed supports, in two parts with a free particle in the middle."""
    ends = {"fixed": [True, True]}
    particles = [
        particle("A", 0, 0, **ends),
        particle("M", 1, 0, fixed=[False, True]),
        particle("B", 2, 0, **ends),
    ]
    return model(particles, [rod("A", "M", **properties), rod("M", "B", **properties)])


@pytest.mark.parametrize("change", [50.0, -30.0])
def test_a_rod_between_walls(change: float) -> None:
    """N = −EA α ΔT, in exact and in linear theory and after a run, as in any textbook."""
    document = between_walls(temperature_change=change)
    expected = [-EA * ALPHA * change] * 2
    assert settle(models.load(document)).final.axial_force == pytest.approx(expected, rel=1e-12)
    assert linear(models.load(document)).axial_force == pytest.approx(expected, rel=1e-12)
    session = Session.open(document)
    assert session.run(until="rest") == "at rest"
    assert session.rods.axial_force == pytest.approx(expected, rel=1e-9)


def test_an_isostatic_structure_only_changes_its_shape() -> None:
    document = triangle((0, 0))
    document["rods"][2]["temperature_change"] = 40.0
    for state in (settle(models.load(document)).final, linear(models.load(document))):
        assert np.abs(state.axial_force).max() < 1e-9
        assert state.displacement[0, 0] == pytest.approx(-2.0 * ALPHA * 40.0, rel=1e-12)


def test_a_warm_structure_that_moves_freely_keeps_no_force() -> None:
    """All forces vanish, and what rounding leaves of them is no lack of balance."""
    document = triangle((0, 0))
    document["particles"][2]["fixed"] = [False, True]
    for element in document["rods"]:
        element["temperature_change"] = 78.75
    found = settle(models.load(document)).final
    assert found.status == "equilibrium"
    assert found.residual < 1e-12


def test_the_redundant_square_with_a_warm_diagonal() -> None:
    """Force method on the self-stress n̄: N = n̄ X, X = −Σ n̄ α ΔT L / Σ n̄² L/EA."""
    document = square((0, 0))
    document["rods"][5]["temperature_change"] = 60.0
    loaded = models.load(document)
    (stress,) = self_stress(loaded)
    lengths = loaded.rods.original_length
    redundant = -stress[5] * ALPHA * 60.0 * lengths[5] / float((stress**2 * lengths / EA).sum())
    assert linear(loaded).axial_force == pytest.approx(stress * redundant, rel=1e-12)
    (exact,) = statics.solve(document)
    assert settle(loaded).final.axial_force == pytest.approx(list(exact["axial_force"].values()), rel=1e-9)


def test_warmth_acts_together_with_load_yielding_and_a_moved_support() -> None:
    document = square((0, -200), tensile_strength=150, compressive_strength=150)
    document["rods"][5]["temperature_change"] = 60.0
    document["rods"][4]["rest_length"] = 1.5 * math.sqrt(2.0) + 1e-3
    document["particles"][0]["displacement"] = [0, -1e-3]
    found = settle(models.load(document), [0.0, 1.0, 0.0])
    assert found.status == "equilibrium"
    for state, exact in zip(found.states, statics.solve(document, [0, 1, 0]), strict=True):
        forces = np.array(list(exact["axial_force"].values()))
        assert np.abs(state.axial_force - forces).max() < 1e-9 * np.abs(forces).max()


def test_a_rod_that_yields_as_it_warms_pulls_when_it_is_cold_again() -> None:
    """ε_p = −(αΔT − S/EA) while warm; cold, N = EA (αΔT) − S."""
    strength, change = 100.0, 80.0
    session = Session.open(between_walls(compressive_strength=strength, temperature_change=change))
    assert session.run(until="rest") == "at rest"
    plastic = -(ALPHA * change - strength / EA)
    assert session.rods.plastic_strain == pytest.approx([plastic] * 2, rel=1e-9)
    session.rods["AM"].temperature_change = session.rods["MB"].temperature_change = 0.0
    assert session.run(until="rest") == "at rest"
    assert session.rods.axial_force == pytest.approx([EA * ALPHA * change - strength] * 2, rel=1e-9)


@pytest.mark.parametrize("scheme", [physics.velocity_verlet, physics.taylor2])
def test_warm_rods_move_as_in_the_independent_simulation(scheme: Callable[..., None]) -> None:
    document = square((30, -200), tensile_strength=150, compressive_strength=150, damping=5.0)
    document["rods"][5]["temperature_change"], document["rods"][1]["temperature_change"] = 80.0, -60.0
    session = Session.open(document | {"settings": {"time_step": 2e-6, "integrator": scheme.__name__}})
    session.run(steps=400)
    states: list[tuple[np.ndarray, list[float]]] = []
    scheme(document, 2e-6, 400, lambda run: states.append((np.array(run.u), list(run.plastic_strain))))
    displacement, plastic_strain = states[-1]
    assert np.abs(session.particles.displacement - displacement).max() < 1e-15
    assert session.rods.plastic_strain == pytest.approx(plastic_strain, abs=1e-15)
    assert np.abs(plastic_strain).max() > 1e-5


def test_the_energy_of_a_rod_that_warms_up_during_a_run_is_accounted_for() -> None:
    session = Session.open(between_walls() | {"settings": {"time_step": 5e-7}})
    session.particles["M"].velocity = (0.5, 0.0)
    session.run(time=5e-4)
    session.rods["AM"].temperature_change = 25.0
    session.run(until="rest")
    energy = session.energy
    assert energy.work > 5.0  # J, by the warming
    assert abs(energy.imbalance) < 2e-4  # ∝ the step's square


def test_support_settlement_and_lack_of_fit_after_a_run() -> None:
    document = square((0, -100))
    document["rods"][4]["rest_length"] = 1.5 * math.sqrt(2.0) - 1e-3
    document["particles"][0]["displacement"] = [0, -2e-3]
    session = Session.open(document)
    assert session.run(until="rest") == "at rest"
    (exact,) = statics.solve(document)
    assert session.rods.axial_force == pytest.approx(list(exact["axial_force"].values()), rel=1e-6)


def test_from_the_command_line_and_in_a_file(answer: Any) -> None:
    run = answer("run", "hyperstatic", "--static", "--set", "rods.AC.temperature_change=40")
    document = square((0, -100))
    document["rods"][4]["temperature_change"] = 40.0
    (exact,) = statics.solve(document)
    assert run["states"][0]["rods"]["AC"]["axial_force"] == pytest.approx(exact["axial_force"]["AC"], rel=1e-9)
    saved = models.document(models.load(document))
    assert saved["rods"][4]["temperature_change"] == 40.0
    assert "temperature_change" not in saved["rods"][3]


def test_a_rod_cannot_cool_to_nothing() -> None:
    session = Session.open(between_walls())
    with pytest.raises(FieldError, match="rod AM: a temperature change of -90000 K would leave it no length"):
        session.rods["AM"].temperature_change = -90000.0
    assert session.rods["AM"].temperature_change == 0.0


@pytest.mark.parametrize("number", range(6))
def test_warmth_that_makes_bars_yield_acts_as_if_it_had_grown_slowly(number: int) -> None:
    """A braced field with strengths drawn by lot, warmed at once and in many small steps from one state to the next."""
    lot = np.random.default_rng([20, number])
    particles = [
        particle(f"P{i}{j}", i + lot.normal(0, 0.05), j + lot.normal(0, 0.05))
        for i in range(3)
        for j in range(2)
    ]
    particles[0]["fixed"], particles[4]["fixed"] = [True, True], [number % 2 == 0, True]
    pairs = [(f"P{i}0", f"P{i}1") for i in range(3)]
    pairs += [(f"P{i}{a}", f"P{i + 1}{b}") for i in range(2) for a in range(2) for b in range(2)]
    rods = [
        rod(
            *pair,
            stiffness=1e5,
            thermal_expansion=1.2e-5,
            tensile_strength=lot.uniform(20, 80),
            compressive_strength=lot.uniform(20, 80),
            temperature_change=lot.normal(0, 80),
        )
        for pair in pairs
    ]
    at_once = Session.open(model(particles, rods))
    assert at_once.settle() == "equilibrium"
    assert (at_once.rods.plastic_strain != 0.0).any()
    found = at_once.rods.axial_force
    errors = []
    for steps in (50, 200):  # in each of which joints are held at first, so that they are of first order
        slowly = Session.open(model(particles, rods))
        warmth = slowly.rods.temperature_change.copy()
        for share in np.arange(1, steps + 1) / steps:
            slowly.rods.temperature_change = share * warmth
            assert slowly.settle() == "equilibrium"
        errors.append(np.abs(slowly.rods.axial_force - found).max() / np.abs(found).max())
    assert errors[0] < 0.02
    assert errors[1] < 0.4 * errors[0] + 1e-7
