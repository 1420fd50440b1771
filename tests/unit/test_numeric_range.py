"""Numbers that can be kept but not computed with are named, with what to do."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from components.field import FieldError
from components.numeric_range import incomputable
from game import Session
from game.commands.command_line import main


def test_usual_models_can_be_computed() -> None:
    assert incomputable(Session.open("isostatic").model) == ""


def test_a_number_beyond_computing_is_named_and_the_model_can_still_be_saved(tmp_path: Path) -> None:
    session = Session.open("isostatic")
    session.environment.force = (1e300, 0.0)
    assert session.run(steps=5) == "diverged"
    assert session.message == (
        "Environment: force is 1e+300 kN, too large to compute with; make it at most 1e+30 kN."
    )
    session.save(tmp_path / "huge.json")
    assert Session.open(tmp_path / "huge.json").environment.force == (1e300, 0.0)
    session.undo()
    session.undo()
    assert session.run(steps=5) == "time reached"


def test_a_window_says_so_too() -> None:
    session = Session.open("isostatic")
    session.environment.acceleration = (1e200, 0.0)
    session.press("space")
    for _ in range(3):
        session.frame(1 / 60)
    assert session.time == 0.0
    assert "too large to compute with" in session.view.status.problem


def test_masses_and_distances_can_be_too_small() -> None:
    session = Session.open("isostatic")
    session.particles["B"].mass = 1e-300
    assert "Particle B: mass is 1e-300 kg, too small" in incomputable(session.model)


def test_no_analysis_computes_with_them(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    session = Session.open("isostatic")
    session.rods["AB"].stiffness = 1e300
    with pytest.raises(FieldError, match="Rod AB: stiffness is 1e\\+300 kN, too large"):
        session.settle()
    session.press("k")
    assert "too large" in session.scenes.active.stages(session)[0][1].heading  # type: ignore[union-attr]
    session.save(tmp_path / "huge.json")
    assert main(["run", str(tmp_path / "huge.json"), "--format", "json"]) == 1
    assert json.loads(capsys.readouterr().out)["status"] == "diverged"


def test_strains_can_be_too_large_and_no_warning_comes_first(recwarn: pytest.WarningsRecorder) -> None:
    session = Session.open("isostatic")
    session.rods["AB"].rest_length = 1e308
    assert "Rod AB: rest length is 1e+308 m, too large" in incomputable(session.model)
    session.undo()
    session.rods["AB"].plastic_strain = 1e308
    with pytest.raises(FieldError, match="Rod AB: plastic strain is 1e\\+308, too large"):
        session.settle()
    assert not recwarn.list


@pytest.mark.parametrize("mass", [1e-320, 1e-35])
def test_such_a_mass_can_be_undone_however_small_it_is(mass: float, recwarn: pytest.WarningsRecorder) -> None:
    session = Session.open("isostatic")
    session.particles["B"].mass = mass
    assert session.run(time=0.001) == "diverged"
    assert "Particle B: mass is" in session.message
    session.undo()
    session.undo()
    assert session.run(time=0.001) == "time reached"
    assert not recwarn.list


def test_curves_are_refused_without_a_warning_of_numpy(recwarn: pytest.WarningsRecorder) -> None:
    session = Session.open("isostatic")
    session.particles["B"].acceleration = (1e300, 0.0)
    session.particles["B"].mass = 1e20
    with pytest.raises(FieldError, match="Particle B: applied acceleration is 1e\\+300"):
        session.load_path()
    assert not recwarn.list
