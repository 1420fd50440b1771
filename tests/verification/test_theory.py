"""Theory beside the simulation: linear answers, indeterminacy, influence lines, vibrations, `pinjoint verify`."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import eigh

from pinjoint.commands import comparison
from pinjoint.commands.command_line import main
from pinjoint.commands.influence import influence
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle
from pinjoint.components.rod import Rod
from pinjoint.documents import models
from pinjoint.systems.statics.counting import Count
from pinjoint.systems.statics.events import NoEquilibrium
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.theory import Indeterminacy, linear, mechanisms, self_stress
from pinjoint.systems.statics.verify import Theories
from pinjoint.systems.statics.vibration import Vibrations
from tests.reference import closed_forms, pynite, statics
from tests.reference import models as trusses
from tests.reference.elements import Model as Document
from tests.reference.elements import read

RELATIVE = 1e-9  # of the largest like quantity

TRUSSES = {
    "triangle": trusses.triangle(),
    "square": trusses.square(),
    "panels": trusses.panel_truss(),
    "opensees": trusses.opensees_truss(),
}


def agree(found: dict[str, Any], expected: dict[str, Any]) -> None:
    """Values by name agree to 1e-9 of the largest."""
    values = np.array([found[name] for name in expected])
    wanted = np.array(list(expected.values()))
    assert np.abs(values - wanted).max() <= RELATIVE * np.abs(wanted).max()


def linear_by_names(document: Document) -> dict[str, dict[str, Any]]:
    model = models.load(document)
    state = linear(model)
    return {
        "axial_force": dict(zip(model.rods.names, state.axial_force.tolist(), strict=True)),
        "displacement": dict(zip(model.particles.names, state.displacement.tolist(), strict=True)),
        "reaction": dict(zip(model.particles.names, state.reaction.tolist(), strict=True)),
    }


# --- linear theory -------------------------------------------------------------------------------------


def check_against_pynite(document: Document) -> None:
    found, expected = linear_by_names(document), pynite.linear_truss(document)
    for quantity in ("axial_force", "displacement", "reaction"):
        agree(found[quantity], expected[quantity])


@pytest.mark.parametrize("name", TRUSSES)
def test_linear_theory_agrees_with_pynite(name: str) -> None:
    check_against_pynite(TRUSSES[name])


@settings(max_examples=15)
@given(seed=st.integers(0, 10_000), redundant=st.integers(0, 4))
def test_linear_theory_agrees_with_pynite_on_trusses_drawn_by_lot(seed: int, redundant: int) -> None:
    check_against_pynite(trusses.random_truss(seed, nodes=7, redundant=redundant))


def test_the_manual_of_opensees() -> None:
    found = linear_by_names(trusses.opensees_truss())["displacement"]["4"]
    assert found == pytest.approx((0.530092777132284, -0.177893638469318), rel=1e-12)


def test_lack_of_fit_and_a_moved_support_act_in_linear_theory() -> None:
    document = trusses.square()
    document["rods"][4]["rest_length"] = 1.5 * math.sqrt(2.0) - 1e-3
    document["particles"][0]["displacement"] = [0, -2e-3]
    found, expected = linear_by_names(document), statics.direct_stiffness(document)
    for quantity in ("axial_force", "displacement", "reaction"):
        agree(found[quantity], expected[quantity])


@pytest.mark.parametrize(("name", "who"), [("pendulum", "bob along y"), ("hanging_net", "along y")])
def test_linear_theory_refuses_a_mechanism_and_names_who_moves(name: str, who: str) -> None:
    with pytest.raises(NoEquilibrium, match=who):
        linear(models.load(name))


def test_linear_theory_refuses_a_free_body_that_is_pulled() -> None:
    document = trusses.triangle((1, 0))
    for particle in document["particles"]:
        particle["fixed"] = [False, True]
    with pytest.raises(NoEquilibrium, match="A, B and C along x"):
        linear(models.load(document))


def test_a_mechanism_carries_a_load_that_does_not_move_it() -> None:
    hanging = trusses.pendulum(0.0)
    found = linear_by_names(hanging)
    assert found["axial_force"]["OP"] == pytest.approx(9.81e-3, rel=1e-12)
    assert found["displacement"]["P"] == pytest.approx((0.0, -9.81e-3 / 200.0), rel=1e-12)


# --- indeterminacy -------------------------------------------------------------------------------------


def equilibrium_matrix(document: Document) -> np.ndarray:
    """Forces of the rods, then of the supports, on the particles: (2n, m + supports)."""
    elements = read(document)
    columns = []
    for rod in elements.rods:
        column = np.zeros((len(elements.particles), 2))
        along = np.array(rod.span) / math.hypot(*rod.span)
        column[rod.start], column[rod.end] = along, -along
        columns.append(column.ravel())
    for number, particle in enumerate(elements.particles):
        for axis in np.flatnonzero(particle.fixed):
            column = np.zeros((len(elements.particles), 2))
            column[number, axis] = 1.0
            columns.append(column.ravel())
    return np.array(columns).T


@pytest.mark.parametrize(
    ("document", "internal", "external", "moving"),
    [
        (trusses.triangle(), 0, 0, 0),
        (trusses.square(), 1, 0, 0),
        (trusses.panel_truss(), 0, 1, 0),
        (trusses.three_bar_truss(1.0, 2.0), 0, 1, 0),
        (trusses.opensees_truss(), 0, 1, 0),
        (trusses.pendulum(0.3), 0, 0, 1),
    ],
)
def test_degrees_of_indeterminacy(document: Document, internal: int, external: int, moving: int) -> None:
    found = Indeterminacy.of(models.load(document))
    assert (found.internal, found.external, found.mechanisms) == (internal, external, moving)
    assert found.static == internal + external


def test_a_free_body_has_three_mechanisms() -> None:
    document = trusses.square()
    for particle in document["particles"]:
        particle["fixed"] = [False, False]
    found = Indeterminacy.of(models.load(document))
    assert (found.static, found.mechanisms) == (1, 3)


@settings(max_examples=25)
@given(seed=st.integers(0, 10_000), nodes=st.integers(3, 9), removed=st.integers(0, 4))
def test_indeterminacy_against_the_rank_of_the_equilibrium_matrix(seed: int, nodes: int, removed: int) -> None:
    document = trusses.random_truss(seed, nodes, redundant=3)
    document["rods"] = document["rods"][min(removed, len(document["rods"]) - 1) :]
    held = {name for rod in document["rods"] for name in rod["between"]}
    document["particles"] = [particle for particle in document["particles"] if particle["name"] in held]
    matrix = equilibrium_matrix(document)
    rank = int(np.linalg.matrix_rank(matrix))
    model = models.load(document)
    found = Indeterminacy.of(model)
    assert found.static == matrix.shape[1] - rank
    assert found.mechanisms == matrix.shape[0] - rank == len(mechanisms(model))
    assert len(self_stress(model)) == found.static
    rods = matrix[:, : model.rods.count]
    free = ~np.array([particle.fixed for particle in read(document).particles]).ravel()
    for state in self_stress(model):
        assert np.abs(state).max() == pytest.approx(1.0)
        assert np.abs((rods @ state)[free]).max(initial=0.0) < 1e-12
    for motion in mechanisms(model):
        assert np.abs(rods.T @ motion.ravel()).max() < 1e-12
        assert not motion[model.particles.fixed].any()


def test_self_stress_of_the_square() -> None:
    """Sides 1, diagonals −√2, or any multiple."""
    (state,) = self_stress(models.load("hyperstatic"))
    assert state / state[0] == pytest.approx([1, 1, 1, 1, -math.sqrt(2), -math.sqrt(2)], rel=1e-12)


# --- influence lines -------------------------------------------------------------------------------------


def influence_by_moving_the_load(
    document: Document, quantity: str, name: str, axis: int | None
) -> dict[str, Any]:
    """The same by one PyNite solution for each place and direction of a force of 1 kN."""
    line = {}
    for number, particle in enumerate(document["particles"]):
        line[particle["name"]] = []
        for direction in ([1, 0], [0, 1]):
            moved = [
                p | {"force": direction if k == number else [0, 0]} for k, p in enumerate(document["particles"])
            ]
            value = pynite.linear_truss(document | {"particles": moved})[quantity][name]
            line[particle["name"]].append(float(value if axis is None else value[axis]))
    return line


@pytest.mark.parametrize(
    ("quantity", "name", "axis"),
    [("axial_force", "U2L3", None), ("reaction", "L3", 1), ("reaction", "L1", 0), ("displacement", "L2", 1)],
)
def test_influence_lines_against_a_load_that_is_moved(quantity: str, name: str, axis: int | None) -> None:
    document = trusses.panel_truss()
    of = name if axis is None else f"{name}.{'xy'[axis]}"
    found = influence(models.load(document), [of])["influence"][of]
    assert found["quantity"] == quantity
    agree(found["of"], influence_by_moving_the_load(document, quantity, name, axis))


def test_a_mechanism_has_no_influence_lines() -> None:
    with pytest.raises(NoEquilibrium, match="bob along y can move"):
        influence(models.load("pendulum"), ["arm"])


# --- vibrations -------------------------------------------------------------------------------------------


def test_frequencies_of_a_chain() -> None:
    """f_j = (1/π) √(k/m) sin(jπ/2(n+1)); k = 1e5 N/m, m = 10 kg, n = 8: f₁ = (100/π) sin(π/18)."""
    document = trusses.chain(8, 1e5, 10.0)
    found = Vibrations.of(models.load(document)).hertz
    assert found[0] == pytest.approx(100 / math.pi * math.sin(math.pi / 18), rel=1e-12)
    assert found == pytest.approx(closed_forms.chain_frequencies(8, 1e5, 10.0), rel=RELATIVE)


@settings(max_examples=10)
@given(seed=st.integers(0, 10_000))
def test_frequencies_and_shapes_against_a_dense_eigenvalue_problem(seed: int) -> None:
    document = trusses.random_truss(seed)
    elements = read(document)
    free = ~np.array([particle.fixed for particle in elements.particles]).ravel()
    masses = np.repeat([particle.mass / 1000 for particle in elements.particles], 2)[free]
    stiffness = statics.stiffness_matrix(document)[np.ix_(free, free)]
    squared = eigh(stiffness, np.diag(masses), eigvals_only=True)
    found = Vibrations.of(models.load(document))
    assert found.angular_squared == pytest.approx(squared, rel=RELATIVE)
    for value, mode in zip(found.angular_squared, found.modes, strict=True):
        shape = mode.ravel()[free]
        left = stiffness @ shape - value * masses * shape
        assert np.abs(left).max() < RELATIVE * np.abs(stiffness).max()


def test_a_loaded_pendulum_swings() -> None:
    """ω² = g/L, the length L = L₀ (1 + mg/EA) being that under its weight."""
    model = models.load(trusses.pendulum(0.4))
    swinging = Vibrations.of(model, settle(model).final)
    length = 1.0 + 9.81e-3 / 200.0
    assert swinging.angular_squared[0] == pytest.approx(9.81 / length, rel=RELATIVE)
    assert Vibrations.of(model).hertz[0] == 0.0  # unloaded, it is a mechanism


def test_the_lowest_modes_of_a_large_structure() -> None:
    """A chain of 700: sparse eigenvalues near zero, f_j = (1/π) √(k/m) sin(jπ/2(n+1))."""
    found = Vibrations.of(models.load(trusses.chain(700, 1e5, 10.0)), count=5).hertz
    assert found == pytest.approx(closed_forms.chain_frequencies(700, 1e5, 10.0)[:5], rel=1e-8)


# --- side by side -------------------------------------------------------------------------------------------


def test_errors_are_relative_to_the_largest_exact_value() -> None:
    model = models.load("isostatic")
    comparison = Theories.of(model).beside(model, simulated=False)
    row = next(row for row in comparison.rows if row.name == "CA")
    assert row.linear == pytest.approx(20.0, rel=1e-12)
    assert row.exact == pytest.approx(20.0678998039911, rel=1e-12)
    assert row.linear_error == pytest.approx((20.0678998039911 - 20.0) / 198.0274601694, rel=1e-9)
    worst = comparison.worst("linear")
    assert worst is not None
    assert worst.title == "displacement y of particle B"
    assert comparison.worst("simulation") is None


def test_verify_puts_simulation_linear_and_exact_side_by_side(answer: Any) -> None:
    found = answer("verify", "isostatic")
    assert (found["status"], found["simulation"]["status"]) == ("verified", "at rest")
    force = found["rods"]["AB"]["axial_force"]
    assert force["exact"] == pytest.approx(-28.3427681444064, rel=1e-12)
    assert force["linear"] == pytest.approx(-28.2842712474619, rel=1e-12)
    assert force["simulation"] == pytest.approx(force["exact"], rel=1e-6)
    assert found["particles"]["A"]["reaction"]["y"]["exact"] == pytest.approx(20.0147921184446, rel=1e-12)
    assert found["worst"]["simulation"]["simulation_error"] < 1e-6
    assert found["indeterminacy"] == {"static": 0, "internal": 0, "external": 0, "mechanisms": 0}


def test_verify_points_out_a_rod_that_yielded_in_the_overshoot(answer: Any) -> None:
    found = answer("verify", "overshoot_yield")
    assert found["status"] == "differs from static theory"
    assert found["remarks"][0]["rods"] == ["AB"]
    assert found["message"].startswith(
        "Rod AB yielded only because the sudden load overshot: in equilibrium its force is 9 kN, below its strength of 10 kN"
    )


def test_verify_says_where_an_unexplained_difference_is(answer: Any) -> None:
    """One load is taken away again before the other comes: statics, which lets both grow, yields less."""
    limits = {"tensile_strength": 215, "compressive_strength": 215}
    model = trusses.square((0, 0), **limits)
    gone = {"kind": "table", "times": [0, 0.05, 0.1], "factors": [0, 1, 0]}
    model["loads"] = [{"on": "C", "force": [0, -270], "history": gone}, {"on": "C", "force": [0, -50]}]
    found = answer("verify", model, status=1)
    assert found["status"] == "not verified"
    assert found["message"].startswith(
        "The simulation came to rest in another state than the exact equilibrium: the "
    )


@pytest.mark.parametrize(
    ("edge", "diagonal"),
    [
        ({}, {"rest_length": 1.41}),
        ({}, {"temperature_change": 80}),
        ({"temperature_change": 50}, {"temperature_change": 50}),  # grows freely: no force anywhere
    ],
)
def test_verify_does_not_measure_forces_by_those_that_are_only_rounding(
    edge: dict[str, float], diagonal: dict[str, float], answer: Any
) -> None:
    """Self-stress needs no support: the reactions are 0, and what a run leaves of them is beside the rods' forces."""
    model = trusses.square((0, 0))
    for rod in model["rods"]:
        rod.update(diagonal if rod["name"] == "AC" else edge)
    found = answer("verify", model)
    assert found["status"] == "verified"
    assert found["worst"]["simulation"]["simulation_error"] < 1e-6


