"""The oracle itself, against closed forms, conservation laws, and the thesis' exact numbers."""

import math
from collections.abc import Callable
from copy import deepcopy
from itertools import pairwise

import numpy as np
import pytest

from tests.reference import closed_forms, elements, models, physics, statics, thesis
from tests.reference.thesis_targets import EQUILIBRIA, TRIANGLE_WITH_SELF_WEIGHT

INTEGRATORS = {
    "velocity_verlet": (physics.velocity_verlet, 2),
    "rk4": (physics.rk4, 4),
    "semi_implicit_euler": (physics.semi_implicit_euler, 1),
    "taylor2": (physics.taylor2, 1),
}


def rows(by_name: dict) -> np.ndarray:
    """Return the values of a dict by names as one array."""
    return np.array(list(by_name.values()))


def history(integrator: Callable, model: dict, time_step: float, steps: int, record: Callable) -> np.ndarray:
    """Return record(simulation) after every step, one row each."""
    records: list = []
    integrator(model, time_step, steps, lambda simulation: records.append(record(simulation)))
    return np.array(records)


def motion_along_x(simulation: physics.Simulation) -> tuple[float, float]:
    """Return displacement and velocity along x of the second particle."""
    return float(simulation.u[1][0]), float(simulation.v[1][0])


# Model defaults


def test_defaults_of_a_model():
    model = models.model(
        [models.particle("A", 0, 0), models.particle("B", 3, 4), models.particle("C", 9, 9)],
        [models.rod("A", "B", tensile_strength=0, compressive_strength=7)],
    )
    read = elements.read(model)
    rod = read.rods[0]
    assert rod.rest_length == 5.0
    assert (rod.stiffness, rod.damping, rod.density) == (164640.0, 100.0, 6.15)
    assert (rod.tensile_strength, rod.compressive_strength) == (math.inf, 7.0)
    assert [particle.mass for particle in read.particles] == [6.15 * 2.5, 6.15 * 2.5, 1.0]
    assert read.particles[0].fixed == (False, False)
    unyielding = elements.read(model | {"settings": {"plasticity": False}})
    assert unyielding.rods[0].compressive_strength == math.inf


def test_a_free_particle_without_mass_is_refused():
    model = models.model([models.particle("A", 0, 0, mass=0)], [])
    with pytest.raises(ValueError, match=r"Particle A .* mass above 0"):
        elements.read(model)


@pytest.mark.parametrize(("time", "factor"), [(-1, 0), (2, 0), (3, 0.25), (6, 1), (60, 1)])
def test_ramp_rises_from_start_over_duration(time: float, factor: float):
    load = elements.Load(0, (0.0, 1.0), {"kind": "ramp", "start": 2, "duration": 4})
    assert load.factor(time) == factor


# Statics


def thesis_cases() -> list:
    """Return (case, geometry, model, load factors) for every published equilibrium."""
    parameters = []
    for scale, tag in ((1, "EA"), (10, "10EA")):
        stiffness = 164640 * scale
        yielding = {"tensile_strength": 215, "compressive_strength": 215}
        cases = {
            f"triangle_{tag}": (models.triangle(stiffness=stiffness), [1]),
            f"square_{tag}": (models.square(stiffness=stiffness), [1]),
            f"square_plastic_{tag}": (models.square((0, -260), stiffness=stiffness, **yielding), [1, 0]),
        }
        for case, (model, factors) in cases.items():
            for geometry in ("linear", "exact"):
                parameters.append(pytest.param(case, geometry, model, factors, id=f"{case}-{geometry}"))
    return parameters


