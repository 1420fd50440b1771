"""Rods that bear tension only: slack or taut in statics, in motion, and refused where theory is linear."""

from __future__ import annotations

import math

import numpy as np
import pytest

from game import Session, models
from systems.statics.events import NoEquilibrium
from systems.statics.force_method import ForceMethodError, solve
from systems.statics.path import Goal, load_path
from systems.statics.settle import settle
from systems.statics.theory import linear
from tests.reference.elements import Model as Document
from tests.reference.models import model, particle, rod

HELD = {"fixed": [True, True]}


def braced(*, both: bool = True, push: float = 50.0, **of_cables: float) -> Document:
    """A square on two supports, pushed sideways at its top, with one or two cables as diagonals."""
    particles = [
        particle("A", 0, 0, **HELD),
        particle("B", 1, 0, **HELD),
        particle("C", 1, 1, force=[push, 0.0]),
        particle("D", 0, 1),
    ]
    cable = {"tension_only": True, "stiffness": 50000.0, **of_cables}
    rods = [rod("A", "D"), rod("D", "C"), rod("B", "C"), rod("A", "C", **cable)]
    return model(particles, [*rods, rod("B", "D", **cable)] if both else rods)


def hung(drop: float, **properties: float) -> Document:
    """A ball on a vertical cable of 1 m, held `drop` m above the place where the cable is straight."""
    ball = particle("B", 0, -1.0 + drop, mass=10.0, acceleration=[0.0, -9.81])
    ball_on = {"tension_only": True, "rest_length": 1.0, "stiffness": 100.0, "damping": 0.0}
    return model([particle("A", 0, 0, **HELD), ball], [rod("A", "B", **(ball_on | properties))])


def test_a_braced_square_bears_like_the_truss_without_its_slack_diagonal() -> None:
    state = settle(models.load(braced())).final
    alone = settle(models.load(braced(both=False))).final
    assert state.axial_force[4] == 0.0
    assert state.axial_force[3] > 0.0
    assert state.axial_force[:4] == pytest.approx(alone.axial_force, rel=1e-10, abs=1e-8)
    assert state.displacement == pytest.approx(alone.displacement, rel=1e-8, abs=1e-13)
    assert state.elastic_energy == pytest.approx(alone.elastic_energy, rel=1e-10)


def test_reversing_the_push_swaps_the_diagonals() -> None:
    there, back = settle(models.load(braced()), (1.0, -1.0)).states
    assert (there.axial_force[3] > 0.0, there.axial_force[4]) == (True, 0.0)
    assert back.axial_force[3] == 0.0
    assert back.axial_force == pytest.approx(settle(models.load(braced()), (-1.0,)).final.axial_force, rel=1e-9)


@pytest.mark.parametrize("integrator", ["velocity_verlet", "dop853", "esdirk4"])
def test_statics_is_where_motion_comes_to_rest(integrator: str) -> None:
    document = braced()
    document["settings"] = {"integrator": integrator}
    session = Session.open(document)
    expected = settle(session.model).final
    assert session.run(until="rest") == "at rest"
    largest = np.abs(expected.axial_force).max()
    assert session.rods.axial_force == pytest.approx(expected.axial_force, abs=1e-8 * largest)
    assert session.rods.axial_force[4] == 0.0


def test_cables_made_too_short_are_both_taut_at_first() -> None:
    """Preloaded alike, both bear: the pair is as stiff as two rods until one has lost its preload."""
    short = {"rest_length": math.sqrt(2.0) * (1.0 - 2e-3)}
    rods = braced(**short, push=10.0)
    for each in rods["rods"]:
        each.pop("tension_only", None)
    assert (settle(models.load(braced(**short, push=10.0))).final.axial_force[3:] > 0.0).all()
    as_rods = settle(models.load(rods)).final.axial_force
    assert settle(models.load(braced(**short, push=10.0))).final.axial_force == pytest.approx(as_rods, rel=1e-9)
    assert settle(models.load(braced(**short, push=300.0))).final.axial_force[4] == 0.0


