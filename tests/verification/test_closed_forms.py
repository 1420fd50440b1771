"""Runs of the real program against textbook formulas, within the error that the order of the scheme allows."""

import math

import numpy as np
import pytest

from pinjoint import Session
from tests.reference import closed_forms
from tests.reference.elements import Model
from tests.reference.models import chain, model, oscillator, particle, pendulum, square, triangle
from tests.reference.thesis_targets import EQUILIBRIA

OMEGA = 50.0  # rad/s
DAMPING = pytest.mark.parametrize("zeta", [0.0, 0.1, 0.7, 1.0, 2.0])


def stepped(document: Model, time_step: float, steps: int, integrator: str = "velocity_verlet") -> Session:
    """Run a model by steps of a fixed size."""
    session = Session.open(document | {"settings": {"time_step": time_step, "integrator": integrator}})
    assert session.run(steps=steps) == "time reached"
    assert session.model.clock.steps == steps
    return session


def released(zeta: float, displacement: float = 0.01, velocity: float = 0.3) -> Model:
    return oscillator(OMEGA, zeta, displacement=[displacement, 0], velocity=[velocity, 0])


def moving(session: Session) -> tuple[float, float]:
    """Displacement and velocity of the oscillator's mass."""
    mass = session.particles["B"]
    return mass.displacement[0], mass.velocity[0]


# --- one degree of freedom -----------------------------------------------------------------------------


@DAMPING
def test_free_vibration(zeta: float) -> None:
    """Second order: after the time t the error is within (ωh)² ωt of the amplitude, times 1 + 2ζ."""
    size, steps = 1e-4, 1500
    found = moving(stepped(released(zeta), size, steps))
    expected = closed_forms.free_vibration(steps * size, OMEGA, zeta, 0.01, 0.3)
    amplitude = math.hypot(0.01, 0.3 / OMEGA)
    bound = (OMEGA * size) ** 2 * OMEGA * steps * size * (1 + 2 * zeta) / 12
    assert abs(found[0] - expected[0]) <= bound * amplitude
    assert abs(found[1] - expected[1]) <= bound * amplitude * OMEGA


@DAMPING
@pytest.mark.parametrize(("integrator", "order"), [("velocity_verlet", 2), ("taylor2", 1)])
def test_observed_order_of_convergence(integrator: str, order: int, zeta: float) -> None:
    """Halving the step divides the error of displacement and velocity by 2^order."""
    time = 0.043
    expected = closed_forms.free_vibration(time, OMEGA, zeta, 0.01, 0.3)
    errors = []
    for steps in (400, 800, 1600) if order == 2 else (6400, 12800, 25600):
        found = moving(stepped(released(zeta), time / steps, steps, integrator))
        errors.append([abs(f - e) for f, e in zip(found, expected, strict=True)])
    observed = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert observed == pytest.approx(np.full((2, 2), order), abs=0.05)


def test_observed_order_of_convergence_where_geometry_and_drag_matter() -> None:
    """A swinging, stretching pendulum with drag and a damper has no closed form: Richardson's estimate."""
    document = pendulum(1.2, stiffness=2.0) | {"environment": {"acceleration": [0, -9.81], "drag": 0.7}}
    document["rods"][0]["damping"] = 0.005
    found = [
        np.array(bob.displacement + bob.velocity)
        for steps in (500, 1000, 2000)
        for bob in [stepped(document, 0.4 / steps, steps).particles["P"]]
    ]
    observed = np.log2(np.abs(found[0] - found[1]) / np.abs(found[1] - found[2]))
    assert observed == pytest.approx(np.full(4, 2.0), abs=0.05)


def test_taylor_scheme_gains_energy_as_its_amplification_matrix_says() -> None:
    """Each undamped step multiplies y∧Ay by det A = 1 + (ωh)²/2: kinetic + elastic − (ωh/4) m ω u v."""
    size, steps = 1e-3, 40
    grown = []
    for taken in (0, steps):
        session = Session.open(released(0.0) | {"settings": {"time_step": size, "integrator": "taylor2"}})
        session.run(steps=taken)
        displacement, velocity = moving(session)
        mixed = OMEGA * size / 4 * 2.0 * OMEGA * displacement * velocity
        grown.append(session.energy.kinetic + session.energy.elastic - mixed)
    growth = closed_forms.taylor2_growth(OMEGA * size) ** steps
    assert grown[1] == pytest.approx(growth * grown[0], rel=1e-12)