@pytest.mark.parametrize(("case", "geometry", "model", "factors"), thesis_cases())
def test_statics_meets_the_thesis_targets(case: str, geometry: str, model: dict, factors: list[float]):
    """Each number to 1e-10 of itself; zeros to 1e-12 kN and 1e-12 mm."""
    for state, target in zip(statics.solve(model, factors, geometry), EQUILIBRIA[case][geometry], strict=True):
        assert state["factor"] == target["factor"]
        assert state["axial_force"] == pytest.approx(target["axial_kN"], rel=1e-10)
        for name, reaction in target["reactions_kN"].items():
            assert state["reaction"][name] == pytest.approx(reaction, rel=1e-10, abs=1e-12)
        for name, displacement in target["displacement_mm"].items():
            millimetres = 1000 * np.array(state["displacement"][name])
            assert millimetres == pytest.approx(np.array(displacement), rel=1e-10, abs=1e-12)
        for name, strain in state["plastic_strain"].items():
            assert strain == pytest.approx(target["plastic_strain"].get(name, 0.0), rel=1e-10, abs=0)


def test_statics_with_self_weight():
    model = models.triangle() | {"environment": {"acceleration": [0, -9.81]}}
    (state,) = statics.solve(model)
    assert state["axial_force"] == pytest.approx(TRIANGLE_WITH_SELF_WEIGHT["axial_kN"], rel=1e-10)
    for name, reaction in TRIANGLE_WITH_SELF_WEIGHT["reactions_kN"].items():
        assert state["reaction"][name] == pytest.approx(reaction, rel=1e-10, abs=1e-12)


def test_accelerations_grow_with_the_first_factor_and_stay():
    weight = {"environment": {"acceleration": [0, -9.81]}}
    dead, both = statics.solve(models.triangle() | weight, [0, 1])
    (alone,) = statics.solve(models.triangle((0, 0)) | weight)
    (together,) = statics.solve(models.triangle() | weight)
    assert dead["axial_force"] == pytest.approx(alone["axial_force"], rel=1e-11)
    assert both["axial_force"] == pytest.approx(together["axial_force"], rel=1e-11)


def test_direct_stiffness_meets_opensees():
    """u = (0.530092777132284, −0.177893638469318) in, from the OpenSees manual's truss example."""
    displacement = statics.direct_stiffness(models.opensees_truss())["displacement"]["4"]
    assert displacement == pytest.approx((0.530092777132284, -0.177893638469318), rel=1e-14)


def test_direct_stiffness_and_the_incremental_solver_agree_with_misfit_and_settlement():
    """Two implementations of first-order theory; the settlement stretches the self-stressed square."""
    model = models.square()
    model["rods"][4]["rest_length"] = 2.12
    model["rods"][0]["plastic_strain"] = 1e-4
    model["particles"][3]["displacement"] = [0.002, -0.001]
    direct = statics.direct_stiffness(model)
    (incremental,) = statics.solve(model, geometry="linear")
    for quantity in ("displacement", "axial_force", "reaction"):
        scale = np.abs(rows(direct[quantity])).max()
        assert np.abs(rows(incremental[quantity]) - rows(direct[quantity])).max() < 1e-12 * scale


def test_exact_geometry_tends_to_linear_theory_in_proportion_to_the_load():
    def difference(scale: float) -> float:
        model = models.square((0, -100 * scale))
        exact = rows(statics.solve(model)[0]["displacement"])
        return float(np.abs(exact - rows(statics.direct_stiffness(model)["displacement"])).max()) / scale

    assert difference(1e-3) / difference(1e-4) == pytest.approx(10, rel=1e-3)


def test_reaction_of_the_redundant_panel_truss():
    """Four panels, 10 kN at L2: the roller L3 carries 10 (2 − √2) by the force method."""
    reaction = statics.direct_stiffness(models.panel_truss())["reaction"]["L3"]
    assert reaction == pytest.approx((0, 10 * (2 - math.sqrt(2))), rel=1e-13)


