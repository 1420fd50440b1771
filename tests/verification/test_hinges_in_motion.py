"""Plastic hinges in motion: against the energy, between integrators and forms, the energy account, repeated loads."""

import itertools
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.documents.document import parse
from pinjoint.systems.program.compiler import Compile
from pinjoint.systems.program.writer import FEW, MANY, VERY_MANY
from tests.reference import frames
from tests.reference.models import particle
from tests.systems.program.test_frames import beam, program_of, state_of
from tests.verification.test_forms import OF_EACH_FORM, state

CLAMPED = {"fixed": [True, True], "fixed_rotation": True}
RAMP = {"kind": "ramp", "start": 0.0, "duration": 0.5}


def portal(moment: float | None = 45.0, integrator: str = "dop853", **settings: Any) -> dict[str, Any]:
    """A portal, its left column higher loaded than it bears: hinges at its feet, the load and the right corner."""
    rods = [
        {"name": f"{a}{b}", "between": [a, b], "stiffness": 1e6, "bending_stiffness": 1e4, "density": 100.0}
        for a, b in itertools.pairwise("ABCDE")
    ]
    for rod in rods:
        rod |= {"plastic_moment": moment, "damping": 20.0}
    places = {"A": (0, 0), "B": (0, 4), "C": (3, 4), "D": (6, 4), "E": (6, 0)}
    return {
        "format": "pinjoint model",
        "version": 1,
        "settings": {"collisions": False, "integrator": integrator, **settings},
        "particles": [particle(name, x, y, **(CLAMPED if y == 0 else {})) for name, (x, y) in places.items()],
        "rods": rods,
        "loads": [
            {"name": "wind", "on": "B", "force": [30.0, 0.0], "history": RAMP},
            {"name": "weight", "on": "C", "force": [0.0, -50.0], "history": RAMP},
        ],
    }


@pytest.mark.parametrize("number", range(12))
@pytest.mark.parametrize("sprung", [False, True])
def test_forces_are_those_of_least_energy_before_and_after_plastic_rotations_take_it_up(
    number: int, sprung: bool
) -> None:
    lot = np.random.default_rng([33, number])
    document = frames.random_frame(lot, sprung=sprung)
    for rod in document["rods"]:
        rod["plastic_rotation"] = lot.normal(0.0, 0.1, 2).tolist()
        rod["stiffness"] = float(10 ** lot.uniform(1.0, 2.0))
        rod["bending_stiffness"] *= 10.0
        if rod["bending_stiffness"]:
            rod["plastic_moment"] = float(10 ** lot.uniform(0.0, 2.0))
    session, program = program_of(parse(document))
    model = session.model
    program.observe()
    before = program.unbalanced.copy(), program.unbalanced_moment.copy(), model.rods.end_moment.copy()
    assert (np.abs(before[2]) <= model.rods.moment_limit).all(), "to the last bit"
    assert model.rods.hinge_yielding.any()
    program.commit()
    program.observe()
    buckled = model.rods.axial_force * model.rods.rest_length**2 < -10.0 * model.rods.bending_stiffness
    if (buckled & (model.rods.bending_stiffness > 0.0)).any():
        pytest.skip("beyond the rods' own buckling")
    size = max(np.abs(model.rods.axial_force).max(), np.abs(model.rods.end_moment).max())
    bound = 1e-13 * size + 2e-15 * model.rods.stiffness.max()
    force, moment = frames.forces(model)
    free = model.particles.turning > 0.0
    for found in (before, (program.unbalanced, program.unbalanced_moment)):
        assert np.abs(found[0] - force).max() <= bound
        assert np.abs((found[1] - moment)[free]).max() <= bound


def test_every_form_has_the_same_bits() -> None:
    states, turned = [], []
    for form in (FEW, MANY, VERY_MANY):
        document = beam(70)
        for rod in document["rods"]:
            rod["plastic_moment"] = 0.02
        session, program = program_of(parse(document), "velocity_verlet", form)
        session.model.writable("clock.step_size")[0] = 1e-5
        program.advance(50)
        states.append(state_of(session))
        rods = session.model.rods
        turned.append(np.stack([rods.plastic_rotation, rods.hinge_formed_at]))
        assert ("if scratch[" in program.source) == (form != FEW), "the others vectorise"
    assert turned[0][0].any()
    assert (turned[0][1] > 0.0).any()
    assert states[0] == states[1]
    assert (turned[0] == turned[1]).all()
    assert turned[2] == pytest.approx(turned[0], rel=1e-9, abs=1e-15)


