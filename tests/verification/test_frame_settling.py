"""Settling of frames in exact geometry: energy minimised by the slow reference, elastica, circles, and states on the way."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from components.model import Model
from game.documents.models import parse
from systems.statics.settle import settle
from systems.statics.state import StaticState, apply
from tests.reference import frames
from tests.reference.models import model
from tests.verification.test_frame_theory import random_frame

EI, LENGTH = 1000.0, 10.0


def cantilever(parts: int, tip: dict[str, Any], slenderness: float = 1e4, **facts: Any) -> Model:
    """A cantilever along x of equal rods, clamped at its left end; slenderness: EA L²/EI."""
    particles: list[dict[str, Any]] = [
        {"name": f"P{i}", "position": [LENGTH * i / parts, 0.0]} for i in range(parts + 1)
    ]
    particles[0] |= {"fixed": [True, True], "fixed_rotation": True}
    particles[-1] |= tip
    stiff = {"stiffness": EI * slenderness / LENGTH**2, "bending_stiffness": EI, **facts}
    rods = [{"name": f"R{i}", "between": [f"P{i}", f"P{i + 1}"], **stiff} for i in range(parts)]
    return parse(model(particles, rods) | {"settings": {"collisions": False}})


def held_by_reference(loaded: Model, state: StaticState, within: float) -> None:
    """The slow reference finds no force out of balance but the reactions."""
    apply(loaded, state)
    force, moment = frames.forces(loaded)
    particles = loaded.particles
    size = max(float(np.abs(state.axial_force).max()), float(np.abs(particles.constant_force).max()))
    rigid = particles.inertia > 0.0
    assert np.abs(np.where(particles.fixed, -force, 0.0) - state.reaction).max() < within * size
    assert np.abs(
        np.where(particles.fixed_rotation & rigid, -moment, 0.0) - state.reaction_moment * rigid
    ).max() < (within * size)
    assert np.abs(force[~particles.fixed]).max(initial=0.0) < within * size
    assert np.abs(moment[particles.turning > 0.0]).max(initial=0.0) < within * size


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_random_frames_are_in_balance_by_the_slow_reference(seed: int) -> None:
    document = random_frame(seed)
    document["settings"] = {"collisions": False}
    loaded = parse(document)
    found = settle(loaded).final
    if found.balanced:
        held_by_reference(loaded, found, 2e-11)


@pytest.mark.parametrize("number", range(4))
def test_settled_is_where_the_energy_is_least(number: int) -> None:
    """A portal with a hinge, a bar, warmth, a settlement, and loads under which it moves far."""
    lot = np.random.default_rng([73, number])
    clamp = {"fixed": [True, True], "fixed_rotation": True}
    particles = [
        {"name": "A", "position": [0.0, 0.0], **clamp, "rotation": float(lot.normal(0.0, 0.02))},
        {"name": "B", "position": [0.0, 3.0], "force": lot.normal(0.0, 60.0, 2).tolist()},
        {"name": "C", "position": [4.0, 3.5], "moment": float(lot.normal(0.0, 50.0))},
        {"name": "D", "position": [4.0, 0.0], **clamp, "displacement": lot.normal(0.0, 0.02, 2).tolist()},
    ]
    rods: list[dict[str, Any]] = [
        {"name": "AB", "between": ["A", "B"], "temperature_gradient": 60.0, "temperature_change": 40.0},
        {"name": "BC", "between": ["B", "C"], "hinged": [number % 2 == 1, False]},
        {"name": "CD", "between": ["C", "D"]},
    ]
    for rod in rods:
        rod |= {
            "stiffness": 2e4,
            "bending_stiffness": 400.0,
            "distributed_force": lot.normal(0.0, 8.0, 2).tolist(),
        }
    loaded = parse(model(particles, [*rods, {"name": "BD", "between": ["B", "D"], "stiffness": 20.0}]))
    found = settle(loaded).final
    assert found.status == "equilibrium"
    assert np.abs(found.rotation).max() > 0.01
    apply(loaded, found)
    displacement, rotation = frames.least_energy(loaded)
    assert found.displacement == pytest.approx(displacement, abs=1e-9 * np.abs(displacement).max())
    assert found.rotation == pytest.approx(rotation, abs=1e-9 * np.abs(rotation).max())


@pytest.mark.parametrize("parts", [2, 5, 12])
@pytest.mark.parametrize("turns", [1, 4])
def test_an_end_moment_rolls_a_cantilever_into_circles(parts: int, turns: int) -> None:
    """M = 2πEI/L for each turn: it closes, without axial forces, whatever the number of rods that divide a turn."""
    rolled = cantilever(turns * parts, {"moment": 2.0 * math.pi * turns * EI / LENGTH})
    found = settle(rolled).final
    assert found.status == "equilibrium"
    assert found.displacement[-1] == pytest.approx([-LENGTH, 0.0], abs=1e-14 * LENGTH)
    assert found.rotation[-1] == pytest.approx(2.0 * math.pi * turns, rel=1e-14)
    assert found.reaction_moment[0] == pytest.approx(-2.0 * math.pi * turns * EI / LENGTH, rel=1e-12)
    moment = found.diagrams["bending_moment"]
    assert moment == pytest.approx(2.0 * math.pi * turns * EI / LENGTH, rel=1e-12)


def elastica(load: float) -> tuple[float, float]:
    """Tip displacement/L of an inextensible cantilever under a tip force across, load = PL²/EI: θ'' = load cos θ."""

    def along(curvature: float) -> np.ndarray:
        def rates(_: float, state: np.ndarray) -> tuple[float, ...]:
            angle, bend = state[:2]
            return bend, load * math.cos(angle), math.cos(angle), math.sin(angle)

        path = solve_ivp(rates, (0.0, 1.0), (0.0, curvature, 0.0, 0.0), "DOP853", rtol=1e-12, atol=1e-13)
        return path.y[:, -1]

    x, y = along(brentq(lambda curvature: along(curvature)[1], -math.sqrt(2.0 * load), 0.0, xtol=1e-13))[2:]
    return x - 1.0, y


@pytest.mark.parametrize(("parts", "error"), [(2, 2.5e-3), (4, 1.8e-4), (8, 1.3e-5), (16, 1.0e-6)])
def test_a_cantilever_bends_like_the_elastica(parts: int, error: float) -> None:
    bent = cantilever(parts, {"force": [0.0, -5.0 * EI / LENGTH**2]}, slenderness=1e8)
    found = settle(bent).final
    assert found.status == "equilibrium"
    assert math.dist(found.displacement[-1] / LENGTH, elastica(5.0)) < 1.1 * error