def test_von_mises_truss_follows_the_exact_path_to_its_limit():
    limit, at_limit = closed_forms.von_mises_limit(1, 5, 1.28e6)
    factors = [0.25 * limit, 0.75 * limit, 0.999 * limit]
    for state in statics.solve(models.von_mises_truss(), factors):
        deflection = -state["displacement"]["B"][1]
        assert 0 < deflection < at_limit
        assert closed_forms.von_mises_force(deflection, 1, 5, 1.28e6) == pytest.approx(
            state["factor"], rel=1e-13
        )
    with pytest.raises(statics.NoEquilibrium) as lost:
        statics.solve(models.von_mises_truss(), [2 * limit])
    assert lost.value.factor == pytest.approx(limit, rel=1e-8)
    assert lost.value.factor <= limit


def test_steep_von_mises_truss_loses_stability_sideways():
    """H = 4, b = 1, crown free: the symmetric path bifurcates well below its limit point."""
    bifurcation = closed_forms.von_mises_bifurcation(4, 1, 1000)
    limit, _ = closed_forms.von_mises_limit(4, 1, 1000)
    assert bifurcation < 0.5 * limit
    model = models.von_mises_truss(4, 1, 1000, guided=False)
    with pytest.raises(statics.NoEquilibrium) as lost:
        statics.solve(model, [limit])
    assert lost.value.factor == pytest.approx(bifurcation, rel=1e-8)


def test_three_bar_truss_yields_collapses_and_keeps_residual_forces():
    """First-order theory: 1.7071 S, 2.4142 S, and −0.414 S and +0.293 S after unloading."""
    strength, collapse = 3.0, closed_forms.three_bar_collapse(3.0)
    first_yield = closed_forms.three_bar_first_yield(strength)
    model = models.three_bar_truss(1.0, strength)
    below, above, full, unloaded = statics.solve(
        model, [first_yield * (1 - 1e-9), first_yield * (1 + 1e-9), collapse * (1 - 1e-9), 0], "linear"
    )
    assert below["plastic_strain"]["MP"] == 0.0
    assert above["plastic_strain"]["MP"] > 0.0
    assert rows(full["axial_force"]) == pytest.approx(strength, rel=1e-8)
    vertical, inclined = closed_forms.three_bar_residual(strength)
    assert rows(unloaded["axial_force"]) == pytest.approx(np.array([inclined, vertical, inclined]), rel=1e-8)
    with pytest.raises(statics.NoEquilibrium) as lost:
        statics.solve(model, [2 * collapse], "linear")
    assert lost.value.factor == pytest.approx(collapse, rel=1e-8)


def test_isostatic_triangle_collapses_when_bc_yields():
    """BC carries −140 √2 kN, so 215 kN is reached at the factor 215/(140 √2)."""
    model = models.triangle(tensile_strength=215, compressive_strength=215)
    with pytest.raises(statics.NoEquilibrium) as lost:
        statics.solve(model, [2], "linear")
    assert lost.value.factor == pytest.approx(215 / (140 * math.sqrt(2)), rel=1e-9)


def test_natural_frequencies_of_a_chain():
    """Eight masses of 10 kg, k = 1e5 N/m: f₁ = (100/π) sin(π/18) Hz."""
    free = slice(2, 18, 2)
    stiffness = 1000 * statics.stiffness_matrix(models.chain(8, 1e5, 10))[free, free]
    frequencies = np.sqrt(np.linalg.eigvalsh(stiffness / 10)) / (2 * math.pi)
    assert frequencies == pytest.approx(np.array(closed_forms.chain_frequencies(8, 1e5, 10)), rel=1e-13)
    assert frequencies[0] == pytest.approx(100 / math.pi * math.sin(math.pi / 18), rel=1e-13)


