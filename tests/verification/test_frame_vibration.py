"""Natural vibrations of frames: beams in closed form, with the order of convergence, and under axial force."""

import math
from typing import Any

import numpy as np
import pytest

from pinjoint.components.model import Model
from pinjoint.documents import models
from pinjoint.documents.models import load, parse
from pinjoint.systems.physics.bending import stiffness_matrix
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.vibration import Vibrations
from tests.reference import frame_theory, frames
from tests.reference.models import CLAMPED, PINNED, line

LENGTH, EA, EI, DENSITY = 2.0, 3e5, 10.0, 6.15
SUPPORTS: dict[str, tuple[dict[str, Any], dict[str, Any], list[float]]] = {
    "cantilever": (CLAMPED, {}, [1.875104068711961, 4.694091132974175, 7.854757438237613]),
    "simply supported": (PINNED, {"fixed": [False, True]}, [math.pi, 2 * math.pi, 3 * math.pi]),
    "clamped": (CLAMPED, CLAMPED, [4.730040744862704, 7.853204624095838, 10.995607838001671]),
    "propped": (CLAMPED, {"fixed": [False, True]}, [3.926602312047919, 7.068582745628732, 10.210176122813031]),
}


def beam(parts: int, first: dict[str, Any], last: dict[str, Any]) -> Model:
    places = [(LENGTH * i / parts, 0.0) for i in range(parts + 1)]
    return parse(line(places, first, last, stiffness=EA, bending_stiffness=EI, density=DENSITY))


def closed(name: str) -> Any:
    """The frequencies (Hz) by ω = k² √(EI/ρ)/L²."""
    return np.array(SUPPORTS[name][2]) ** 2 * math.sqrt(1000.0 * EI / DENSITY) / LENGTH**2 / (2.0 * math.pi)


@pytest.mark.parametrize("name", SUPPORTS)
def test_beams_vibrate_as_in_textbooks(name: str) -> None:
    """One rod is enough for 1.4e-3 (0.3e-3 of a simple beam), and errors fall with the fourth power of its parts."""
    first, last, _ = SUPPORTS[name]
    assert Vibrations.of(beam(1, first, last)).hertz[0] == pytest.approx(closed(name)[0], rel=1.4e-3)
    errors = [Vibrations.of(beam(parts, first, last)).hertz[:3] / closed(name) - 1.0 for parts in (8, 16)]
    assert (errors[0] > 0.0).all()  # Rayleigh's quotient of cubics
    assert errors[0][0] < 1e-4
    assert np.log2(errors[0] / errors[1])[:2] == pytest.approx(4.0, abs=0.1)


def test_a_simple_beam_of_one_rod() -> None:
    """An IPE 200 of 6 m: f = π/2 √(EI/ρ)/L², and what motion in time has instead is named beside it."""
    model = parse(line([(0.0, 0.0), (6.0, 0.0)], *SUPPORTS["simply supported"][:2], section="IPE 200"))
    rod, found = model.rods[0], Vibrations.of(model)
    exact = math.pi / 2.0 * math.sqrt(1000.0 * rod.bending_stiffness / rod.density) / 36.0
    assert found.hertz[0] == pytest.approx(exact, rel=3e-4)
    assert found.lumped == pytest.approx(158.4, abs=0.1)
    assert "its lowest frequency is 158.4 Hz" in found.note


@pytest.mark.parametrize("name", SUPPORTS)
def test_modes_that_are_told_are_close(name: str) -> None:
    """Within 2 %, whatever the number of rods; and where one rod has no end that moves, there still are some."""
    first, last, _ = SUPPORTS[name]
    for parts in (1, 2, 3, 5):
        found = Vibrations.of(beam(parts, first, last)).hertz
        told = min(len(found), 3)
        assert told >= 2
        assert found[:told] == pytest.approx(closed(name)[:told], rel=0.02)


@pytest.mark.parametrize(
    ("hinged", "root"), [((True, True), math.pi), ((True, False), 3.9266023), ((False, True), 3.9266023)]
)
def test_hinged_ends_turn_by_themselves(hinged: tuple[bool, bool], root: float) -> None:
    model = beam(1, CLAMPED, CLAMPED)
    model.rods[0].hinged = hinged
    omega = root**2 * math.sqrt(1000.0 * EI / DENSITY) / LENGTH**2
    assert Vibrations.of(model).angular_squared[0] == pytest.approx(omega**2, rel=2e-3)


