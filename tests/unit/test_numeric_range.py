"""Numbers that can be kept but not computed with are named, with what to do."""

from pathlib import Path
from typing import Any

import pytest

from pinjoint import Session
from pinjoint.components.field import FieldError
from pinjoint.components.numeric_range import incomputable
from pinjoint.paths import PathError, apply_override
from tests.reference.models import model


def test_usual_models_can_be_computed() -> None:
    assert incomputable(Session.open("isostatic").model) == ""


def test_a_number_beyond_computing_is_named_and_the_model_can_still_be_saved(tmp_path: Path) -> None:
    session = Session.open("isostatic")
    session.particles["B"].velocity = (1e300, 0.0)
    assert session.run(steps=5) == "diverged"
    assert session.message == (
        "Particle B: velocity is 1e+300 m/s, too large to compute with; make it at most 1e+30 m/s."
    )
    session.save(tmp_path / "huge.json")
    assert Session.open(tmp_path / "huge.json").particles["B"].velocity == (1e300, 0.0)
    session.undo()
    session.undo()
    assert session.run(steps=5) == "time reached"


def test_a_window_says_so_too() -> None:
    session = Session.open("isostatic")
    session.particles["B"].velocity = (1e200, 0.0)
    session.press("space")
    for _ in range(3):
        session.frame(1 / 60)
    assert session.time == 0.0
    assert "too large to compute with" in session.view.status.problem


def test_masses_and_distances_can_be_too_small() -> None:
    session = Session.open("isostatic")
    for rod in session.model.rods:
        rod.density = 1e-40
    assert "Particle A: mass is 1.70711e-40 kg, too small" in incomputable(session.model)


def test_a_weight_that_leaves_no_rotational_inertia_is_named() -> None:
    session = Session.open("portal")
    session.rods.density, session.particles.mass = 5e-324, 1.0  # inertia 0 would let joints turn without end
    assert session.run(steps=1) == "diverged"
    assert "density is 4.94066e-324 kg/m, too small" in session.message


def test_no_analysis_computes_with_them(answer: Any, tmp_path: Path) -> None:
    session = Session.open("isostatic")
    session.rods["AB"].plastic_strain = 1e300
    with pytest.raises(FieldError, match="Rod AB: plastic strain is 1e\\+300, too large"):
        session.settle()
    session.press("k")
    assert "too large" in session.scenes.active.stages(session)[0][1].heading  # type: ignore[union-attr]
    session.save(tmp_path / "huge.json")
    assert answer("run", str(tmp_path / "huge.json"), status=1)["status"] == "diverged"


def test_strains_can_be_too_large_and_no_warning_comes_first(recwarn: pytest.WarningsRecorder) -> None:
    session = Session.open("isostatic")
    session.rods["AB"].plastic_strain = 1e308
    with pytest.raises(FieldError, match="Rod AB: plastic strain is 1e\\+308, too large"):
        session.settle()
    assert not recwarn.list


@pytest.mark.parametrize(
    ("element", "fact", "value"),
    [
        ("particles.B", "mass", 1e-320),
        ("particles.B", "radius", 1e300),
        ("particles.B", "force", (0.0, -1e300)),
        ("rods.AB", "stiffness", 1e-35),
        ("rods.AB", "rest_length", 1e308),
        ("settings", "time_step", 5e-324),
        ("environment", "drag", 1e31),
    ],
)
def test_what_a_person_sets_is_refused_at_once(
    element: str, fact: str, value: float | tuple[float, float], recwarn: pytest.WarningsRecorder
) -> None:
    session = Session.open("isostatic")
    table, _, name = element.partition(".")
    handle = getattr(session, table)[name] if name else getattr(session.model, table)
    with pytest.raises(FieldError, match=r"it must be at (most|least)"):
        setattr(handle, fact, value)
    said = str(value).strip("()")
    with pytest.raises(PathError, match=r"it must be at (most|least)"):
        apply_override(session.model, f"{element}.{fact}={said}")
    assert session.run(time=0.001) == "time reached"
    assert not recwarn.list


def test_curves_are_refused_without_a_warning_of_numpy(recwarn: pytest.WarningsRecorder) -> None:
    session = Session.open("isostatic")
    session.particles["B"].displacement = (1e300, 0.0)
    with pytest.raises(FieldError, match="Particle B: displacement is 1e\\+300"):
        session.load_path()
    assert not recwarn.list


@pytest.mark.parametrize(("end", "computes"), [(1e9, True), (1e12, True), (1e20, False), (1e30, False)])
def test_a_wall_so_far_that_nothing_can_be_told_to_touch_it_is_named(end: float, computes: bool) -> None:
    ball = {"name": "ball", "position": [0, 0], "radius": 0.5}
    wall = {"name": "ground", "start": [-end, -1.0], "end": [1.0, -1.0]}
    session = Session.open(
        model([ball], [], environment={"acceleration": [0, -9.81]}, components={"walls.Wall": [wall]})
    )
    assert (session.run(time=0.5) == "time reached") == computes
    if computes:
        assert session.model.clock.collisions == 1
        assert session.energy.kinetic == pytest.approx(0.92369, rel=1e-4)
    else:
        assert "The obstacle ground: one of its ends is" in session.message
        assert session.time == 0.0