def test_undamped_energy_stays_bounded_over_a_million_steps() -> None:
    """Verlet conserves kinetic + elastic·(1 − (ωh)²/4): the energy swings by that share and never drifts."""
    size = 0.2 / OMEGA
    session = Session.open(released(0.0) | {"settings": {"time_step": size}})
    share = (OMEGA * size) ** 2 / 4
    energies, conserved = [], []
    for _ in range(1000):
        session.run(steps=1000)
        energy = session.energy
        energies.append((energy.kinetic + energy.elastic) / energy.initial)
        conserved.append((energy.kinetic + energy.elastic * (1 - share)) / energy.initial)
    assert session.model.clock.steps == 1_000_000
    assert max(energies) - min(energies) <= share * 1.01
    assert conserved == pytest.approx([conserved[0]] * 1000, rel=1e-10)


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.3])
def test_overshoot_of_a_damped_step_response(zeta: float) -> None:
    """Largest displacement over the static one: 1 + e^(−πζ/√(1−ζ²)), twice without damping."""
    size, force = 1e-4, 0.5
    session = Session.open(oscillator(OMEGA, zeta, force=force) | {"settings": {"time_step": size}})
    static = force * 1000 / (2.0 * OMEGA**2)
    largest = 0.0
    for _ in range(800):
        session.simulation.advance(1)
        largest = max(largest, moving(session)[0] / static)
    assert largest == pytest.approx(closed_forms.step_overshoot(zeta), abs=(OMEGA * size) ** 2)


@pytest.mark.parametrize("time", [0.01, 0.05, 0.0837, 0.3])
def test_ramp_response(time: float) -> None:
    """Undamped under a force that rises linearly for 0.05 s; second order, as the load is only continuous."""
    rise, force, size = 0.05, 0.5, 1e-4
    document = oscillator(OMEGA) | {
        "loads": [{"on": "B", "force": [force, 0], "history": {"kind": "ramp", "duration": rise}}]
    }
    steps = round(time / size)
    found = moving(stepped(document, size, steps))[0] / (force * 1000 / (2.0 * OMEGA**2))
    expected = closed_forms.ramp_response(time, rise, OMEGA)
    assert found == pytest.approx(expected, abs=(OMEGA * size) ** 2 * max(OMEGA * time, 1.0) / 12)


@pytest.mark.parametrize("share", [0.6, 0.8])
def test_elastic_plastic_ductility(share: float) -> None:
    """Undamped, force suddenly F = share × strength: u_max/u_yield = 1/(2 (1 − F/R))."""
    strength, size = 1.0, 2e-5
    document = oscillator(OMEGA, force=share * strength)
    document["rods"][0] |= {"tensile_strength": strength, "compressive_strength": strength}
    session = Session.open(document | {"settings": {"time_step": size}})
    yielded = strength * 1000 / (2.0 * OMEGA**2)
    largest = before = 0.0
    while (displacement := moving(session)[0]) >= before:
        largest = before = displacement
        session.simulation.advance(1)
    assert largest / yielded == pytest.approx(closed_forms.elastoplastic_ductility(share), rel=1e-5)
    assert session.rods["AB"].plastic_strain == pytest.approx(largest - yielded, rel=1e-9)


# --- several -------------------------------------------------------------------------------------------


def test_free_fall_is_exact() -> None:
    """Constant forces are integrated without error: y = v t − g t²/2, also with drag that is absent."""
    document = model(
        [particle("p", 0, 5, velocity=[3, 4], force=[0.02, 0], mass=2.0)],
        [],
        environment={"acceleration": [0, -9.81]},
    )
    session = Session.open(document)
    session.run(time=1.7)
    body, time = session.particles["p"], 1.7
    assert body.displacement == pytest.approx(
        (3 * time + 5 * time**2, 4 * time - 9.81 / 2 * time**2), rel=1e-12
    )
    assert body.velocity == pytest.approx((3 + 10 * time, 4 - 9.81 * time), rel=1e-12)
    assert abs(session.energy.imbalance) <= 1e-11 * session.energy.kinetic


