"""Frames in motion and at rest against closed forms, dense eigenvalues and the slow reference."""

import math
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.documents.document import parse
from pinjoint.systems.physics.bending import stiffness_matrix
from pinjoint.systems.physics.spectrum import spectrum
from tests.reference import frames
from tests.reference.models import CLAMPED, PINNED, line, rod

EI, LENGTH, LOAD = 100.0, 2.0, -1e-4
NO_COLLISIONS = {"settings": {"collisions": False}}


def cantilever(count: int, slenderness: float) -> dict[str, Any]:
    """A cantilever of length 1 m and EA = 10⁵ kN, of so many rods; slenderness: length/radius of gyration."""
    stiff = {"stiffness": 1e5, "bending_stiffness": 1e5 / slenderness**2, "damping": 0.0}
    return line([(i / count, 0.0) for i in range(count + 1)], CLAMPED, {}, **stiff) | NO_COLLISIONS


@pytest.mark.parametrize(
    ("count", "slenderness", "error", "share"),
    [(8, 200.0, -0.73e-2, 1.0), (16, 50.0, -0.25e-2, 2.0), (32, 200.0, -0.062e-2, 1.04)],
)
def test_inertia_of_rotations_spoils_neither_the_first_mode_nor_the_step(
    count: int, slenderness: float, error: float, share: float
) -> None:
    """ω₁ = 1.8751² √(EI/ρL⁴): lumped masses make it less; the highest is hardly above that of the axes, 2 √(EA/ρ)/h."""
    made = parse(cantilever(count, slenderness))
    values = np.linalg.eigvalsh(stiffness_matrix(made, by_mass=True)[0])
    first = 1.8751040687119611**2 * math.sqrt(1000.0 * 1e5 / slenderness**2 / 6.15)
    axial = 2.0 * math.sqrt(1000.0 * 1e5 / 6.15) * count
    assert math.sqrt(values[0]) / first - 1.0 == pytest.approx(error, rel=0.02)
    assert math.sqrt(values[-1]) / axial == pytest.approx(share, rel=0.01)
    assert spectrum(made, made.rods.axial_force).frequency == pytest.approx(math.sqrt(values[-1]), rel=1e-3)


@pytest.mark.parametrize("number", range(20))
def test_the_highest_frequency_is_bounded(number: int) -> None:
    """In any state, against the Hessian of the energy by differences, of rods without distributed forces."""
    lot = np.random.default_rng([31, number])
    made = parse(frames.random_frame(lot, 4, loaded=False, warm=False, sprung=False))
    state = np.column_stack([made.particles.displacement, made.particles.rotation])
    mobility = np.column_stack([made.particles.mobility, made.particles.turning])
    session = Session(made)
    program = session.simulation.programs.compiled
    program.observe()
    hessian = np.zeros((state.size, state.size))
    for place in range(state.size):
        for sign in (1.0, -1.0):
            trial = state.copy()
            trial.ravel()[place] += sign * 1e-6
            made.writable("particles.displacement")[...] = trial[:, :2]
            made.writable("particles.rotation")[...] = trial[:, 2]
            program.observe()
            force = np.column_stack([program.unbalanced, program.unbalanced_moment])
            hessian[:, place] -= sign * force.ravel() / 2e-6
    made.writable("particles.displacement")[...] = state[:, :2]
    made.writable("particles.rotation")[...] = state[:, 2]
    program.observe()
    root = np.sqrt(mobility.ravel())
    highest = np.linalg.eigvalsh(root[:, None] * 0.5 * (hessian + hessian.T) * root).max()
    assert spectrum(made, made.rods.axial_force).frequency >= 0.97 * math.sqrt(highest)


def beam(**facts: Any) -> dict[str, Any]:
    """One rod, clamped at both ends but for hinges, under a small distributed force."""
    stiff = {"stiffness": 1e5, "bending_stiffness": EI, "distributed_force": [0.0, LOAD], **facts}
    return line([(0.0, 0.0), (LENGTH, 0.0)], CLAMPED, CLAMPED, **stiff) | NO_COLLISIONS


