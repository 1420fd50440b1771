"""The neighbour list is made anew when the document changes or particles have moved, not in every step."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from game import Session
from systems.broad_phase import ALL_PAIRS_DISCS, near_pairs
from systems.collision.driven import neighbours
from systems.collision.driven.columns import Whole
from systems.collision.driven.neighbours import NeighbourList
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


def test_a_list_forgets_contacts_that_were_chosen_for_a_step_long_over() -> None:
    session = Session.open(truss({"position": [1.0, 0.6]}))
    near = NeighbourList(session.model)
    near.look_up()
    near.list_within(1.0)
    near.driven.whole[Whole.CHOSEN] = 1
    near.driven.chosen[0] = len(near.pairs) - 1
    session.particles["ball"].displacement = (50.0, 0.0)
    for _ in range(2):
        near.list_within(1e-3)
    assert near.driven.pairs.shape == near.pairs.shape


# --- steps in which nothing can meet ---------------------------------------------------------------------------


def test_what_flies_away_from_a_structure_is_not_looked_at_in_every_step(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A ball slips off a node: of the 10 s in which it falls 450 m, the list is made anew some times, not thousands."""
    session = Session.open(truss({"position": [1.03, 0.65]}, integrator="velocity_verlet"))
    listed: list[float] = []
    monkeypatch.setattr(NeighbourList, "list_within", noting(listed, NeighbourList.list_within))
    session.run(time=10.0)
    assert session.particles["ball"].displacement[1] < -300.0
    assert session.model.clock.steps > 10_000
    assert len(listed) < 500


def noting(what: list[Any], method: Any) -> Any:
    """A method that also notes with what it is called."""

    def noted(self: Any, *given: Any) -> Any:
        what.append(given)
        return method(self, *given)

    return noted


@pytest.mark.parametrize("integrator", ["velocity_verlet", "dop853"])
def test_a_spring_that_snaps_back_within_clear_steps_is_not_missed(integrator: str) -> None:
    """A stiff, light node shoots to and fro through where a ball is, faster than its speed at first lets expect."""
    session = Session.open(
        {
            "format": "pinjoint model",
            "version": 1,
            "settings": {"restitution": 1.0, "integrator": integrator},
            "particles": [
                {"name": "pin", "position": [0.0, 0.0], "fixed": [True, True]},
                {"name": "node", "position": [1.0, 0.0], "fixed": [False, True], "mass": 1e-3, "radius": 0.01},
                {"name": "ball", "position": [1.4, 0.0], "fixed": [True, True], "radius": 0.1},
            ],
            "rods": [
                {
                    "name": "spring",
                    "between": ["pin", "node"],
                    "stiffness": 100.0,
                    "damping": 0.0,
                    "rest_length": 1.5,
                }
            ],
        }
    )
    session.run(time=0.01)
    assert len(session.impacts) >= 1
    assert session.particles["node"].displacement[0] <= 0.29 + 1e-9


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
