"""Scenes that break engines: piles, crowds on one point, extreme speeds, sizes and masses. No hang, no NaN."""

from collections.abc import Generator

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pinjoint.systems.collision.columns import Reason
from pinjoint.systems.collision.free.discs import Discs
from pinjoint.systems.collision.kernels.pile import begin_steps
from pinjoint.systems.collision.overlaps import part
from tests.reference.scenes_of_discs import (
    GRAVITY,
    Scene,
    break_shot,
    deepest,
    gas,
    line,
    packed,
    stacked,
    with_held,
)

DOWN = np.array([0.0, -GRAVITY])
MOST_EVENTS = 300_000  # in the scenes here; more is as good as a hang
RADIUS = 0.05


def fly(scene: Scene, until: float, **rest: object) -> Discs:
    discs = Discs(**scene, **rest)
    reason, impacts = discs.advance(until, MOST_EVENTS)
    assert reason is Reason.DONE
    for numbers in (*discs.state_at(until), impacts.time, impacts.impulse, impacts.loss):
        assert np.isfinite(numbers).all()
    return discs


def sinking(discs: Discs, scene: Scene, until: float) -> float:
    """By how much of the smallest radius discs are in one another at most."""
    place = scene["position"] + discs.state_at(until)[0]
    movable = (scene["inverse_mass"] > 0).any(axis=1)
    return deepest(place, scene["radius"], movable) / scene["radius"].min()


# --- piles --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("restitution", [0.0, 0.3, 0.8])
@pytest.mark.parametrize("spread", [0.0, 0.2])
def test_a_dropped_pile_comes_to_rest(restitution: float, spread: float) -> None:
    """Not sunk by more than 10⁻⁶ of a radius, and without the least motion from then on."""
    scene = stacked(40, 6, spread=spread)
    discs = fly(scene, 6.0, acceleration=DOWN, restitution=restitution)
    assert discs.at_rest
    assert sinking(discs, scene, 6.0) <= 1e-6
    before = discs.state_at(6.0)[0].copy()
    discs.advance(1e6)
    assert discs.state_at(1e6)[0].tobytes() == before.tobytes()


@pytest.mark.parametrize(("count", "columns"), [(40, 6), (300, 17)])
def test_a_pile_at_rest_is_in_equilibrium(count: int, columns: int) -> None:
    """Every disc is, and what the held ones carry is the weight of all; nothing is in one another, nothing vanishes."""
    scene = stacked(count, columns)
    discs = fly(scene, 6.0, acceleration=DOWN, restitution=0.3)
    assert discs.at_rest
    assert sinking(discs, scene, 6.0) <= 1e-12
    mass = 1 / scene["inverse_mass"][:count, 1]
    forces = discs.contact_forces()
    assert np.abs(forces[:count] + mass[:, None] * DOWN).max() <= 1e-9 * GRAVITY * mass.max()
    assert forces[count:].sum(axis=0) == pytest.approx([0, -GRAVITY * mass.sum()], rel=1e-9, abs=1e-6)
    fallen = GRAVITY * mass @ discs.state_at(6.0)[0][:count, 1]
    appeared = discs.lost_at(6.0) + fallen  # as discs that had sunk in were pushed apart
    assert -1e-9 <= appeared / (GRAVITY * mass.sum() * RADIUS) <= 2e-3


def test_a_pile_comes_to_rest_without_a_jump() -> None:
    """In 2 ms no disc goes farther than its speed takes it, but for the last fortieth of a radius to where it lies."""
    scene, interval = stacked(120, 10), 2e-3
    discs = Discs(**scene, acceleration=DOWN, restitution=0.3)
    before, speed = discs.state_at(0.0)[0], 0.0
    for k in range(1, 3000):
        discs.advance(k * interval, MOST_EVENTS)
        after, velocity = discs.state_at(k * interval)
        fastest = np.hypot(*velocity.T).max()
        moved = np.hypot(*(after - before).T).max()
        assert moved <= interval * (max(speed, fastest) + 2.0 * GRAVITY * interval) * 2.0 + 0.04 * RADIUS
        before, speed = after, fastest
        if discs.at_rest:
            break
    assert discs.at_rest


def test_falling_discs_hardly_sink_into_one_another() -> None:
    """At no moment by more than 1e-3 of a radius; the account of energy is even to what lifts all by 2e-3 of one."""
    scene = stacked(200, 14)
    discs = Discs(**scene, acceleration=DOWN, restitution=0.3)
    mass = 1 / scene["inverse_mass"][:200, 0]
    for time in np.arange(1, 81) / 80:
        discs.advance(float(time), MOST_EVENTS)
        assert sinking(discs, scene, time) <= 1e-3
        displacement, velocity = (part[:200] for part in discs.state_at(time))
        fallen = -GRAVITY * mass @ displacement[:, 1]
        left = fallen - mass @ (velocity**2).sum(axis=1) / 2 - discs.lost_at(time)
        assert abs(left) <= 2e-3 * GRAVITY * mass.sum() * RADIUS


