"""The plan: which systems run in a scene with a model; scenes are honoured by every kind of system."""

import csv
import io
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from numba import njit

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.editor.scenes import PHYSICS, Scene
from pinjoint.systems.base import Commit, Law, Phase, System
from pinjoint.systems.physics.integrators import INTEGRATORS, SemiImplicitEuler
from tests.reference.models import model, particle
from tests.systems.test_events import Crossing

BALL = model([particle("A", 0.0, 0.0)], [])


class Arcade(Scene):
    name = "arcade"
    sources = ("pause",)
    systems = (*PHYSICS, "edit.hover")


class Still(Scene):
    name = "still"
    sources = ("pause",)


@njit
def _lifted(particles_mass: float) -> tuple[float, float]:
    return 0.0, 0.001 * particles_mass


class Lift(Law):
    """Accelerates by 1 m/s² upwards in the arcade."""

    name = "test.lift"
    each = "particles"
    kernel = _lifted
    reads = ("particles.mass",)
    scenes = ("arcade",)


@njit
def _counted(rods_plastic_strain: float) -> tuple[float, float]:
    return rods_plastic_strain + 1.0, 0.0


class Count(Commit):
    """Counts steps in a column that a model without yielding does not use."""

    name = "test.count"
    kernel = _counted
    reads = ("rods.plastic_strain",)
    writes = ("rods.plastic_strain",)
    after = ("plasticity.yielding",)
    scenes = ("arcade",)


class Noting(System):
    """Notes in which scenes it ran."""

    name = "test.noting"
    phase = Phase.STEP
    scenes = ("arcade",)

    def __init__(self) -> None:
        self.ran: list[str] = []

    def process(self, frame: Any) -> None:
        self.ran.append(frame.scene)


@pytest.fixture
def arcade() -> Iterator[Callable[..., Session]]:
    """Opens sessions in which there are two further scenes."""
    EXTENSIONS.scenes.extend([Arcade, Still])
    yield lambda document, *systems: Session.open(document, systems)
    del EXTENSIONS.scenes[-2:]


def go(session: Session, scene: str) -> None:
    if session.scene != "pause":
        session.scenes.request("pause")
    if scene != "pause":
        session.scenes.request(scene)
    session.scenes.apply(session)


# --- what the command prints --------------------------------------------------------------------------------


def test_in_pause_no_time_passes(answer: Any) -> None:
    found = answer("plan", "isostatic", "--scene", "pause")
    assert found["scene"] == "pause"
    assert list(found["phases"]) == ["input", "edit", "step", "events", "render"]
    assert found["phases"]["step"] == []
    assert found["phases"]["edit"] == ["edit.scale", "edit.actions", "edit.hover"]
    assert found["left_out"]["physics.axial_damping"].startswith("not active in 'pause'")


@pytest.mark.parametrize("scene", ["properties", "save", "load"])
def test_in_forms_nothing_of_physics_is_active(answer: Any, scene: str) -> None:
    assert answer("plan", "isostatic", "--scene", scene)["phases"]["step"] == []


def test_in_simulation_what_the_model_needs_acts_and_the_rest_says_why_not(answer: Any) -> None:
    found = answer("plan", "isostatic", "--scene", "simulation")
    assert found["phases"]["step"] == [
        "run.time",
        "physics.elasticity_after_yielding",
        "physics.axial_damping",
        "plasticity.strength",
        "plasticity.yielding",
        "plasticity.first_yield",
        "physics.dop853",
    ]
    why = found["left_out"]
    assert "no particle can meet another" in why["collision.discs"]
    assert why["loads.ramp"] == "no load has a history of this kind"
    assert why["physics.slackness"] == "the model has no cables"
    assert why["physics.rk4"] == "physics.dop853 integrates"


def test_every_system_is_planned_or_left_out_once(answer: Any) -> None:
    found = answer("plan", "ball_on_truss", "--set", "settings.integrator=rk4")
    running = [name for names in found["phases"].values() for name in names]
    assert len(running) == len(set(running))
    assert not set(running) & set(found["left_out"])
    assert "collision.discs" in running
    assert "physics.rk4" in running


