"""Settling against the thesis' structures in exact geometry, and the messages of statics."""

from __future__ import annotations

import json

import pytest

from game import Session, models
from game.cli import main
from systems.statics.settle import settle
from tests.reference.thesis_targets import EQUILIBRIA


@pytest.mark.parametrize(
    ("name", "target", "factors"),
    [
        ("isostatic", "triangle_EA", [1.0]),
        ("isostatic_10x", "triangle_10EA", [1.0]),
        ("hyperstatic", "square_EA", [1.0]),
        ("hyperstatic_10x", "square_10EA", [1.0]),
        ("hyperstatic_yield", "square_plastic_EA", [1.0, 0.0]),
    ],
)
def test_the_exact_column(name: str, target: str, factors: list[float]) -> None:
    model = models.load(name)
    found = settle(model, factors)
    assert found.status == "equilibrium"
    for state, exact in zip(found.states, EQUILIBRIA[target]["exact"], strict=True):
        forces = exact["axial_kN"]
        largest = max(abs(force) for force in forces.values())
        for rod, force in zip(model.rods.names, state.axial_force.tolist(), strict=True):
            assert force == pytest.approx(forces[rod], abs=1e-9 * largest)
        for particle, moved in zip(model.particles.names, state.displacement.tolist(), strict=True):
            expected = [1e-3 * axis for axis in exact["displacement_mm"][particle]]
            assert moved == pytest.approx(expected, abs=1e-9 * 4e-3)


def test_the_shallow_truss_snaps_at_its_limit_load() -> None:
    """Von Mises truss, H = 1 m, half-span 5 m, EA = 1280 MN: snaps through at 3789.46 kN."""
    found = settle(models.load("von_mises"))
    (event,) = [event for event in found.events if event.kind == "snap-through"]
    assert event.load_factor * 3800.0 == pytest.approx(3789.46, abs=0.01)


def test_collapse_names_the_rod_and_the_load(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "isostatic_collapse", "--static", "--format", "json"]) == 1
    run = json.loads(capsys.readouterr().out)
    assert run["status"] == "collapse"
    assert "rod BC yields" in run["message"]
    assert run["events"][-1]["rods"]


def test_settling_in_a_session_can_be_undone_and_leaves_it_at_rest() -> None:
    session = Session.open("isostatic")
    assert session.settle() == "equilibrium"
    assert session.rods["AB"].axial_force == pytest.approx(-28.3427681444064, abs=1e-7)
    assert session.run(until="rest") == "at rest"
    session.undo()
    session.undo()
    assert session.particles["B"].displacement == (0.0, 0.0)
