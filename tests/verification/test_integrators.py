"""Every integrator: observed order, tolerance met, stability and energy, against closed forms and scipy."""

import math

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.systems.physics.integrators import INTEGRATORS
from tests.benchmarks import accuracy, problems
from tests.reference.closed_forms import free_vibration
from tests.reference.elements import Model
from tests.reference.models import oscillator

OMEGA, ZETA, SPEED = 2 * math.pi, 0.3, 0.1
ADAPTIVE = [name for name, integrator in INTEGRATORS.items() if integrator.estimates_error]
# Steps in one period: coarse enough that the error is above round-off, fine enough that its first term leads.
COARSEST = {"dop853": 4, "esdirk4": 16, "rk4": 16}


def run(document: Model, end: float, **settings: object) -> Session:
    session = Session.open(document | {"settings": settings})
    assert session.run(time=end) == "time reached"
    return session


@pytest.mark.parametrize("integrator", list(INTEGRATORS))
def test_the_error_falls_with_the_order_that_is_stated(integrator: str) -> None:
    exact, _ = free_vibration(1.0, OMEGA, ZETA, 0.0, SPEED)
    fewest = COARSEST.get(integrator, 64)
    errors = []
    for steps in (fewest, 2 * fewest, 4 * fewest):
        document = oscillator(OMEGA, ZETA, velocity=[SPEED, 0])
        session = run(document, 1.0, integrator=integrator, time_step=1.0 / steps)
        errors.append(abs(session.particles["B"].displacement[0] - exact))
    observed = math.log2(errors[1] / errors[2])
    assert observed == pytest.approx(INTEGRATORS[integrator].order, abs=0.35), errors


@pytest.mark.parametrize("integrator", ADAPTIVE)
def test_the_tolerance_is_met_over_five_decades(integrator: str) -> None:
    """Of one period; the error of each step is what the tolerance limits, and steps add up."""
    exact, _ = free_vibration(1.0, OMEGA, ZETA, 0.0, SPEED)
    for tolerance in (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9):
        session = run(
            oscillator(OMEGA, ZETA, velocity=[SPEED, 0]), 1.0, integrator=integrator, tolerance=tolerance
        )
        error = abs(session.particles["B"].displacement[0] - exact) / (SPEED / OMEGA)
        assert error < 10 * tolerance, (tolerance, error)


@pytest.mark.parametrize("problem", [problems.transient(), problems.swinging(), problems.yielding_step()])
def test_default_settings_are_exact(problem: problems.Problem) -> None:
    exact = problem.exact()
    for settings, allowed in (({}, 1e-6), ({"tolerance": 1e-12}, 1e-10)):
        session = run(problem.document, problem.time, **settings)
        assert np.linalg.norm(session.particles.displacement - exact) < allowed * np.linalg.norm(exact)


@pytest.mark.parametrize("zeta", [0.0, 1.0, 1e3])
def test_the_implicit_integrator_is_stable_at_any_step(zeta: float) -> None:
    """A mass released from rest, in steps of up to ten periods, never goes farther."""
    for step in (0.1, 1.0, 10.0):
        document = oscillator(OMEGA, zeta, displacement=[0.001, 0])
        session = Session.open(document | {"settings": {"integrator": "esdirk4", "time_step": step}})
        for _ in range(5):
            session.run(steps=4)
            assert abs(session.particles["B"].displacement[0]) <= 0.001 * (1 + 1e-9)


def yielding_damped() -> Model:
    """A mass that yields while a ramp pulls, with a damper and drag: every entry of the account."""
    document = oscillator(OMEGA, 0.05, velocity=[0.2, 0])
    document["rods"][0] |= {"tensile_strength": 2e-3, "compressive_strength": 2e-3}
    document["loads"] = [{"on": "B", "force": [1e-3, 0], "history": {"kind": "ramp", "duration": 0.7}}]
    return document | {"environment": {"drag": 0.1}}


@pytest.mark.parametrize("integrator", list(INTEGRATORS))
def test_the_energy_account_closes_with_the_step(integrator: str) -> None:
    """By half the step the imbalance falls at least by half; with error control it is as small as the tolerance."""
    imbalances = []
    for steps in (500, 1000, 2000):
        energy = run(yielding_damped(), 1.0, integrator=integrator, time_step=1.0 / steps).energy
        assert min(energy.work, energy.dissipated_damping, energy.dissipated_plastic) > 1e-4
        imbalances.append(abs(energy.imbalance) / energy.initial)
    assert imbalances[-1] < 1e-2
    assert imbalances[-1] < 0.6 * imbalances[0] or imbalances[-1] < 1e-9
    if integrator in ADAPTIVE:
        energy = run(yielding_damped(), 1.0, integrator=integrator).energy
        assert abs(energy.imbalance) < 1e-7 * energy.initial


def test_the_benchmark_names_the_fastest_at_each_error() -> None:
    rows = [
        {"problem": "p", "method": "dop853", "value": 1e-9, "seconds": 2.0, "error": 1e-9},
        {"problem": "p", "method": "rk4", "value": 1e-3, "seconds": 1.0, "error": 1e-5},
        {"problem": "p", "method": "scipy LSODA", "value": 1e-6, "seconds": 10.0, "error": 1e-7},
    ]
    found = {row["error"]: row for row in accuracy.fastest(rows)}
    assert (found[1e-4]["ours"], found[1e-4]["ratio"]) == ("rk4", 10.0)
    assert (found[1e-6]["ours"], found[1e-6]["ratio"]) == ("dop853", 5.0)
    assert found[1e-10]["ours"] == "–"
