"""Laws of mods that are too much for the steps, and integrators of mods where they do not act: the run says so."""

from typing import Any

import numpy as np
import pytest

from pinjoint import Session, mods
from tests.mods.conftest import Write
from tests.reference.models import oscillator

SPRING = """
from numba import njit
from pinjoint.systems.base import Law

@njit
def spring(particles_displacement):
    x, y = particles_displacement
    return -3e10 * x, -3e10 * y

class Spring(Law):
    name = "apple.spring"
    each = "particles"
    kernel = spring
    reads = ("particles.displacement",)

def plugin(app):
    app.system(Spring)
"""

ELSEWHERE = """
from pinjoint.systems.physics.integrators import VelocityVerlet

class Mine(VelocityVerlet):
    name = "apple.mine"
    scenes = ("force method",)

def plugin(app):
    app.integrator(Mine)
"""


def struck(**settings: Any) -> Session:
    document = oscillator(30.0, velocity=[0.001, 0.0])
    return Session.open(document | {"settings": {"collisions": False, **settings}})


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [1e-3, 2e-5, None])
def test_a_law_that_is_too_stiff_for_the_steps_ends_the_run(write_mod: Write, size: float | None) -> None:
    """Its work is integrated as coarsely as the motion, so that the account of energy alone shows nothing."""
    mods.load_all([write_mod("apple", SPRING)])
    session = struck(integrator="velocity_verlet", time_step=size)
    assert session.run(steps=3000) == "diverged"
    assert np.abs(session.particles.displacement).max() == 0.0  # the last good state
    assert "Make the time step smaller." in session.message
    assert "apple.spring" in session.message


def test_steps_that_a_law_makes_tiny_are_told(write_mod: Write) -> None:
    mods.load_all([write_mod("apple", SPRING)])
    session = struck(integrator="dop853")
    assert session.run(steps=20_000) == "time reached"
    assert "Forces change so fast that time steps of" in session.message
    assert "much stiffer than the rods" in session.message


def test_an_integrator_that_does_not_act_in_the_scene_is_replaced_with_a_note(write_mod: Write) -> None:
    mods.load_all([write_mod("apple", ELSEWHERE)])
    session = struck(integrator="mine", time_step=1e-4)
    session.run(steps=10)
    assert session.simulation.integrator.key == "velocity_verlet"
    said = "The integrator mine cannot act (not active in 'simulation', only in force method); velocity_verlet acts instead."
    assert session.message == said
    session.settings.integrator = "velocity_verlet"
    session.run(steps=10)
    assert session.message == ""
