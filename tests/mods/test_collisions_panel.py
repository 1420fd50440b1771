"""The panels of impacts and of a gas' speeds."""

import math

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.included.collisions import BINS, free_speeds, histogram, panels, rayleigh


def titles(session: Session) -> list[str]:
    return [readout.title for readout in panels(session)]


def test_a_gas_shows_its_speeds_unasked_and_u_switches_them() -> None:
    session = Session.open("hard_disc_gas")
    assert titles(session) == ["Speeds"]
    session.press("u")
    assert titles(session) == []
    session.press("u")
    assert titles(session) == ["Speeds"]


def test_others_show_them_when_asked() -> None:
    session = Session.open("collision_iii")
    assert titles(session) == []
    session.press("u")
    assert titles(session) == ["Speeds"]
    empty = Session.open("isostatic")
    empty.press("u")  # no particle is free of rods
    assert titles(empty) == []


def test_impacts_are_counted_on_screen() -> None:
    session = Session.open("collision_iii")
    session.model.writable("clock.collisions")[0] = 314
    assert [readout.rows for readout in panels(session)] == [(("so far", "314"),)]


def test_rayleighs_curve_is_a_density_with_its_mean_and_square() -> None:
    """∫ f = 1, ∫ v f = √(π⟨v²⟩)/2, ∫ v² f = ⟨v²⟩."""
    speed = np.linspace(0, 20, 20_001)
    density = rayleigh(speed, 4.0)
    step = speed[1]
    assert density.sum() * step == pytest.approx(1, abs=1e-6)
    assert (speed * density).sum() * step == pytest.approx(math.sqrt(math.pi), abs=1e-6)
    assert (speed**2 * density).sum() * step == pytest.approx(4, abs=1e-6)


def test_a_histogram_holds_every_particle() -> None:
    """The area under the outline is 1; also of those that are faster than its end."""
    speed = np.abs(np.random.default_rng(0).normal(0, 2, 500))
    edges, heights = histogram(speed, 1.0)
    assert len(edges) == 2 * (BINS + 1)
    assert np.trapezoid(heights, edges) == pytest.approx(1)


def test_heavier_particles_count_by_their_energy() -> None:
    session = Session.open("hard_disc_gas")
    before = free_speeds(session.model)
    assert before == pytest.approx(np.ones(225), abs=1e-5)
    session.particles["atom 1"].mass = 4.0
    after = free_speeds(session.model)
    assert after[0] / after[1] == pytest.approx(2, rel=1e-5)
