"""Batches: variants computed together have the bits of single runs, or are left to these."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pinjoint.commands.command_line import main
from pinjoint.commands.reports.report import Analysis
from pinjoint.sweeps import sweep
from pinjoint.sweeps.batched_model import BatchedModel
from pinjoint.sweeps.batches import Batches
from pinjoint.sweeps.execution import Worker
from pinjoint.sweeps.plan import Plan, Record, plan_of
from pinjoint.sweeps.variant_runner import VariantRunner
from pinjoint.systems.physics.automatic import choose, stiffnesses, suited_to
from pinjoint.systems.physics.spectrum import spectra, spectrum
from tests.reference.models import oscillator, square, triangle

TRIANGLE = triangle(damping=100, density=6.15, tensile_strength=215, compressive_strength=215)
# Where it yields, it does so in the overshoot, and soon rests; a mechanism would take many thousand steps.
OVERSHOOTING = triangle(damping=20, density=6.15, tensile_strength=215, compressive_strength=215)
TIMES = Analysis(times=(1e-4, 3e-4, 1e-3))
MEASURES = [
    "rods.*.axial_force,rods.*.length,rods.*.strain,rods.*.plastic_strain,rods.*.yielding",
    "particles.*.displacement,particles.*.velocity,particles.*.reaction,particles.*.mass",
    "energy.work,energy.imbalance,energy.kinetic,energy.elastic,energy.dissipated_damping",
    "energy.dissipated_plastic,residual,collisions",
]


def loaded() -> dict[str, Any]:
    """The triangle under loads that change in time."""
    return TRIANGLE | {
        "loads": [
            {"name": "up", "on": "B", "force": [0, -90], "history": {"kind": "ramp", "duration": 2e-4}},
            {"name": "on", "on": "B", "force": [30, 0], "history": {"kind": "ramp", "start": 1e-4}},
        ]
    }


def loaded_cables() -> dict[str, Any]:
    """That triangle with a cable, which becomes slack and taut."""
    rods = [
        rod | {"tension_only": rod["name"] == "CA", "compressive_strength": None} for rod in TRIANGLE["rods"]
    ]
    return loaded() | {"rods": rods}


def planned(source: Any, vary: list[str], analysis: Analysis, samples: int | None = None) -> Plan:
    return plan_of(source, vary, MEASURES, analysis, (), samples, 1)


def alone(plan: Plan, number: int) -> list[Record]:
    return VariantRunner(plan).records(number)


CASES: dict[str, tuple[Any, list[str], Analysis, int | None]] = {
    "until rest": (TRIANGLE, ["rods.*.stiffness~normal(164640,5%)"], Analysis(), 4),
    "at times": (TRIANGLE, ["particles.B.force.y=-50,-200,-300"], TIMES, None),
    "plans that differ": (
        TRIANGLE,
        ["settings.plasticity=true,false", "rods.*.damping=0,100", "rods.*.compressive_strength=null,90"],
        TIMES,
        None,
    ),
    "fixed steps": (
        TRIANGLE,
        [
            "settings.time_step=null,3e-6",
            "settings.integrator=automatic,velocity_verlet",
            "rods.AB.density=5,6",
        ],
        TIMES,
        None,
    ),
    "loads and state": (
        loaded(),
        ["loads.up.force.y=-80,-90", "loads.*.force.x~normal(10,5)", "particles.B.velocity.x=0,1"],
        TIMES,
        1,
    ),
    "environment and geometry": (
        TRIANGLE,
        [
            "environment.acceleration.y=0,-9.81",
            "particles.B.position.y=0.8,1.2",
            "settings.tolerance=1e-6,1e-9",
        ],
        TIMES,
        None,
    ),
    "another structure": (
        square(damping=100),
        ["rods.CD.tensile_strength=40,80"],
        Analysis(times=(2e-3,)),
        None,
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_together_they_have_the_bits_of_single_runs(name: str) -> None:
    plan = planned(*CASES[name])
    together = Worker(plan).together(range(plan.size))
    assert together == {number: alone(plan, number) for number in range(plan.size)}


BY_INTEGRATOR: dict[str, tuple[Any, list[str], Analysis]] = {
    "dop853": (OVERSHOOTING, ["rods.BC.compressive_strength=205:290:5"], Analysis()),
    "rk4": (loaded_cables(), ["environment.drag=0.5,10", "rods.AB.stiffness=1e5:2e5:5"], TIMES),
    "velocity_verlet": (OVERSHOOTING, ["rods.BC.compressive_strength=205:290:5"], Analysis()),
    "semi_implicit_euler": (loaded(), ["settings.time_step=null,2e-6", "rods.AB.stiffness=1e5:2e5:5"], TIMES),
    "taylor2": (loaded_cables(), ["environment.drag=0.5,10", "rods.AB.stiffness=1e5:2e5:5"], TIMES),
}


@pytest.mark.parametrize("integrator", BY_INTEGRATOR)
def test_by_every_integrator_they_have_the_bits_of_single_runs(integrator: str) -> None:
    """Some steps are rejected or end at events, some variants end early."""
    source, vary, analysis = BY_INTEGRATOR[integrator]
    plan = plan_of(source, vary, MEASURES, analysis, (f"settings.integrator={integrator}",), None, 1)
    together = Worker(plan).together(range(plan.size))
    assert together == {number: alone(plan, number) for number in range(plan.size)}


@pytest.mark.filterwarnings("error")
def test_a_variant_that_is_left_to_a_run_of_its_own_warns_nobody() -> None:
    """With steps that are too long it has not begun any."""
    fixed = ["settings.time_step=3e-6,1", "settings.integrator=velocity_verlet"]
    assert set(Worker(planned(TRIANGLE, fixed, Analysis())).together(range(2))) == {0}


def test_variants_of_whose_energy_a_person_is_told_are_single_runs() -> None:
    """Nothing damps the motion, which rk4 takes at the longer step: not at rest, and not without a word."""
    struck = oscillator(1000.0, velocity=[0.001, 0.0]) | {
        "settings": {"integrator": "rk4", "collisions": False}
    }
    plan = planned(struck, ["settings.time_step=5e-5,2.5e-3"], Analysis(times=(0.2,)))
    assert Worker(plan).together(range(2)) == {0: alone(plan, 0)}
    [(status, message, *_)] = alone(plan, 1)
    assert status == "time reached"
    assert "The time steps lost 100 % of the supplied energy" in message


def test_the_number_of_threads_changes_no_bit() -> None:
    plan = planned(TRIANGLE, ["rods.*.stiffness~normal(164640,5%)"], TIMES, 30)
    one, three = (Worker(plan, threads).together(range(plan.size)) for threads in (1, 3))
    assert len(one) == 30
    assert one == three


def test_what_cannot_be_computed_together_is_left_to_single_runs() -> None:
    """A warning, no rest, a number that is refused, one that is extreme; then one that is none of these."""
    vary = [
        "settings.time_step=1e-2,null",
        "rods.*.damping=0,100",
        "rods.CA.temperature_change=-1e9,0",
        "rods.CA.stiffness=-1,1e-40,1e5",
    ]
    plan = planned(TRIANGLE, vary, Analysis(limit=0.1))
    worker = Worker(plan)
    together = worker.together(range(plan.size))
    assert set(together) == {plan.size - 1}
    statuses = {records[-1][0] for _, records in worker.compute(range(plan.size)).outcomes}
    assert statuses == {"failed", "diverged", "limit reached", "at rest"}


@pytest.mark.parametrize(
    ("source", "vary", "analysis"),
    [
        (TRIANGLE, "rods.CA.stiffness=1e5,2e5", Analysis(load_factors=(1.0,))),
        (TRIANGLE, "particles.C.fixed.x=true,false", TIMES),
        ("collision_ii", "settings.restitution=1,0.5", TIMES),
    ],
    ids=["statics", "supports", "no rods"],
)
def test_other_sweeps_are_single_runs(source: Any, vary: str, analysis: Analysis) -> None:
    assert Worker(planned(source, [vary], analysis)).at_a_time == 1


def test_a_fault_in_computing_together_is_counted_and_told(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """The results are the same, one by one."""
    vary = ["rods.CA.stiffness=1e5,2e5,3e5"]
    whole = sweep(TRIANGLE, vary, MEASURES, TIMES)
    assert whole.faults == {}

    def fail(batches: Batches, numbers: Any) -> Any:
        raise RuntimeError("shapes differ")

    monkeypatch.setattr(Batches, "records", fail)
    found = sweep(TRIANGLE, vary, MEASURES, TIMES)
    assert found.faults == {"RuntimeError: shapes differ": 3}
    assert found.columns == whole.columns
    output = str(tmp_path / "found.csv")
    arguments = ["--vary", "rods.CA.stiffness=1e5,2e5", "--measure", "residual", "--at", "1e-4"]
    main(["sweep", "isostatic", *arguments, "--workers", "1", "--output", output])
    told = capsys.readouterr().err
    assert "2 variants were computed one by one" in told
    assert "RuntimeError: shapes differ" in told


def beside(**chosen: Any) -> dict[str, Any]:
    """The triangle and a particle by itself."""
    apart = {"name": "E", "position": [5, 5]}
    return TRIANGLE | {"particles": [*TRIANGLE["particles"], apart], "settings": chosen}


def two_triangles(**chosen: Any) -> dict[str, Any]:
    """Two that are alike, beside each other."""
    letters = str.maketrans("ABC", "DEF")
    particles = [
        p | {"name": p["name"].translate(letters), "position": [p["position"][0] + 5, p["position"][1]]}
        for p in TRIANGLE["particles"]
    ]
    rods = [
        r | {"name": r["name"].translate(letters), "between": [n.translate(letters) for n in r["between"]]}
        for r in TRIANGLE["rods"]
    ]
    return TRIANGLE | {
        "particles": [*TRIANGLE["particles"], *particles],
        "rods": [*TRIANGLE["rods"], *rods],
        "settings": chosen,
    }


@pytest.mark.parametrize(
    ("vary", "alone_too"),
    [
        ("rods.DE.stiffness=1e5,2e5", 0),  # both islands move until the whole is at rest
        ("particles.E.force=0", 1),  # the second island rests from the start, and sleeps
    ],
)
def test_islands_are_computed_together_until_one_would_sleep(vary: str, alone_too: int) -> None:
    path, _, values = vary.partition("=")
    axes = [f"{path}.{d}={values}" for d in "xy"] if path.endswith("force") else [vary]
    plan = planned(two_triangles(sleeping=True, collisions=False), axes, TIMES)
    together = Worker(plan).together(range(plan.size))
    assert len(together) == plan.size - alone_too
    assert together == {number: alone(plan, number) for number in together}


@pytest.mark.parametrize("sleeping", [True, False])
def test_an_island_falls_asleep_in_a_run_of_its_own(sleeping: bool) -> None:
    """By small fixed steps, of which reviews come every 1024."""
    steps = {"integrator": "velocity_verlet", "time_step": 2e-6, "collisions": False}
    model = two_triangles(sleeping=sleeping, **steps)
    for rod in model["rods"][3:]:
        rod["damping"] = 20.0
    plan = planned(model, ["rods.AB.stiffness=1.6e5,1.7e5"], Analysis(times=(2.5e-2,)))
    together = Worker(plan).together(range(plan.size))
    assert len(together) == (0 if sleeping else 2)
    assert together == {number: alone(plan, number) for number in together}


def test_structures_whose_particles_can_meet_are_single_runs() -> None:
    plan = planned(beside(sleeping=False), ["settings.collisions=true,false"], TIMES)
    assert set(Worker(plan).together(range(2))) == {1}


@pytest.mark.parametrize(
    "source", [TRIANGLE, square(damping=100), "tower"], ids=["triangle", "square", "tower"]
)
def test_limits_of_a_block_are_those_of_its_model(source: Any) -> None:
    plan = planned(source, ["rods.*.stiffness~normal(164640,30%)"], TIMES, 3)
    runner = VariantRunner(plan)
    batched = BatchedModel.of(runner.model, 3)
    expected = []
    for number in range(3):
        with runner.taken_back():
            runner.override(plan.overrides_of(number))
            batched["rods.stiffness"][number] = runner.model.rods.stiffness
            found = spectrum(runner.model, runner.model.rods.axial_force)
            expected.append((found.frequency, found.decay, choose(runner.model)))
            batched["rods.axial_force"][number] = runner.model.rods.axial_force
    drag = np.zeros(3)
    frequency, decay = spectra(batched.as_model(), batched.rods.axial_force, drag)
    chosen = [suited_to(stiffness) for stiffness in stiffnesses(batched.as_model(), drag).tolist()]
    assert list(zip(frequency.tolist(), decay.tolist(), chosen, strict=True)) == expected
