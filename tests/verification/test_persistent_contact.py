"""Discs that stay in contact, moving and at rest, against a slow reference that shares nothing with the engine."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pinjoint import Session
from pinjoint.components.obstacles import Obstacles
from pinjoint.systems.collision.free.discs import Discs
from tests.reference import persistent_contact
from tests.reference.models import model, particle
from tests.reference.scenes_of_discs import GRAVITY, Scene, stacked

DOWN = np.array([0.0, -GRAVITY])
RADIUS = 0.05
UNTIL = 0.1  # s


def heap() -> Scene:
    """Two discs that touch on top of a large held one, and a third on them, heavier, that drives them apart."""
    large, aside = 5.0, np.arcsin(RADIUS / (5.0 + RADIUS))
    x, y = (large + RADIUS) * np.sin(aside), (large + RADIUS) * np.cos(aside) - large
    place = np.array([[-x, y], [x, y], [0.0, y + np.sqrt(4.0 * RADIUS**2 - x**2)], [0.0, -large]])
    return {
        "position": place,
        "velocity": np.zeros((4, 2)),
        "radius": np.array([RADIUS, RADIUS, RADIUS, large]),
        "inverse_mass": np.array([[1.0, 1.0], [0.5, 0.5], [0.25, 0.25], [0.0, 0.0]]),
    }


@pytest.fixture(scope="module")
def expected() -> np.ndarray:
    """Displacements of the heap after UNTIL, extrapolated from two runs of first order."""
    coarse, fine = (persistent_contact.moved(heap(), DOWN, UNTIL, steps) for steps in (500, 1000))
    assert 1e-4 < np.abs(fine - coarse).max() / RADIUS < 1e-3
    found: np.ndarray = 2.0 * fine - coarse - heap()["position"]
    assert np.abs(found).max() > 0.5 * RADIUS
    return found


def test_a_heap_that_gives_way_moves_as_the_reference_does(expected: np.ndarray) -> None:
    """Its discs turn around one another in steps of 0.0156; that leaves some 1e-5 of a radius."""
    discs = Discs(**heap(), acceleration=DOWN, restitution=0.0)
    discs.advance(UNTIL)
    np.testing.assert_allclose(discs.state_at(UNTIL)[0], expected, atol=2e-5 * RADIUS)


@pytest.mark.parametrize("integrator", ["velocity_verlet", "dop853"])
def test_motion_in_contact_within_steps_is_of_first_order(expected: np.ndarray, integrator: str) -> None:
    """The same heap under a drag that is next to nothing, which an integrator's steps follow."""
    scene = heap()
    columns = scene["position"].tolist(), scene["radius"].tolist(), scene["inverse_mass"][:, 0].tolist()
    particles = [
        {
            "name": f"p{k}",
            "position": place,
            "radius": radius,
            "mass": 1.0 / (w or 1.0),
            "fixed": [w == 0.0] * 2,
        }
        for k, (place, radius, w) in enumerate(zip(*columns, strict=True))
    ]
    for step, error in ((2e-3, 1.5e-3), (2e-4, 1.5e-4)):
        session = Session.open(
            model(
                particles,
                [],
                environment={"acceleration": DOWN.tolist(), "drag": 1e-09},
                settings={"restitution": 0.0, "integrator": integrator, "time_step": step},
            )
        )
        session.run(time=UNTIL)
        np.testing.assert_allclose(session.model.particles.displacement, expected, atol=error * RADIUS)


@pytest.mark.parametrize(("count", "columns", "seed"), [(12, 4, 0), (60, 7, 1)])
def test_contacts_of_a_resting_pile_push_as_statics_demands(count: int, columns: int, seed: int) -> None:
    """The forces that hold each disc's weight are the only ones, contact by contact; nothing sinks in by 1e-6."""
    scene = stacked(count, columns, seed)
    discs = Discs(**scene, acceleration=DOWN, restitution=0.3)
    discs.advance(8.0)
    assert discs.at_rest
    place = scene["position"] + discs.state_at(8.0)[0]
    _, _, gaps = persistent_contact.lines_of(scene, place, RADIUS)
    assert gaps.min() >= -1e-6 * scene["radius"].min()
    demanded = persistent_contact.forces_at_rest(scene, place, DOWN)
    state = discs.state()
    found = {
        (min(pair), max(pair)): force
        for pair, force in zip(state.contacts.tolist(), state.forces.tolist(), strict=True)
    }
    heaviest = GRAVITY / scene["inverse_mass"][:count].min()
    assert max(demanded.values()) > 2.0 * heaviest
    for pair in demanded.keys() | found.keys():
        assert found.get(pair, 0.0) == pytest.approx(demanded.get(pair, 0.0), abs=1e-6 * heaviest)
    _, lines, _ = persistent_contact.lines_of(scene, place, 1e-9 * RADIUS)
    floor = (np.array(list(demanded.values())) @ lines).reshape(-1, 2)[count:, 1].sum()
    assert floor == pytest.approx(-GRAVITY * (1.0 / scene["inverse_mass"][:count, 1]).sum(), rel=1e-9)


