"""The bundled models of collisions against the formulas that their descriptions promise."""

import math

import numpy as np
import pytest

from game import Session, models
from game.included.collisions import panels
from systems.collision.arrays import Reason
from systems.collision.discs import Discs
from tests.reference import closed_forms
from tests.reference.scenes_of_discs import deepest


def discs_of(name: str) -> Discs:
    """The particles of a bundled model without rods, as discs."""
    model = models.load(name)
    particles = model.particles
    return Discs(
        particles.position,
        particles.velocity,
        particles.radius,
        np.where(particles.fixed, 0.0, 1 / particles.mass[:, None]),
        acceleration=np.array(model.environment.acceleration),
        restitution=model.settings.restitution,
    )


def velocity_at(discs: Discs, time: float) -> np.ndarray:
    """Velocities at a time to which the discs fly first."""
    assert discs.advance(time)[0] is Reason.DONE
    return discs.state_at(time)[1]


def test_newtons_cradle_passes_one_ball_on_and_gets_it_back() -> None:
    """The blow arrives after 0.45 m; the last ball is on its way from then on, and back, for ever."""
    discs = discs_of("newtons_cradle")
    assert velocity_at(discs, 0.8)[:5, 0] == pytest.approx([0, 0, 0, 0, 1], abs=1e-14)
    assert sorted(np.abs(velocity_at(discs, 30.0)[:5, 0])) == pytest.approx([0, 0, 0, 0, 1], abs=1e-12)


def test_the_break_is_symmetric_and_keeps_its_energy() -> None:
    discs = discs_of("billiards_break")
    place = models.load("billiards_break").particles.position[:16]
    partner = np.hypot(*(place[:, None] - (place * [1, -1] + [0, 1.27])[None]).transpose(2, 0, 1)).argmin(
        axis=1
    )
    velocity = velocity_at(discs, 0.3)[:16]
    assert np.abs(velocity - velocity[partner] * [1, -1]).max() <= 1e-9
    assert (np.hypot(*velocity.T) > 0.01).sum() >= 10
    for time in (0.3, 2.0):
        assert (velocity_at(discs, time)[:16] ** 2).sum() == pytest.approx(36, rel=1e-12)


def test_the_digits_of_pi_are_counted() -> None:
    discs = discs_of("galperin_pi")
    velocity_at(discs, 100.0)
    assert discs.impacts == closed_forms.galperin_contacts(2) == 314


def test_the_gas_relaxes_to_rayleighs_mean_and_keeps_its_energy() -> None:
    """(√π/2) v₀, standard error √((4 − π)/4n) of a moment; here of eight moments."""
    discs = discs_of("hard_disc_gas")
    energy = (velocity_at(discs, 0.0) ** 2).sum()
    means = [np.hypot(*velocity_at(discs, time)[:225].T).mean() for time in range(3, 11)]
    assert np.mean(means) == pytest.approx(math.sqrt(math.pi) / 2, abs=2 * math.sqrt((4 - math.pi) / 4 / 225))
    assert (velocity_at(discs, 10.0) ** 2).sum() == pytest.approx(energy, rel=1e-12)


def test_the_pile_comes_to_rest_without_sinking_in() -> None:
    discs = discs_of("pile")
    velocity_at(discs, 10.0)
    assert discs.at_rest
    particles = models.load("pile").particles
    place = particles.position + discs.state_at(10.0)[0]
    assert deepest(place, particles.radius, ~particles.fixed.all(axis=1)) <= 1e-6 * particles.radius.min()
    assert (place[:60, 1] > 0).all()


# --- in the program -------------------------------------------------------------------------------------------


def test_the_digits_of_pi_are_counted_on_screen() -> None:
    session = Session.open("galperin_pi")
    session.run(time=10.0)
    assert [readout.rows for readout in panels(session)] == [(("so far", "314"),)]


def test_the_ball_strikes_the_truss_by_newtons_law() -> None:
    """At √(2h/g), when the truss has sagged a little; J = (1 + e) μ v with the masses of ball and node alone."""
    session = Session.open("ball_on_truss")
    gravity, height = 9.81, 1.0
    fall = math.sqrt(2 * height / gravity)
    session.run(time=fall + 0.05)
    assert session.impacts.time[0] == pytest.approx(fall, abs=2e-4)
    node = session.particles["F"].mass
    reduced = 40 * node / (40 + node)
    assert session.impacts.impulse[0] == pytest.approx(1.5 * reduced * gravity * fall, rel=0.01)
    assert abs(session.energy.imbalance) <= 1e-3 * 40 * gravity * height


def test_the_pile_is_told_to_be_at_rest() -> None:
    session = Session.open("pile")
    assert session.run(until="rest") == "at rest"
    assert not session.particles.velocity.any()