def test_drag_alone_lets_the_velocity_decay() -> None:
    """v = v₀ e^(−dt), path = (v₀ − v)/d, to second order."""
    drag, size, steps = 3.0, 1e-3, 1000
    document = model([particle("p", 0, 0, velocity=[2, -1])], [], environment={"drag": drag})
    body = stepped(document, size, steps).particles["p"]
    decay = math.exp(-drag * size * steps)
    bound = (drag * size) ** 2 * drag * size * steps
    assert body.velocity == pytest.approx((2 * decay, -decay), rel=bound)
    assert body.displacement == pytest.approx((2 * (1 - decay) / drag, -(1 - decay) / drag), rel=bound)


def free_structure() -> Model:
    """A triangle without supports, stretched, turning and flying, with dampers."""
    document = triangle(force=(0, 0), stiffness=2000.0, damping=0.5)
    speeds = {"A": [1.0, 2.0], "B": [-3.0, 0.5], "C": [0.3, -0.7]}
    for node in document["particles"]:
        node |= {"fixed": [False, False], "velocity": speeds[node["name"]], "displacement": [0.01, -0.02]}
    return document


def test_momentum_of_a_free_structure_is_kept_to_round_off() -> None:
    """Rods pull equally and oppositely along their axes: linear and angular momentum are constant."""
    session = Session.open(free_structure())
    session.simulation.advance(0)

    def momenta() -> tuple[float, float, float]:
        nodes = session.particles
        present = nodes.position + nodes.displacement
        momentum = nodes.mass[:, None] * nodes.velocity
        spin = (present[:, 0] * momentum[:, 1] - present[:, 1] * momentum[:, 0]).sum()
        return (*momentum.sum(axis=0).tolist(), float(spin))

    start = momenta()
    session.run(steps=20_000)
    assert session.model.clock.steps == 20_000
    assert session.energy.dissipated_damping > 0.1 * session.energy.initial
    assert momenta() == pytest.approx(start, rel=1e-11, abs=1e-11 * max(map(abs, start)))


@pytest.mark.parametrize("document", [triangle(), square()], ids=["triangle", "square"])
def test_reactions_balance_loads_at_rest(document: Model) -> None:
    session = Session.open(document)
    assert session.run(until="rest") == "at rest"
    nodes = session.particles
    forces = nodes.applied_force + nodes.reaction
    present = nodes.position + nodes.displacement
    largest = np.abs(nodes.applied_force).max()
    assert np.abs(forces.sum(axis=0)).max() <= 1e-7 * largest
    turning = (present[:, 0] * forces[:, 1] - present[:, 1] * forces[:, 0]).sum()
    assert abs(turning) <= 1e-7 * largest
    assert not nodes.reaction[~nodes.fixed].any()


def test_reactions_are_what_changes_the_momentum() -> None:
    """Σ (applied + reaction) = Σ m a, with a from the velocities of neighbouring steps (second order)."""
    size = 1e-6
    session = stepped(triangle(), size, 400)
    nodes = session.particles
    total = (nodes.applied_force + nodes.reaction).sum(axis=0)
    before = stepped(triangle(), size, 399).particles
    after = stepped(triangle(), size, 401).particles
    rate = (nodes.mass[:, None] * (after.velocity - before.velocity)).sum(axis=0) / (2 * size) / 1000.0
    assert total == pytest.approx(rate, rel=1e-3)


@pytest.mark.parametrize("amplitude", [0.1, 1.0, 2.5])
def test_pendulum_period(amplitude: float) -> None:
    """T = 2π √(l/g) / agm(1, cos θ₀/2); the rod stretches by some mg/EA = 5e-5 of its length."""
    session = Session.open(pendulum(amplitude))
    small = 2 * math.pi * math.sqrt(1.0 / 9.81)
    quarter = small * closed_forms.pendulum_period_ratio(amplitude) / 4
    session.run(time=0.9 * quarter)
    angle = _angle(session)
    while angle > 0.0:
        time, earlier = session.time, angle
        session.run(steps=1)
        angle = _angle(session)
    crossing = time + (session.time - time) * earlier / (earlier - angle)
    assert crossing == pytest.approx(quarter, rel=2e-4)


