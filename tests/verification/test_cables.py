"""Rods that bear tension only: slack or taut in statics, in motion, and refused where theory is linear."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.documents import models
from pinjoint.systems.statics.events import NoEquilibrium
from pinjoint.systems.statics.force_method import solve
from pinjoint.systems.statics.path import Curve, Goal
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.theory import linear
from pinjoint.systems.statics.unknowns import MethodError
from tests.reference import closed_forms, statics
from tests.reference.elements import Model as Document
from tests.reference.models import model, particle, random_truss, rod

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


@pytest.mark.parametrize("sideways", [True, False])
def test_a_slack_cable_may_pass_its_support_and_hold_from_the_other_side(sideways: bool) -> None:
    """Pushed exactly towards it: on the way the cable shrinks to a point and turns over."""
    pushed = particle("B", 2, 0, fixed=[False, sideways], force=[-10.0, 0.0])
    cable = rod("A", "B", tension_only=True, stiffness=1000.0)
    state = settle(models.load(model([particle("A", 0, 0, **HELD), pushed], [cable]))).final
    assert state.status == "equilibrium"
    assert state.axial_force == pytest.approx([10.0], rel=1e-9)
    assert state.displacement[1] == pytest.approx([-4.0 - 2.0 * 10.0 / 1000.0, 0.0], rel=1e-9, abs=1e-9)


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


def cabled(seed: int, cables: int = 5, **of_truss: Any) -> Document:
    """A truss drawn by lot, some of its rods cables, some of these a little too short or too long."""
    document = random_truss(seed, **({"nodes": 7, "redundant": 4, "load": 300.0} | of_truss))
    lot = np.random.default_rng(seed)
    for number in lot.permutation(len(document["rods"]))[:cables].tolist():
        document["rods"][number]["tension_only"] = True
    return document


@settings(max_examples=8)
@given(seed=st.integers(0, 10_000))
def test_linear_trusses_against_all_choices_of_slack_cables(seed: int) -> None:
    document = cabled(seed)
    found = settle(models.load(document), theory="first-order")
    try:
        expected = statics.direct_stiffness_of_cables(document)
    except ValueError:
        assert found.status != "equilibrium"
        return
    moved = np.array(list(expected["displacement"].values()))
    if np.abs(moved).max() > 100.0:
        return  # so far that settling calls it a mechanism
    assert found.status == "equilibrium"
    forces = np.array([expected["axial_force"].get(name, 0.0) for name in rod_names(document)])
    assert np.abs(found.final.axial_force - forces).max() <= 1e-9 * np.abs(forces).max()
    assert np.abs(found.final.displacement - moved).max() <= 1e-9 * np.abs(moved).max()


def rod_names(document: Document) -> list[str]:
    return [rod["name"] for rod in document["rods"]]


@settings(max_examples=15)
@given(seed=st.integers(0, 10_000))
def test_trusses_in_exact_geometry_against_an_independent_newton_method(seed: int) -> None:
    document = cabled(seed, cables=3)
    try:
        (expected,) = statics.solve(document)
    except statics.NoEquilibrium:
        return  # it gives way by more than that solver follows
    found = settle(models.load(document))
    assert found.status == "equilibrium"
    forces = np.array(list(expected["axial_force"].values()))
    assert np.abs(found.final.axial_force - forces).max() <= 1e-9 * np.abs(forces).max()


@settings(max_examples=10)
@given(seed=st.integers(0, 10_000))
def test_cables_slacken_and_tighten_at_the_loads_that_are_said(seed: int) -> None:
    """Just before the load of an event its cable is as it was, just beyond as is said; cables are prestressed."""
    document = cabled(seed)
    lot = np.random.default_rng(seed)
    for each in document["rods"]:
        start, end = (next(p for p in document["particles"] if p["name"] == n) for n in each["between"])
        if each.get("tension_only"):
            length = math.dist(start["position"], end["position"])
            each["rest_length"] = length * (1.0 - float(lot.uniform(-2e-4, 6e-4)))
    events = [e for e in settle(models.load(document)).events if e.kind in ("slack", "taut", "mechanism")]
    if any(event.kind == "mechanism" for event in events):
        return
    for event in events[:3]:
        if event.load_factor < 1e-3:
            continue
        beside = [event.load_factor - 1e-6, event.load_factor + 1e-6]
        states = settle(models.load(document), beside).states
        before, beyond = (state.axial_force[rod_names(document).index(event.rods[0])] for state in states)
        assert (before > 0.0, beyond > 0.0) == ((True, False) if event.kind == "slack" else (False, True))


def test_a_curve_goes_on_where_cables_slacken_and_tighten() -> None:
    """From both diagonals taut through one slack, at the same equilibria as settling."""
    model = models.load(braced(rest_length=math.sqrt(2.0) * (1.0 - 1e-3), push=300.0))
    curve = Curve.of(model, Goal(1.0))
    assert curve.complete
    assert curve.stable.all()
    assert curve.axial_force[0, 4] > 0.0
    assert curve.axial_force[-1, 4] == 0.0
    for factor, forces in list(zip(curve.load_factor, curve.axial_force, strict=True))[1::4]:
        assert forces == pytest.approx(settle(model, [float(factor)]).final.axial_force, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    ("aside", "stiffness", "longer"), [(0.5, 1e6, 0.003), (0.5, 1e8, 0.005), (1.0, 1e8, 0.004)]
)
def test_a_cable_much_stiffer_than_what_moves_it_tightens_without_a_jump(
    aside: float, stiffness: float, longer: float
) -> None:
    """Its force would grow 10³ times as quickly as the load, so that the path hardly comes near where it tightens."""
    particles = [
        particle("A", 0, 0, **HELD),
        particle("B", 1, 0, force=[0.0, -1.0]),
        particle("C", 1, 1, **HELD),
        particle("D", 1.0 + aside, 1, **HELD),
    ]
    cable = {"tension_only": True, "stiffness": stiffness, "rest_length": math.hypot(1.0, aside) + longer}
    rods = [rod("A", "B", stiffness=100.0), rod("C", "B", stiffness=100.0), rod("D", "B", **cable)]
    made = models.load(model(particles, rods))
    settled, curve = settle(made), Curve.of(made, Goal(1.0))
    assert [event.kind for event in settled.events] == ["taut"]
    assert settled.final.residual <= 1e-9
    assert curve.complete
    assert curve.axial_force[-1] == pytest.approx(settled.final.axial_force, rel=1e-6)


def test_random_loads_settle_where_they_come_to_rest() -> None:
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
    with pytest.raises(MethodError, match="Rods AC and BD act in tension only"):
        solve(opened, ())


def test_the_braced_portal_does_what_its_description_says(capsys: pytest.CaptureFixture[str]) -> None:
    """Prestressed by about 20 kN, BD slack from 30.6 kN on, 62.6 kN in AC under the whole wind."""
    before = settle(models.load("braced_portal"), [0.0]).final
    assert before.axial_force[3:] == pytest.approx([20.0, 20.0], abs=0.6)
    found = settle(models.load("braced_portal"))
    (event,) = found.events
    assert (event.kind, event.rods) == ("slack", ("BD",))
    assert event.load_factor * 50.0 == pytest.approx(30.6, abs=0.05)
    assert found.final.axial_force[3:] == pytest.approx([62.6, 0.0], abs=0.05)
    assert main(["verify", "braced_portal"]) == 0
    assert "all cables are counted as taut" in capsys.readouterr().out


@pytest.mark.parametrize("tolerance", [1e-9, 1e-12])
def test_errors_are_controlled_where_the_damper_of_a_cable_sets_in(tolerance: float) -> None:
    """It sets in with a jump of c v. Taut the ball moves by m x'' + c x' + k x = m g until c x' + k x = 0."""
    drop, mass, stiffness, damping, gravity = 0.5, 10.0, 1e5, 200.0, 9.81
    instant, end = math.sqrt(2.0 * drop / gravity), 0.345
    omega = math.sqrt(stiffness / mass)
    zeta = damping / (2.0 * mass * omega)
    sag = mass * gravity / stiffness
    moved, speed = closed_forms.free_vibration(end - instant, omega, zeta, -sag, gravity * instant)
    assert stiffness * (sag + moved) + damping * speed > 0.0
    session = Session.open(hung(drop, damping=damping / 1000.0) | {"settings": {"tolerance": tolerance}})
    session.run(time=end)
    assert -session.particles.displacement[1, 1] == pytest.approx(drop + sag + moved, abs=tolerance)
    assert -session.particles.velocity[1, 1] == pytest.approx(speed, abs=100.0 * tolerance)


@pytest.mark.parametrize("seed", [6, 10, 21, 30, 31, 43, 52])
def test_where_a_cable_tightens_as_a_very_short_step_begins(seed: int) -> None:
    """Steps as short as a strong damper's jump asks for are not divided further: there was no time left to."""
    document = random_truss(seed, nodes=5, redundant=2)
    for number, each in enumerate(document["rods"]):
        each |= {"tension_only": number % 2 == 1, "damping": 100.0}
    session = Session.open(document | {"settings": {"collisions": False}})
    assert session.run(time=0.2) in ("time reached", "at rest")
    assert abs(session.energy.imbalance) <= 1e-6 * session.energy.work


@pytest.mark.parametrize(
    ("integrator", "order"), [("semi_implicit_euler", 1), ("velocity_verlet", 2), ("rk4", 4), ("esdirk4", 4)]
)
def test_orders_hold_where_a_cable_tightens(integrator: str, order: int) -> None:
    """The force has a kink there: steps across it cost h², so that Verlet keeps its order; others end a step there."""
    drop, pulse = 0.5, math.sqrt(100.0 * 1000.0 / 10.0)
    instant = math.sqrt(2.0 * drop / 9.81)
    duration, sag = 0.9 * math.pi / pulse, 9.81 / pulse**2
    swing = sag * (1.0 - math.cos(pulse * duration)) + 9.81 * instant / pulse * math.sin(pulse * duration)
    errors = []
    for steps in (401, 1601):
        document = hung(drop)
        document["settings"] = {"integrator": integrator, "time_step": (instant + duration) / steps}
        session = Session.open(document)
        session.run(time=instant + duration)
        errors.append(abs(float(session.particles.displacement[1, 1]) + drop + swing))
    assert math.log(errors[0] / errors[1], 4.0) == pytest.approx(order, abs=0.2)