def test_a_mass_at_the_tip_of_a_cantilever() -> None:
    """1 + cos k cosh k + (M/m) k (cos k sinh k − sin k cosh k) = 0; with a tip as heavy as the beam, k = 1.247917."""
    model = beam(1, CLAMPED, {"mass": DENSITY * LENGTH})
    omega = 1.2479174**2 * math.sqrt(1000.0 * EI / DENSITY) / LENGTH**2
    assert Vibrations.of(model).angular_squared[0] == pytest.approx(omega**2, rel=1e-4)


@pytest.mark.parametrize("number", range(6))
def test_random_frames_against_a_fine_mesh(number: int) -> None:
    """The textbook's matrices with as many parts give the same where all ends are rigid; 16 give the lowest to 0.2 %."""
    lot = np.random.default_rng([91, number])
    document = frames.random_frame(lot, 4, loaded=False, warm=False)
    for place, particle in enumerate(document["particles"]):
        particle |= {"displacement": [0.0, 0.0], "rotation": 0.0}
        particle |= CLAMPED if place == 0 else {"mass": 5.0} if place == 1 else {}
    for rod in document["rods"]:
        del rod["rest_length"]
        rod |= {} if number % 2 else {"hinged": [False, False], "end_springs": [0.0, 0.0]}
    found = Vibrations.of(parse(document)).angular_squared
    if number % 2 == 0:
        all_found = frame_theory.natural_frequencies(document, 4)
        # Of a dense eigenvalue problem, which depends on the machine.
        rounding = np.finfo(float).eps * all_found[-1]
        assert found == pytest.approx(all_found[: len(found)], rel=1e-7, abs=rounding)
    fine = frame_theory.natural_frequencies(document, 16)[: len(found)]
    assert found[0] == pytest.approx(fine[0], rel=4e-3)
    assert found == pytest.approx(fine, rel=0.045)


def test_a_portal_against_a_fine_mesh() -> None:
    document = models.document(load("portal"))
    found = Vibrations.of(load("portal")).angular_squared
    assert len(found) == 3
    assert found == pytest.approx(frame_theory.natural_frequencies(document, 12)[:3], rel=0.01)
    assert found[0] == pytest.approx(frame_theory.natural_frequencies(document, 12)[0], rel=1e-4)


def test_the_mode_of_a_cantilever() -> None:
    """cosh − cos − σ (sinh − sin), and its slope."""
    parts = 40
    mode = Vibrations.of(beam(parts, CLAMPED, {})).modes[0]
    mode = mode / mode[-1, 1]
    k = 1.875104068711961
    sigma = (math.cosh(k) + math.cos(k)) / (math.sinh(k) + math.sin(k))
    z = k * np.arange(parts + 1) / parts
    shape = np.cosh(z) - np.cos(z) - sigma * (np.sinh(z) - np.sin(z))
    slope = k / LENGTH * (np.sinh(z) + np.sin(z) - sigma * (np.cosh(z) - np.cos(z)))
    assert mode[:, 1] == pytest.approx(shape / shape[-1], abs=1e-3)
    assert mode[:, 2] == pytest.approx(slope / shape[-1], abs=1e-3)


@pytest.mark.parametrize("number", range(4))
def test_random_frames_against_the_operator_of_the_stable_step(number: int) -> None:
    """What is told of motion in time, against dense eigenvalues of what the time step is chosen by."""
    lot = np.random.default_rng([57, number])
    document = frames.random_frame(lot, 4, loaded=False, warm=False)
    for particle in document["particles"]:
        particle |= {"displacement": [0.0, 0.0], "rotation": 0.0}
    for rod in document["rods"]:
        del rod["rest_length"]
    made = parse(document)
    matrix, _ = stiffness_matrix(made, by_mass=True)
    values = np.sort(np.linalg.eigvalsh(matrix))
    moving = values[values > 1e-6 * values.max()]
    assert Vibrations.of(made).lumped == pytest.approx(math.sqrt(moving[0]) / (2.0 * math.pi), rel=1e-6)


def test_compression_lets_a_beam_swing_more_slowly_and_tension_faster() -> None:
    """ω² = ω₀² (1 + N L²/π²EI) of a simply supported beam."""
    critical = math.pi**2 * EI / LENGTH**2
    plain = Vibrations.of(beam(16, *SUPPORTS["simply supported"][:2])).angular_squared[0]
    for share in (-0.9, -0.5, 2.0):
        last = SUPPORTS["simply supported"][1] | {"force": [share * critical, 0.0]}
        loaded = beam(16, PINNED, last)
        found = Vibrations.of(loaded, settle(loaded).final).angular_squared[0]
        assert found / plain == pytest.approx(1.0 + share, abs=4e-3)