# --- one degree of freedom, against closed forms and their quadratures -----------------------------------------


def obstacles(*walls: tuple[tuple[float, float], tuple[float, float]]) -> Obstacles:
    """Straight pieces from end to end."""
    ends = np.array(walls)
    names = [f"wall {k}" for k in range(len(walls))]
    return Obstacles(ends[:, 0], ends[:, 1] - ends[:, 0], np.zeros(len(walls)), np.ones(len(walls)), names)


EVERY = 0.002  # s at which motion is compared, between the ends of steps as well as at them


def turned(rate: Callable[[float, float], float], start: float, until: float) -> tuple[np.ndarray, np.ndarray]:
    """Angle and its rate at each multiple of EVERY up to a time (s), given the second derivative; from rest."""
    times = np.arange(0.0, until, EVERY)
    found = solve_ivp(
        lambda _, state: (state[1], rate(*state)),
        (0.0, until),
        (start, 0.0),
        "DOP853",
        times,
        rtol=1e-13,
        atol=1e-14,
    )
    return found.y[0], found.y[1]


def followed(discs: Discs, count: int) -> np.ndarray:
    """Displacements at each of so many multiples of EVERY, shape (count, n, 2), m."""
    places = []
    for k in range(count):
        discs.advance(k * EVERY)
        places.append(discs.state_at(k * EVERY)[0])
    return np.array(places)


def test_a_disc_slides_off_a_round_hill_until_it_has_fallen_by_a_third() -> None:
    """R φ'' = g sin φ; the push m (g cos φ − R φ'²) ends at cos φ = 2/3 cos φ₀, at a speed of √(g R cos φ)."""
    start, reach = 0.1, 0.6
    place = np.array([[reach * np.sin(start), reach * np.cos(start)], [0.0, 0.0]])
    discs = Discs(
        place, np.zeros((2, 2)), [0.1, 0.5], [[1.0, 1.0], [0.0, 0.0]], acceleration=DOWN, restitution=0.5
    )
    angle, _ = turned(lambda phi, _: GRAVITY / reach * np.sin(phi), start, 1.5)
    leaves = np.arccos(2.0 / 3.0 * np.cos(start))
    angle = angle[angle < leaves]
    assert len(angle) > 200
    expected = reach * np.array([np.sin(angle), np.cos(angle)]).T - place[0]
    np.testing.assert_allclose(followed(discs, len(angle))[:, 0], expected, atol=1e-9 * reach)
    discs.advance(len(angle) * EVERY)
    assert len(discs.state().contacts) == 0
    across = discs.state_at(discs.now)[1][0, 0]
    assert across == pytest.approx(np.sqrt(GRAVITY * reach * np.cos(leaves)) * np.cos(leaves), rel=1e-8)


def test_a_disc_slides_down_one_that_gives_way() -> None:
    """On a smooth floor, m and M: their centre of mass falls straight, and

    (1 − μ cos² φ) φ'' = g/R sin φ − μ sin φ cos φ φ'² with μ = m/(m + M), until the push between them ends.
    """
    start, radius, share = 0.2, 0.15, 10.0 / 11.0
    reach = 2.0 * radius
    place = np.array([[0.0, radius], [reach * np.sin(start), radius + reach * np.cos(start)]])
    discs = Discs(
        place,
        np.zeros((2, 2)),
        [radius, radius],
        [[1.0, 1.0], [0.1, 0.1]],
        acceleration=DOWN,
        restitution=0.2,
        obstacles=obstacles(((-3.0, 0.0), (3.0, 0.0))),
    )

    def rate(phi: float, turn: float) -> float:
        pull = GRAVITY / reach * np.sin(phi) - share * np.sin(phi) * np.cos(phi) * turn * turn
        return float(pull / (1.0 - share * np.cos(phi) ** 2))

    angle, turn = turned(rate, start, 0.4)
    pushes = np.cos(angle) * np.vectorize(rate)(angle, turn) > np.sin(angle) * turn * turn
    angle = angle[: np.argmin(pushes)]
    assert len(angle) > 50
    aside, down = reach * (np.sin(angle) - np.sin(start)), reach * (np.cos(angle) - np.cos(start))
    still = np.zeros_like(angle)
    expected = np.stack([[-share * aside, still], [(1.0 - share) * aside, down]]).transpose(2, 0, 1)
    np.testing.assert_allclose(followed(discs, len(angle)), expected, atol=1e-9 * radius)


