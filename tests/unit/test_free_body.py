"""Free bodies: the forces on joints and rods are in equilibrium."""

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.free_body import Apart, on_joint, on_rod

MODELS = ["isostatic", "hyperstatic", "braced_portal", "warren_bridge", "tower", "pendulum", "hanging_net"]


def sums(forces: list) -> tuple[float, float]:
    return sum(force.x for force in forces), sum(force.y for force in forces)


def largest(session: Session) -> float:
    particles = session.model.particles
    return max(
        np.abs(particles.applied_force).max(),
        np.abs(particles.reaction).max(),
        np.abs(Apart.of(session.model).pull).max(),
    )


@pytest.mark.parametrize("name", MODELS)
def test_settled_joints_are_in_equilibrium_without_inertia(name: str) -> None:
    session = Session.open(name)
    session.settle()
    for particle in session.model.particles:
        forces = on_joint(session.model, particle.row)
        assert not [force for force in forces if force.kind == "inertia"]
        assert sums(forces) == pytest.approx((0.0, 0.0), abs=1e-8 * largest(session))


@pytest.mark.parametrize("name", MODELS)
def test_supports_balance_rods_and_dampers_while_a_structure_moves(name: str) -> None:
    """Reactions are computed by the step program, the pulls of rods and dampers here: they agree where nothing moves."""
    session = Session.open(name)
    session.run(steps=40)
    held = session.model.particles.fixed
    assert np.abs(Apart.of(session.model).left_over[held]).max(initial=0.0) <= 1e-8 * largest(session)


def test_what_is_left_over_accelerates() -> None:
    """m a is m Δv / Δt of a short step of the run: the mean of both ends, to the second order in Δt."""
    session = Session.open("isostatic")
    session.settings.time_step = 1e-7
    session.run(time=2e-5)
    joint = session.particles["B"]
    before, first = np.array(joint.velocity), Apart.of(session.model).left_over[joint.row]
    session.run(steps=1)
    last = Apart.of(session.model).left_over[joint.row]
    change = joint.mass * (np.array(joint.velocity) - before) / 1e-7 / 1000.0  # kN
    assert 0.5 * (first + last) == pytest.approx(change, rel=1e-6)
    [force] = [force for force in on_joint(session.model, joint.row) if force.kind == "inertia"]
    assert (force.x, force.y) == pytest.approx(tuple(-last))


def test_a_rod_pulls_its_joints_with_opposite_forces() -> None:
    session = Session.open("isostatic")
    session.settle()
    rod = session.rods["CA"]
    first, last = on_rod(session.model, rod.row)
    assert (first.name, last.name) == ("at C", "at A")
    assert (first.x, first.y) == (-last.x, -last.y)
    assert np.hypot(last.x, last.y) == pytest.approx(abs(rod.axial_force))
    on_a = next(f for f in on_joint(session.model, session.particles["A"].row) if f.name == "rod CA")
    assert (on_a.x, on_a.y) == (-last.x, -last.y)  # action and reaction
    assert on_a.x > 0.0  # it is in tension: it pulls A towards C


def test_loads_and_weight_are_told_apart() -> None:
    session = Session.open("warren_bridge")
    session.settle()
    kinds = {force.name: (force.x, force.y) for force in on_joint(session.model, session.particles["L5"].row)}
    assert kinds["load 5"] == (0.0, -30.0)
    assert kinds["weight"][1] == pytest.approx(-9.81e-3 * session.particles["L5"].mass)
    assert "other" not in kinds