# Dynamics against closed forms


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.5, 1.0, 2.5])
@pytest.mark.parametrize("name", ["velocity_verlet", "rk4"])
def test_damped_oscillator_converges_to_the_closed_form(name: str, zeta: float):
    """The rod along x is exactly linear; the largest error over all steps falls with h^order."""
    integrator, order = INTEGRATORS[name]
    omega, duration = 10.0, 1.0
    model = models.oscillator(omega, zeta, displacement=[0.1, 0], velocity=[-0.4, 0])

    def largest_error(steps: int) -> float:
        motion = history(integrator, model, duration / steps, steps, motion_along_x)
        times = duration / steps * np.arange(1, steps + 1)
        exact = np.array([closed_forms.free_vibration(t, omega, zeta, 0.1, -0.4) for t in times])
        return float(np.abs(motion - exact).max())

    coarse, fine = largest_error(200), largest_error(400)
    assert math.log2(coarse / fine) == pytest.approx(order, abs=0.15)
    assert fine < (1e-3 if order == 2 else 1e-6)


def test_suddenly_applied_force():
    """k = 200, m = 0.5, F = 200 (ω = 20): u(0.2) = 1.6536 undamped, 1.15312 at ζ = 0.5."""
    for zeta, published in ((0.0, 1.6536), (0.5, 1.15312)):
        model = models.oscillator(20.0, zeta, mass=500.0, force=200.0)
        displacement, _ = physics.rk4(model, 1e-3, 200)["displacement"]["B"]
        assert displacement == pytest.approx(closed_forms.step_response(0.2, 20.0, zeta), rel=1e-7)
        assert displacement == pytest.approx(published, abs=5e-5 if zeta == 0 else 5e-6)


@pytest.mark.parametrize("zeta", [0.0, 0.2])
def test_overshoot_of_a_sudden_force(zeta: float):
    """Factor 2 without damping; the nearest sample misses the maximum by (ωh)²/8 at most, 3.1e-4."""
    model = models.oscillator(10.0, zeta, mass=1.0, force=0.01)
    motion = history(physics.rk4, model, 0.005, 80, motion_along_x)[:, 0] / 0.1
    assert motion.max() == pytest.approx(closed_forms.step_overshoot(zeta), abs=3.2e-4)
    assert closed_forms.step_overshoot(0.0) == 2.0


def test_force_rising_linearly():
    """The whole response, and its maximum 1 + |sin(πt_r/T)|/(πt_r/T), for t_r = 0.4 T."""
    omega = 10.0
    period = 2 * math.pi / omega
    rise = 0.4 * period
    model = models.oscillator(omega, mass=1.0) | {
        "loads": [{"on": "B", "force": [0.01, 0], "history": {"kind": "ramp", "start": 0, "duration": rise}}]
    }
    steps = 500  # the corner at t_r falls on a step, so that rk4 keeps its order
    motion = history(physics.rk4, model, 2 * period / steps, steps, motion_along_x)[:, 0] / 0.1
    times = 2 * period / steps * np.arange(1, steps + 1)
    exact = np.array([closed_forms.ramp_response(t, rise, omega) for t in times])
    assert np.abs(motion - exact).max() < 1e-6
    assert exact.max() == pytest.approx(closed_forms.ramp_response_factor(0.4), rel=1e-4)


def test_falling_weight():
    """A weight reaching the spring at √(2gh): 1 + √(1 + 2h/δ) times the deflection at rest."""
    omega, gravity, height = 30.0, 9.81, 0.02
    at_rest = gravity / omega**2
    model = models.oscillator(omega, velocity=[math.sqrt(2 * gravity * height), 0])
    model["environment"] = {"acceleration": [gravity, 0]}
    motion = history(physics.rk4, model, 5e-4, 250, motion_along_x)[:, 0]
    expected = closed_forms.falling_weight_factor(height / at_rest)
    assert motion.max() / at_rest == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("ratio", [0.6, 0.75, 0.9])
