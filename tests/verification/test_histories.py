"""Loads that vary, on oscillators of one degree of freedom, against closed forms (F0 = k δ, ω² = k/m, T = 2π/ω)."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components import FieldError
from pinjoint.included.histories import read_record, shake
from tests.reference.models import model, particle, rod

STIFFNESS, MASS = 100.0, 100.0  # kN/m, kg
OMEGA = math.sqrt(1000.0 * STIFFNESS / MASS)
PERIOD = 2.0 * math.pi / OMEGA
FORCE = 2.0  # kN
STATIC = FORCE / STIFFNESS
FREQUENCY = 0.8 * OMEGA / (2.0 * math.pi)  # r = 0.8
DAMPING_RATIO = 0.1
RISE, PULSE = 0.7 * PERIOD, 0.3 * PERIOD

HISTORIES: dict[str, dict[str, Any]] = {
    "step": {"kind": "constant"},
    "ramp": {"kind": "ramp", "start": 0.0, "duration": RISE},
    "rise": {"kind": "table", "times": [0.0, RISE], "factors": [0.0, 1.0]},
    "pulse": {"kind": "pulse", "start": 0.0, "duration": PULSE},
    "sine": {"kind": "sine", "frequency": FREQUENCY},
    "record": {"kind": "record", "times": [0.0, 9.0], "accelerations": [1.0, 1.0]},
}


def oscillators() -> dict[str, Any]:
    """One for each history, side by side: a mass on a rod along x; only the one under the sine is damped."""
    particles, rods, loads = [], [], []
    for row, (name, history) in enumerate(HISTORIES.items()):
        particles += [
            particle(f"{name} support", 0.0, row, fixed=[True, True]),
            particle(name, 1.0, row, fixed=[False, True], mass=MASS),
        ]
        ratio = DAMPING_RATIO if name == "sine" else 0.0
        damping = 2.0 * ratio * math.sqrt(1000.0 * STIFFNESS * MASS) / 1000.0
        rods.append(rod(f"{name} support", name, stiffness=STIFFNESS, damping=damping))
        loads.append({"on": name, "force": [FORCE, 0.0], "history": history})
    settings = {"time_step": 1e-05, "integrator": "velocity_verlet", "collisions": False}
    return model(particles, rods, settings=settings, loads=loads)


def only(name: str, history: dict[str, Any], **settings: Any) -> Session:
    """The oscillator of this name alone, under another history."""
    document, row = oscillators(), [*HISTORIES].index(name)
    return Session.open(
        model(
            document["particles"][2 * row : 2 * row + 2],
            document["rods"][row : row + 1],
            settings=settings,
            loads=[document["loads"][row] | {"history": history}],
        )
    )


@pytest.fixture(scope="module")
def session() -> Session:
    return Session.open(oscillators())


def at(session: Session, time: float, name: str) -> float:
    """The displacement at a time, over the static one."""
    session.restart()
    session.run(time=time)
    found: float = session.particles[name].displacement[0] / STATIC
    return found


def test_a_load_applied_at_once_doubles_the_displacement(session: Session) -> None:
    assert at(session, PERIOD / 2.0, "step") == pytest.approx(2.0, rel=1e-7)


@pytest.mark.parametrize("name", ["ramp", "rise"])
def test_the_largest_response_to_a_ramp(session: Session, name: str) -> None:
    """1 + |sin(π t_r / T)| / (π t_r / T); after t_r: u = 1 + [sin ω(t − t_r) − sin ωt] / (ω t_r)."""
    x = math.pi * RISE / PERIOD
    middle = RISE / 2.0 + PERIOD * 0.5  # where cos ω(t − t_r/2) = −1
    assert at(session, middle, name) == pytest.approx(1.0 + math.sin(x) / x, rel=1e-6)


def test_the_largest_response_to_a_pulse(session: Session) -> None:
    """2 sin(π t_d / T) for t_d ≤ T/2, at t_d/2 + T/4. Its edges fall within a step: an error of order h/T."""
    expected = 2.0 * math.sin(math.pi * PULSE / PERIOD)
    assert at(session, PULSE / 2.0 + PERIOD / 4.0, "pulse") == pytest.approx(expected, rel=2e-4)


@pytest.mark.parametrize("integrator", ["dop853", "esdirk4"])
def test_a_load_may_jump_while_everything_is_at_rest(integrator: str) -> None:
    """The same response as above, later; no displacement tells yet what an error is relative to."""
    start = 0.7
    late = only("pulse", HISTORIES["pulse"] | {"start": start}, integrator=integrator)
    assert late.run(time=start + PULSE / 2.0 + PERIOD / 4.0) == "time reached", late.message
    expected = 2.0 * math.sin(math.pi * PULSE / PERIOD)
    assert late.particles["pulse"].displacement[0] / STATIC == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("integrator", ["velocity_verlet", "semi_implicit_euler", "taylor2"])
@pytest.mark.parametrize("share", [0.17, 0.31, 0.47])
def test_the_work_of_a_load_that_jumps_within_the_first_step(integrator: str, share: float) -> None:
    """Force × displacement: nothing moves before. Of the piece after the jump no half is lost to rounding."""
    step = 3.1e-5
    jump = {"kind": "ramp", "start": share * step, "duration": 0.0}
    session = only("pulse", jump, integrator=integrator, time_step=step)
    session.run(steps=3)
    moved = session.particles["pulse"].displacement[0]
    assert moved > 0.0
    assert session.energy.work == pytest.approx(1000.0 * session.loads[0].force[0] * moved, rel=1e-9)


@pytest.mark.parametrize("integrator", ["velocity_verlet", "semi_implicit_euler", "taylor2"])
def test_a_load_may_grow_from_nothing_while_everything_is_at_rest(integrator: str) -> None:
    """After the first step of Euler and Taylor the load acts, but has moved nothing yet: no alarm."""
    growing = {"kind": "ramp", "start": 0.0, "duration": 0.01}
    session = only("pulse", growing, integrator=integrator, time_step=3.1e-5)
    assert session.run(steps=100) == "time reached", session.message


@pytest.mark.parametrize(
    "settings",
    [{"integrator": "velocity_verlet", "time_step": 5e-5}, {"integrator": "dop853"}],
    ids=lambda settings: settings["integrator"],
)
def test_the_steady_response_to_a_sine(settings: dict[str, Any]) -> None:
    """Amplitude 1/√((1 − r²)² + (2ξr)²), phase atan(2ξr / (1 − r²)) behind the load.

    After 24 periods of the load, what it began with is e^(−ξωt) = 5e-9 of that.
    """
    session = only("sine", HISTORIES["sine"], **settings)
    r = 2.0 * math.pi * FREQUENCY / OMEGA
    amplitude = 1.0 / math.hypot(1.0 - r * r, 2.0 * DAMPING_RATIO * r)
    phase = math.atan2(2.0 * DAMPING_RATIO * r, 1.0 - r * r)
    time = (24.0 + phase / (2.0 * math.pi) + 0.25) / FREQUENCY
    assert at(session, time, "sine") == pytest.approx(amplitude, rel=1e-6)


def test_a_record_is_multiplied_with_its_accelerations(session: Session) -> None:
    """With an acceleration of 1 m/s² and a force of m·1 it is the step; here the force is F0."""
    assert at(session, PERIOD / 2.0, "record") == pytest.approx(2.0, rel=1e-7)


def test_loads_count_in_statics_as_documented(session: Session) -> None:
    session.restart()
    session.settle()
    found = {name: session.particles[name].displacement[0] / STATIC for name in HISTORIES}
    expected = {"step": 1.0, "ramp": 1.0, "rise": 1.0, "pulse": 0.0, "sine": 0.0, "record": 0.0}
    assert found == pytest.approx(expected, abs=1e-12)
    assert session.time < math.inf  # though the sine never ends
    session.run(steps=10)
    assert session.time < math.inf
    session.undo()
    session.undo()


def test_a_table_may_be_of_numpy() -> None:
    session = Session.open(oscillators())
    load = session.loads[0]
    load.history = {"kind": "table", "times": np.linspace(0.0, 1.0, 3), "factors": np.array([0, 1, 0])}
    assert load.history == {"kind": "table", "times": (0.0, 0.5, 1.0), "factors": (0.0, 1.0, 0.0)}
    with pytest.raises(FieldError, match="times of the history is"):
        load.history = {"kind": "table", "times": np.float64(1.0), "factors": [1.0]}


# --- base acceleration ---------------------------------------------------------------------------------------


def test_shaken_supports_move_the_mass_as_an_acceleration_does(tmp_path: Path) -> None:
    """Relative to the supports, a constant base acceleration a is a force −m a: −(m a/k)(1 − cos ωt)."""
    (tmp_path / "record.csv").write_text("time,acc\n0,0.05\n1,0.05\n9,0.05\n", encoding="utf-8")
    still = oscillators() | {"loads": []}
    session = Session.open(still)
    record = read_record(tmp_path / "record.csv", unit=9.80665)
    shake(session.model, record)
    shake(session.model, record)  # again: replaces
    assert session.loads.count == len(HISTORIES)
    session.run(time=PERIOD / 2.0)
    expected = -2.0 * MASS * 0.05 * 9.80665 / 1000.0 / STIFFNESS
    assert session.particles["step"].displacement[0] == pytest.approx(expected, rel=1e-7)


def test_shake_writes_a_model_with_the_record(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    record, made = tmp_path / "record.csv", tmp_path / "shaken.json"
    record.write_text("0,0\n0.5,1\n1,0\n", encoding="utf-8")
    assert main(["shake", "isostatic", str(record), "--direction", "y", "--output", str(made)]) == 0
    session = Session.open(made)
    assert session.loads[0].history["accelerations"] == (0.0, 1.0, 0.0)
    assert session.loads[0].force[1] == pytest.approx(-session.loads[0].particle.mass / 1000.0)
    record.write_text("0,0\nhalf,1\n", encoding="utf-8")
    assert main(["shake", "isostatic", str(record), "--output", str(made)]) == 2
    assert "line 2: ['half', '1'] is not a time" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("history", "said"),
    [
        ({"kind": "sine", "frequency": 0.0}, "must be above 0 Hz"),
        ({"kind": "pulse", "duration": 0.0}, "must be above 0 s"),
        ({"kind": "table", "times": [0.0, 1.0], "factors": [0.0]}, "2 times and 1 values"),
        ({"kind": "table", "times": [0.0, 0.0], "factors": [0.0, 1.0]}, "must ascend"),
        ({"kind": "record", "times": [], "accelerations": []}, "0 times"),
    ],
)
def test_a_history_that_makes_no_sense_is_refused(history: dict[str, Any], said: str) -> None:
    session = Session.open(oscillators())
    with pytest.raises(FieldError, match=said):
        session.loads[0].history = history


def test_a_table_is_linear_between_its_points_and_constant_outside() -> None:
    from pinjoint.systems.loads.kernels import interpolated

    values = np.array([9.0, 3.0, 0.0, 1.0, 3.0, 3.0, 5.0, 7.0, -1.0])
    found = [interpolated(t, values, 1) for t in (-1.0, 0.0, 0.25, 1.0, 2.0, 2.5, 3.0, 4.0)]
    assert found == [5.0, 5.0, 5.5, 7.0, 3.0, 1.0, -1.0, -1.0]