@pytest.mark.parametrize("collisions", [False, True])
@pytest.mark.parametrize("integrator", OF_EACH_FORM)
def test_interpreted_and_compiled_programs_have_the_same_bits(integrator: str, collisions: bool) -> None:
    document = portal(10.0, integrator, collisions=collisions)
    for load in document["loads"]:
        load["history"] = RAMP | {"duration": 0.01}
    interpreted = state(document, 60, Compile.NEVER)
    assert state(document, 60, Compile.ALWAYS) == interpreted
    assert state(document, 60, Compile.ELSEWHERE, 17) == interpreted


def test_the_account_closes_with_the_square_of_the_step_and_all_come_to_the_same_rotations() -> None:
    exact = Session.open(portal(tolerance=1e-11))
    exact.run(time=0.8)
    turned, taken = exact.model.rods.plastic_rotation, exact.energy.dissipated_plastic
    assert (np.abs(turned[[0, 2, 3]]) > 0.02).sum() >= 4, "four hinges"
    assert abs(exact.energy.imbalance) < 1e-12 * exact.energy.work
    missing = []
    for step in (1e-4, 0.5e-4, 0.25e-4):
        session = Session.open(portal(integrator="velocity_verlet", time_step=step))
        session.run(time=0.8)
        missing.append(abs(session.energy.imbalance) / session.energy.work)
        assert session.model.rods.plastic_rotation == pytest.approx(turned, rel=1e-5, abs=1e-7)
    assert missing[0] < 1e-8
    assert np.log2(missing[0] / missing[2]) == pytest.approx(4.0, abs=0.8)
    for name, tolerance in (("dop853", 1e-9), ("esdirk4", 1e-9), ("rk4", 1e-9)):
        session = Session.open(portal(integrator=name, tolerance=tolerance))
        session.run(time=0.8)
        assert session.model.rods.plastic_rotation == pytest.approx(turned, rel=1e-7, abs=1e-9)
        assert session.energy.dissipated_plastic == pytest.approx(taken, rel=1e-7)


def fixed_beam(force: float, history: dict[str, Any]) -> dict[str, Any]:
    """A beam of 4 m clamped at both ends, with a force at a quarter, so stiff that nothing moves noticeably."""
    parts = [
        {"name": n, "between": list(n), "stiffness": 1e9, "bending_stiffness": 1e6, "damping": 1e5}
        for n in ("AB", "BC")
    ]
    return {
        "format": "pinjoint model",
        "version": 1,
        "settings": {"collisions": False},
        "environment": {"drag": 2000.0},
        "particles": [
            {"name": "A", "position": [0, 0], **CLAMPED},
            {"name": "B", "position": [1, 0]},
            {"name": "C", "position": [4, 0], **CLAMPED},
        ],
        "rods": [rod | {"plastic_moment": 10.0, "density": 100.0} for rod in parts],
        "loads": [{"name": "down", "on": "B", "force": [0.0, -force], "history": history}],
    }


def test_slow_loads_find_the_moments_of_hinge_by_hinge_calculation_and_leave_its_residual_moments() -> None:
    """Elastic: M_A = Pab²/L² = 9P/16, M_B = 9P/32, M_C = 3P/16. A yields at 160/9 kN; from then on it is a hinge, and
    M_C = Pab(L + a)/2L² = 15P/32. M_B by statics.
    """
    history = {"kind": "table", "times": [0.0, 2.0, 3.0, 5.0], "factors": [0.0, 1.0, 1.0, 0.0]}
    session = Session.open(fixed_beam(24.0, history))
    session.run(time=3.0)
    first = 160.0 / 9.0
    more = 24.0 - first
    at_c = 3.0 / 16.0 * first + 15.0 / 32.0 * more
    at_b = (24.0 * 3.0 - 10.0 * 3.0 - at_c) / 4.0
    moments = session.model.rods.bending_moment
    assert moments.ravel() == pytest.approx([-10.0, at_b, at_b, -at_c], rel=1e-4)
    assert session.model.rods.hinge_yielding.tolist() == [[True, False], [False, False]]
    assert session.model.rods.hinge_formed_at[0, 0] == pytest.approx(2.0 * first / 24.0, rel=1e-3)
    session.run(time=6.0)
    left = np.array([-10.0, at_b, at_b, -at_c]) - 24.0 * np.array(
        [-9.0 / 16.0, 9.0 / 32.0, 9.0 / 32.0, -3.0 / 16.0]
    )
    assert session.model.rods.bending_moment.ravel() == pytest.approx(left, abs=1e-3)