def _angle(session: Session) -> float:
    bob = session.particles["P"]
    x, y = (p + d for p, d in zip(bob.position, bob.displacement, strict=True))
    return math.atan2(x, -y)


@pytest.mark.parametrize("mode", [1, 2, 5])
def test_chain_swings_in_its_modes(mode: int) -> None:
    """Verlet turns a mode of frequency ω into one of ω', sin(ω'h/2) = ωh/2, and otherwise is exact."""
    count, stiffness, mass, size, steps = 5, 4000.0, 2.0, 2e-3, 500
    shape = [math.sin(mode * math.pi * i / (count + 1)) for i in range(count + 2)]
    document = chain(count, stiffness, mass)
    for node, share in zip(document["particles"][1:-1], shape[1:-1], strict=True):
        node["displacement"] = [1e-3 * share, 0]
    omega = 2 * math.pi * closed_forms.chain_frequencies(count, stiffness, mass)[mode - 1]
    turned = 2 * math.asin(omega * size / 2)
    found = stepped(document, size, steps).particles.displacement[:, 0]
    assert found == pytest.approx(1e-3 * np.array(shape) * math.cos(turned * steps), abs=1e-14)


# --- the thesis' structures ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "case"),
    [
        ("isostatic", "triangle_EA"),
        ("isostatic_10x", "triangle_10EA"),
        ("hyperstatic", "square_EA"),
        ("hyperstatic_10x", "square_10EA"),
        ("hyperstatic_yield", "square_plastic_EA"),
    ],
)
def test_thesis_structure_comes_to_rest_in_its_exact_state(name: str, case: str) -> None:
    session = Session.open(name)
    assert session.run(until="rest") == "at rest"
    assert_state(session, EQUILIBRIA[case]["exact"][0])


def test_thesis_square_unloaded_after_yielding_keeps_its_residual_forces() -> None:
    session = Session.open("hyperstatic_yield")
    session.run(until="rest")
    session.loads[0].force = (0, 0)
    assert session.run(until="rest") == "at rest"
    assert_state(session, EQUILIBRIA["square_plastic_EA"]["exact"][1])


def assert_state(session: Session, exact: dict) -> None:
    """Every number of the exact column within 1e-6 of it, or of the largest of its kind where it is 0."""
    displacement = {name: [d / 1000 for d in values] for name, values in exact["displacement_mm"].items()}
    found = {
        "displacement": (displacement, lambda name: session.particles[name].displacement),
        "reaction": (exact["reactions_kN"], lambda name: session.particles[name].reaction),
        "axial force": (exact["axial_kN"], lambda name: session.rods[name].axial_force),
        "plastic strain": (exact["plastic_strain"], lambda name: session.rods[name].plastic_strain),
    }
    largest_force = max(map(abs, exact["axial_kN"].values()))
    for kind, (expected, read) in found.items():
        smallest = {"reaction": 1e-8 * largest_force, "displacement": 1e-10}.get(kind, 0.0)
        for name, value in expected.items():
            assert read(name) == pytest.approx(value, rel=1e-6, abs=smallest), (kind, name)


def test_arch_snaps_through_to_the_equilibrium_below() -> None:
    """Thesis Fig. 39: half span 2 m, EA 20 000 kN, 1000 kN: H − δ = −s with 2 EA (1/L₀ − 1/L) s = 1000."""
    session = Session.open("snap_through")
    assert session.run(until="rest") == "at rest"
    depth = -(0.3 + session.particles["B"].displacement[1])
    carried = closed_forms.von_mises_force(0.3 + depth, 0.3, 2.0, 20000.0)
    assert carried == pytest.approx(1000.0, rel=1e-7)
    assert session.rods["AB"].axial_force == pytest.approx(500.0 * math.hypot(2.0, depth) / depth, rel=1e-7)


def test_strut_yields_by_overshoot_and_rests_below_its_strength() -> None:
    """Thesis Fig. 40: 9 kN on a strut of 10 kN, suddenly: it rests at −9 kN, shortened for good."""
    session = Session.open("overshoot_yield")
    assert session.run(until="rest") == "at rest"
    strut = session.rods["AB"]
    assert strut.axial_force == pytest.approx(-9.0, rel=1e-7)
    assert -0.03 < strut.plastic_strain < -0.01
    assert not strut.yielding
