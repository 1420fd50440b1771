"""The neighbour list is made anew when the document changes or particles have moved, not in every step."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinjoint import Session
from pinjoint.systems.broad_phase import ALL_PAIRS_DISCS, near_pairs
from pinjoint.systems.collision.driven.columns import Phase, Whole
from pinjoint.systems.collision.driven.neighbours import NeighbourList
from pinjoint.systems.program.compiler import Compile
from tests.benchmarks.models import lattice
from tests.reference.forms import programs
from tests.reference.models import model, particle, rod
from tests.systems.collision.test_driven_collisions import gaps_of, truss


def listed(session: Session) -> int:
    """How often pairs were listed since the document changed."""
    return int(session.simulation._driven_steps._neighbours.driven.whole[Whole.LISTS])


def test_a_step_looks_up_nothing_and_an_edit_does() -> None:
    session = Session(lattice(200, damping=1.0))
    session.step()
    near = session.simulation._driven_steps._neighbours.driven
    for _ in range(5):
        session.step()
    assert listed(session) == 1
    session.particles[3].radius = 0.06
    session.step()
    assert listed(session) == 1
    assert session.simulation._driven_steps._neighbours.driven is not near


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


# --- the list in machine code, and interpreted, is that of a look at all pairs ---------------------------------


def scattered(seed: int, count: int, width: float, spread: float, away: float) -> NeighbourList:
    """Discs in a square of this width (m), and walls, of which some are so far away (m), by positions or displacements.

    The largest discs are 10^spread times the least; some are held, some joined, a few on one place.
    """
    random = np.random.default_rng(seed)
    place, shift = width * random.random((count, 2)), np.zeros((count, 2))
    fixed = random.random((count, 2)) < 0.4
    place[: count // 6] = place[:1]
    place[count // 3 : count // 2] += away
    shift[count // 2 : 2 * count // 3] = away, -(away**4)
    drawn = {(min(pair), max(pair)) for pair in random.integers(0, count, (2 * count, 2)).tolist()}
    joined = [pair for pair in sorted(drawn) if (place[pair[0]] != place[pair[1]]).all()]
    ends = width * random.random((6, 2, 2))
    ends[:2, 1] = ends[:2, 0] + random.random((2, 2)) / 100.0
    ends[3:, 1] += away
    session = Session.open(
        model(
            [
                {"name": f"p{k}", "position": place[k].tolist(), "fixed": fixed[k].tolist()}
                for k in range(count)
            ],
            [{"name": f"r{k}", "between": [f"p{i}", f"p{j}"]} for k, (i, j) in enumerate(joined)],
            components={"walls.Wall": [{"start": a, "end": b} for a, b in ends.tolist()]},
        )
    )
    session.particles.radius = 0.02 * 10.0 ** random.uniform(0.0, spread, count)
    session.model.writable("particles.displacement")[...] = shift
    velocity = 10.0 ** random.uniform(-3.0, 3.0, (count, 2)) * ~fixed
    session.model.writable("particles.velocity")[...] = velocity
    session.model.writable("clock.step_size")[0] = 1e-4
    near = NeighbourList(session.model)
    near.look_up()
    return near


def slowly(near: NeighbourList, span: float) -> list[list[int]]:
    """The pairs to list: by a look at all of them."""
    n, others = near.count, len(near.obstacles)
    every = np.array([(i, j) for i in range(n) for j in range(i + 1, n + others)], dtype=np.int64)
    gap, _ = gaps_of(near, every)
    radius, speed = near.driven.radius[:n], np.hypot(*near.velocity.T)
    step = near.model.clock.step_size
    margin = np.maximum(np.maximum(0.5 * radius, np.minimum(512 * step * speed, 4.0 * radius)), 2.0 * span)
    moves = near.everywhere(~near.model.particles.fixed.all(axis=1))
    joined = {tuple(sorted(pair)) for pair in near.model.rods.between.tolist()}
    may = moves[every].any(axis=1) & [tuple(pair) not in joined for pair in every.tolist()]

    def within(margin: np.ndarray) -> np.ndarray:
        return every[may & (gap <= near.everywhere(margin)[every].sum(axis=1))]

    for _ in range(4):
        if len(within(margin)) or len(within(4.0 * margin)):
            break
        margin = 4.0 * margin
    return within(margin).tolist()


@settings(max_examples=30)
@given(
    seed=st.integers(0, 2**32),
    count=st.integers(1, 40),
    width=st.sampled_from([0.1, 3.0, 100.0]),
    spread=st.sampled_from([0.0, 1.5, 20.0]),
    away=st.sampled_from([0.0, 1.0, 30.0, -1e6, 1e25]),
    span=st.sampled_from([0.0, 1e-3, 0.5, 1e10]),
)
def test_the_pairs_listed_are_those_of_a_look_at_all_pairs(
    seed: int, count: int, width: float, spread: float, away: float, span: float
) -> None:
    near = scattered(seed, count, width, spread, away)
    expected = slowly(near, span)
    for choice in (Compile.NEVER, Compile.ALWAYS):
        with programs(choice):
            near.driven.whole[Whole.LISTED] = 0
            near.list_within(span)
            assert near.pairs.tolist() == expected


@pytest.mark.parametrize("choice", [Compile.NEVER, Compile.ALWAYS])
def test_what_lasts_goes_on_in_pairs_that_stay(choice: Compile) -> None:
    """Also where there is no room for all that comes near: the list is made again then."""
    near, random = scattered(3, 40, 3.0, 1.0, 0.0), np.random.default_rng(3)
    with programs(choice):
        near.list_within(0.0)
        few, whole = near.pairs.copy(), near.driven.whole
        lasting = np.sort(random.choice(len(few), 8, replace=False))
        near.driven.lasting[lasting], near.driven.forces[lasting] = 1, 1.0 + np.arange(8.0)
        whole[Whole.PHASE], whole[Whole.CHOSEN], near.driven.chosen[:3] = Phase.HELD, 3, lasting[[6, 0, 3]]
        near.list_within(0.4)
    pairs, forces = near.pairs.tolist(), near.driven.forces[: len(near.pairs)]
    assert len(pairs) > len(few)
    rows = [pairs.index(pair) for pair in few[lasting].tolist()]
    assert np.flatnonzero(near.driven.lasting[: len(pairs)]).tolist() == rows
    assert forces[rows].tolist() == list(range(1, 9))
    assert forces.sum() == 36.0
    assert near.driven.chosen[:3].tolist() == [rows[6], rows[0], rows[3]]
    inside = np.unique(near.pairs)
    assert near.driven.near[: whole[Whole.NEAR]].tolist() == inside[inside < near.count].tolist()


@pytest.mark.parametrize("choice", [Compile.NEVER, Compile.ALWAYS])
@pytest.mark.parametrize("lost", [np.nan, np.inf, -np.inf, 1e200, 1e308])
def test_what_is_lost_is_near_nothing(lost: float, choice: Compile) -> None:
    """As a run diverges, between two checks of its state."""
    near = scattered(7, 40, 3.0, 1.0, 0.0)
    rows = [3, 20, 39]
    near.model.writable("particles.displacement")[rows] = lost
    near.model.writable("particles.velocity")[rows[:2]] = -lost
    with programs(choice):
        near.list_within(1e-3)
    assert near.pairs.tolist() == slowly(near, 1e-3)
    assert not np.isin(near.pairs, rows).any()


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
    assert len(near.pairs) == 0


# --- steps in which nothing can meet ---------------------------------------------------------------------------


def test_what_flies_away_from_a_structure_is_not_looked_at_in_every_step() -> None:
    """A ball slips off a node: of the 10 s in which it falls 450 m, the list is made anew some times, not thousands."""
    session = Session.open(truss({"position": [1.03, 0.65]}, integrator="velocity_verlet"))
    session.run(time=10.0)
    assert session.particles["ball"].displacement[1] < -300.0
    assert session.model.clock.steps > 10_000
    assert listed(session) < 500


@pytest.mark.parametrize("integrator", ["velocity_verlet", "dop853"])
def test_a_spring_that_snaps_back_within_clear_steps_is_not_missed(integrator: str) -> None:
    """A stiff, light node shoots to and fro through where a ball is, faster than its speed at first lets expect."""
    session = Session.open(
        model(
            [
                particle("pin", 0.0, 0.0, fixed=[True, True]),
                particle("node", 1.0, 0.0, fixed=[False, True], mass=0.001, radius=0.01),
                particle("ball", 1.4, 0.0, fixed=[True, True], radius=0.1),
            ],
            [rod("pin", "node", name="spring", stiffness=100.0, damping=0.0, rest_length=1.5)],
            settings={"restitution": 1.0, "integrator": integrator},
        )
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
        model(
            [particle("p", 0.0, 0.0), particle("wall", 0.3, 0.0, fixed=[True, True])],
            [],
            settings={"time_step": 0.001, "integrator": "velocity_verlet"},
            loads=[{"on": "p", "force": [1.0, 0.0], "history": history}],
        )
    )
    session.run(time=1.0)
    assert len(session.impacts) >= 1
    assert session.particles["p"].displacement[0] <= 0.2