def test_discs_that_fly_apart_in_a_step_have_been_pushed() -> None:
    """Two rows of a crowd meet head-on: each pair bounces once, and parts at e times the speed."""
    rows, speed, restitution = 30, 3.0, 0.3
    y = 3.2 * RADIUS * np.arange(rows)
    x = np.repeat([0.0, 2.2 * RADIUS], rows)
    scene = {
        "position": np.column_stack([x, np.tile(y, 2)]),
        "velocity": np.repeat([[speed, 0.0], [-speed, 0.0]], rows, axis=0),
        "radius": np.full(2 * rows, RADIUS),
        "inverse_mass": np.ones((2 * rows, 2)),
    }
    discs = Discs(**scene, acceleration=DOWN, restitution=restitution)
    begin_steps.py_func(discs.numbers, discs.counts)
    _, impacts = discs.advance(0.1)
    assert len(impacts.time) == rows
    assert discs.state_at(0.1)[1][:, 0] == pytest.approx(-restitution * scene["velocity"][:, 0])


def test_what_spills_over_falls_and_the_rest_lies_still() -> None:
    """A heap on a floor without walls: some discs fall for ever, which keeps none of the others awake."""
    scene = packed(7, 7)
    floor = (scene["inverse_mass"] == 0).all(axis=1) & (scene["position"][:, 1] > 0)
    scene = {key: value[~floor] for key, value in scene.items()}
    movable = scene["inverse_mass"][:, 0] > 0
    scene["velocity"][movable] = np.random.default_rng(0).uniform(-0.1, 0.1, (movable.sum(), 2))
    discs = fly(scene, 6.0, acceleration=DOWN, restitution=0.3)
    place, velocity = scene["position"] + discs.state_at(6.0)[0], discs.state_at(6.0)[1]
    falls = place[:, 1] < -1.0
    assert 3 < falls.sum() < movable.sum() - 3
    assert not velocity[~falls].any()


@pytest.mark.parametrize("rows", [2, 20])
def test_a_packed_pile_stays_as_it_is(rows: int) -> None:
    scene = packed(20, rows)
    discs = fly(scene, 1.0, acceleration=DOWN, restitution=0.5)
    assert np.abs(discs.state_at(1.0)[0]).max() <= 1e-5 * RADIUS
    assert sinking(discs, scene, 1.0) <= 1e-6


def test_a_ball_falls_on_a_pile_at_rest() -> None:
    scene = stacked(40, 6)
    resting = fly(scene, 6.0, acceleration=DOWN, restitution=0.3)
    place = scene["position"] + resting.state_at(6.0)[0]
    ball = {"position": [[0.4, 0.9]], "velocity": [[0.0, 0.0]], "radius": [0.08], "inverse_mass": [[0.2, 0.2]]}
    scene = {key: np.concatenate([np.array(ball[key]), scene[key]]) for key in ball}
    scene["position"][1:] = place
    discs = fly(scene, 8.0, acceleration=DOWN, restitution=0.3)
    assert discs.at_rest
    assert sinking(discs, scene, 8.0) <= 1e-6


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.4, 0.9]))
@settings(max_examples=6)
def test_heaps_of_any_kind_never_sink_in(seed: int, restitution: float) -> None:
    rng = np.random.default_rng(seed)
    scene = stacked(int(rng.integers(2, 30)), int(rng.integers(2, 6)), seed, spread=rng.uniform(0, 0.5))
    discs = fly(scene, 4.0, acceleration=DOWN, restitution=restitution)
    assert sinking(discs, scene, 4.0) <= 1e-4
    assert (scene["position"] + discs.state_at(4.0)[0]).min() >= -2 * RADIUS  # nothing leaked


# --- crowds and extremes ------------------------------------------------------------------------------------


def test_five_hundred_towards_one_point() -> None:
    """Discs on circles around a point, all flying there at 1 m/s: momentum stays 0, no energy is lost."""
    count = 500
    angle = 2.4 * np.arange(count)  # close to the golden angle: none overlap at these distances
    distance = 2.0 + 0.05 * np.arange(count)
    towards = -np.column_stack([np.cos(angle), np.sin(angle)])
    scene = {
        "position": -towards * distance[:, None],
        "velocity": towards,
        "radius": np.full(count, 0.02),
        "inverse_mass": np.ones((count, 2)),
    }
    discs = fly(scene, 40.0)
    velocity = discs.state_at(40.0)[1]
    assert (velocity**2).sum() == pytest.approx(count, rel=1e-12)
    assert velocity.sum(axis=0) == pytest.approx(towards.sum(axis=0), abs=1e-11)
    assert discs.impacts > 500


