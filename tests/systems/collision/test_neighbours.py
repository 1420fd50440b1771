"""The neighbour list is made anew when the document changes or particles have moved, not in every step."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest

from game import Session
from systems.broad_phase import ALL_PAIRS_DISCS, near_pairs
from systems.collision.driven import neighbours
from systems.collision.driven.neighbours import NeighbourList
from systems.collision.driven.stepper import DrivenCollisions
from tests.benchmarks.models import lattice
from tests.systems.collision.test_driven_collisions import truss


def test_a_step_looks_up_nothing_and_an_edit_does(monkeypatch: pytest.MonkeyPatch) -> None:
    session = Session(lattice(200, damping=1.0))
    session.step()
    looked: list[Any] = []

    def looked_up(*where: Any) -> Any:
        looked.append(where)
        return near_pairs(*where)

    monkeypatch.setattr(neighbours, "near_pairs", looked_up)
    for _ in range(5):
        session.step()
    assert not looked
    session.particles[3].radius = 0.06
    session.step()
    assert looked


@pytest.mark.parametrize("count", [20, ALL_PAIRS_DISCS + 20])
@pytest.mark.parametrize("sizes", [(0.05,), (0.05, 0.3), (0.001, 0.02, 0.02, 0.4)])
def test_all_pairs_within_reach_are_found_once_and_in_order(sizes: tuple[float, ...], count: int) -> None:
    random = np.random.default_rng(len(sizes))
    place, reach = random.uniform(0.0, 2.0, (count, 2)), random.choice(sizes, count)
    place[:2], reach[:2] = [(0.1, 0.1), (0.4, 0.5)], 0.25  # these just touch
    pairs = [
        (i, j)
        for i in range(count)
        for j in range(i + 1, count)
        if np.hypot(*(place[j] - place[i])) <= reach[i] + reach[j]
    ]
    assert (0, 1) in pairs
    assert near_pairs(place, reach).tolist() == [list(pair) for pair in pairs]


def test_no_discs_are_near_no_discs() -> None:
    assert near_pairs(np.zeros((0, 2)), np.zeros(0)).shape == (0, 2)


# --- for how long nothing can meet ---------------------------------------------------------------------------


def lively(seed: int) -> Session:
    """Two loaded triangles that swing, three stray discs that fly, gravity and a fixed disc."""
    random = np.random.default_rng(seed)
    particles, rods = [], []
    for k in range(2):
        for i, (x, y) in enumerate([(0.0, 0.0), (1.0, 0.0), (0.5, 0.8)]):
            place = [3.0 * k + x + random.uniform(-0.1, 0.1), y + random.uniform(-0.1, 0.1)]
            held = [i < 1, i < 2]
            speed = np.where(held, 0.0, random.normal(0.0, 2.0, 2)).tolist()
            mass = float(10.0 ** random.uniform(-1, 1))
            particles.append(
                {"name": f"n{k}{i}", "position": place, "fixed": held, "velocity": speed, "mass": mass}
            )
        rods += [
            {"name": f"r{k}{a}{b}", "between": [f"n{k}{a}", f"n{k}{b}"], "stiffness": 50.0, "damping": 0.01}
            for a, b in ((0, 1), (1, 2), (0, 2))
        ]
    for k in range(3):
        place, speed = random.uniform([-1.0, 1.5], [5.0, 4.0]).tolist(), random.normal(0.0, 3.0, 2).tolist()
        particles.append({"name": f"d{k}", "position": place, "velocity": speed})
    particles.append({"name": "rock", "position": [2.0, -1.0], "fixed": [True, True], "radius": 0.2})
    return Session.open(
        {
            "format": "pinjoint model",
            "version": 1,
            "environment": {"acceleration": [0.0, -9.81]},
            "particles": particles,
            "rods": rods,
        }
    )


@pytest.mark.parametrize("seed", range(6))
def test_before_its_time_nothing_meets(seed: int) -> None:
    """Followed without collisions: within the time that is told, no gap closes and no particle is too fast."""
    session = lively(seed)
    near = NeighbourList(session.model)
    near.look_up()
    clear = near.clear_time()
    assert 0.0 < clear < math.inf
    session.settings.collisions = False
    joined = {tuple(sorted(pair)) for pair in session.model.rods.between.tolist()}
    mobile = (session.model.particles.mobility > 0.0).any(axis=1)
    every = itertools.combinations(range(session.model.particles.count), 2)
    pairs = np.array([p for p in every if p not in joined and mobile[list(p)].any()])
    for _ in range(20):
        session.run(time=clear / 20)
        gap, _ = near.gaps(pairs, near.displacement)
        assert gap.min() > 0.0
        assert not near.outran


def test_what_flies_away_from_a_structure_is_not_watched(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ball slips off a node: of the 10 s in which it falls 450 m, some steps are watched, not tens of thousands."""
    document = truss({"position": [1.03, 0.65]}, integrator="velocity_verlet")
    session = Session.open(document)
    watched: list[None] = []
    step = DrivenCollisions._examined_step

    def noted(*args: Any, **rest: Any) -> Any:
        watched.append(None)
        return step(*args, **rest)

    monkeypatch.setattr(DrivenCollisions, "_examined_step", noted)
    session.run(time=10.0)
    assert session.particles["ball"].displacement[1] < -300.0
    assert session.model.clock.steps > 10_000
    assert len(watched) < 500


@pytest.mark.parametrize("kind", ["sine", "pulse", "table"])
def test_a_load_that_grows_drives_a_particle_into_another(kind: str) -> None:
    """It rests, unloaded, beside another one; what no speed nor force tells yet is not missed."""
    history = {
        "sine": {"kind": "sine", "frequency": 5.0, "phase": 0.0},
        "pulse": {"kind": "pulse", "start": 0.3, "duration": 0.02},
        "table": {"kind": "table", "times": [0.0, 0.5, 0.51, 0.52], "factors": [0.0, 0.0, 1.0, 0.0]},
    }[kind]
    session = Session.open(
        {
            "format": "pinjoint model",
            "version": 1,
            "settings": {"time_step": 1e-3, "integrator": "velocity_verlet"},
            "particles": [
                {"name": "p", "position": [0.0, 0.0]},
                {"name": "wall", "position": [0.3, 0.0], "fixed": [True, True]},
            ],
            "loads": [{"on": "p", "force": [1.0, 0.0], "history": history}],
        }
    )
    session.run(time=1.0)
    assert len(session.impacts) >= 1
    assert session.particles["p"].displacement[0] <= 0.2
