"""The stable step: the bounds of frequency and damping hold, are close, and are the ones that matter."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from pinjoint import Session
from pinjoint.components.model import Model
from pinjoint.documents import models
from pinjoint.systems.physics.spectrum import spectrum
from tests.reference.elements import Model as Document
from tests.reference.models import chain, model, oscillator, particle, rod, square, triangle

Matrix = NDArray[np.float64]


def lattice(columns: int, rows: int, seed: int = 0, **properties: float) -> Document:
    """A braced grid with uneven places and stiffnesses, pinned at the left."""
    random = np.random.default_rng(seed)
    nodes = [
        particle(
            f"{i},{j}", i + random.uniform(-0.2, 0.2), j + random.uniform(-0.2, 0.2), fixed=[i == 0, i == 0]
        )
        for i in range(columns)
        for j in range(rows)
    ]
    ties = [(1, 0), (0, 1), (1, 1), (1, -1)]
    members = [
        rod(f"{i},{j}", f"{i + a},{j + b}", stiffness=1e4 * random.uniform(0.2, 5.0), **properties)
        for i in range(columns)
        for j in range(rows)
        for a, b in ties
        if i + a < columns and 0 <= j + b < rows
    ]
    return model(nodes, members)


def dense(made: Model, along: Matrix, across: Matrix) -> Matrix:
    """M^-½ K M^-½ from 2 × 2 blocks, rod by rod, in the present state."""
    nodes, rods = made.particles, made.rods
    matrix = np.zeros((nodes.count, 2, nodes.count, 2))
    present = nodes.position + nodes.displacement
    for (a, b), k, g in zip(rods.between.astype(int), along, across, strict=True):
        n = (present[b] - present[a]) / np.linalg.norm(present[b] - present[a])
        block = k * np.outer(n, n) + g * (np.eye(2) - np.outer(n, n))
        for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
            matrix[i, :, j, :] += sign * block
    root = np.sqrt(nodes.mobility).ravel()
    return root[:, None] * matrix.reshape(2 * nodes.count, -1) * root


DOCUMENTS = {
    "oscillator": oscillator(100.0, 0.3),
    "triangle": triangle(),
    "square": square(),
    "chain": chain(12, 4000.0, 2.0),
    "lattice": lattice(9, 7, damping=2.0),
    "long lattice": lattice(60, 2, seed=1, damping=0.01),
    "one stiff rod among many": lattice(12, 8, seed=2),
    "flat": lattice(4, 4, seed=3) | {"environment": {"drag": 12.0}},
}
DOCUMENTS["one stiff rod among many"]["rods"][77]["stiffness"] = 1e7


@pytest.mark.parametrize("document", list(DOCUMENTS.values()), ids=list(DOCUMENTS))
def test_bounds_are_safe_and_close(document: Document) -> None:
    """At least the largest eigenvalue of M⁻¹K and M⁻¹C, at most 10 % more (5 % in ω)."""
    made = models.load(document)
    found = spectrum(made, np.zeros(made.rods.count))
    nothing = np.zeros(made.rods.count)
    stiffness = np.linalg.eigvalsh(dense(made, made.rods.stiffness / made.rods.rest_length, nothing))[-1]
    damping = np.linalg.eigvalsh(dense(made, made.rods.damping, nothing))[-1] + made.environment.drag
    assert math.sqrt(stiffness) * (1 - 1e-12) <= found.frequency <= 1.05 * math.sqrt(stiffness)
    assert damping / 2 * (1 - 1e-12) <= found.decay <= 1.1 * damping / 2


def test_tension_makes_rods_stiff_sideways() -> None:
    """N/L across the axis of a rod that is stretched: it decides once ε > 1."""
    stretched = model(
        [particle("A", 0, 0, fixed=[True, True]), particle("B", 1, 0, displacement=[4, 0], mass=1)],
        [rod("A", "B", stiffness=10.0, damping=0)],
    )
    session = Session.open(stretched)
    found = spectrum(session.model, session.rods.axial_force)
    across = session.rods["AB"].axial_force / session.rods["AB"].length
    assert found.frequency >= math.sqrt(1000.0 * max(10.0, across))
    assert found.frequency <= math.sqrt(1000.0 * session.rods["AB"].axial_force)


def test_without_rods_only_drag_limits_the_step() -> None:
    session = Session.open(
        model([particle("p", 0, 0)], [], environment={"drag": 50.0}, settings={"integrator": "velocity_verlet"})
    )
    session.simulation.advance(0)
    assert session.simulation.step_size.stable == pytest.approx(2.0 / 50.0, rel=1e-12)
    session = Session.open(model([particle("p", 0, 0)], []))
    session.simulation.advance(0)
    assert session.simulation.step_size.stable == math.inf


@pytest.mark.parametrize("zeta", [0.0, 0.1, 1.0, 10.0])
def test_the_limit_of_verlet_is_the_formula(zeta: float) -> None:
    """(2/ω) (√(1+ζ²) − ζ)."""
    session = Session.open(oscillator(100.0, zeta) | {"settings": {"integrator": "velocity_verlet"}})
    session.simulation.advance(0)
    assert session.simulation.step_size.stable == pytest.approx(
        0.02 * (math.sqrt(1 + zeta**2) - zeta), rel=1e-9
    )


def test_every_direction_of_a_rod_is_seen() -> None:
    """ω = √(2 k/m) of a free rod, wherever it points."""
    for angle in range(0, 180, 15):
        x, y = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        nodes = [particle("A", 0, 0, mass=1), particle("B", round(x, 15), round(y, 15), mass=1)]
        made = models.load(model(nodes, [rod("A", "B", stiffness=5.0)]))
        assert spectrum(made, np.zeros(1)).frequency == pytest.approx(100.0, rel=1e-12), angle


@pytest.mark.parametrize("name", models.bundled())
def test_automatic_steps_of_bundled_models_are_stable(name: str) -> None:
    session = Session.open(name)
    session.simulation.advance(0)
    assert 0.0 < session.model.clock.step_size <= 0.9 * session.simulation.step_size.stable
    assert session.simulation.step_size.warning == ""
