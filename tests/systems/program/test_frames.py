"""Members that bend, in step programs: against the energy that their forces derive from, in every form and integrator."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.model import Model
from pinjoint.documents.document import parse
from pinjoint.systems.base import Law
from pinjoint.systems.physics.integrators import INTEGRATORS
from pinjoint.systems.program.kernel import compiled
from pinjoint.systems.program.program import Program
from pinjoint.systems.program.reordered import make_program
from pinjoint.systems.program.writer import FEW, MANY, VERY_MANY
from tests.reference import frames, models

FORMS = (FEW, MANY, VERY_MANY)
OF_TURNING = re.compile(
    r"\b(rotation|angular_velocity|twisting|particles_turning|slope_start|bow_start|lever|per_arm|turn_a)\b"
)


def program_of(model: Model, integrator: str = "velocity_verlet", form: str = FEW) -> tuple[Session, Program]:
    session = Session(model)
    plan = session.simulation.programs.plan
    return session, make_program(session.model, plan, INTEGRATORS[integrator], form)


def beam(count: int = 4, *, clamped: bool = True, **settings: Any) -> dict[str, Any]:
    """A cantilever along x with a force, a moment, a varying load, a distributed force, damped, one warm side, one hinge."""
    foot, tip = {"fixed": [True, True], "fixed_rotation": clamped}, {"force": [0.0, -1.0], "moment": 0.3}
    member = {
        "stiffness": 2e4,
        "bending_stiffness": 50.0,
        "damping": 5.0,
        "distributed_force": [0.1, -0.2],
        "temperature_gradient": 300.0,
    }
    sine = {"kind": "sine", "frequency": 20.0}
    return models.line([(0.5 * i, 0.0) for i in range(count + 1)], foot, tip, **member) | {
        "settings": {"collisions": False, **settings},
        "environment": {"drag": 2.0, "acceleration": [0.0, -9.81]},
        "loads": [{"name": "shaken", "on": f"P{count}", "force": [0.5, 0.2], "moment": 0.4, "history": sine}],
    }


def state_of(session: Session) -> bytes:
    particles = session.model.particles
    columns = (particles.displacement, particles.velocity, particles.rotation, particles.angular_velocity)
    return b"".join(column.tobytes() for column in columns)


@pytest.mark.parametrize("number", range(12))
@pytest.mark.parametrize(("loaded", "warm"), [(False, False), (True, False), (False, True), (True, True)])
def test_forces_are_the_derivatives_of_the_energy(number: int, loaded: bool, warm: bool) -> None:
    model = parse(frames.random_frame(np.random.default_rng([30, number]), loaded=loaded, warm=warm))
    session, program = program_of(model)
    program.observe()
    force, moment = frames.forces(session.model)
    free = session.model.particles.turning > 0.0
    size = max(np.abs(session.model.rods.axial_force).max(), np.abs(session.model.rods.end_moment).max())
    bound = 1e-14 * size + 2e-16 * session.model.rods.stiffness.max()  # displacements are as large as the rods
    assert np.abs(program.unbalanced - force).max() <= bound
    assert np.abs((program.unbalanced_moment - moment)[free]).max() <= bound


@pytest.mark.parametrize(
    ("name", "form"),
    [(n, form) for n, kind in INTEGRATORS.items() for form in FORMS[: 2 if kind.controlled else 3]],
)
def test_trusses_know_nothing_of_it(name: str, form: str) -> None:
    session = Session.open("isostatic")
    plan = session.simulation.programs.plan
    source = make_program(session.model, plan, INTEGRATORS[name], form).source
    assert not OF_TURNING.findall(source)


def test_slopes_without_moments_are_read_only_where_rods_are_warmer_on_one_side() -> None:
    session = Session(parse(beam()))
    assert "rods_initial_slopes" in session.simulation.programs.compiled.source
    session.model.assign(list(session.rods), "temperature_gradient", 0.0)
    assert "rods_initial_slopes" not in session.simulation.programs.compiled.source


@pytest.mark.parametrize("name", ["velocity_verlet", "semi_implicit_euler", "taylor2"])
def test_every_form_has_the_same_bits(name: str) -> None:
    states = []
    for form in (FEW, MANY):
        session, program = program_of(parse(beam(70)), name, form)
        session.model.writable("clock.step_size")[0] = 1e-5
        program.advance(50)
        states.append(state_of(session))
    assert states[0] == states[1]


def test_blocks_are_as_good() -> None:
    found = []
    for form in (FEW, VERY_MANY):
        session, program = program_of(parse(beam(300)), "velocity_verlet", form)
        session.model.writable("clock.step_size")[0] = 1e-5
        program.advance(200)
        program.observe()
        found.append((session.model.particles.rotation, session.model.rods.end_moment, program.measures.copy()))
    for one, other in zip(*found, strict=True):
        assert one == pytest.approx(other, rel=1e-11, abs=1e-11 * np.abs(one).max())


@pytest.mark.parametrize(
    ("name", "step", "order"),
    [("velocity_verlet", 1e-4, 2), ("semi_implicit_euler", 2e-5, 1), ("taylor2", 2e-5, 1), ("rk4", 1e-4, 4)],
)
def test_the_order_is_that_of_the_integrator(name: str, step: float, order: int) -> None:
    exact = Session(parse(beam(3, integrator="dop853", tolerance=1e-13)))
    exact.run(time=0.02)
    errors = []
    for size in (step, step / 2.0):
        session = Session(parse(beam(3, integrator=name, time_step=size)))
        session.run(time=0.02)
        errors.append(np.abs(session.model.particles.rotation - exact.model.particles.rotation).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.15)


@pytest.mark.parametrize(
    ("name", "share"), [("dop853", 1e-9), ("esdirk4", 1e-7), ("rk4", 1e-5), ("velocity_verlet", 1e-3)]
)
def test_the_energy_account_closes(name: str, share: float) -> None:
    session = Session(parse(beam(integrator=name)))
    session.run(time=0.1)
    energy = session.energy
    assert energy.dissipated_damping > 0.1 * abs(energy.work)
    assert abs(energy.imbalance) <= share * abs(energy.work)


@pytest.mark.parametrize("turned", [1.0, -4.0, 1e4])
def test_a_rigid_turn_leaves_no_force(turned: float) -> None:
    model = parse(beam(3))
    model.rods.temperature_gradient = 0.0
    model.rods.distributed_force = (0.0, 0.0)
    position = model.particles.position
    rotated = position @ np.array([[np.cos(turned), np.sin(turned)], [-np.sin(turned), np.cos(turned)]])
    model.writable("particles.displacement")[...] = rotated - position
    model.writable("particles.rotation")[...] = turned
    session, program = program_of(model)
    program.observe()
    assert np.abs(session.model.rods.axial_force / session.model.rods.stiffness).max() < 1e-14
    slope = np.abs(session.model.rods.end_moment).max() / (6.0 * 50.0 / 0.5)
    assert slope <= 4e-16 * max(abs(turned), 1.0) + 1e-15


def test_what_no_longer_bends_has_no_moments() -> None:
    session = Session(parse(beam()))
    session.run(time=0.01)
    assert session.model.rods.bending_moment.any()
    session.model.rods.bending_stiffness = 0.0
    session.run(steps=1)
    assert not session.model.rods.end_moment.any()
    assert not session.model.particles.reaction_moment.any()


@compiled
def spring(slope_start, slope_end):  # type: ignore[no-untyped-def]
    return 30.0 * slope_start, 30.0 * slope_end


class Spring(Law):
    """Rotational springs between rods and their chords, by a mod."""

    name = "mod.spring"
    each = "ends"
    kernel = spring


@compiled
def brake(particles_angular_velocity, particles_rotation):  # type: ignore[no-untyped-def]
    return -0.01 * particles_angular_velocity + 0.0 * particles_rotation


class Brake(Law):
    """Holds all turning up, by a mod."""

    name = "mod.brake"
    each = "rotations"
    kernel = brake
    reads = ("particles.angular_velocity", "particles.rotation")
    account = "dissipated_damping"


@pytest.mark.parametrize("name", ["velocity_verlet", "dop853", "esdirk4"])
def test_laws_of_mods_act_on_ends_and_rotations(name: str) -> None:
    still = Session(parse(beam(integrator=name)))
    session = Session(parse(beam(integrator=name)), [Spring(), Brake()])
    for one in (still, session):
        one.run(time=0.05)
    energy = session.energy
    assert abs(session.model.particles.rotation[-1]) < 0.9 * abs(still.model.particles.rotation[-1])
    assert abs(energy.imbalance) < 1e-3 * abs(energy.work)


def test_where_nothing_bends_they_have_nothing_to_do() -> None:
    session = Session.open("isostatic", [Spring(), Brake()])
    alone = Session.open("isostatic")
    for one in (session, alone):
        one.run(steps=20)
    assert state_of(session) == state_of(alone)


def test_sweeps_of_frames_are_single_runs(tmp_path: Path) -> None:
    model, output = tmp_path / "beam.json", tmp_path / "found.csv"
    model.write_text(json.dumps(beam(2)))
    varied = ["--vary", "rods.*.bending_stiffness=0,50", "--measure", "rods.R0.bending_moment.start"]
    assert main(["sweep", str(model), *varied, "--at", "0.01", "--output", str(output)]) == 0
    lines = output.read_text().splitlines()
    assert [line.partition(",")[0] for line in lines] == ["variant", "0", "1"]


def test_frames_whose_particles_cannot_meet_move_as_if_nothing_could() -> None:
    """Also where steps are taken back because a particle went farther than was expected: moments are put back."""
    states = []
    for collisions in (True, False):
        session = Session.open("portal")
        session.settings.collisions, session.settings.integrator = collisions, "dop853"
        session.run(time=0.5)
        states.append(state_of(session))
    assert states[0] == states[1]
