"""What runs by default, `automatic` with its error controlled, against transients to nearly full precision."""

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pinjoint import Session
from pinjoint.documents import document as documents
from pinjoint.systems.physics.spectrum import spectrum
from tests.benchmarks.models import lattice
from tests.reference.elements import Document
from tests.reference.models import model, particle, rod
from tests.reference.transients import Motion, Untraceable, follow
from tests.verification.test_against_reference import SHORTEST, decimals, trusses

WITHIN = 1e-6  # of the largest displacement of the run
TIGHTLY = 1e-10  # the same, where a tolerance of 1e-12 is asked for


@settings(max_examples=6)
@given(trusses(full=True, damped=True), decimals(2.0, 40.0))
def test_random_trusses_by_default_and_by_a_tight_tolerance(document: Document, turns: float) -> None:
    """Yielding, damped, dragged, supported and loaded ever differently, for some radians of the fastest motion."""
    document = document | {"settings": {"collisions": False}}
    duration = turns / _fastest(document)
    expected, largest = _followed(document, duration)
    assert _error(document, duration, expected) <= WITHIN * largest
    assert _error(document, duration, expected, tolerance=1e-12) <= TIGHTLY * largest


def _followed(document: Document, duration: float) -> tuple[np.ndarray, float]:
    """Displacements (m) at the end, and the largest of any particle on the way."""
    try:
        found: Motion = follow(document, duration)
    except Untraceable:
        assume(False)
    assume(_shortest(document, found.displacement) > SHORTEST)
    return found.displacement, found.largest["displacement"]


def _fastest(document: Document) -> float:
    """The highest rate (1/s) of anything in a model as it starts."""
    session = Session.open(document)
    found = spectrum(session.model, session.rods.axial_force)
    return max(found.frequency, 2.0 * found.decay, 1.0)


def _shortest(document: Document, displacement: np.ndarray) -> float:
    """The length (m) of the shortest rod when displaced so."""
    row = {each["name"]: number for number, each in enumerate(document["particles"])}
    places = np.array([each["position"] for each in document["particles"]]) + displacement
    ends = np.array([[row[name] for name in rod["between"]] for rod in document["rods"]])
    return float(np.hypot(*(places[ends[:, 1]] - places[ends[:, 0]]).T).min())


def _error(document: Document, duration: float, expected: np.ndarray, **choices: Any) -> float:
    """The largest of any particle's errors (m)."""
    session = Session.open(document | {"settings": document["settings"] | choices})
    assert session.run(time=duration) in ("time reached", "at rest")
    return float(np.hypot(*(session.particles.displacement - expected).T).max())


@settings(max_examples=6)
@given(trusses(full=True, damped=True), decimals(5.0, 40.0), st.sampled_from([0.4, 0.1]))
def test_the_shown_error_of_verlet_is_within_a_factor_3_of_the_true_one(
    document: Document, turns: float, share: float
) -> None:
    """Where some ten steps or more lead to the end; after fewer, as long as is stable, it was up to 5 times."""
    document = document | {"settings": {"collisions": False, "integrator": "velocity_verlet"}}
    duration = turns / _fastest(document)
    expected, largest = _followed(document, duration)
    session = Session.open(document)
    session.simulation.advance(0)
    step = share * session.simulation.step_size.stable
    session = Session.open(document | {"settings": document["settings"] | {"time_step": step}})
    session.run(time=duration)
    true = float(np.hypot(*(session.particles.displacement - expected).T).max())
    assume(true > 1e-11 * largest)
    found = session.document.assessment.error()
    assert found is not None
    assert 1 / 3 < found.displacement / true < 3.0


def test_the_reference_knows_what_yields_from_the_start_on() -> None:
    """One bar, stretched beyond its strength and flying apart: its force stays at the strength, so that
    m Δv = −2 F t for equal ends, exactly."""
    document = model(
        [
            particle("A", 0, 0, displacement=[-0.01, 0], velocity=[-3, 0], mass=1),
            particle("B", 1, 0, displacement=[0.01, 0], velocity=[3, 0], mass=1),
        ],
        [rod("A", "B", stiffness=1000, damping=0, tensile_strength=0.2)],
        settings={"collisions": False},
    )
    expected = follow(document, 0.01).displacement
    exact = 0.01 + 3 * 0.01 - 0.5 * 200.0 * 0.01**2
    assert abs(expected[1, 0] - exact) < 1e-14
    assert _error(document, 0.01, expected) < 1e-12


def test_the_reference_ends_with_a_rod_that_yields_between_two_held_particles() -> None:
    """Its elongation never changes: it neither goes on yielding nor unloads, and stays as it is."""
    document = model(
        [
            particle("A", 0, 0, displacement=[-0.01, 0], fixed=[True, True]),
            particle("B", 1, 0, fixed=[True, True]),
            particle("C", 2, 0, velocity=[1, 0], mass=1),
        ],
        [rod(*ends, stiffness=1000, damping=0, tensile_strength=2) for ends in ("AB", "BC")],
    )
    displacement = follow(document, 1e-4).displacement
    assert displacement[:2].tolist() == [[-0.01, 0.0], [0.0, 0.0]]
    assert displacement[2, 0] == pytest.approx(1e-4, rel=1e-2)


@pytest.mark.parametrize("cables", [0, 5], ids=["rods", "some cables"])
def test_a_lattice_of_several_hundred_rods_is_exact_in_forces_and_speeds_too(cables: int) -> None:
    """Jittered, of rods of very different stiffness, under sudden forces, undamped."""
    made, random = documents.document(lattice(400, damping=0.0)), np.random.default_rng(3)
    for one in made["particles"]:
        one["position"] = (np.array(one["position"]) + random.uniform(-0.2, 0.2, 2)).tolist()
        if not any(one.get("fixed", [])):
            one["force"] = random.uniform(-20.0, 20.0, 2).tolist()
    for number, one in enumerate(made["rods"]):
        one["stiffness"] = 10.0 ** random.uniform(3.0, 5.0)
        one["tension_only"] = cables > 0 and number % cables == 0
    runs = []
    for tolerance in (1e-9, 1e-12):
        chosen = {"collisions": False, "tolerance": tolerance}
        session = Session.open(made | {"settings": made["settings"] | chosen})
        session.run(time=0.02)
        runs.append(session)
    run, exact = runs
    assert run.model.clock.steps < 1000
    for table, name, within in [
        ("particles", "displacement", 1e-6),
        ("particles", "velocity", 1e-5),
        ("rods", "axial_force", 1e-5),
    ]:
        true = exact.table(table).column(name)
        assert np.abs(run.table(table).column(name) - true).max() <= within * np.abs(true).max()


def test_a_run_too_large_for_error_control_says_so(monkeypatch: pytest.MonkeyPatch, answer: Any) -> None:
    monkeypatch.setattr("pinjoint.systems.physics.automatic.AFFORDABLE", 2)
    monkeypatch.setattr("pinjoint.systems.run.measured_error.IN_A_COMMAND", 0)
    words = ["run", "isostatic", "--at", "0.001"]
    found = answer(*words)
    assert found["integrator"] == "velocity_verlet"
    assert found["error_estimate"] is None
    assert "--measure-error" in found["message"]
    found = answer(*words, "--measure-error")
    assert found["error_estimate"]["relative"] > 0.0
    assert "--measure-error" not in found["message"]
