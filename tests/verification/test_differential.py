"""Models drawn by lot with every feature against the references: the small form of `pinjoint bench differential`."""

import numpy as np
import pytest

from pinjoint import Session
from tests.benchmarks import differential
from tests.reference.collisions import Scene, run
from tests.reference.elements import read
from tests.reference.random_models import KINDS, case, drawn, numbers_of
from tests.reference.transients import Untraceable, follow

# Each is compiled.
IN_MOTION = ("everything, in motion", "cables", "discs on trusses", "free discs that collide")
SETTLED = tuple(kind.title for kind in KINDS if not kind.moves)


@pytest.mark.parametrize("turn", range(4))
@pytest.mark.parametrize("title", IN_MOTION)
def test_default_runs_meet_what_is_promised_and_say_how_exact_they_are(title: str, turn: int) -> None:
    found = differential.examine(drawn(title, turn))
    assert not found.wrong, f"--seed {found.case.number}: {found.wrong}"


@pytest.mark.parametrize("turn", range(2))
@pytest.mark.parametrize("title", SETTLED)
def test_equilibria_and_curves_are_those_of_an_independent_method(title: str, turn: int) -> None:
    found = differential.examine(drawn(title, turn))
    assert not found.wrong, f"--seed {found.case.number}: {found.wrong}"


def test_a_number_is_always_the_same_model() -> None:
    assert case(12).document == case(12).document
    assert case(12).document != case(12 + len(KINDS)).document


def test_every_number_is_a_model_that_opens() -> None:
    for number in range(2 * len(KINDS)):
        Session.open(case(number).document)


def test_the_reference_of_motion_agrees_with_that_of_collisions_in_extended_precision() -> None:
    compared = 0
    for number in numbers_of("free discs that collide", 12):
        given_ = case(number)
        if "components" in given_.document:
            continue
        found, elements = follow(given_.document, given_.duration), read(given_.document)
        common = np.array(elements.environment_acceleration)
        scene = Scene(
            position=np.array([p.position for p in elements.particles]),
            velocity=np.array([p.velocity for p in elements.particles]),
            acceleration=np.array([p.acceleration for p in elements.particles]) + common,
            radius=np.array([p.radius for p in elements.particles]),
            inverse_mass=np.array([[1.0 / p.mass] * 2 for p in elements.particles]),
            restitution=elements.restitution,
        )
        end, impacts = run(scene, given_.duration)
        assert len(impacts) == found.impacts
        assert found.velocity == pytest.approx(end.velocity.astype(float), abs=1e-10)
        compared += len(impacts)
    assert compared > 5


@pytest.mark.parametrize("title", ["everything, in motion", "yielding", "cables with dampers"])
def test_the_account_of_the_reference_closes(title: str) -> None:
    events = 0
    for number in numbers_of(title, 2):
        given_ = case(number)
        try:
            found = follow(given_.document, given_.duration)
        except Untraceable:
            continue
        energy = found.energy
        left = energy["kinetic"] + energy["elastic"] + sum(v for k, v in energy.items() if k.startswith("diss"))
        assert energy["initial"] + energy["work"] == pytest.approx(left, abs=1e-10 * found.largest["energy"])
        events += found.events
    assert events > 0


def test_what_disagrees_is_told_with_its_number() -> None:
    given_ = drawn("equilibrium: elastic", 0)
    found = differential.Finding(given_, errors={"balance": 1.0}, wrong=["balance off by 1.0e+00"])
    made = differential.tables([found])
    assert made["disagreements"] == [
        {"seed": given_.number, "kind": "equilibrium: elastic", "what": "balance off by 1.0e+00"}
    ]
    (row,) = made["equilibrium"]
    assert (row["models"], row["disagree"], row["balance worst"]) == (1, 1, 1.0)


def test_one_model_is_told_in_full() -> None:
    made = differential.report(quick=True, seed=numbers_of("free discs that collide", 1)[0])
    assert {"motion", "model", "document", "particles", "energies, J"} <= set(made)
    assert all(row["program"] == pytest.approx(row["reference"], abs=1e-9) for row in made["particles"])