@pytest.mark.parametrize(
    ("name", "status", "said"),
    [
        ("collision_i", "not verified", "The model has no rods"),
        ("isostatic_collapse", "not verified", "Plastic collapse at the load factor 0.868"),
        ("pendulum", "theory only", "bob along y"),
    ],
)
def test_verify_says_what_is_missing(answer: Any, name: str, status: str, said: str) -> None:
    found = answer("verify", name, "--theory-only", status=status == "not verified")
    assert found["status"] == status
    assert said in found["message"]


@pytest.mark.parametrize("words", [("isostatic",), ("isostatic", "--influence", "AB", "A.y", "B.x")])
def test_verify_prints_tables(capsys: pytest.CaptureFixture[str], words: tuple[str, ...]) -> None:
    assert main(["verify", *words]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any(line.startswith("axial force") for line in lines)
    assert len(words) > 1 or lines[0].startswith("isostatic: verified, simulation and exact theory agree to ")
    assert main(["verify", "isostatic", "--influence", "nothing"]) == 2
    assert "nothing" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("isostatic", "g = m + r − 2n = 3 + 3 − 2·3 = 0"),
        ("hyperstatic", "g = m + r − 2n = 6 + 3 − 2·4 = 1"),
        (
            "pendulum",
            "g = m + r − 2n = 1 + 2 − 2·2 = −1; by matrix rank: no state of self-stress, one mechanism",
        ),
        ("snap_through", "g = m + r − 2n = 2 + 4 − 2·3 = 0"),
    ],
)
def test_the_rule_is_told_with_its_numbers(capsys: pytest.CaptureFixture[str], name: str, said: str) -> None:
    main(["verify", name, "--theory-only"])
    assert said in capsys.readouterr().out.splitlines()