def test_elastoplastic_ductility_under_a_sudden_force(ratio: float):
    """μ = 1/(2 (1 − F/R)); the plastic strain left is (μ − 1) R/EA, and the energy balances."""
    model = models.oscillator(10.0, mass=1.0, force=ratio * 0.01)
    model["rods"][0] |= {"tensile_strength": 0.01, "compressive_strength": 0.01}
    ductility = closed_forms.elastoplastic_ductility(ratio)
    motion = history(physics.velocity_verlet, model, 5e-4, 4000, motion_along_x)[:, 0] / 0.1
    assert motion.max() == pytest.approx(ductility, rel=1e-4)
    result = physics.velocity_verlet(model, 5e-4, 4000)
    assert result["plastic_strain"]["AB"] == pytest.approx((ductility - 1) * 0.1, rel=1e-3)
    energy = result["energy"]
    assert energy["dissipated_plastic"] == pytest.approx(10.0 * (ductility - 1) * 0.1, rel=1e-3)
    assert abs(energy["imbalance"]) < 1e-4 * energy["work"]


def test_both_yield_limits_move_with_the_plastic_strain():
    """After yielding in tension at +F the elastic range is still 2F wide: −F comes 2F/EA lower."""
    model = models.oscillator(10.0)
    model["rods"][0] |= {"stiffness": 1000.0, "tensile_strength": 4.0, "compressive_strength": 4.0}
    simulation = physics.Simulation(model)

    def force_at(displacement: float) -> float:
        u = np.array([[0.0, 0.0], [displacement, 0.0]])
        simulation.commit_plasticity(u)
        return simulation.axial_force(0, u)

    assert force_at(0.010) == pytest.approx(4.0, rel=1e-14)
    assert simulation.plastic_strain[0] == pytest.approx(0.006, rel=1e-14)
    assert force_at(0.003) == pytest.approx(-3.0, rel=1e-12)
    assert force_at(0.002) == pytest.approx(-4.0, rel=1e-12)
    assert simulation.plastic_strain[0] == pytest.approx(0.006, rel=1e-12)
    assert force_at(0.000) == pytest.approx(-4.0, rel=1e-12)
    assert simulation.plastic_strain[0] == pytest.approx(0.004, rel=1e-12)


def test_pendulum_of_large_amplitude():
    """T/T₀ = 1.18034 from 90°. The rod stretches by 3mg/EA = 1.5e-6 at most and lengthens T by as little."""
    amplitude = math.pi / 2
    length, gravity, time_step = 1.0, 9.81, 1e-4
    model = models.pendulum(amplitude, length, gravity, mass=1.0, stiffness=20000.0)
    quarter = closed_forms.pendulum_period_ratio(amplitude) * math.pi / 2 * math.sqrt(length / gravity)
    steps = math.ceil(quarter / time_step) + 2
    offset = history(physics.velocity_verlet, model, time_step, steps, lambda s: s.u[1][0] + length)
    after = int(np.argmax(offset < 0))  # records begin one step in, so row n − 1 is the time n h
    crossing = time_step * (after + offset[after - 1] / (offset[after - 1] - offset[after]))
    assert crossing == pytest.approx(quarter, rel=1e-5)
    assert closed_forms.pendulum_period_ratio(amplitude) == pytest.approx(1.18034, abs=5e-6)


def test_sudden_load_on_the_von_mises_truss_snaps_it_above_the_dynamic_limit():
    limit = closed_forms.von_mises_dynamic_limit(1, 5, 1.28e6)
    assert limit == pytest.approx(2910.8, abs=0.05)

    def largest_deflection(load: float) -> float:
        model = models.von_mises_truss(force=-load, damping=0)
        return float(-history(physics.velocity_verlet, model, 1e-4, 600, lambda s: s.u[1][1]).min())

    assert largest_deflection(0.999 * limit) < 1.0
    assert largest_deflection(1.001 * limit) > 2.0


def test_verlet_sees_a_growing_load_at_both_ends_of_the_step():
    """F = F₁ t/T on a free mass: v = F₁ t²/(2mT), exact for the trapezoidal rule."""
    ramp = {"kind": "ramp", "start": 0, "duration": 2}
    model = models.model([models.particle("P", 0, 0, mass=4)], [])
    model["loads"] = [{"on": "P", "force": [0.01, 0], "history": ramp}]
    velocity = physics.velocity_verlet(model, 0.1, 10)["velocity"]["P"]
    assert velocity == pytest.approx((10 / (2 * 4 * 2), 0), rel=1e-14)


