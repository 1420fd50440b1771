"""The error that a run is shown with, against its true error."""

import math
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.editor.readouts import readouts
from pinjoint.systems.run.measured_error import FINEST_TOLERANCE
from tests.benchmarks.problems import Problem, tightly, transient, under_damped, yielding_step
from tests.properties.limits import within
from tests.reference import bits
from tests.reference.elements import Model
from tests.reference.models import oscillator, pendulum, square, triangle


def _free(zeta: float) -> Problem:
    made = oscillator(2 * math.pi, zeta, velocity=[0.1, 0])
    return Problem(f"ζ = {zeta}", made, 3.3, lambda: tightly(made, 3.3))


def _stiff(made: Model, time: float) -> Problem:
    return Problem("stiff", made, time, lambda: tightly(made, time))


PROBLEMS = {
    "undamped mass": _free(0.0),
    "under-damped mass": under_damped(),
    "critically damped mass": _free(1.0),
    "over-damped mass": _free(20.0),
    "triangle, undamped": _stiff(triangle(stiffness=164640), 2e-3),
    "triangle, damped": transient(),
    "square": _stiff(square(force=(0, -200), stiffness=164640, damping=10), 3e-3),
    "pendulum": _stiff(pendulum(math.pi / 2), 0.05),
}


def _run(problem: Problem, **settings: Any) -> Session:
    session = Session.open(problem.document | {"settings": {"collisions": False} | settings})
    session.run(time=problem.time)
    return session


def _true_error(session: Session, problem: Problem) -> float:
    return float(np.hypot(*(session.particles.displacement - problem.exact()).T).max())


def _limit(problem: Problem, integrator: str) -> float:
    session = Session.open(problem.document | {"settings": {"collisions": False, "integrator": integrator}})
    session.simulation.advance(0)
    return session.simulation.step_size.stable


@pytest.mark.parametrize("share", [0.9, 0.2])
@pytest.mark.parametrize("problem", PROBLEMS.values(), ids=PROBLEMS)
def test_verlets_error_is_known_within_a_factor_2(problem: Problem, share: float) -> None:
    step = share * _limit(problem, "velocity_verlet")
    session = _run(problem, integrator="velocity_verlet", time_step=step)
    found = session.document.assessment.error()
    assert found is not None
    assert 0.5 < found.displacement / _true_error(session, problem) < 2.0
    largest = np.hypot(*session.particles.displacement.T).max()
    assert 0.0 < found.relative <= found.displacement / largest * (1.0 + 1e-12)


@pytest.mark.parametrize("steps", [150, 400, 1000])
def test_the_error_of_yielding_between_steps_is_known_within_a_factor_3(steps: int) -> None:
    problem = yielding_step()
    session = _run(problem, integrator="velocity_verlet", time_step=problem.time / steps)
    assert session.energy.dissipated_plastic > 0.0
    found = session.document.assessment.error()
    assert found is not None
    assert 1 / 3 < found.displacement / _true_error(session, problem) < 3.0


@pytest.mark.parametrize(
    ("problem", "settings"),
    [
        (under_damped(), {"integrator": "dop853", "tolerance": 1e-6}),
        (transient(), {"integrator": "esdirk4", "tolerance": 1e-5}),
        (under_damped(), {"integrator": "rk4", "time_step": 0.02}),
        (under_damped(), {"integrator": "semi_implicit_euler", "time_step": 1e-3}),
    ],
    ids=lambda value: value.title if isinstance(value, Problem) else value["integrator"],
)
def test_the_error_of_other_integrators_is_known_within_a_factor_2(
    problem: Problem, settings: dict[str, Any]
) -> None:
    session = _run(problem, **settings)
    found = session.document.assessment.error()
    assert found is not None
    assert 0.5 < found.displacement / _true_error(session, problem) < 2.0


def _with_everything() -> Model:
    """A damped square with a cable, yielding rods, a warm rod, displaced supports, a ramp and a load that jumps."""
    made = square(force=(20, -60), stiffness=164640, damping=0.5)
    by_name = {rod["name"]: rod for rod in made["rods"]}
    by_name["AC"] |= {"tension_only": True}
    by_name["BC"] |= {"tensile_strength": 40, "compressive_strength": 40}
    by_name["AB"] |= {"thermal_expansion": 1.2e-5, "temperature_change": 40}
    made["particles"][3]["displacement"] = [1e-4, -2e-4]
    histories = (
        {"kind": "ramp", "start": 1e-3, "duration": 0.0},
        {"kind": "ramp", "start": 0.0, "duration": 2e-3},
    )
    made["loads"] = [{"on": "C", "force": [30, 10], "history": history} for history in histories]
    return made


