"""The bundled models of collisions against the formulas that their descriptions promise."""

import json
import math

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.included.collisions import panels
from tests.reference.scenes_of_discs import deepest


def velocity_at(session: Session, time: float) -> np.ndarray:
    """Velocities at a time to which the particles move first."""
    if time > session.time:
        session.run(time=time - session.time)
    return session.particles.velocity.copy()


def test_newtons_cradle_passes_one_ball_on_and_gets_it_back() -> None:
    """The blow arrives after 0.45 m; the last ball is on its way from then on, and back, for ever."""
    session = Session.open("newtons_cradle")
    assert velocity_at(session, 0.8)[:5, 0] == pytest.approx([0, 0, 0, 0, 1], abs=1e-14)
    assert sorted(np.abs(velocity_at(session, 30.0)[:5, 0])) == pytest.approx([0, 0, 0, 0, 1], abs=1e-12)


def test_the_break_is_symmetric_and_keeps_its_energy() -> None:
    session = Session.open("billiards_break")
    place = session.particles.position[:16]
    mirrored = place * [1, -1] + [0, 1.27]
    partner = np.hypot(*(place[:, None] - mirrored[None]).transpose(2, 0, 1)).argmin(axis=1)
    velocity = velocity_at(session, 0.3)[:16]
    assert np.abs(velocity - velocity[partner] * [1, -1]).max() <= 1e-9
    assert (np.hypot(*velocity.T) > 0.01).sum() >= 10
    for time in (0.3, 2.0):
        assert (velocity_at(session, time)[:16] ** 2).sum() == pytest.approx(36, rel=1e-12)


def test_the_gas_relaxes_to_rayleighs_mean_keeps_its_energy_and_presses_on_its_walls() -> None:
    """(√π/2) v₀, standard error √((4 − π)/4n) of a moment; here of eight moments.

    p = (N/A) k T (1 + …) for discs that cover η = 0.126 of the box: Z = (1 + η²/8)/(1 − η)² (Henderson, 1975).
    """
    session = Session.open("hard_disc_gas")
    energy = (velocity_at(session, 0.0) ** 2).sum()
    means = [np.hypot(*velocity_at(session, time)[:225].T).mean() for time in range(3, 11)]
    assert np.mean(means) == pytest.approx(math.sqrt(math.pi) / 2, abs=2 * math.sqrt((4 - math.pi) / 4 / 225))
    assert (velocity_at(session, 21.0) ** 2).sum() == pytest.approx(energy, rel=1e-12)
    impacts = session.impacts
    on_walls = (impacts.second >= session.particles.count) & (impacts.time > 1.0)
    pressure = impacts.impulse[on_walls].sum() / 20 / 12
    filled = 225 * math.pi * session.particles.radius[0] ** 2 / 9
    expected = 225 / 9 * 0.5 * (1 + filled**2 / 8) / (1 - filled) ** 2
    assert pressure == pytest.approx(expected, rel=0.05)


def test_the_ball_hops_down_the_stairs() -> None:
    session = Session.open("staircase")
    assert session.run(until="rest") == "at rest"
    first = session.impacts.time[0]
    fall = 1.8 - 0.05 - 1.25
    assert first == pytest.approx(math.sqrt(2 * fall / 9.81), rel=1e-13)
    ball, radius = session.particles["ball"], 0.05
    x, y = np.add(ball.position, ball.displacement)
    slope = math.atan2(0.15, 1.4)
    assert (x, y) == pytest.approx(
        (3.4 - radius, -0.15 + radius * math.tan(slope) + radius / math.cos(slope)), abs=1e-8
    )


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


def test_the_pile_comes_to_rest_without_sinking_in() -> None:
    session = Session.open("pile")
    assert session.run(until="rest") == "at rest"
    particles = session.particles
    assert not particles.velocity.any()
    place = particles.position + particles.displacement
    assert deepest(place, particles.radius, ~particles.fixed.all(axis=1)) <= 1e-6 * particles.radius.min()
    assert place.min() >= particles.radius.min() * (1 - 1e-6)


ROOT = 3.0**0.5  # of offset centres: the line of centres is at 30° to the motion

SIX = {  # velocities after the impact, exact
    "i": ((2.5, 0.0), (2.5, 0.0)),
    "ii": ((1.25, 0.0), (3.75, 0.0)),
    "iii": ((0.0, 0.0), (5.0, 0.0)),
    "iv": ((5.0 * (1 - 10000) / 10001, 0.0), (10.0 / 10001, 0.0)),
    "v": ((5.0 * (10000 - 1) / 10001, 0.0), (5.0 * 20000 / 10001, 0.0)),
    "vi": ((1.25, -1.25 * ROOT), (3.75, 1.25 * ROOT)),
}


@pytest.mark.parametrize("case", SIX)
def test_velocities_after_the_thesis_impacts(case: str, capsys: pytest.CaptureFixture[str]) -> None:
    """By `pinjoint run`."""
    assert main(["run", f"collision_{case}", "--at", "0.2", "--format", "json"]) == 0
    final = json.loads(capsys.readouterr().out)["states"][-1]
    assert final["collisions"] == 1
    for particle, expected in zip(final["particles"].values(), SIX[case], strict=True):
        assert particle["velocity"] == pytest.approx(expected, rel=1e-12, abs=1e-12)
    assert final["energy"]["imbalance"] == pytest.approx(0.0, abs=1e-12)
