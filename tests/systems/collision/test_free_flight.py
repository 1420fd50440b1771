"""Collisions in the program: events, energy, state and what a person is told, through Session."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.documents.models import document
from pinjoint.systems.collision.driven.neighbours import NeighbourList
from pinjoint.systems.edit.pull import Hand
from pinjoint.systems.physics.pace import natural_pace
from tests.systems.collision.test_driven_collisions import box, energy_of_discs, gaps_of, state

GRAVITY = {"acceleration": [0.0, -9.81]}


def model(particles: list[dict[str, Any]], **sections: Any) -> dict[str, Any]:
    named = [{"name": f"p{k}", **particle} for k, particle in enumerate(particles)]
    return {"format": "pinjoint model", "version": 1, "particles": named, **sections}


def gas(seed: int = 3, restitution: float = 1.0) -> dict[str, Any]:
    random = np.random.default_rng(seed)
    cells = [[0.15 * (k % 6), 0.15 * (k // 6)] for k in range(30)]
    moving = [
        {"position": cell, "velocity": random.normal(size=2).tolist(), "mass": float(random.uniform(0.1, 5.0))}
        for cell in cells
    ]
    walls = [{"position": [0.15 * k, y], "fixed": [True, True]} for k in range(-1, 7) for y in (-0.2, 0.8)]
    return model([*moving, *walls], environment=GRAVITY, settings={"restitution": restitution})


def pile(count: int = 6) -> dict[str, Any]:
    places = [[0.09 * k, 0.0] for k in range(7)] + [[x, 0.09 * k] for x in (0.0, 0.54) for k in range(1, 6)]
    floor = [{"position": place, "fixed": [True, True]} for place in places]
    balls = [{"position": [0.2 + 0.1001 * (k % 3), 0.4 + 0.12 * (k // 3)]} for k in range(count)]
    return model([*floor, *balls], environment=GRAVITY, settings={"restitution": 0.4})


def momentum(session: Session) -> np.ndarray:
    return (session.model.particles.mass[:, None] * session.model.particles.velocity).sum(axis=0)


# --- what runs -------------------------------------------------------------------------------------------


def test_free_particles_fly_on_exact_paths() -> None:
    session = Session.open("collision_i")
    session.run(time=0.1)
    assert session.simulation.integrator.key == "free_flight"


@pytest.mark.parametrize(
    "document",
    [
        model([{"position": [0.0, 0.0]}]),
        model([{"position": [k, 0.0], "fixed": [True, True]} for k in range(3)]),
        model([{"position": [0.0, 0.0]}, {"position": [1.0, 0.0]}], settings={"collisions": False}),
        model(
            [{"position": [0.0, 0.0]}, {"position": [1.0, 0.0]}], rods=[{"name": "r", "between": ["p0", "p1"]}]
        ),
    ],
    ids=["one particle", "nothing moves", "switched off", "joined by a rod"],
)
def test_without_anything_to_touch_collisions_are_left_out(document: dict[str, Any]) -> None:
    session = Session.open(document)
    assert "collision.discs" not in [system.name for system in session.simulation.plan]


# --- energy, momentum, effective mass ----------------------------------------------------------------------


def test_energy_of_elastic_impacts_is_kept() -> None:
    session = Session.open(gas())
    session.run(time=2.0)
    energy = session.energy
    assert session.model.clock.collisions > 100
    assert energy.dissipated_impact == pytest.approx(0.0, abs=1e-12 * energy.kinetic)
    assert energy.imbalance == pytest.approx(0.0, abs=1e-12 * energy.kinetic)


def test_energy_lost_in_impacts_is_accounted_for() -> None:
    session = Session.open(gas(restitution=0.8))
    session.run(time=1.0)
    energy = session.energy
    assert energy.dissipated_impact > 0.1 * energy.initial
    assert session.impacts.energy_lost.sum() == pytest.approx(energy.dissipated_impact, rel=1e-12)
    assert energy.imbalance == pytest.approx(0.0, abs=1e-6 * energy.initial)


def test_momentum_is_kept() -> None:
    document = gas()
    document["particles"], document["environment"] = document["particles"][:30], {}
    session = Session.open(document)
    before = momentum(session)
    session.run(time=1.0)
    assert session.model.clock.collisions > 10
    np.testing.assert_allclose(momentum(session), before, atol=1e-12)


@pytest.mark.parametrize("restitution", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("angle", [0.2, 0.7, 1.2])
def test_a_particle_held_in_y_answers_with_its_mass_along_x_only(angle: float, restitution: float) -> None:
    """Its inverse mass along the normal is n_x²/m: J = (1 + e) v·n / (1/m₁ + n_x²/m₂); the support takes the rest."""
    normal, speed = np.array([math.cos(angle), math.sin(angle)]), np.array([3.0, 1.0])
    moving = {"position": [0.0, 0.0], "velocity": speed.tolist(), "mass": 2.0}
    held = {"position": (0.5 * speed + 0.1 * normal).tolist(), "fixed": [False, True], "mass": 5.0}
    session = Session.open(model([moving, held], settings={"restitution": restitution}))
    session.run(time=0.55)
    impulse = (1 + restitution) * (speed @ normal) / (1 / 2 + normal[0] ** 2 / 5)
    expected = [speed - impulse / 2 * normal, [impulse / 5 * normal[0], 0.0]]
    assert session.impacts.time == pytest.approx([0.5], rel=1e-12)
    assert session.impacts.impulse == pytest.approx([impulse], rel=1e-12)
    assert session.particles.velocity == pytest.approx(np.array(expected), rel=1e-12, abs=1e-14)
    assert session.energy.imbalance == pytest.approx(0.0, abs=1e-14)


# --- the same bits -----------------------------------------------------------------------------------------


def test_the_step_does_not_matter() -> None:
    fine, coarse = (
        Session.open(gas() | {"settings": {"time_step": step, "restitution": 0.9}}) for step in (2**-12, 2**-3)
    )
    fine.run(time=1.0)
    coarse.run(time=1.0)
    assert state(fine) == state(coarse)


@pytest.mark.parametrize("document", [gas(restitution=0.9), pile()], ids=["gas", "pile"])
def test_saved_and_continued_gives_the_same_bits(document: dict[str, Any], tmp_path: Path) -> None:
    session = Session.open(document)
    session.run(steps=450)
    session.save(tmp_path / "saved.json")
    again = Session.open(tmp_path / "saved.json")
    assert state(again) == state(session)
    for one in (session, again):
        one.run(steps=400)
    assert state(again) == state(session)
    assert again.energy == session.energy


@pytest.mark.parametrize(
    "change",
    [{"contacts": [[0, -7]]}, {"kind": "orbits"}, {"pile": [[1.0]]}, {"more": 1}, {"motion": [[1.0], []]}],
    ids=str,
)
def test_a_collision_state_that_makes_no_sense_is_refused(change: dict[str, Any]) -> None:
    session = Session.open("collision_i")
    session.run(time=0.1)
    saved = document(session.model)
    saved["state"]["collision_state"] |= change
    with pytest.raises(ValueError, match=r"collision_state.*: this is not what Pinjoint saves here"):
        Session.open(saved)


# --- rest ----------------------------------------------------------------------------------------------------


def test_a_pile_comes_to_rest_without_sinking_and_loads_its_supports() -> None:
    session = Session.open(pile())
    assert session.run(until="rest", limit=10.0) == "at rest"
    particles = session.model.particles
    place = particles.position + particles.displacement
    apart = np.hypot(*(place[:, None] - place).transpose(2, 0, 1)) + np.eye(len(place))
    held = particles.fixed.all(axis=1)
    assert (apart[~held] - 0.1).min() > -1e-6 * 0.05
    assert not particles.velocity.any()
    weight = 1e-3 * 9.81 * particles.mass.sum()  # that of the floor, too
    assert particles.reaction[:, 1].sum() == pytest.approx(weight, rel=1e-6)
    assert session.simulation.residual < 1e-9


# --- overlaps ------------------------------------------------------------------------------------------------


def test_particles_that_overlap_are_moved_apart_by_inverse_mass() -> None:
    session = Session.open(
        model([{"position": [0.0, 0.0], "mass": 1.0}, {"position": [0.08, 0.0], "mass": 3.0}])
    )
    session.run(steps=1)
    assert session.particles["p0"].displacement[0] == pytest.approx(-0.015, rel=1e-9)
    assert session.particles["p1"].displacement[0] == pytest.approx(0.005, rel=1e-9)
    assert "1 pair of particles overlapped" in session.message


def test_particles_at_one_point_are_spread() -> None:
    session = Session.open(model([{"position": [1.0, 2.0]} for _ in range(40)]))
    session.run(time=1.0)
    place = session.model.particles.position + session.model.particles.displacement
    apart = np.hypot(*(place[:, None] - place).transpose(2, 0, 1)) + np.eye(40)
    assert apart.min() > 0.1 * (1.0 - 1e-12)
    assert np.abs(place - (1.0, 2.0)).max() < 1.0


# --- events --------------------------------------------------------------------------------------------------


def test_impacts_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    events = tmp_path / "events.csv"
    command = ["run", "collision_ii", "--at", "0.05,0.2", "--format", "json", "--events", str(events)]
    assert main(command) == 0
    run = json.loads(capsys.readouterr().out)
    assert [s["collisions"] for s in run["states"]] == [0, 1]
    assert run["states"][1]["energy"]["dissipated_impact"] == pytest.approx(4.6875, rel=1e-12)
    head, line = events.read_text().splitlines()
    assert head == "time,first,second,impulse,energy_lost,x,y"
    cells = line.split(",")
    assert cells[1:3] == ["particle 1", "particle 2"]
    assert [float(c) for c in (cells[0], *cells[3:])] == pytest.approx(
        [0.08, 3.75, 4.6875, 0.45, 0.0], rel=1e-12
    )


# --- a hand that pulls -----------------------------------------------------------------------------------------


def pull(session: Session, name: str, anchors: list[tuple[float, float]], steps: int = 40) -> None:
    """Pull a particle to displacements, one after the other, for so many steps each, and let go."""
    session.simulation.advance(0)
    hand = Hand.on(session.model, session.view, session.particles[name], lambda: natural_pace(session.model))
    for anchor in anchors:
        session.document.timeline.hold(hand.at(anchor))
        session.run(steps=steps)
    session.document.timeline.hold(None)


def sinking(session: Session) -> float:
    """By how much of a radius discs are in one another at most."""
    near = NeighbourList(session.model)
    near.look_up()
    near.list_within(0.0)
    gap, _ = gaps_of(near, near.pairs)
    return float((-gap / near.driven.size[near.pairs].min(axis=1)).max(initial=0.0))


def test_a_hand_pulls_a_disc_into_others_on_exact_paths() -> None:
    """Its work, that of a force constant in each step, is all energy that there is."""
    session = Session.open(model([{"position": [0.11 * k, 0.0]} for k in range(9)]))
    pull(session, "p0", [(0.2, 0.01), (0.4, 0.0), (0.0, 0.3)])
    assert session.simulation.integrator.key == "free_flight"
    assert len(session.impacts) >= 4
    energy = session.energy
    assert energy.work > 0.0
    assert energy.work == pytest.approx(energy.kinetic, rel=1e-12)
    assert sinking(session) <= 1e-12


def test_a_hand_pulls_a_disc_through_a_pile() -> None:
    """It is followed without end or loss, and once let go the pile comes to rest again."""
    session = Session.open(pile(12))
    assert session.run(until="rest", limit=10.0) == "at rest"
    x, y = session.particles["p24"].displacement
    pull(session, "p24", [(x + 0.03, y - 0.02), (x, y)], steps=60)
    assert sinking(session) <= 1e-3
    energy = session.energy
    assert energy.work > 0.0
    assert abs(energy.imbalance) <= 1e-8 * energy.work
    assert session.run(until="rest", limit=session.model.clock.time + 20.0) == "at rest"
    assert sinking(session) <= 1e-6


def test_what_falls_as_a_hand_pulls_something_else_falls_no_faster() -> None:
    """Two blocks of discs push each other in mid-air by the steps of a pile; their momentum is that of their weight."""
    blocks = [
        {
            "position": [side * (0.06 + 0.101 * i) + 0.003 * j, 0.101 * j + 0.01 * side],
            "velocity": [-side * 1.0, 0.0],
        }
        for side in (-1, 1)
        for i in range(9)
        for j in range(9)
    ]
    discs = [*blocks, {"position": [50.0, 0.0]}]
    session = Session.open(model(discs, environment=GRAVITY, settings={"restitution": 0.0}))
    pull(session, f"p{len(blocks)}", [(0.1, 0.0)], steps=60)
    fallen, speed = session.particles.displacement[:-1, 1].mean(), session.particles.velocity[:-1, 1].mean()
    assert len(session.impacts) > 500
    assert speed == pytest.approx(-9.81 * session.time, rel=1e-12)
    assert fallen == pytest.approx(-0.5 * 9.81 * session.time**2, rel=2e-3)


def test_stepping_back_replays_what_a_hand_did_with_the_same_bits() -> None:
    session = Session.open(gas(restitution=0.9))
    session.run(steps=20)
    session.simulation.advance(0)
    hand = Hand.on(session.model, session.view, session.particles["p7"], lambda: natural_pace(session.model))
    states = {}
    for anchor in ((0.2, 0.1), (-0.1, 0.2)):
        session.document.timeline.hold(hand.at(anchor))
        for _ in range(15):
            session.run(steps=1)
            states[session.model.clock.steps] = state(session)
    session.document.timeline.hold(None)
    session.run(steps=10)
    for _ in range(12):
        assert session.step(-3)
        now = session.model.clock.steps
        assert states.get(now, state(session)) == state(session)
    assert now < 30


@pytest.mark.parametrize(
    ("seed", "count", "fit", "restitution"), [(2, 14, 3, 0.2), (16, 10, 4, 0.9), (22, 13, 3, 0.9)]
)
def test_energy_does_not_grow_where_rows_fit_exactly_between_walls(
    seed: int, count: int, fit: int, restitution: float
) -> None:
    """Heavy and light discs that jam: what forces keep their rows together is not determined."""
    random = np.random.default_rng(seed)
    half, columns = 0.05 * fit, int(0.1 * fit / 0.115)
    discs = [
        {
            "position": [-half + 0.0525 + 0.11 * (k % columns), 0.06 + 0.13 * (k // columns)],
            "mass": float(random.choice([1.0, 1.0, 1.0, 10.0, 0.1])),
            "velocity": random.normal(0.0, 1.0, 2).tolist(),
        }
        for k in range(count)
    ]
    session = Session.open(box(discs, half, environment=GRAVITY, settings={"restitution": restitution}))
    first = before = energy_of_discs(session)
    for _ in range(30):
        session.run(time=0.1)
        now = energy_of_discs(session)
        assert now <= before + 1e-3 * (abs(first) + abs(before))
        before = now
    assert sinking(session) <= 1e-3


def test_a_moment_at_which_a_step_ends_is_reached_where_its_number_is_rounded_down() -> None:
    session = Session.open(gas())
    size, origin = 2.5298381201802593e-06, 0.03260847205211093
    now = {"step_size": size, "origin": origin, "steps": 97, "time": origin + 97 * size}
    for name, value in now.items():
        session.model.writable(f"clock.{name}")[0] = value
    target = origin + 98 * size
    assert (target - origin) / size * (1.0 + 1e-15) < 98
    session.simulation._stepper.land(target)
    assert session.model.clock.time == target
