"""The force method: hyperstatic forces, superposition, and unknowns that are none."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinjoint import Session
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.documents import models
from pinjoint.methods.copies import exact_forces
from pinjoint.systems.statics.force_method import solve
from pinjoint.systems.statics.theory import linear
from pinjoint.systems.statics.unknowns import MethodError, Unknown, redundants
from tests.reference.models import model, panel_truss, particle, rod
from tests.reference.statics import direct_stiffness


def test_each_rod_of_the_square_has_the_force_of_linear_theory() -> None:
    model = models.load("hyperstatic")
    linear = direct_stiffness(models.document(model))["axial_force"]
    for name in model.rods.names:
        solution = solve(model, [Unknown.named(model, name)])
        assert solution.force[0] == pytest.approx(linear[name], rel=1e-12, abs=1e-11)
        assert solution.delta_unit[0, 0] < 0.0  # the unit pair pulls the ends together


def test_support_of_the_panel_truss() -> None:
    """4 panels of 2 m, height 2 m, 10 kN down at L2: the reaction at L3 is 10 (2 − √2)."""
    model = models.load(panel_truss())
    solution = solve(model, [Unknown.named(model, "L3.y")])
    assert solution.delta_real[0] == 0.0
    assert solution.delta_unit[0, 0] > 0.0
    assert solution.force[0] == pytest.approx(10.0 * (2.0 - math.sqrt(2.0)), rel=1e-12)


@pytest.mark.parametrize("name", ["hyperstatic", "tower", "three_bar_plastic"])
def test_set_1_is_the_superposition_of_sets_2_and_3(name: str) -> None:
    model = models.load(name)
    unknowns = redundants(model)
    solution = solve(model, unknowns)
    assert unknowns
    scale = np.abs(solution.real.axial_force).max()
    assert np.abs(solution.superposed.axial_force - solution.real.axial_force).max() <= 1e-10 * scale
    moved = np.abs(solution.real.displacement).max()
    assert np.abs(solution.superposed.displacement - solution.real.displacement).max() <= 1e-10 * moved


def test_isostatic_structures_have_no_redundants() -> None:
    assert redundants(models.load("isostatic")) == []
    assert redundants(models.load("warren_bridge")) == []


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000), st.integers(4, 7))
def test_redundants_of_random_braced_structures(seed: int, count: int) -> None:
    """All pairs joined, three supports: count (count − 1)/2 + 3 − 2 count redundants, and superposition."""
    model = _complete_graph(np.random.default_rng(seed), count)
    unknowns = redundants(model)
    assert len(unknowns) == count * (count - 1) // 2 + 3 - 2 * count
    solution = solve(model, unknowns)
    linear = direct_stiffness(models.document(model))["axial_force"]
    scale = max(abs(force) for force in linear.values())
    for unknown, force in zip(unknowns, solution.force.tolist(), strict=True):
        assert force == pytest.approx(linear[unknown.name], abs=1e-8 * scale)


def _complete_graph(random: np.random.Generator, count: int) -> Model:
    angles = np.sort(random.uniform(0.0, 2.0 * np.pi, count)) + np.arange(count) * 0.3
    radii = random.uniform(0.7, 1.5, count)
    position = np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)
    fixed = np.zeros((count, 2), dtype=bool)
    fixed[0], fixed[1, 1 if abs(np.diff(position[:2, 0])[0]) > abs(np.diff(position[:2, 1])[0]) else 0] = (
        True,
        True,
    )
    model = Model()
    model.create(Particle, count, position=position, fixed=fixed, force=random.normal(size=(count, 2)) * 50.0)
    pairs = [(a, b) for a in range(count) for b in range(a + 1, count)]
    model.create(Rod, len(pairs), between=pairs, stiffness=random.uniform(5e4, 3e5, len(pairs)))
    return model


def test_an_unknown_whose_release_makes_a_mechanism_is_refused_with_the_motion() -> None:
    model = models.load("isostatic")
    with pytest.raises(MethodError, match=r"Without AB the structure is a mechanism: .*B .* can move"):
        solve(model, [Unknown.named(model, "AB")])


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("A", r"say which of its supports, such as A\.x or A\.y"),
        ("A.x", "A is free along x"),
        ("ACC", "did you mean 'AC'"),
    ],
)
def test_unknowns_that_do_not_exist_are_explained(name: str, words: str) -> None:
    with pytest.raises(MethodError, match=words):
        Unknown.named(models.load("hyperstatic"), name)


def test_lack_of_fit_counts() -> None:
    """A rod made too long by δ in the square, without load: p = (Δ_real − Δ₀)/Δ₁ still is the rod's force."""
    model = models.load("hyperstatic")
    model.particles["C"].force = (0.0, 0.0)
    rod = model.rods["AC"]
    rod.rest_length = rod.original_length + 1e-4
    solution = solve(model, [Unknown.named(model, "AC")])
    along = rod.stiffness / rod.rest_length * (solution.delta_real[0] - 1e-4)
    assert solution.force[0] == pytest.approx(along, rel=1e-10)
    assert solution.force[0] < 0.0


THREE_BARS = model(
    [
        particle("A", 0, 0, fixed=[True, True]),
        particle("B", 1, 0, fixed=[True, True], displacement=[1e-3, -5e-3]),
        particle("C", 2, 0, fixed=[True, True]),
        particle("D", 1, 1, force=[3, -7]),
    ],
    [rod(end, "D") for end in "ABC"],
)


@pytest.mark.parametrize("name", ["AD", "BD", "CD", "B.y"])
def test_moved_supports_count(name: str) -> None:
    model = models.load(THREE_BARS)
    unknown = Unknown.named(model, name)
    solution, theory = solve(model, [unknown]), linear(model)
    by_theory = theory.reaction[1, 1] if name == "B.y" else theory.axial_force[model.rods[name].row]
    assert solution.force[0] == pytest.approx(by_theory, rel=1e-12)
    assert solution.delta_real[0] - solution.delta_base[0] == pytest.approx(
        solution.delta_unit[0, 0] * solution.force[0], rel=1e-9
    )
    assert solution.real.displacement == pytest.approx(theory.displacement, rel=1e-12, abs=1e-15)
    assert solution.superposed.displacement == pytest.approx(theory.displacement, rel=1e-9, abs=1e-14)
    [exact] = exact_forces(model, [unknown]) or []
    assert exact == pytest.approx(by_theory, rel=1e-2)


def test_set_3_is_without_moved_supports_and_plastic_strain() -> None:
    rods = [{**rod, "plastic_strain": 1e-3} for rod in THREE_BARS["rods"]]
    session = Session.open({**THREE_BARS, "rods": rods})
    session.press("k")
    session.press("k")
    session.click(1, 0.5)
    session.press("k")
    session.press("k")
    worlds = (world for world, _ in session.scenes.active.stages(session))
    first, second, third = (world for world in worlds if world.particles.count)
    assert first.particles["B"].displacement == second.particles["B"].displacement == (1e-3, -5e-3)
    assert third.particles["B"].displacement == (0.0, 0.0)
    assert not third.rods.plastic_strain.any()