def test_slow_runs_come_to_the_equilibria_of_statics() -> None:
    """At one joint of two rods inertia decides which end turns: together they turn as in statics."""
    document = portal(50.0, "velocity_verlet") | {"environment": {"drag": 60.0}}
    for load in document["loads"]:
        load |= {"history": RAMP | {"duration": 8.0}, "force": [1.04 * part for part in load["force"]]}
    session, found = Session.open(document), Session.open(document).statics("exact").final
    session.run(time=12.0)
    assert session.model.particles.displacement == pytest.approx(found.displacement, abs=2e-6)
    joints = [
        [*(one[[1, 2], 1] - one[[2, 3], 0]), one[3, 1]]
        for one in (session.model.rods.plastic_rotation, found.columns["rods.plastic_rotation"])
    ]
    assert joints[0] == pytest.approx(joints[1], abs=1e-6)
    assert np.abs(joints[0]).min() > 1e-3


def test_a_shaken_portal_keeps_residual_moments_of_least_energy_and_the_account_closes() -> None:
    document = portal(30.0)
    shaking = {"kind": "table", "times": [0, 0.2, 0.6, 1.0, 1.2], "factors": [0, 1.1, -1.1, 0.9, 0]}
    document["environment"] = {"drag": 20.0}
    for load in document["loads"]:
        load["history"] = shaking
    session = Session.open(document)
    session.run(until="rest")
    energy, model = session.energy, session.model
    assert abs(energy.imbalance) < 1e-9 * energy.work
    assert energy.dissipated_plastic > 100.0
    moments = model.rods.end_moment
    assert np.abs(moments).max() > 1.0, "without load"
    assert (np.abs(moments) <= model.rods.moment_limit).all()
    place, rotation = frames.least_energy(model)
    assert model.particles.displacement == pytest.approx(place, abs=1e-7)
    assert model.particles.rotation == pytest.approx(rotation, abs=1e-7)
    elastic = sum(
        frames.rod_energy(
            model,
            row,
            model.particles.displacement[second] - model.particles.displacement[first],
            (model.particles.rotation[first], model.particles.rotation[second]),
        ).real
        for row, (first, second) in enumerate(model.rods.between.astype(int).tolist())
    )
    assert energy.elastic == pytest.approx(1000.0 * elastic, rel=1e-6)


def test_hinges_are_told_with_their_instants_and_saved(tmp_path: Path) -> None:
    session = Session.open(portal())
    session.run(time=0.7)
    happenings = session.document.chronicle.happenings
    told = [one for one in happenings if one.kind == "hinge"]
    assert [one.elements for one in told] == [("D",), ("E",), ("C",), ("A",)], "each particle once"
    [collapse] = [one for one in happenings if one.kind != "hinge"]
    assert (collapse.kind, collapse.elements) == ("collapse", ("A", "C", "D", "E"))
    assert collapse.time == told[-1].time, "the last hinge makes the mechanism"
    assert told[0].message.startswith("A plastic hinge forms at D")
    assert told[0].load_factor == pytest.approx(told[0].time / 0.5)
    path, found = tmp_path / "portal.json", tmp_path / "found.json"
    path.write_text(json.dumps(portal()))
    assert main(["run", str(path), "--at", "0.5", "--format", "json", "--output", str(found)]) == 0
    result = json.loads(found.read_text())
    events = [event for event in result["events"] if event["kind"] == "hinge"]
    assert events[0] | {"time": 0.0} == {
        "kind": "hinge",
        "time": 0.0,
        "particle": "D",
        "rod": "DE",
        "end": "start",
    }
    assert result["states"][-1]["rods"]["DE"]["hinge_yielding"] == [True, True]
    assert result["states"][-1]["rods"]["DE"]["plastic_rotation"][0] > 0.001


def test_switched_off_plasticity_keeps_what_has_turned() -> None:
    session = Session.open(portal())
    session.run(time=0.8)
    turned = session.model.rods.plastic_rotation.copy()
    session.settings.plasticity = False
    assert "slipping" not in session.simulation.program.source
    session.run(time=0.81)
    assert (session.model.rods.plastic_rotation == turned).all()
    assert not session.model.rods.hinge_yielding.any()