def test_drag_and_imposed_acceleration_on_a_free_particle():
    """v = v₀ e^(−dt) + (g/d)(1 − e^(−dt)); work, drag and kinetic energy balance."""
    drag, gravity, duration = 0.8, 9.81, 1.5
    model = models.model([models.particle("P", 0, 0, velocity=[3, 0], acceleration=[0, -gravity])], [])
    model["environment"] = {"drag": drag}
    result = physics.rk4(model, duration / 100, 100)
    decay = math.exp(-drag * duration)
    assert result["velocity"]["P"] == pytest.approx((3 * decay, -gravity / drag * (1 - decay)), rel=1e-9)
    assert abs(result["energy"]["imbalance"]) < 1e-8 * result["energy"]["initial"]
    assert result["energy"]["dissipated_drag"] > 0


# Order, conservation, balance


def swinging_square() -> dict:
    """Return a free, soft, damped square that turns and deforms by tenths while a load grows."""
    model = models.square((0.0, -0.3), stiffness=20.0, damping=0.05)
    for particle, velocity in zip(model["particles"], [(0, 0), (1, 2), (-2, 1), (0, 0)], strict=True):
        particle["velocity"] = list(velocity)
    model["environment"] = {"acceleration": [0.3, -2.0], "force": [0.01, 0.02], "drag": 0.3}
    ramp = {"kind": "ramp", "start": 0, "duration": 2}
    return model | {"loads": [{"on": "B", "force": [0.4, 0.1], "history": ramp}]}


@pytest.mark.parametrize("name", INTEGRATORS)
def test_observed_order(name: str):
    """Differences of successively halved steps fall by 2^order, with dampers, drag and a growing load."""
    integrator, order = INTEGRATORS[name]
    duration, coarsest = 0.4, {1: 800, 2: 100, 4: 40}[order]
    states = []
    for steps in (coarsest, 2 * coarsest, 4 * coarsest):
        result = integrator(swinging_square(), duration / steps, steps)
        states.append(np.concatenate([rows(result["displacement"]), rows(result["velocity"])]))
    first, second = (np.abs(a - b).max() for a, b in pairwise(states))
    assert math.log2(first / second) == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize("name", INTEGRATORS)
def test_energy_imbalance_falls_with_the_order(name: str):
    """The fourth-order term of rk4 outweighs its higher ones only at small steps."""
    integrator, order = INTEGRATORS[name]
    duration, steps = 0.4, {1: 800, 2: 100, 4: 640}[order]
    coarse, fine = (integrator(swinging_square(), duration / n, n)["energy"] for n in (steps, 2 * steps))
    assert math.log2(abs(coarse["imbalance"] / fine["imbalance"])) == pytest.approx(order, abs=0.1)
    assert fine["dissipated_damping"] > 0
    assert fine["dissipated_drag"] > 0


def test_energy_balances_while_rods_of_different_length_yield():
    """Steps that enter or leave the plastic range miss the corner by O(h²) of strain."""
    model = models.square((0, -260), tensile_strength=100, compressive_strength=80, damping=30)
    energy = physics.velocity_verlet(model, 1e-6, 1500)["energy"]
    assert energy["dissipated_plastic"] > 0.1 * energy["work"]
    assert abs(energy["imbalance"]) < 1e-5 * energy["work"]


def test_initial_state_beyond_the_strength_yields_before_the_account_begins():
    model = models.oscillator(10.0, mass=1.0, displacement=[0.3, 0])
    model["rods"][0] |= {"tensile_strength": 0.01, "compressive_strength": 0.01}
    energy = physics.velocity_verlet(model, 1e-3, 0)["energy"]
    assert energy["initial"] == pytest.approx(10.0**2 / (2 * 100.0), rel=1e-12)
    assert energy["dissipated_plastic"] == 0.0


