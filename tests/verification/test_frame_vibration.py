"""Natural vibrations of frames: beams in closed form, with the order of convergence, and under axial force."""

import math
from typing import Any

import numpy as np
import pytest

from pinjoint.components.model import Model
from pinjoint.documents.models import parse
from pinjoint.systems.physics.bending import stiffness_matrix
from pinjoint.systems.statics.settle import settle
from pinjoint.systems.statics.vibration import Vibrations
from tests.reference import frames
from tests.reference.models import CLAMPED, PINNED, line

LENGTH, EA, EI, DENSITY = 2.0, 3e8, 10.0, 6.15  # so slender that its rotary inertia is nothing
SUPPORTS: dict[str, tuple[dict[str, Any], dict[str, Any], list[float]]] = {
    "cantilever": (CLAMPED, {}, [1.875104068711961, 4.694091132974175, 7.854757438237613]),
    "simply supported": (PINNED, {"fixed": [False, True]}, [math.pi, 2 * math.pi, 3 * math.pi]),
    "clamped": (CLAMPED, CLAMPED, [4.730040744862704, 7.853204624095838, 10.995607838001671]),
    "propped": (CLAMPED, {"fixed": [False, True]}, [3.926602312047919, 7.068582745628732, 10.210176122813031]),
}


def beam(parts: int, first: dict[str, Any], last: dict[str, Any]) -> Model:
    places = [(LENGTH * i / parts, 0.0) for i in range(parts + 1)]
    return parse(line(places, first, last, stiffness=EA, bending_stiffness=EI, density=DENSITY))


@pytest.mark.parametrize("name", SUPPORTS)
def test_beams_vibrate_as_in_textbooks(name: str) -> None:
    """ω = k² √(EI/ρ)/L²; half a rod's mass at a free tip makes it lower to second order, else the error is of fourth."""
    first, last, roots = SUPPORTS[name]
    expected = np.array(roots) ** 2 * math.sqrt(1000.0 * EI / DENSITY) / LENGTH**2 / (2.0 * math.pi)
    order = 2.0 if name == "cantilever" else 4.0
    errors = [np.abs(Vibrations.of(beam(parts, first, last)).hertz[:3] / expected - 1.0) for parts in (16, 32)]
    assert (errors[1] < (0.007 if name == "cantilever" else 2e-5)).all()
    assert np.log2(errors[0] / errors[1])[2] == pytest.approx(order, abs=0.25)


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
    """All frequencies against dense eigenvalues of what the time step is chosen by, with rotational inertia."""
    lot = np.random.default_rng([57, number])
    document = frames.random_frame(lot, 4, loaded=False, warm=False)
    for particle in document["particles"]:
        particle |= {"displacement": [0.0, 0.0], "rotation": 0.0}
    for rod in document["rods"]:
        del rod["rest_length"]
    made = parse(document)
    matrix, _ = stiffness_matrix(made, by_mass=True)
    values = np.sort(np.linalg.eigvalsh(matrix))
    found = np.sort(Vibrations.of(made).angular_squared)
    moving = values > 1e-6 * values.max()
    assert found[-moving.sum() :] == pytest.approx(values[moving], rel=1e-6)


def test_compression_lets_a_beam_swing_more_slowly_and_tension_faster() -> None:
    """ω² = ω₀² (1 + N L²/π²EI) of a simply supported beam."""
    critical = math.pi**2 * EI / LENGTH**2
    plain = Vibrations.of(beam(16, *SUPPORTS["simply supported"][:2])).angular_squared[0]
    for share in (-0.9, -0.5, 2.0):
        last = SUPPORTS["simply supported"][1] | {"force": [share * critical, 0.0]}
        loaded = beam(16, PINNED, last)
        found = Vibrations.of(loaded, settle(loaded).final).angular_squared[0]
        assert found / plain == pytest.approx(1.0 + share, abs=4e-3)


@pytest.mark.parametrize("name", SUPPORTS)
def test_rods_that_would_vibrate_between_their_ends_are_named(name: str) -> None:
    """Without a word, the frequency is within 5 %."""
    first, last, roots = SUPPORTS[name]
    expected = roots[0] ** 2 * math.sqrt(1000.0 * EI / DENSITY) / LENGTH**2 / (2.0 * math.pi)
    said = {parts: Vibrations.of(beam(parts, first, last)) for parts in (1, 2, 3, 4, 6, 8)}
    # also where no end can move, and no frequency is left
    assert "Rod R0 bends more between its ends" in said[1].note
    assert not said[8].note
    assert (len(said[1].hertz) == 0) == (name == "clamped")
    assert all(abs(found.hertz[0] / expected - 1.0) < 0.05 for found in said.values() if not found.note)