@pytest.mark.parametrize(
    "settings",
    [
        {"integrator": "dop853", "tolerance": 1e-7},
        {"integrator": "esdirk4", "tolerance": 1e-6},
        {"integrator": "automatic"},
    ],
    ids=lambda settings: settings["integrator"],
)
def test_the_errors_of_all_quantities_at_the_reported_time_are_known_within_a_factor_2(
    settings: dict[str, Any],
) -> None:
    document = _with_everything()
    runs = []
    for chosen in (settings, {"integrator": "dop853", "tolerance": 1e-13}):
        session = Session.open(document | {"settings": {"collisions": False} | chosen})
        session.run(time=3.1e-3)
        runs.append(session)
    run, exact = runs
    assert run.model.clock.departure is not None  # the time is within a step
    assert exact.energy.dissipated_plastic > 0.0
    found = run.document.assessment.error()
    assert found is not None
    velocity = np.hypot(*(run.particles.velocity - exact.particles.velocity).T).max()
    force = np.abs(run.rods.axial_force - exact.rods.axial_force).max()
    assert 0.5 < found.velocity / velocity < 2.0
    assert 0.5 < found.axial_force / force < 2.0
    if settings["integrator"] == "automatic":
        assert found.relative < 1e-6
        assert max(found.relative_velocity, found.relative_axial_force) < 1e-5


def test_measuring_leaves_no_trace() -> None:
    problem = under_damped()
    asked, other = (_run(problem, integrator="velocity_verlet", time_step=0.01) for _ in range(2))
    asked.document.assessment.error()
    assert bits.different(bits.columns(asked.model), bits.columns(other.model)) == []
    for session in (asked, other):
        session.run(time=0.1)
    assert bits.different(bits.columns(asked.model), bits.columns(other.model)) == []
    asked.undo()
    asked.undo()
    assert asked.time == 0.0


def test_there_is_no_error_to_be_known_of_what_was_edited_or_has_not_begun() -> None:
    session = Session.open(under_damped().document | {"settings": {"collisions": False}})
    assert session.document.assessment.error() is None
    session.run(time=0.1)
    session.rods[0].damping = 0.2
    session.run(time=0.1)
    assert session.document.assessment.error() is None


def test_no_frame_waits_for_the_error_of_a_long_run(monkeypatch: pytest.MonkeyPatch) -> None:
    session = Session.open(triangle(stiffness=164640))
    session.run(steps=100)
    evaluations = session.model.clock.steps * 3 * 12  # the stages of dop853
    monkeypatch.setattr("pinjoint.systems.run.measured_error.IN_A_FRAME", evaluations - 1)
    assert session.document.assessment.error() is None
    assert session.document.assessment.error(evaluations) is not None


def test_there_is_none_below_what_a_tolerance_can_tell() -> None:
    session = _run(under_damped(), integrator="dop853", tolerance=2 * FINEST_TOLERANCE)
    assert session.document.assessment.error() is None


@pytest.mark.parametrize(("integrator", "share"), [("rk4", 0.95), ("velocity_verlet", 0.99)])
def test_there_is_none_where_steps_lost_or_created_most_of_the_energy(integrator: str, share: float) -> None:
    made = oscillator(2 * math.pi, 0.0, velocity=[0.1, 0])
    problem = Problem("long", made, 200.0, lambda: tightly(made, 200.0))
    session = _run(problem, integrator=integrator, time_step=share * _limit(problem, integrator))
    assert "energy" in session.message
    assert session.document.assessment.error(10**9) is None


def test_there_is_none_where_states_alternate() -> None:
    made = oscillator(1000.0, mass=1.0, force=1.0)
    problem = Problem("alternating", made, 20.0, lambda: tightly(made, 20.0))
    session = _run(problem, integrator="velocity_verlet", time_step=0.002)  # 2/ω
    assert "the same state" in session.message
    assert session.document.assessment.error(10**9) is None


def test_the_error_is_in_the_report(answer: Any, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["run", "isostatic", "--at", "0.002", "--integrator", "velocity_verlet"]
    found = answer(*words)["error_estimate"]
    assert 0.0 < found["displacement"] < 0.01 * found["relative"]  # of some millimetres
    assert main([*words, "--format", "table"]) == 0
    names = {"displacements": "", "velocities": "_velocity", "axial forces": "_axial_force"}
    shares = ", ".join(f"{name} {found[f'relative{of}']:.7g}" for name, of in names.items())
    said = "errors as shares of the largest value, measured by a run with finer steps:"
    assert f"{said}\n{shares}\n" in capsys.readouterr().out


def test_the_error_is_in_the_energy_panel_while_nothing_moves() -> None:
    session = _run(under_damped(), integrator="velocity_verlet", time_step=0.01)
    session.view.wanted = frozenset({"energy"})
    (readout,) = readouts(session)
    # E^−ζωt (ωh)²/24 ωt.
    assert readout.rows[-3] == ("error of displacements", "0.11 % of the largest")
    assert [title for title, _ in readout.rows[-2:]] == ["error of velocities", "error of axial forces"]
    session.press("space")
    assert session.busy
    (readout,) = readouts(session)
    assert readout.rows[-1][0] == "numerical imbalance"


def test_at_rest_time_that_passes_without_steps_is_not_run_again(answer: Any) -> None:
    ways = (["--until-rest"], ["--at", "20"])
    estimates = [answer("run", "isostatic", *how)["error_estimate"] for how in ways]
    assert estimates[0]["relative"] > 0.0
    assert estimates[0] == estimates[1]


def test_a_run_that_cannot_be_taken_again_in_a_few_times_its_steps_has_no_measured_error() -> None:
    session = Session.open("eulers_columns")
    session.press("e")
    session.press(".")
    session.frame(0.0)
    with within(20.0, "measuring the error of one long step"):
        assert session.document.assessment.error() is None