def test_a_weight_on_two_cables() -> None:
    """N = F / (2 sin α) at the depth that the cables' elongation leaves, α in exact geometry."""
    legs = {"tension_only": True, "stiffness": 1000.0}
    particles = [
        particle("A", -1, 0, **HELD),
        particle("M", 0, 0, force=[0.0, -10.0]),
        particle("B", 1, 0, **HELD),
    ]
    state = settle(models.load(model(particles, [rod("A", "M", **legs), rod("M", "B", **legs)]))).final
    depth = -state.displacement[1, 1]
    length = math.hypot(1.0, depth)
    assert state.axial_force == pytest.approx([1000.0 * (length - 1.0)] * 2, rel=1e-9)
    assert state.axial_force == pytest.approx([10.0 / (2.0 * depth / length)] * 2, rel=1e-9)


def test_a_ball_falls_freely_until_its_cable_is_taut() -> None:
    """Taut after √(2h/g); lowest where m g (h + s) = EA s²/2L₀; its energy account closes."""
    drop, weight, stiffness = 0.5, 10.0 * 9.81, 100.0 * 1000.0
    session = Session.open(hung(drop))
    instant = math.sqrt(2.0 * drop / 9.81)
    session.run(time=0.999 * instant)
    assert session.rods.axial_force[0] == 0.0
    assert session.energy.elastic == 0.0
    fallen = 0.5 * 9.81 * (0.999 * instant) ** 2
    assert session.particles.displacement[1, 1] == pytest.approx(-fallen, rel=1e-9)
    pulse = math.sqrt(stiffness / 10.0)
    sag, speed = 9.81 / pulse**2, math.sqrt(2.0 * 9.81 * drop)
    lowest = sag + math.hypot(sag, speed / pulse)
    at = instant + (math.pi - math.atan2(speed / pulse, sag)) / pulse
    session.run(time=at - 0.999 * instant)
    assert session.particles.displacement[1, 1] == pytest.approx(-drop - lowest, rel=1e-8)
    assert session.energy.elastic == pytest.approx(weight * (drop + lowest), rel=1e-6)
    assert abs(session.energy.imbalance) < 1e-6 * session.energy.elastic


def test_a_damper_of_a_cable_never_pushes_and_the_account_closes() -> None:
    session = Session.open(hung(0.5, damping=0.5))
    assert session.run(until="rest") == "at rest"
    assert session.rods.axial_force[0] == pytest.approx(0.0981, rel=1e-7)
    energy = session.energy
    assert energy.dissipated_damping > 0.0
    assert abs(energy.imbalance) < 1e-6 * energy.dissipated_damping


def test_a_cable_that_yielded_is_longer_when_it_is_slack() -> None:
    session = Session.open(hung(0.5, tensile_strength=2.0, damping=0.5))
    assert session.run(until="rest") == "at rest"
    stretched = session.rods.plastic_strain[0]
    assert stretched > 1e-3
    assert -session.particles.displacement[1, 1] - 0.5 == pytest.approx(stretched + 0.0981 / 100.0, rel=1e-6)
    assert abs(session.energy.imbalance) < 1e-5 * session.energy.dissipated_plastic


def test_random_trusses_settle_where_they_come_to_rest() -> None:
    numbers = np.random.default_rng(7)
    session = None
    for _ in range(4):
        document = braced(push=float(numbers.uniform(-80.0, 80.0)))
        document["particles"][3]["force"] = numbers.uniform(-40.0, 40.0, 2).tolist()
        document["rods"][1]["rest_length"] = float(numbers.uniform(0.999, 1.001))
        session = Session.open(document)
        expected = settle(session.model).final
        assert expected.status == "equilibrium"
        assert session.run(until="rest") == "at rest"
        largest = np.abs(expected.axial_force).max()
        assert session.rods.axial_force == pytest.approx(expected.axial_force, abs=1e-8 * largest)


def test_what_slack_cables_do_not_hold_is_explained_by_name() -> None:
    """Without weight the ball stays where it is, its cable slack: that is said."""
    document = hung(0.1)
    document["particles"][1]["acceleration"] = [0.0, 0.0]
    found = settle(models.load(document)).final
    assert found.axial_force[0] == 0.0
    assert "Rod AB is slack" in found.message


def test_linear_theories_refuse_cables_by_name() -> None:
    opened = models.load(braced())
    with pytest.raises(NoEquilibrium, match="Rods AC and BD act in tension only"):
        linear(opened)
    with pytest.raises(ForceMethodError, match="Rods AC and BD act in tension only"):
        solve(opened, ())
    with pytest.raises(ValueError, match="Rods AC and BD act in tension only"):
        load_path(opened, Goal(1.0))
