"""Settling of frames in exact geometry: energy minimised by the slow reference, elastica, circles, and states on the way."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from pinjoint.components.model import Model
from pinjoint.components.particle import in_support_axes
from pinjoint.documents.models import parse
from pinjoint.session import Session
from pinjoint.systems.statics.factor import is_held, soft_modes
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.state import StaticState
from pinjoint.systems.statics.theory import Indeterminacy, linear
from tests.reference import frames
from tests.reference.models import CLAMPED, PINNED, line, model, particle, rod
from tests.verification.test_frame_theory import random_frame

EI, LENGTH = 1000.0, 10.0


def cantilever(parts: int, tip: dict[str, Any], slenderness: float = 1e4, **facts: Any) -> Model:
    """A cantilever along x of equal rods, clamped at its left end; slenderness: EA L²/EI."""
    places = [(LENGTH * i / parts, 0.0) for i in range(parts + 1)]
    stiff = {"stiffness": EI * slenderness / LENGTH**2, "bending_stiffness": EI, **facts}
    return parse(line(places, CLAMPED, tip, **stiff) | {"settings": {"collisions": False}})


def held_by_reference(loaded: Model, state: StaticState, within: float) -> None:
    """The slow reference finds no force out of balance but the reactions."""
    state.put(loaded)
    force, moment = frames.forces(loaded)
    particles = loaded.particles
    size = max(float(np.abs(state.axial_force).max()), float(np.abs(particles.constant_force).max()))
    rigid = particles.inertia > 0.0
    along = particles.support_springs * in_support_axes(loaded, state.displacement)
    sprung = in_support_axes(loaded, along, back=True)
    assert np.abs(np.where(particles.fixed, -force, -sprung) - state.reaction).max() < within * size
    turned = np.where(particles.fixed_rotation, -moment, -particles.rotation_spring * state.rotation)
    assert np.abs((turned - state.reaction_moment) * rigid).max() < within * size
    assert np.abs(force[~particles.fixed]).max(initial=0.0) < within * size
    assert np.abs(moment[particles.turning > 0.0]).max(initial=0.0) < within * size


@settings(max_examples=12, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_random_frames_are_in_balance_by_the_slow_reference(seed: int) -> None:
    document = random_frame(seed)
    document["settings"] = {"collisions": False}
    loaded = parse(document)
    found = settle(loaded).final
    assume(found.balanced)  # else it collapses; hypothesis fails if too many do
    held_by_reference(loaded, found, 2e-11)


@pytest.mark.parametrize("number", range(4))
def test_settled_is_where_the_energy_is_least(number: int) -> None:
    """A portal with a hinge, a bar, warmth, a settlement, and loads under which it moves far."""
    lot = np.random.default_rng([73, number])
    particles = [
        particle("A", 0.0, 0.0, **CLAMPED, rotation=float(lot.normal(0.0, 0.02))),
        particle("B", 0.0, 3.0, force=lot.normal(0.0, 60.0, 2).tolist()),
        particle("C", 4.0, 3.5, moment=float(lot.normal(0.0, 50.0))),
        particle("D", 4.0, 0.0, **CLAMPED, displacement=lot.normal(0.0, 0.02, 2).tolist()),
    ]
    rods = [
        rod("A", "B", temperature_gradient=60.0, temperature_change=40.0),
        rod("B", "C", hinged=[number % 2 == 1, False]),
        rod("C", "D"),
    ]
    for member in rods:
        member |= {"stiffness": 2e4, "bending_stiffness": 400.0}
        member["distributed_force"] = lot.normal(0.0, 8.0, 2).tolist()
    loaded = parse(model(particles, [*rods, rod("B", "D", stiffness=20.0)]))
    found = settle(loaded).final
    assert found.status == "equilibrium"
    assert np.abs(found.rotation).max() > 0.01
    found.put(loaded)
    displacement, rotation = frames.least_energy(loaded)
    assert found.displacement == pytest.approx(displacement, abs=1e-9 * np.abs(displacement).max())
    assert found.rotation == pytest.approx(rotation, abs=1e-9 * np.abs(rotation).max())


@pytest.mark.parametrize(("parts", "turns"), [(2, 1), (5, 1), (12, 1), (3, 4)])
def test_an_end_moment_rolls_a_cantilever_into_circles(parts: int, turns: int) -> None:
    """M = 2πEI/L for each turn: it closes, without axial forces, whatever the number of rods that divide a turn."""
    rolled = cantilever(turns * parts, {"moment": 2.0 * math.pi * turns * EI / LENGTH})
    found = settle(rolled).final
    assert found.status == "equilibrium"
    assert found.displacement[-1] == pytest.approx([-LENGTH, 0.0], abs=1e-14 * LENGTH)
    assert found.rotation[-1] == pytest.approx(2.0 * math.pi * turns, rel=1e-14)
    assert found.reaction_moment[0] == pytest.approx(-2.0 * math.pi * turns * EI / LENGTH, rel=1e-12)
    moment = found.diagrams["bending_moment"]
    assert moment == pytest.approx(2.0 * math.pi * turns * EI / LENGTH, rel=1e-12)


def elastica(load: float) -> tuple[float, float]:
    """Tip displacement/L of an inextensible cantilever under a tip force across, load = PL²/EI: θ'' = load cos θ."""

    def along(curvature: float) -> np.ndarray:
        def rates(_: float, state: np.ndarray) -> tuple[float, ...]:
            angle, bend = state[:2]
            return bend, load * math.cos(angle), math.cos(angle), math.sin(angle)

        path = solve_ivp(rates, (0.0, 1.0), (0.0, curvature, 0.0, 0.0), "DOP853", rtol=1e-12, atol=1e-13)
        return path.y[:, -1]

    x, y = along(brentq(lambda curvature: along(curvature)[1], -math.sqrt(2.0 * load), 0.0, xtol=1e-13))[2:]
    return x - 1.0, y


@pytest.mark.parametrize(("parts", "error"), [(2, 2.5e-3), (4, 1.8e-4), (8, 1.3e-5), (16, 1.0e-6)])
def test_a_cantilever_bends_like_the_elastica(parts: int, error: float) -> None:
    bent = cantilever(parts, {"force": [0.0, -5.0 * EI / LENGTH**2]}, slenderness=1e8)
    found = settle(bent).final
    assert found.status == "equilibrium"
    assert math.dist(found.displacement[-1] / LENGTH, elastica(5.0)) < 1.1 * error


@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_braces_that_yield_or_go_slack_beside_members_that_bend(seed: int) -> None:
    """Under the load and after unloading to a fifth of it, by the slow reference; no force beyond a strength."""
    lot, document = np.random.default_rng(seed), random_frame(seed)
    document["settings"] = {"collisions": False}
    for member in document["rods"]:
        if member["bending_stiffness"] == 0.0:
            member["tension_only"] = bool(lot.random() < 0.5)
        member["tensile_strength"] = float(lot.uniform(15.0, 60.0))
        if not member.get("tension_only"):
            member["compressive_strength"] = float(lot.uniform(15.0, 60.0))
    loaded = parse(document)
    found = settle(loaded, (0.5, 0.1)).final
    assume(found.balanced)  # else it collapses; hypothesis fails if too many do
    assert (found.axial_force <= loaded.rods.tension_limit * (1.0 + 1e-9)).all()
    assert (found.axial_force >= -loaded.rods.compression_limit * (1.0 + 1e-9)).all()
    for node in loaded.particles:
        node.force, node.moment = tuple(0.1 * f for f in node.force), 0.1 * node.moment
    for member in loaded.rods:
        member.distributed_force = tuple(0.1 * q for q in member.distributed_force)
    held_by_reference(loaded, found, 1e-10)


def test_a_settled_frame_stays_where_it_is() -> None:
    """Settling it again, through half the load, and to nothing and back: the state depends on the load alone."""
    document = random_frame(5)
    document["settings"] = {"collisions": False}
    loaded = parse(document)
    first = settle(loaded).final
    first.put(loaded)
    for factors in ((1.0,), (0.5, 1.0), (0.0, 1.0)):
        again = settle(loaded, factors).final
        assert again.status == "equilibrium"
        assert again.load_factor == 1.0
        assert again.displacement == pytest.approx(first.displacement, rel=1e-9, abs=1e-12)
        assert again.rotation == pytest.approx(first.rotation, rel=1e-9, abs=1e-12)
        assert not again.events


def column(parts: int, force: float, **top: Any) -> Model:
    """A column 4 m high, clamped at its foot, under a force down."""
    places = [(0.0, 4.0 * i / parts) for i in range(parts + 1)]
    loaded = {"force": [0.0, -force], **top}
    return parse(line(places, CLAMPED, loaded, stiffness=1e6, bending_stiffness=EI))


@pytest.mark.parametrize(("parts", "error"), [(1, 0.0076), (2, 5.2e-4), (4, 4e-5)])
def test_a_column_sways_at_eulers_load(parts: int, error: float) -> None:
    """π²EI/4L², but for the shortening of its axis by 1.5e-4; then it stands bent to one side."""
    found = settle(column(parts, 170.0)).final
    (bifurcation,) = (event for event in found.events if event.kind == "bifurcation")
    euler = math.pi**2 * EI / 64.0
    assert bifurcation.load_factor * 170.0 == pytest.approx(euler * (1.0 + error), rel=2e-4)
    assert found.status == "equilibrium"
    assert abs(found.displacement[-1, 0]) > 1.9


def test_a_rod_that_bends_within_itself_is_to_be_divided() -> None:
    """Into ⌈√(ν/2.5)⌉, ν = −N L₀²/EI: 22.4 of the whole column, propped at its top, 1.4 of each quarter."""
    found = settle(column(1, 1400.0, fixed=[True, False])).final
    assert found.status == "equilibrium"
    assert "Rod R0 bends more between its ends than a single rod can represent" in found.message
    assert "Divide R0 into 3" in found.message
    assert "within itself" not in settle(column(4, 1200.0, fixed=[True, False])).message


def test_two_discs_at_the_ends_of_cantilevers_carry_a_ball() -> None:
    """Under half the weight each and under their distributed forces; the moments are those of statics."""
    particles = [
        particle("A", -2.3, 0.0, **CLAMPED),
        particle("P", -0.3, 0.0),
        particle("Q", 0.3, 0.0),
        particle("B", 2.3, 0.0, **CLAMPED),
        particle("ball", 0.0, 0.6, force=[0.0, -5.0], radius=0.35),
    ]
    load = {"bending_stiffness": 3000.0, "stiffness": 1e6, "distributed_force": [0.0, -2.0]}
    found = settle(parse(model(particles, [rod(*ends, **load) for ends in ("AP", "QB")]))).final
    assert found.status == "equilibrium"
    assert len(found.contacts) == 2
    assert found.reaction[:, 1].sum() == pytest.approx(5.0 + 8.0, rel=1e-9)
    assert found.reaction_moment[0] == pytest.approx(2.5 * 2.0 + 2.0 * 2.0**2 / 2.0, rel=5e-3)
    assert found.reaction_moment[3] == pytest.approx(-found.reaction_moment[0], rel=1e-9)


@pytest.mark.parametrize("parts", [1, 16, 400])
@pytest.mark.parametrize("slenderness", [1e4, 1e8])
def test_a_long_member_is_no_mechanism(parts: int, slenderness: float) -> None:
    """However many rods divide it, and however stiff its axis is beside bending: PL³/3EI to the last digits."""
    bent = cantilever(parts, {"force": [0.0, -EI / LENGTH**2]}, slenderness)
    assert Indeterminacy.of(bent).mechanisms == Indeterminacy.of(bent).static == 0
    assert linear(bent).displacement[-1, 1] == pytest.approx(-LENGTH / 3.0, rel=1e-13)


def test_a_lever_that_a_moment_turns_round_and_round_is_a_mechanism() -> None:
    """Pinned at one end; its weight balances less than the moment, wherever it is."""
    particles = [particle("A", 0.0, 0.0, **PINNED), particle("B", 2.0, 0.0, force=[0.0, -10.0], moment=30.0)]
    lever = rod("A", "B", stiffness=1e5, bending_stiffness=200.0)
    found = settle(parse(model(particles, [lever])))
    assert found.status == "mechanism"
    assert "B" in found.message
    particles[1]["moment"] = 5.0
    hanging = settle(parse(model(particles, [lever]))).final
    assert hanging.status == "equilibrium"
    x, y = np.array([2.0, 0.0]) + hanging.displacement[1]
    assert 10.0 * x == pytest.approx(5.0, rel=1e-9)
    assert y < 0.0


def test_settling_ends_a_motion_where_the_load_alone_leads_to() -> None:
    """From the middle of a swing, where forces that are no scaled load hold the frame for an instant."""
    document = random_frame(8, moves=False)
    document["settings"] = {"collisions": False}
    wanted = settle(parse(document)).final
    moving = Session(parse(document))
    moving.run(time=0.01)
    assert moving.model.particles.rotation != pytest.approx(wanted.rotation, rel=0.01)
    assert moving.settle() == "equilibrium"
    assert moving.model.particles.displacement == pytest.approx(wanted.displacement, rel=1e-9, abs=1e-13)
    assert moving.model.particles.rotation == pytest.approx(wanted.rotation, rel=1e-9, abs=1e-13)


def test_a_frame_is_held_until_it_snaps() -> None:
    """As a run is told in the window: Williams' toggle just below its limit load, and half-way through."""
    span, rise = 12.943, 0.386
    places = [(-span, 0.0), (0.0, rise), (span, 0.0)]
    halves = line(places, CLAMPED, CLAMPED, stiffness=1885.0, bending_stiffness=9.27)
    halves["particles"][1]["force"] = [0.0, -0.034]
    toggle = parse(halves)
    assert is_held(toggle, at_first=True)
    below = settle(toggle).final
    assert [event.kind for event in below.events] == ["note"]  # to divide both, for a limit load exact to 1 %
    below.put(toggle)
    assert is_held(toggle)
    toggle.particles["P1"].displacement = (0.0, -0.35)
    Session(toggle).simulation.programs.compiled.observe()
    assert not is_held(toggle)
    (snap,) = (event for event in settle(toggle, (0.0, 1.2)).events if event.kind == "snap-through")
    # 1.9 % above that of fine divisions
    assert snap.load_factor * 0.034 == pytest.approx(0.03387 * 1.019, rel=5e-3)