def test_free_undamped_structure_conserves_momentum():
    """Linear and angular momentum; both hold for Verlet to round-off at any step size."""
    model = models.square((0, 0), damping=0)
    for particle, velocity in zip(model["particles"], [(0, 3), (1, -2), (-4, 1), (2, 2)], strict=True):
        particle |= {"fixed": [False, False], "velocity": list(velocity)}
    masses = np.array([particle.mass for particle in elements.read(model).particles])
    positions = np.array([particle["position"] for particle in model["particles"]])

    def momentum(simulation: physics.Simulation) -> tuple[float, ...]:
        p = masses[:, None] * simulation.v
        x = positions + simulation.u
        return (*p.sum(axis=0), float(np.sum(x[:, 0] * p[:, 1] - x[:, 1] * p[:, 0])))

    expected = np.array(momentum(physics.Simulation(model)))
    recorded = history(physics.velocity_verlet, model, 5e-5, 400, momentum)
    assert np.abs(recorded - expected).max() < 1e-12 * masses.sum() * 5.0
    moved = history(physics.velocity_verlet, model, 5e-5, 400, lambda s: s.u)[-1]
    assert np.abs(moved).max() > 0.01


def test_reactions_balance_loads_and_inertia_at_every_step():
    """Σ m a = Σ applied + Σ reactions, in kN, without drag; rods cancel out."""
    model = models.triangle(damping=20)
    masses = np.array([particle.mass for particle in elements.read(model).particles])

    def unbalanced(simulation: physics.Simulation) -> np.ndarray:
        forces = simulation.forces
        inertia = masses[:, None] * forces.acceleration / 1000
        return np.sum(forces.applied + forces.reaction - inertia, axis=0)

    assert np.abs(history(physics.velocity_verlet, model, 2e-5, 100, unbalanced)).max() < 1e-11


def test_damped_motion_comes_to_rest_at_the_static_equilibrium():
    model = models.triangle(damping=20)
    moving = physics.velocity_verlet(model, 1e-4, 2500)
    (still,) = statics.solve(model)
    assert moving["axial_force"] == pytest.approx(still["axial_force"], rel=1e-9)
    for quantity in ("displacement", "reaction"):
        assert rows(moving[quantity]) == pytest.approx(rows(still[quantity]), rel=1e-9, abs=1e-12)


# Stability and energy of the integrators


def amplification(integrator: Callable, omega: float, zeta: float, time_step: float) -> np.ndarray:
    """Return the 2 × 2 matrix that one step applies to (u, u'), measured on two initial states."""
    columns = []
    for u, v in ((0.01, 0.0), (0.0, 0.01)):
        model = models.oscillator(omega, zeta, displacement=[u, 0], velocity=[v, 0])
        result = integrator(model, time_step, 1)
        columns.append((result["displacement"]["B"][0] / 0.01, result["velocity"]["B"][0] / 0.01))
    return np.array(columns).T


@pytest.mark.parametrize("zeta", [0.0, 0.1, 0.5, 1.0, 2.0, 10.0])
def test_verlet_is_stable_up_to_its_limit(zeta: float):
    limit = closed_forms.verlet_stability_limit(1.0, zeta)
    for fraction in (0.1, 0.5, 0.9, 0.999):
        matrix = amplification(physics.velocity_verlet, 1.0, zeta, fraction * limit)
        assert np.abs(np.linalg.eigvals(matrix)).max() <= 1 + 1e-12
    if zeta == 0:
        beyond = amplification(physics.velocity_verlet, 1.0, zeta, 1.001 * limit)
        assert np.abs(np.linalg.eigvals(beyond)).max() > 1.05