def test_the_plan_is_a_table_too(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plan", "isostatic", "--format", "csv"]) == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert {"system": "run.time", "phase": "step", "order": "1", "left_out": ""} in rows
    assert main(["plan", "isostatic"]) == 0
    assert "the model has no cables" in capsys.readouterr().out


def test_an_unknown_scene_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plan", "isostatic", "--scene", "arcade"]) == 2
    assert "There is no scene 'arcade'; choose from pause, simulation" in capsys.readouterr().err


# --- scenes are honoured by every kind of system -----------------------------------------------------------


def test_a_law_acts_in_its_scene_and_nowhere_else(arcade: Callable[..., Session]) -> None:
    session = arcade(BALL, Lift())
    session.run(time=1.0)
    assert session.particles["A"].velocity == (0.0, 0.0)
    go(session, "simulation")
    session.frame(0.5)
    assert session.particles["A"].velocity == (0.0, 0.0)
    go(session, "arcade")
    begun = session.time
    session.run(time=1.0)
    assert session.particles["A"].velocity == pytest.approx((0.0, 1.0))
    assert session.particles["A"].displacement == pytest.approx((0.0, 0.5))
    go(session, "simulation")
    session.run(time=1.0)
    assert session.particles["A"].velocity == pytest.approx((0.0, 1.0))
    assert session.time == pytest.approx(begun + 2.0)
    assert abs(session.energy.imbalance) < 1e-12


def test_frames_of_a_scene_that_wants_physics_let_time_pass_as_in_a_simulation(
    arcade: Callable[..., Session],
) -> None:
    session = arcade(BALL, Lift())
    go(session, "arcade")
    assert session.busy  # so that a window draws frame after frame
    for _ in range(30):
        session.frame(1.0 / 60.0)
    assert session.time > 0.0
    assert session.particles["A"].velocity[1] == pytest.approx(session.time)
    assert session.undo() == "run"
    assert session.time == 0.0


def test_in_a_scene_that_names_no_systems_time_stands_still(arcade: Callable[..., Session]) -> None:
    session = arcade(BALL, Lift())
    go(session, "still")
    session.frame(1.0)
    assert session.time == 0.0
    assert not session.busy
    assert [system.name for system in session.plan("still").phases[Phase.STEP]] == []
    assert "edit.hover" not in session.plan("still").left_out  # hovering is of windows


def test_a_commit_acts_in_its_scene_and_nowhere_else(arcade: Callable[..., Session]) -> None:
    document = {**BALL, "settings": {"plasticity": False, "integrator": "velocity_verlet", "time_step": 1e-4}}
    document["particles"] = [particle("A", 0.0, 0.0), particle("B", 1.0, 0.0, velocity=[1.0, 0.0])]
    document["rods"] = [{"name": "AB", "between": ["A", "B"], "stiffness": 1e-12, "damping": 0}]
    document["environment"] = {"drag": 1.0}  # else nothing but collisions acts, and no steps are taken
    session = arcade(document, Count())
    session.run(steps=10)
    assert session.rods["AB"].plastic_strain == 0.0
    go(session, "arcade")
    session.run(steps=5)
    counted = session.rods["AB"].plastic_strain
    assert counted >= 5.0
    go(session, "pause")
    session.run(steps=5)
    assert session.rods["AB"].plastic_strain == counted


def test_a_frame_system_runs_in_its_scene_and_nowhere_else(arcade: Callable[..., Session]) -> None:
    noting = Noting()
    session = arcade(BALL, noting)
    for scene in ("pause", "simulation", "arcade", "pause"):
        go(session, scene)
        session.frame(0.01)
    assert noting.ran == ["arcade"]


def test_an_integrator_acts_in_its_scenes_and_another_elsewhere(arcade: Callable[..., Session]) -> None:
    class Mine(SemiImplicitEuler):
        name = "test.mine"
        scenes = ("arcade",)

    INTEGRATORS["mine"] = Mine()
    try:
        document = {**BALL, "environment": {"drag": 1.0}, "settings": {"integrator": "mine"}}
        session = arcade(document)
        assert session.simulation.integrator.key == "dop853"
        go(session, "arcade")
        session.run(time=0.01)
        assert session.simulation.integrator.key == "mine"
        assert np.isfinite(session.particles.displacement).all()
    finally:
        del INTEGRATORS["mine"]


def test_what_an_event_noted_in_its_scene_is_kept_in_others(arcade: Callable[..., Session]) -> None:
    class Here(Crossing):
        name = "test.here"
        scenes = ("arcade",)

    class There(Crossing):
        name = "test.there"
        scenes = ("simulation",)

    here, there = Here(), There()
    session = arcade(model([particle("A", 0.0, 0.0, velocity=[-1.0, 0.0])], []), here, there)
    for scene in ("arcade", "simulation", "arcade"):
        go(session, scene)
        session.run(time=0.01)
    assert [len(event.seen) for event in (here, there)] == [1, 1]


def test_the_reason_names_all_scenes_in_which_a_system_is_active(arcade: Callable[..., Session]) -> None:
    reasons = arcade(BALL).plan("pause").left_out
    assert reasons["run.time"] == "not active in 'pause', only in simulation, arcade"
