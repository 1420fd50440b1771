"""The bundled models of collisions, through Session, against the formulas that their descriptions promise."""

import math

import numpy as np
import pytest

from game import Session
from tests.reference import closed_forms

GRAVITY = 9.81


def speeds(session: Session) -> np.ndarray:
    return np.hypot(*session.particles.velocity.T)


def test_newtons_cradle_passes_one_ball_on_and_gets_it_back() -> None:
    """The blow arrives after 0.55 m; the last ball reaches the end after another 0.75 m, and so on."""
    session = Session.open("newtons_cradle")
    session.run(time=0.8)
    assert session.particles.velocity[:5, 0] == pytest.approx([0, 0, 0, 0, 1], abs=1e-14)
    kinetic = session.energy.kinetic
    session.run(time=30.0)
    assert session.energy.kinetic == pytest.approx(kinetic, rel=1e-12)
    assert sorted(speeds(session)[:5]) == pytest.approx([0, 0, 0, 0, 1], abs=1e-12)


def test_the_break_is_symmetric_and_keeps_its_energy() -> None:
    session = Session.open("billiards_break")
    session.run(time=0.3)
    velocity = session.particles.velocity[:16]
    place = session.particles.position[:16]
    partner = np.hypot(*(place[:, None] - (place * [1, -1] + [0, 1.27])[None]).transpose(2, 0, 1)).argmin(
        axis=1
    )
    assert np.abs(velocity - velocity[partner] * [1, -1]).max() <= 1e-9
    assert (speeds(session)[:16] > 0.01).sum() >= 10
    assert session.energy.kinetic == pytest.approx(0.17 * 6**2 / 2, rel=1e-12)
    session.run(time=2.0)
    assert session.energy.kinetic == pytest.approx(0.17 * 6**2 / 2, rel=1e-12)


def test_the_digits_of_pi_are_counted() -> None:
    session = Session.open("galperin_pi")
    session.run(time=10.0)
    assert session.model.clock.collisions == closed_forms.galperin_contacts(2) == 314
    session.restart()
    session.particles["heavy"].mass = 1_000_000
    session.run(time=10.0)
    assert session.model.clock.collisions == 3141


def test_the_gas_relaxes_to_rayleighs_mean_and_keeps_its_energy() -> None:
    """(√π/2) v₀, standard error √((4 − π)/4n) of a moment; here of eight moments."""
    session = Session.open("hard_disc_gas")
    kinetic = session.energy.kinetic or 225 / 2
    means = []
    for time in np.linspace(3.0, 10.0, 8):
        session.run(time=float(time) - session.time)
        means.append(speeds(session)[:225].mean())
    assert np.mean(means) == pytest.approx(math.sqrt(math.pi) / 2, abs=2 * math.sqrt((4 - math.pi) / 4 / 225))
    assert session.energy.kinetic == pytest.approx(225 / 2, rel=1e-5)  # as the file's digits have it
    assert session.energy.kinetic == pytest.approx(session.energy.initial, rel=1e-12) or kinetic


def test_the_ball_strikes_the_truss_by_newtons_law() -> None:
    """At √(2h/g); with e = 0.5 the ball goes on with the speed of the two masses alone."""
    session = Session.open("ball_on_truss")
    fall = math.sqrt(2 * 1.0 / GRAVITY)
    session.run(time=fall + 0.05)
    impacts = session.impacts
    assert len(impacts) >= 1
    assert impacts.time[0] == pytest.approx(fall, abs=2e-4)  # the truss sags a little under its own weight
    node = session.particles["F"].mass
    reduced = 40 * node / (40 + node)
    assert impacts.impulse[0] == pytest.approx(1.5 * reduced * GRAVITY * fall, rel=0.01)
    assert abs(session.energy.imbalance) <= 1e-3 * 40 * GRAVITY


def test_the_pile_comes_to_rest_without_sinking_in() -> None:
    session = Session.open("pile")
    assert session.run(until="rest") == "at rest"
    place, radius = session.particles.position + session.particles.displacement, session.particles.radius
    gap = np.hypot(*(place[:, None] - place[None]).transpose(2, 0, 1)) - (radius[:, None] + radius[None])
    gap[60:, 60:] = 1.0
    np.fill_diagonal(gap, 1.0)
    assert -gap.min() <= 1e-6 * radius.min()
    assert (place[:60, 1] > 0).all()
    assert not session.particles.velocity.any()
