"""Impacts late in a run, where time is rounded to more than what lies between two of them."""

import pytest

from pinjoint import Session
from pinjoint.components.model import Model
from pinjoint.components.particle import Particle


@pytest.mark.parametrize("time", [0.0, 65536.0])
def test_particles_that_meet_before_the_next_moment_of_time_collide(time: float) -> None:
    """In hours of pulls a catapult stood still for good: one pair just parted, and the next met within 2e-13 s."""
    model = Model()
    for name, x, speed in (("A", 0.0, -10.0), ("B", 0.2, 10.0), ("C", 1.0, 10.0), ("D", 1.2 + 3e-12, -10.0)):
        model.create(Particle, name=name, position=(x, 0.0), velocity=(speed, 0.0), mass=1.0, radius=0.1)
    model.environment.drag = 1e-6  # and so no free flight
    model.clock.time = time
    session = Session(model)
    session.simulation.run_to(time + 1e-3)
    assert session.time == pytest.approx(time + 1e-3)
    assert session.particles["C"].velocity[0] < 0.0 < session.particles["D"].velocity[0]