@pytest.mark.parametrize("number", range(10))
def test_a_column_that_leans_ever_further_never_snaps(number: int) -> None:
    """A small force beside a column makes its bending grow steadily, below the critical load and beyond it."""
    lot = np.random.default_rng([89, number])
    parts, length, critical = int(lot.integers(2, 7)), 3.0, math.pi**2 * EI / (4.0 * 3.0**2)
    aside, share = critical * 10.0 ** lot.uniform(-8, -2), lot.uniform(0.9, 2.0)
    places = [(0.0, length * i / parts) for i in range(parts + 1)]
    pushed = {"force": [aside, -share * critical]}
    column = line(places, CLAMPED, pushed, stiffness=10.0 ** lot.uniform(5, 8), bending_stiffness=EI)
    column["settings"] = {"collisions": False}
    at_once, slowly = settle(parse(column)), settle(parse(column), np.linspace(0.0, 1.0, 40).tolist())
    for found in (at_once, slowly):
        assert found.final.balanced
        assert not [event for state in found.states for event in state.events if event.kind != "note"]
    tip = [found.final.displacement[-1] for found in (at_once, slowly)]
    assert tip[0] == pytest.approx(tip[1], abs=1e-7)
    assert tip[0][0] > 0.0


def test_a_member_between_two_nodes_in_one_place_gives_no_numbers_that_are_none(
    recwarn: pytest.WarningsRecorder,
) -> None:
    """1e-300 m is a length, but its inverse has no square."""
    places, loaded = [(0, 0), (1e-300, 0)], {"force": [0.0, -1.0]}
    found = settle(parse(line(places, CLAMPED, loaded, rest_length=1.0, bending_stiffness=1.0)))
    assert found.status == "limit reached"
    assert not recwarn.list


def test_a_motion_that_too_small_a_stiffness_resists_has_no_mode() -> None:
    weight = np.array([3.0, 1.0, 1.0, 2e-323])  # as of a bar of EI = 5e-324 kN·m²
    matrix = np.diag(weight) - np.diag([0.0, 1.0, 0.0, 0.0])
    assert soft_modes(matrix, weight).shape == (4, 0)


@pytest.mark.parametrize("theory", ["first-order", "exact"])
@pytest.mark.parametrize("top", [(5.0, 1.0), (6.0, 0.0), (5.6, 0.8)])
def test_a_loose_bar_is_as_neutral_beside_a_beam_as_alone(theory: str, top: tuple[float, float]) -> None:
    """Its turning takes no energy at all, beside which there is none to compare with if it lies along x or y."""
    document = model([particle("C", 5, 0, fixed=[True, True]), particle("D", *top)], [rod("C", "D")])
    assert settle(parse(document), theory=theory).status == "neutral equilibrium"
    document["particles"] += [
        particle("E", 9, 0, fixed=[True, True], fixed_rotation=True),
        particle("F", 11, 0),
    ]
    document["rods"].append(rod("E", "F", bending_stiffness=100.0))
    assert settle(parse(document), theory=theory).status == "neutral equilibrium"