def test_thesis_scheme_gains_energy_every_step():
    """u_n v_{n+1} − u_{n+1} v_n measures energy: it grows by 1 + (ωΔt)²/2, × 1.368 a period at 0.1."""
    matrix = amplification(thesis.taylor2, 1.0, 0.0, 0.1)
    assert np.linalg.det(matrix) == pytest.approx(closed_forms.taylor2_growth(0.1), rel=1e-12)
    state, areas = np.array([1.0, 0.0]), []
    for _ in range(20):
        following = matrix @ state
        areas.append(state[0] * following[1] - state[1] * following[0])
        state = following
    growth = np.array(areas[1:]) / np.array(areas[:-1])
    assert growth == pytest.approx(closed_forms.taylor2_growth(0.1), rel=1e-12)
    assert closed_forms.taylor2_growth(0.1) ** (2 * math.pi / 0.1) == pytest.approx(1.368, abs=5e-4)


def test_rk4_loses_energy_slowly():
    """The determinant is 1 − z⁶/72 + z⁸/576; over a period at z = 0.1 that is 1 − 8.7e-7."""
    matrix = amplification(physics.rk4, 1.0, 0.0, 0.5)
    assert np.linalg.det(matrix) == pytest.approx(closed_forms.rk4_growth(0.5), rel=1e-12)
    assert 1 - closed_forms.rk4_growth(0.1) ** (2 * math.pi / 0.1) == pytest.approx(8.7e-7, rel=5e-3)


@pytest.mark.parametrize("integrator", [physics.velocity_verlet, physics.semi_implicit_euler])
def test_symplectic_schemes_keep_areas(integrator: Callable):
    assert np.linalg.det(amplification(integrator, 1.0, 0.0, 0.5)) == pytest.approx(1.0, rel=1e-13)


# The thesis' own style


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


# Closed forms among themselves


def test_free_vibration_is_continuous_across_critical_damping():
    for time in (0.1, 0.7, 2.0):
        critical = closed_forms.free_vibration(time, 3.0, 1.0, 0.2, -1.0)
        for zeta in (1 - 1e-9, 1 + 1e-9):
            assert closed_forms.free_vibration(time, 3.0, zeta, 0.2, -1.0) == pytest.approx(critical, rel=1e-6)


def test_strongly_damped_vibration_does_not_overflow():
    """ζ = 1e4: the slow exponential e^(−ωt/2ζ) is left."""
    displacement, _ = closed_forms.free_vibration(1.0, 1e3, 1e4, 1.0, 0.0)
    assert displacement == pytest.approx(math.exp(-0.05), rel=1e-7)


def test_logarithmic_decrement_of_successive_maxima():
    omega, zeta = 4.0, 0.1
    period = 2 * math.pi / (omega * math.sqrt(1 - zeta**2))
    first, _ = closed_forms.free_vibration(0.0, omega, zeta, 1.0, 0.0)
    second, velocity = closed_forms.free_vibration(period, omega, zeta, 1.0, 0.0)
    assert velocity == pytest.approx(0.0, abs=1e-14)
    assert math.log(first / second) == pytest.approx(closed_forms.logarithmic_decrement(zeta), rel=1e-13)


@pytest.mark.parametrize("ratio", [0.3, 1.0, 1.7])
def test_harmonic_amplification_is_the_steady_state_of_the_equation(ratio: float):
    """u'' + 2ζω u' + ω² u = ω² sin Ωt, integrated with trapezoids until the transient has died (e^−20)."""
    zeta, omega, step = 0.1, 1.0, 0.01
    matrix = np.array([[0.0, 1.0], [-(omega**2), -2 * zeta * omega]])
    left, right = np.eye(2) - step / 2 * matrix, np.eye(2) + step / 2 * matrix
    advance, drive = np.linalg.solve(left, right), np.linalg.solve(left, [0.0, step * omega**2])
    state, largest = np.zeros(2), 0.0
    for n in range(int(200 / step) + int(2 * math.pi / ratio / step)):
        state = advance @ state + drive * math.sin(ratio * step * (n + 0.5))
        if n * step >= 200:
            largest = max(largest, abs(float(state[0])))
    assert largest == pytest.approx(closed_forms.harmonic_amplification(ratio, zeta), rel=2e-4)


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
