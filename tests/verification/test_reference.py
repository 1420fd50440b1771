"""The thesis' program against the reference of motion, which the program meets, and closed forms by other ways.

What moves and rests in tests/reference is held to textbooks by tests of the program: these meet the same closed forms and,
on generated models, the reference.
"""

import math
from copy import deepcopy

import numpy as np
import pytest

from tests.reference import closed_forms, models, physics, thesis


def rows(by_name: dict) -> np.ndarray:
    """Return the values of a dict by names as one array."""
    return np.array(list(by_name.values()))


def test_thesis_objects_agree_with_the_arrays():
    """Same scheme, in polar objects and in arrays: loads, weight, damping and yielding all at work."""
    model = models.square((0, -260), tensile_strength=100, compressive_strength=80, damping=30)
    model["environment"] = {"acceleration": [1.0, -9.81], "force": [0.5, 0.2]}
    ramp = {"kind": "ramp", "start": 1e-4, "duration": 1e-3}
    model["loads"] = [{"on": "B", "force": [40, 0], "history": ramp}]
    arrays = physics.taylor2(deepcopy(model), 1e-6, 1500)
    objects = thesis.taylor2(deepcopy(model), 1e-6, 1500)
    assert np.abs(rows(arrays["plastic_strain"])).max() > 1e-4
    for quantity in ("displacement", "velocity", "axial_force", "plastic_strain"):
        expected = rows(arrays[quantity])
        assert np.abs(rows(objects[quantity]) - expected).max() < 1e-9 * np.abs(expected).max()


def test_thesis_objects_follow_a_mass_whose_support_has_none():
    model = models.oscillator(2 * math.pi, mass=2.0, force=0.3)
    model["rods"][0]["density"] = 0
    arrays, objects = (scheme.taylor2(deepcopy(model), 1e-4, 300) for scheme in (physics, thesis))
    assert objects["displacement"]["B"] == pytest.approx(arrays["displacement"]["B"], rel=1e-9, abs=1e-15)


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
@pytest.mark.parametrize(("mass1", "mass2"), [(1, 1), (1, 1e4), (1e4, 1)])
def test_thesis_head_on_collisions(restitution: float, mass1: float, mass2: float):
    result = thesis.taylor2(models.two_discs(restitution, mass1, mass2), 1e-3, 120)
    expected = closed_forms.impact_velocities(mass1, mass2, 5.0, 0.0, restitution)
    assert rows(result["velocity"])[:, 0] == pytest.approx(np.array(expected), rel=1e-12, abs=1e-12)
    assert np.abs(rows(result["velocity"])[:, 1]).max() < 1e-14  # polar: a sine of π is not quite 0


def test_thesis_finds_an_oblique_contact_late():
    """Exact (1.25, −2.165) and (3.75, 2.165) m/s. Found up to v h cos 30° late, v₂ₓ = 5 (1 − (o/d)²) is low by
    up to 10 o²/d³ of that, 1.1e-3 m/s at h = 1e-5 s.
    """
    (v1, v2) = rows(thesis.taylor2(models.two_discs(1.0, offset=0.05), 1e-5, 9000)["velocity"])
    assert 0 < 3.75 - v2[0] < 1.1e-3
    assert v2[1] == pytest.approx(5 * math.sqrt(3) / 4, abs=1e-3)
    assert v1 + v2 == pytest.approx(np.array([5.0, 0.0]), abs=1e-12)


def test_free_vibration_is_continuous_across_critical_damping():
    for time in (0.1, 0.7, 2.0):
        critical = closed_forms.free_vibration(time, 3.0, 1.0, 0.2, -1.0)
        for zeta in (1 - 1e-9, 1 + 1e-9):
            assert closed_forms.free_vibration(time, 3.0, zeta, 0.2, -1.0) == pytest.approx(critical, rel=1e-6)


def test_galperin_contacts_digits_of_pi():
    """The formula gives the digits of π; for the first cases the impacts are also played through."""
    assert [closed_forms.galperin_contacts(k) for k in range(6)] == [3, 31, 314, 3141, 31415, 314159]
    for power in range(4):
        small, large, contacts = 0.0, -1.0, 0
        while small > large or small < 0:
            if small > large:
                small, large = closed_forms.impact_velocities(1.0, 100.0**power, small, large, 1.0)
            else:
                small = -small
            contacts += 1
        assert contacts == closed_forms.galperin_contacts(power)


def test_bouncing_ball_comes_to_rest_after_the_sum_of_its_flights():
    height, gravity, restitution = 2.0, 9.81, 0.6
    flights = [math.sqrt(2 * height / gravity)]
    for bounce in range(1, 100):
        peak = closed_forms.bounce_height(height, restitution, bounce)
        flights.append(2 * math.sqrt(2 * peak / gravity))
    assert sum(flights) == pytest.approx(closed_forms.bouncing_time(height, gravity, restitution), rel=1e-13)


def test_von_mises_numbers():
    """H = 1 m, b = 5 m, EA = 1280 MN: 3789.46 kN at 426.4 mm, landing at 2.1585 m."""
    limit, at_limit = closed_forms.von_mises_limit(1, 5, 1.28e6)
    assert limit == pytest.approx(3789.46, abs=0.005)
    assert at_limit == pytest.approx(0.4264, abs=5e-5)
    assert closed_forms.von_mises_dynamic_limit(1, 5, 1.28e6) == pytest.approx(2910.8, abs=0.05)
    landing = closed_forms.von_mises_landing(1, 5, 1.28e6)
    assert landing == pytest.approx(2.1585, abs=5e-5)
    assert closed_forms.von_mises_force(landing, 1, 5, 1.28e6) == pytest.approx(limit, rel=1e-12)
    for deflection in (0.2, at_limit, 1.4):
        slope = 1e-5
        work = closed_forms.von_mises_energy(deflection + slope, 1, 5, 1.28e6)
        work -= closed_forms.von_mises_energy(deflection - slope, 1, 5, 1.28e6)
        force = closed_forms.von_mises_force(deflection, 1, 5, 1.28e6)
        assert work / (2 * slope) == pytest.approx(force, rel=1e-8)


def test_three_bar_numbers():
    assert closed_forms.three_bar_first_yield(1.0) == pytest.approx(1.7071, abs=5e-5)
    assert closed_forms.three_bar_collapse(1.0) == pytest.approx(2.4142, abs=5e-5)
    assert closed_forms.three_bar_residual(1.0) == pytest.approx((-0.414, 0.293), abs=5e-4)


def test_period_of_a_pendulum_from_90_degrees():
    assert closed_forms.pendulum_period_ratio(math.pi / 2) == pytest.approx(1.18034, abs=5e-6)