@pytest.mark.parametrize(
    ("hinged", "moments", "shears", "turned"),
    [
        ((False, False), (-1 / 12, -1 / 12), (1 / 2, -1 / 2), (0.0, 0.0)),
        ((True, False), (0.0, -1 / 8), (3 / 8, -5 / 8), (-1 / 48, 0.0)),
        ((False, True), (-1 / 8, 0.0), (5 / 8, -3 / 8), (0.0, 1 / 48)),
        ((True, True), (0.0, 0.0), (1 / 2, -1 / 2), (-1 / 24, 1 / 24)),
    ],
)
def test_a_clamped_beam(hinged: Any, moments: Any, shears: Any, turned: Any) -> None:
    """Moments of qL², shears of qL, rotations of qL³/EI (q downwards positive): textbook."""
    session = Session(parse(beam(hinged=hinged)))
    session.run(steps=1)
    member = session.rods["R0"]
    assert member.bending_moment == pytest.approx(np.multiply(moments, -LOAD * LENGTH**2), abs=1e-12)
    assert member.shear == pytest.approx(np.multiply(shears, -LOAD * LENGTH), abs=1e-12)
    assert member.end_rotation == pytest.approx(np.multiply(turned, -LOAD * LENGTH**3 / EI), abs=1e-12)
    reactions = session.model.particles.reaction_moment
    assert reactions == pytest.approx(np.multiply(moments, -LOAD * LENGTH**2) * [-1.0, 1.0], abs=1e-12)


def test_warmth_on_one_side_bends_a_clamped_beam() -> None:
    """M = EI α ΔT/h at both ends; the warmer side, the left one, is pressed: the right one is in tension."""
    session = Session(parse(beam(distributed_force=[0.0, 0.0], temperature_gradient=20.0)))
    session.run(steps=1)
    assert session.rods["R0"].bending_moment == pytest.approx([EI * 1.2e-5 * 20.0] * 2, rel=1e-12)


def test_at_rest_the_energy_is_least() -> None:
    """A frame with hinges, bars, distributed forces and warmth comes to rest where the slow reference has no force."""
    stiff = {"bending_stiffness": 4000.0, "damping": 2000.0, "stiffness": 2e4}
    document = line([(0.0, 0.0), (0.0, 3.0), (4.0, 3.0), (4.0, 0.0)], CLAMPED, PINNED, **stiff)
    document["particles"][2] |= {"force": [10.0, -20.0], "moment": 2.0}
    document["rods"][0] |= {"temperature_gradient": 40.0}
    document["rods"][1] |= {"hinged": [False, True], "distributed_force": [0.0, -5.0]}
    document["rods"].append(rod("P0", "P2", stiffness=50.0))
    document["settings"] = {"collisions": False, "integrator": "esdirk4"}
    session = Session(parse(document | {"environment": {"drag": 20.0}}))
    session.run(until="rest")
    force, moment = frames.forces(session.model)
    free = ~session.model.particles.fixed
    turns = session.model.particles.turning > 0.0
    assert np.abs(force[free]).max() < 1e-7
    assert np.abs(moment[turns]).max() < 1e-7
    reaction = session.model.particles.reaction
    assert reaction[~free] == pytest.approx(-force[~free], abs=1e-7)
    assert session.model.particles.reaction_moment[0] == pytest.approx(-moment[0], abs=1e-7)
    assert abs(session.energy.imbalance) < 1e-6 * session.energy.work


def test_a_rolling_beam_keeps_momentum_and_energy() -> None:
    """A free beam spins many turns: angular momentum Σ m r × v + J ω and energy stay; rotations are not wrapped."""
    count, spin = 4, 200.0
    place = np.linspace(-1.0, 1.0, count + 1)
    stiff = {"stiffness": 2e4, "bending_stiffness": 20.0, "damping": 0.0}
    document = line([(x, 0.0) for x in place.tolist()], {}, {}, **stiff)
    for particle in document["particles"]:
        particle |= {"velocity": [0.0, spin * particle["position"][0]], "angular_velocity": spin}
    document["settings"] = {"collisions": False, "integrator": "dop853"}
    session = Session(parse(document))

    def momentum() -> float:
        p = session.model.particles
        at = p.position + p.displacement
        orbital = p.mass * (at[:, 0] * p.velocity[:, 1] - at[:, 1] * p.velocity[:, 0])
        return float((orbital + p.inertia * p.angular_velocity).sum())

    begun = momentum()
    session.run(time=0.5)
    assert session.model.particles.rotation.min() > 50.0
    assert momentum() == pytest.approx(begun, rel=1e-9)
    assert abs(session.energy.imbalance) < 1e-8 * session.energy.initial


def test_what_can_turn_no_more_stops_turning() -> None:
    """A particle whose rigid ends become hinges keeps its place: its moment does no more work."""
    document = cantilever(2, 20.0)
    document["particles"][2] |= {"moment": 1.0}
    session = Session(parse(document))
    session.run(time=0.002)
    session.rods["R1"].hinged = (True, True)
    session.run(steps=1)
    turned = session.particles["P2"].rotation
    session.run(time=0.01)
    assert session.particles["P2"].rotation == turned
    assert session.particles["P2"].angular_velocity == 0.0
    assert abs(session.energy.imbalance) < 1e-7 * session.energy.work
