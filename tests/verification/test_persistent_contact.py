"""Discs that stay in contact, moving and at rest, against a slow reference that shares nothing with the engine."""

import numpy as np
import pytest

from game import Session
from systems.collision.free.discs import Discs
from tests.reference import persistent_contact
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
            {
                "format": "pinjoint model",
                "version": 1,
                "environment": {"acceleration": DOWN.tolist(), "drag": 1e-9},
                "settings": {"restitution": 0.0, "integrator": integrator, "time_step": step},
                "particles": particles,
            }
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