def _in_full(portions: Generator[None, None, int]) -> int:
    while True:
        try:
            next(portions)
        except StopIteration as end:
            return int(end.value)


def test_five_hundred_on_one_point_are_parted() -> None:
    """Coincident centres have no line between them; where discs go is the same every time."""
    position, inverse_mass = np.zeros((500, 2)), np.ones((500, 2))
    radius = np.full(500, RADIUS)
    parted = []

    def among(pairs: np.ndarray) -> np.ndarray:
        return np.ones(len(pairs), dtype=bool)

    for _ in range(2):
        displacement = np.zeros((500, 2))
        left = _in_full(part(position, displacement, radius, inverse_mass, among))
        assert np.isfinite(displacement).all()
        parted.append(displacement)
    assert parted[0].tobytes() == parted[1].tobytes()
    assert left == 0
    assert np.hypot(*parted[0].T).max() < 10 * RADIUS * np.sqrt(500)


def test_coincident_centres_are_no_harm_to_the_engine() -> None:
    scene = line([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1, 1, 1])
    discs = fly(scene, 2.0)
    assert discs.state_at(2.0)[1].sum(axis=0) == pytest.approx([-1, 0])


def test_a_billion_metres_a_second() -> None:
    scene = gas(50, 0.2)
    scene["velocity"] *= 1e9
    discs = fly(scene, 1e-8)
    velocity = discs.state_at(1e-8)[1]
    assert (velocity**2).sum() == pytest.approx(50 * 1e18, rel=1e-12)
    assert discs.impacts > 100


def test_one_bullet_into_a_pile() -> None:
    """A rest and a speed of 10⁹ m/s in one scene: it ends, and what flies away is finite."""
    scene = packed(8, 6)
    count = len(scene["position"])
    scene = with_held(scene, np.array([[-500.0, 0.25]]))
    scene["inverse_mass"][count] = 1.0
    scene["velocity"][count, 0] = 1e9
    discs = fly(scene, 1e-3, acceleration=DOWN, restitution=0.5)
    assert discs.impacts >= 1


def test_radii_a_million_times_apart() -> None:
    """A large ball sweeps up dust; masses as their areas."""
    rng = np.random.default_rng(0)
    dust = rng.uniform(-1, 1, (60, 2)) * 0.9e-3 + [1.002, 0.0]
    scene = {
        "position": np.concatenate([[[0.0, 0.0]], dust]),
        "velocity": np.concatenate([[[1.0, 0.0]], np.zeros((60, 2))]),
        "radius": np.concatenate([[1.0], np.full(60, 1e-6)]),
        "inverse_mass": np.concatenate([[[1.0, 1.0]], np.full((60, 2), 1e12)]),
    }
    discs = fly(scene, 0.1)
    velocity = discs.state_at(0.1)[1]
    assert discs.impacts >= 60
    assert velocity[0, 0] ** 2 + 1e-12 * (velocity[1:] ** 2).sum() == pytest.approx(1, rel=1e-12)
    assert (velocity[1:, 0] > 1.9).mean() > 0.8  # struck by a wall at 1 m/s, they leave at 2; few meet others


def test_a_tower_of_unequal_masses() -> None:
    """A million on one on a million: the light one in between is squeezed, not lost."""
    scene = line([0.0, 0.1, 0.2, 0.3], [0.0] * 4, [0, 1e6, 1, 1e6])
    scene["position"] = scene["position"][:, ::-1].copy()
    discs = fly(scene, 1.0, acceleration=DOWN, restitution=0.5)
    assert sinking(discs, scene, 1.0) <= 1e-6
    forces = discs.contact_forces()
    assert forces[0, 1] == pytest.approx(-2.000001e6 * GRAVITY, rel=1e-6)


def test_many_balls_touch_at_once() -> None:
    """A rack of 120, broken, has one answer, whichever way its balls are numbered, to round-off."""
    scene = break_shot(15)
    order = np.random.default_rng(0).permutation(len(scene["position"]))
    one = fly(scene, 0.5).state_at(0.5)[1]
    other = fly({key: value[order] for key, value in scene.items()}, 0.5).state_at(0.5)[1]
    assert np.abs(one[order] - other).max() <= 1e-11