@pytest.mark.parametrize("seed", range(20))
def test_the_rule_counts_self_stresses_less_mechanisms(seed: int) -> None:
    """Maxwell's rule and the rank agree in the difference, with loose particles and free bodies, too."""
    random = np.random.default_rng(seed)
    model = Model()
    model.create(Particle, 7, position=random.random((7, 2)), fixed=random.random((7, 2)) < 0.3)
    pairs = [(i, j) for i in range(6) for j in range(i) if random.random() < 0.5]
    if pairs:
        model.create(Rod, len(pairs), between=pairs)
    found = Indeterminacy.of(model)
    assert Count.of(model).degree == found.static - found.mechanisms


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("collision_i", []),
        ("pendulum", ["no self-stress; kinematically indeterminate: one mechanism"]),
        ("isostatic", ["statically determinate; no mechanisms"]),
        ("hyperstatic", ["statically indeterminate to degree 1 (internal 1, external 0); no mechanisms"]),
    ],
)
def test_verify_tells_the_degree_where_there_are_rods(
    capsys: pytest.CaptureFixture[str], name: str, said: list[str]
) -> None:
    main(["verify", name, "--theory-only"])
    lines = capsys.readouterr().out.splitlines()
    assert [
        line for line in lines if line.startswith(("statically", "kinematically", "no self-stress"))
    ] == said


def test_verifying_leaves_no_trace_in_theory(capsys: pytest.CaptureFixture[str]) -> None:
    model = models.load("hyperstatic_yield")
    before = models.document(model)
    Theories.of(model), Vibrations.of(model), mechanisms(model), self_stress(model)
    assert models.document(model) == before


def test_an_empty_model_has_no_theory_to_fail() -> None:
    model = Model()
    assert len(Vibrations.of(model).hertz) == len(mechanisms(model)) == len(self_stress(model)) == 0
    assert list(Theories.of(model).beside(model, simulated=False).rows) == []


def test_verify_leaves_out_a_simulation_that_takes_long_unless_it_is_asked_for(
    answer: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(comparison, "MOST_WORK", 100)
    found = answer("verify", "hyperstatic")
    assert (found["status"], found["simulation"]["status"]) == ("theory only", "left out")
    assert "--limit SECONDS lets it go on" in found["message"]
    assert found["rods"]["AB"]["axial_force"]["simulation"] is None
    found = answer("verify", "hyperstatic", "--limit", "60")
    assert found["status"] == "verified"
