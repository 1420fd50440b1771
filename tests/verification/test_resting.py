"""Statics of discs that rest on one another and on structures: closed forms, balance, and runs until rest."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinjoint import Session
from pinjoint.documents import models
from pinjoint.systems.statics.contacts import Discs
from pinjoint.systems.statics.settle import Settlement, settle
from tests.reference.elements import Model as Document
from tests.reference.models import model, particle, rod, triangle

G = 9.81
HELD = {"fixed": [True, True]}
WEIGHT = {"environment": {"acceleration": [0, -G]}}


def notch(at: tuple[float, float] = (0.05, 1.0), **sections: Any) -> Document:
    """A ball of 2 kg and radius 0.2 m above the notch between two held discs of 0.3 m, 0.7 m apart."""
    particles = [
        particle("L", -0.35, 0, radius=0.3, **HELD),
        particle("R", 0.35, 0, radius=0.3, **HELD),
        particle("ball", *at, radius=0.2, mass=2.0),
    ]
    return model(particles, [], **(WEIGHT | sections))


def overlaps(document: Document, found: Settlement) -> int:
    opened = models.load(document)
    return len(Discs.of(opened, np.zeros((opened.particles.count, 2))).touching(found.final.displacement))


def test_a_ball_comes_to_rest_in_a_notch() -> None:
    """At the height √((R + r)² − d²), pressed against both by mg / 2 cos α, which their supports bear."""
    found = settle(models.load(notch()))
    assert found.status == "equilibrium"
    height = math.sqrt(0.5**2 - 0.35**2)
    assert np.add(found.final.displacement[2], [0.05, 1.0]) == pytest.approx([0.0, height], abs=1e-12)
    force = 2.0 * G / 1000.0 / (2.0 * height / 0.5)
    assert found.final.contacts.tolist() == [[0, 2], [1, 2]]
    assert found.final.contact_force == pytest.approx([force, force], rel=1e-10)
    own = np.array([0.0, G / 1000.0])  # the held discs' own weight of 1 kg
    assert found.final.reaction[0] - own == pytest.approx([force * 0.7, force * height / 0.5], rel=1e-9)


def test_a_guided_ball_rests_beside_the_top() -> None:
    """Constrained in x, at √((R + r)² − x²); its guide bears the horizontal part."""
    base, ball = particle("base", 0.03, 0, **HELD), particle("ball", 0, 1, mass=2.0, fixed=[True, False])
    found = settle(models.load(model([base, ball], [], **WEIGHT))).final
    height = math.sqrt(0.1**2 - 0.03**2)
    assert found.displacement[1, 1] + 1.0 == pytest.approx(height, abs=1e-12)
    assert found.reaction[1, 0] == pytest.approx(0.002 * G * 0.03 / height, rel=1e-9)


def test_a_stack_in_a_slot_presses_with_all_its_weight() -> None:
    """Five balls one above the other, each guided: the contact below ball k bears those above it."""
    balls = [particle(f"b{k}", 0, 0.2 + 0.3 * k, mass=1.0 + k, fixed=[True, False]) for k in range(5)]
    document = model([particle("base", 0, 0, **HELD), *balls], [], **WEIGHT)
    found = settle(models.load(document)).final
    heights = [0.2 + 0.3 * k + found.displacement[1 + k, 1] for k in range(5)]
    assert heights == pytest.approx([0.1 * (k + 1) for k in range(5)], abs=1e-11)
    borne = [sum(1.0 + i for i in range(k, 5)) * G / 1000.0 for k in range(5)]
    assert found.contact_force == pytest.approx(borne, rel=1e-9)


def test_a_ball_exactly_on_top_of_another_balances_and_that_is_said() -> None:
    document = model([particle("base", 0, 0, **HELD), particle("ball", 0, 1, mass=2.0)], [], **WEIGHT)
    found = settle(models.load(document))
    assert found.status == "unstable equilibrium"
    assert found.final.displacement[1] == pytest.approx([0.0, -0.9], abs=1e-12)
    assert "Unstable equilibrium: the slightest push moves ball along x" in found.message


def test_what_nothing_supports_falls_and_is_named() -> None:
    """Beside the base, the ball falls for ever; the state is that before it did."""
    document = model([particle("base", 1, 0, **HELD), particle("ball", 0, 1, mass=2.0)], [], **WEIGHT)
    found = settle(models.load(document))
    assert found.status == "mechanism"
    assert "ball moves downwards and nothing stops it." in found.message
    assert not found.final.displacement.any()
    (event,) = [event for event in found.events if event.kind == "free body"]
    assert event.motion is not None
    assert event.motion[1] == pytest.approx([0.0, -1.0])


def test_the_ball_on_the_truss_comes_to_rest_where_it_settles() -> None:
    """Also where each step is as long as its error allows, which the forces in contact must not change."""
    session = Session.open("ball_on_truss")
    assert session.run(until="rest") == "at rest"
    found = settle(models.load("ball_on_truss"))
    assert found.status == "equilibrium"
    assert session.particles.displacement == pytest.approx(found.final.displacement, abs=1e-8)
    assert session.rods.axial_force == pytest.approx(found.final.axial_force, abs=1e-6)
    assert session.particles["A"].reaction[1] + session.particles["D"].reaction[1] == pytest.approx(
        G * session.particles.mass.sum() / 1000
    )


def test_the_ball_on_the_truss_moves_alike_in_one_run_and_in_many() -> None:
    """To within the error of first order of steps in contact, which end at other times: up to 2e-4 m/s."""
    whole, parts = Session.open("ball_on_truss"), Session.open("ball_on_truss")
    whole.run(time=1.0)
    for _ in range(10):
        parts.run(time=0.1)
    assert whole.particles["ball"].velocity == pytest.approx(parts.particles["ball"].velocity, abs=2e-4)


def test_a_ball_without_a_guide_rolls_off_its_node() -> None:
    """The node moves aside under it, since the truss is held on the left only."""
    guided = models.load("ball_on_truss")
    guided.particles["ball"].fixed = (False, False)
    found = settle(guided)
    assert found.status == "mechanism"
    assert "ball moves" in found.message


def table(stiffness: float = 5000.0) -> Document:
    """A ball of 40 kg over the two upper nodes of a truss."""
    particles = [
        particle("A", 0, 0, **HELD),
        particle("B", 1, 0, fixed=[False, True]),
        particle("C", 0.4, 0.5),
        particle("D", 0.6, 0.5),
        particle("ball", 0.5, 0.71, radius=0.15, mass=40.0),
    ]
    rods = [rod(*ends, stiffness=stiffness) for ends in ("AC", "CB", "CD", "DB", "AB", "AD")]
    sections = {"environment": {"acceleration": [0, -G], "drag": 20.0}, "settings": {"restitution": 0.0}}
    return model(particles, rods, **sections)


@pytest.mark.parametrize("stiffness", [5.0, 5000.0, 164640.0])
def test_a_ball_on_two_nodes_loads_their_truss(stiffness: float) -> None:
    """Where it lies the truss is in balance with the forces of its contacts."""
    document = table(stiffness)
    found = settle(models.load(document)).final
    assert found.status == "equilibrium"
    place = np.array([p["position"] for p in document["particles"]]) + found.displacement
    for (first, second), force in zip(found.contacts, found.contact_force, strict=True):
        between = place[second] - place[first]
        assert np.hypot(*between) == pytest.approx(0.2, abs=1e-12)
        document["particles"][first]["force"] = (-force * between / np.hypot(*between)).tolist()
    without = document | {"particles": document["particles"][:4]}
    loaded = settle(models.load(without)).final
    assert found.axial_force == pytest.approx(loaded.axial_force, rel=1e-8)
    assert found.displacement[:4] == pytest.approx(loaded.displacement, rel=1e-8, abs=1e-14)


def test_settled_discs_are_where_a_run_comes_to_rest() -> None:
    """In the notch with drag; nothing moves any more when time goes on after settling a ball on a truss."""
    running = Session.open(notch(environment={"acceleration": [0, -G], "drag": 1.0}))
    settled = Session.open(notch())
    running.settings.restitution = 0.2
    assert running.run(until="rest") == "at rest"
    assert settled.settle() == "equilibrium"
    assert running.particles.displacement == pytest.approx(settled.particles.displacement, abs=1e-9)
    session = Session.open(table())
    session.settle()
    forces = session.rods.axial_force.copy()
    assert session.run(until="rest") == "at rest"
    assert session.rods.axial_force == pytest.approx(forces, rel=1e-6)
    assert session.model.clock.collisions == 0


def bowl(seed: int, balls: int) -> Document:
    """Balls of various sizes above a rough bowl of held discs."""
    lot = np.random.default_rng(seed)
    held = [
        particle(f"w{k}", x, 0.3 * abs(x) * lot.uniform(0.5, 1.5), radius=0.06, **HELD)
        for k, x in enumerate(np.linspace(-1.0, 1.0, 21).tolist())
    ]
    held += [
        particle(f"{side}{k}", x, 0.4 + 0.1 * k, radius=0.06, **HELD)
        for side, x in (("l", -1.05), ("r", 1.05))
        for k in range(14)
    ]
    stones = [
        particle(
            f"b{k}",
            float(lot.uniform(-0.8, 0.8)),
            0.7 + 0.35 * k,
            radius=float(lot.uniform(0.06, 0.16)),
            mass=float(lot.uniform(0.5, 5.0)),
        )
        for k in range(balls)
    ]
    return model([*held, *stones], [], **WEIGHT)


@settings(max_examples=4)
@given(seed=st.integers(0, 10_000))
def test_random_piles_rest_in_balance_without_overlap(seed: int) -> None:
    """The bowl bears all weight; no disc is inside another; no contact pulls."""
    document = bowl(seed, 6)
    opened = models.load(document)
    found = settle(opened)
    assert found.status == "equilibrium"
    assert overlaps(document, found) == 0
    weight = G / 1000.0 * float(opened.particles.mass.sum())
    assert found.final.reaction.sum(axis=0) == pytest.approx([0.0, weight], abs=1e-9 * weight)
    assert (found.final.contact_force > 0.0).all()
    assert found.final.residual < 1e-9


def test_nodes_that_meet_under_load_press_each_other() -> None:
    """Two cantilevered rods are pushed together until their ends touch; then both ends share the load."""
    particles = [
        particle("A", 0, 0, **HELD),
        particle("B", 1, 0, fixed=[False, True], force=[50.0, 0.0]),
        particle("C", 1.11, 0, fixed=[False, True]),
        particle("D", 2.11, 0, **HELD),
    ]
    document = model(particles, [rod("A", "B", stiffness=1000.0), rod("C", "D", stiffness=1000.0)])
    found = settle(models.load(document)).final
    assert found.displacement[1, 0] - found.displacement[2, 0] == pytest.approx(0.01, abs=1e-12)
    assert found.axial_force == pytest.approx([30.0, -20.0], rel=1e-9)
    assert found.contact_force == pytest.approx([20.0], rel=1e-9)


def test_without_collisions_nothing_rests_on_anything() -> None:
    found = settle(models.load(notch(settings={"collisions": False})))
    assert "Free body: nothing holds ball along y" in found.message


def test_a_structure_that_no_disc_touches_is_settled_as_before() -> None:
    alone, beside = triangle(), triangle()
    beside["particles"].append(particle("stray", 5, 5))
    states = [settle(models.load(document)).final for document in (alone, beside)]
    assert states[0].axial_force.tolist() == states[1].axial_force.tolist()


# --- walls ---------------------------------------------------------------------------------------------


def walled(
    particles: list[Document], rods: list[Document], *walls: tuple[list[float], list[float]]
) -> Document:
    lines = [{"name": f"w{k}", "start": start, "end": end} for k, (start, end) in enumerate(walls)]
    return model(particles, rods, components={"walls.Wall": lines}, **WEIGHT)


def settled(document: Document) -> Settlement:
    session = Session.open(document)
    return settle(session.model)


def test_a_ball_rests_on_the_floor_and_falls_beside_it() -> None:
    """Its weight is the force of the contact, whose second row is that of the wall, beyond the particles."""
    floor: tuple[list[float], list[float]] = ([-1, 0], [1, 0])
    found = settled(walled([particle("ball", 0.3, 1, mass=2.0)], [], floor)).final
    assert found.displacement[0] == pytest.approx([0.0, -0.95], abs=1e-12)
    assert found.contacts.tolist() == [[0, 1]]
    assert found.contact_force == pytest.approx([0.002 * G], rel=1e-9)
    beside = settled(walled([particle("ball", 1.02, 1, mass=2.0)], [], floor))
    assert beside.status == "mechanism"
    assert "ball moves downwards and nothing stops it." in beside.message


def test_a_floor_alone_is_settled() -> None:
    assert settled(walled([], [], ([-1, 0], [1, 0]))).status == "equilibrium"


def test_a_ball_rests_in_a_corner_of_slopes() -> None:
    """Between 1:1 and 1:2, at the distance r from both; forces mg sin β / sin(α + β) on the slope of angle α."""
    document = walled([particle("ball", 0.2, 1, mass=2.0, radius=0.1)], [], ([-1, 1], [0, 0]), ([0, 0], [2, 1]))
    found = settled(document).final
    x, y = np.add([0.2, 1.0], found.displacement[0])
    alpha, beta = math.pi / 4.0, math.atan(0.5)
    assert (x + y) * math.sqrt(0.5) == pytest.approx(0.1, abs=1e-12)
    assert y * math.cos(beta) - x * math.sin(beta) == pytest.approx(0.1, abs=1e-12)
    share = np.sin([beta, alpha]) / math.sin(alpha + beta)
    assert found.contact_force == pytest.approx(0.002 * G * share, rel=1e-9)


def test_a_hinged_rod_leans_on_the_floor() -> None:
    """It turns about its hinge until its end lies on the wall, which it does not pass, and bears half the weight."""
    particles = [particle("A", 0, 0, **HELD), particle("B", 1, 0)]
    found = settled(walled(particles, [rod("A", "B")], ([-1, -0.5], [2, -0.5]))).final
    assert found.displacement[1, 1] == pytest.approx(-0.45, abs=1e-12)
    assert found.contact_force == pytest.approx([6.15 / 2000.0 * G], rel=1e-6)


def test_a_truss_that_nothing_else_holds_lies_on_the_floor() -> None:
    particles = [particle("A", 0, 0.5), particle("B", 1, 0.6), particle("C", 0.5, 1, force=[0.0, -10.0])]
    rods = [rod("A", "B"), rod("B", "C"), rod("A", "C")]
    found = settled(walled(particles, rods, ([-2, 0], [3, 0]))).final
    assert found.status == "equilibrium"
    assert [0.5 + found.displacement[0, 1], 0.6 + found.displacement[1, 1]] == pytest.approx(
        [0.05] * 2, abs=1e-12
    )
    weight = 6.15 * (math.hypot(1, 0.1) + math.hypot(0.5, 0.4) + math.hypot(0.5, 0.5)) * G / 1000.0
    assert found.contact_force.sum() == pytest.approx(10.0 + weight, rel=1e-9)


def test_a_settled_pile_stays_where_it_is() -> None:
    """Eight stones in a trough, then half a second of exact flight: nothing moves by a millionth of a radius."""
    stones = [
        particle(f"s{k}", 0.13 * (k % 3) - 0.13, 0.2 + 0.2 * k, radius=0.06 + 0.005 * k) for k in range(8)
    ]
    trough = (([-0.25, 0.0], [0.25, 0.0]), ([-0.25, 0.0], [-0.25, 2.0]), ([0.25, 0.0], [0.25, 2.0]))
    session = Session.open(walled(stones, [], *trough))
    assert session.settle() == "equilibrium"
    settled_at = session.particles.displacement.copy()
    session.run(time=0.5)
    assert session.particles.displacement == pytest.approx(settled_at, abs=6e-8)


@pytest.mark.parametrize("apart", [0.0, 1e-300, 1e-12, 1e-6, 0.02])
def test_discs_in_one_place_are_named(apart: float, recwarn: pytest.WarningsRecorder) -> None:
    found = settled(model([particle("A", 0, 0), particle("B", apart, 0)], []))
    assert found.status == "limit reached"
    assert found.message.startswith("A and B are nearly at the same place")
    assert not recwarn.list


def test_discs_that_overlap_are_parted() -> None:
    found = settled(model([particle("A", 0, 0), particle("B", 0.03, 0)], []))
    assert found.status == "equilibrium"
    assert found.final.displacement[:, 0] == pytest.approx([-0.035, 0.035], rel=1e-9)


def test_a_disc_that_its_guide_holds_in_the_floor_is_in_no_equilibrium(
    recwarn: pytest.WarningsRecorder,
) -> None:
    """However stiff contacts become, until they would be stiffer than numbers can be."""
    guided = particle("guided", 0, 0.19, radius=0.2, mass=2.0, fixed=[False, True])
    found = settled(walled([guided], [], ([-1, 0], [1, 0])))
    assert found.status == "limit reached"
    assert "No equilibrium of the particles was found" in found.message
    assert not recwarn.list


def test_a_ball_that_is_too_far_away_to_move_does_not_fall(recwarn: pytest.WarningsRecorder) -> None:
    found = settled(model([particle("ball", 0, 0, displacement=[-1e30, 0])], [], **WEIGHT))
    assert found.status in ("mechanism", "limit reached")
    assert not recwarn.list