def test_a_disc_between_a_wall_and_another_slides_down_like_a_ladder() -> None:
    """L φ'' = g sin φ for equal masses, until the push of the wall ends at cos φ = 2/3 cos φ₀."""
    start, radius = 0.3, 0.1
    length = 2.0 * radius
    place = np.array([[radius + length * np.sin(start), radius], [radius, radius + length * np.cos(start)]])
    discs = Discs(
        place,
        np.zeros((2, 2)),
        [radius, radius],
        np.ones((2, 2)),
        acceleration=DOWN,
        restitution=0.2,
        obstacles=obstacles(((0.0, 0.0), (3.0, 0.0)), ((0.0, 3.0), (0.0, 0.0))),
    )
    angle, _ = turned(lambda phi, _: GRAVITY / length * np.sin(phi), start, 0.5)
    angle = angle[np.cos(angle) > 2.0 / 3.0 * np.cos(start)]
    assert len(angle) > 50
    aside, down = length * (np.sin(angle) - np.sin(start)), length * (np.cos(angle) - np.cos(start))
    still = np.zeros_like(angle)
    expected = np.stack([[aside, still], [still, down]]).transpose(2, 0, 1)
    np.testing.assert_allclose(followed(discs, len(angle)), expected, atol=1e-9 * radius)


def test_the_account_is_even_at_every_moment_of_discs_that_slide() -> None:
    """Two discs fall onto a floor and slide along it and one another, under two pulls."""
    session = Session.open(
        model(
            [
                particle("a", 0.0, 0.16, mass=10.0, radius=0.15, velocity=[0.3, 0.0]),
                particle("b", 0.02, 0.5, radius=0.15, acceleration=[1.0, 0.0]),
            ],
            [],
            environment={"acceleration": DOWN.tolist()},
            settings={"restitution": 0.2},
            components={"walls.Wall": [{"start": [-3.0, 0.0], "end": [3.0, 0.0]}]},
        )
    )
    session.run(time=0.4)
    energies = []
    for _ in range(400):
        session.run(steps=1)
        energies.append(session.energy)
    supplied = max(energy.kinetic + abs(energy.work) for energy in energies)
    assert max(abs(energy.imbalance) for energy in energies) <= 1e-9 * supplied


def test_a_disc_strikes_one_that_slides_at_the_time_at_which_their_paths_meet() -> None:
    """In the midst of a step of the contact, on its curved path; elastic, so that no energy is lost."""
    start, reach, speed = 0.1, 0.6, 2.0
    place = np.array([[reach * np.sin(start), reach * np.cos(start)], [1.3, 0.55], [0.0, 0.0]])
    scene = (
        place,
        [[0.0, 0.0], [-speed, 0.0], [0.0, 0.0]],
        [0.1, 0.1, 0.5],
        [[1.0, 1.0], [2.0, 2.0], [0.0, 0.0]],
    )
    discs = Discs(*scene, acceleration=[DOWN, [0.0, 0.0], DOWN], restitution=1.0)
    _, impacts = discs.advance(0.5)

    def gap(time: float, state: np.ndarray) -> float:
        x, y = reach * np.sin(state[0]) - 1.3 + speed * time, reach * np.cos(state[0]) - 0.55
        return float(np.hypot(x, y)) - 0.2

    gap.terminal = True  # type: ignore[attr-defined]
    swing = lambda _, state: (state[1], GRAVITY / reach * np.sin(state[0]))  # noqa: E731
    met = solve_ivp(swing, (0.0, 0.5), (start, 0.0), "DOP853", events=gap, rtol=1e-13, atol=1e-14)
    assert impacts.pairs[0].tolist() == [0, 1]
    assert impacts.time[0] == pytest.approx(met.t_events[0][0], abs=1e-10)
    moved, velocity = discs.state_at(0.5)
    kinetic = 0.5 * np.array([1.0, 0.5]) @ (velocity[:2] ** 2).sum(axis=1)
    assert kinetic + GRAVITY * moved[0, 1] == pytest.approx(0.25 * speed**2, abs=1e-9)
