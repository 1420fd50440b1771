"""Members that bend in commands: theory beside the run, states of theory, and what does not know them yet."""

import json
from pathlib import Path
from typing import Any

import pytest

from pinjoint.commands.command_line import main
from pinjoint.documents import models
from pinjoint.session import Session
from pinjoint.systems.statics.theory import linear
from tests.reference.models import model

Out = pytest.CaptureFixture[str]


@pytest.fixture
def portal(tmp_path: Path) -> Path:
    """Clamped at A, pinned at D, loaded on its beam and pushed aside; with a brace that is a bar."""
    rod = {"bending_stiffness": 8000.0, "stiffness": 8e5, "damping": 3000.0}
    particles: list[dict[str, Any]] = [
        {"name": "A", "position": [0.0, 0.0], "fixed": [True, True], "fixed_rotation": True},
        {"name": "B", "position": [0.0, 4.0], "force": [30.0, 0.0]},
        {"name": "C", "position": [6.0, 4.0]},
        {"name": "D", "position": [6.0, 0.0], "fixed": [True, True]},
    ]
    rods = [
        {"name": "AB", "between": ["A", "B"], **rod},
        {"name": "BC", "between": ["B", "C"], **rod, "distributed_force": [0.0, -10.0]},
        {"name": "CD", "between": ["C", "D"], **rod},
    ]
    document = model(particles, rods) | {"settings": {"collisions": False, "integrator": "esdirk4"}}
    path = tmp_path / "portal.json"
    path.write_text(json.dumps(document | {"environment": {"drag": 20.0}}), encoding="utf-8")
    return path


def test_verify_has_moments_beside_the_run_and_states_like_run(portal: Path, answer: Any) -> None:
    verified = answer("verify", str(portal))
    assert verified["status"] == "verified"
    assert verified["count"] == {"rods": 3, "constraints": 5, "nodes": 4, "hinges": 0, "degree": 2}
    assert verified["indeterminacy"] == {"static": 2, "internal": 0, "external": 2, "mechanisms": 0}
    assert set(verified["rods"]["AB"]["bending_moment"]) == {"start", "end"}
    assert verified["particles"]["B"]["rotation"]["simulation_error"] < 1e-6
    assert verified["particles"]["A"]["reaction_moment"]["exact"] == pytest.approx(54.32256, rel=1e-6)
    for moments in verified["self_stress_moments"]:
        # a joint of two rods passes them on
        assert moments["AB"][1] == pytest.approx(moments["BC"][0], abs=1e-12)
    (settled,) = answer("run", str(portal), "--static")["states"]
    exact, linear = (verified["states"][way] for way in ("exact", "linear"))
    assert set(exact) == set(linear) == set(settled)
    for group in ("particles", "rods"):
        assert {name: set(facts) for name, facts in linear[group].items()} == {
            name: set(facts) for name, facts in settled[group].items()
        }
    for facts in ({"end_axial_force", "shear", "bending_moment", "end_rotation", "largest_moment"},):
        assert facts <= set(linear["rods"]["BC"])
    assert {"rotation", "angular_velocity", "reaction_moment"} <= set(linear["particles"]["B"])
    assert exact["rods"] == settled["rods"]
    value, distance = linear["rods"]["BC"]["largest_moment"]
    start, end = linear["rods"]["BC"]["bending_moment"]
    assert value == pytest.approx(min(start, end))  # the corner of the leeward column
    assert distance in (0.0, 6.0)


def test_verify_of_a_truss_has_states_and_what_it_had(answer: Any) -> None:
    verified = answer("verify", "isostatic")
    assert verified["count"] == {"rods": 3, "constraints": 3, "nodes": 3, "degree": 0}
    assert "self_stress_moments" not in verified
    assert "bending_moment" not in verified["rods"]["AB"]
    assert verified["states"]["linear"]["rods"]["CA"]["axial_force"] == pytest.approx(20.0)
    assert "bending_moment" not in verified["states"]["exact"]["rods"]["AB"]


def test_a_table_of_theory_names_both_ends(portal: Path, capsys: Out) -> None:
    assert main(["verify", str(portal)]) == 0
    text = capsys.readouterr().out
    assert "g = 3m + r − 3n − h = 3·3 + 5 − 3·4 − 0 = 2" in text
    for heading in ("rotation, rad", "reaction moment, kN·m", "shear force, kN", "bending moment, kN·m"):
        assert f"{heading}  " in text
    assert "AB start" in text


def test_the_force_method_says_what_to_release_instead_of_a_rod_that_bends(portal: Path, capsys: Out) -> None:
    assert main(["force-method", str(portal), "--release", "AB"]) == 2
    assert "Release the moment at one of its ends instead: AB.start or AB.end." in capsys.readouterr().err


def test_the_force_method_of_a_portal_gives_what_linear_theory_does(portal: Path, capsys: Out) -> None:
    assert main(["force-method", str(portal), "--all"]) == 0
    found = json.loads(capsys.readouterr().out)
    theory = linear(models.load(portal))
    names = models.load(portal).rods.names
    assert found["axial_force"] == pytest.approx(dict(zip(names, theory.axial_force, strict=True)), rel=1e-9)
    assert set(found["virtual_work"]) == set(names)
    assert found["unit"] == ["kN·m"] * len(found["released"])


def test_a_sweep_measures_moments_of_settled_frames(portal: Path, tmp_path: Path) -> None:
    out = tmp_path / "sweep.csv"
    measures = "rods.AB.bending_moment.start,particles.B.rotation,rods.BC.largest_moment"
    words = ["sweep", str(portal), "--static", "--vary", "particles.B.force.x=10,30", "--measure", measures]
    assert main([*words, "--output", str(out)]) == 0
    first, *rows = out.read_text(encoding="utf-8").splitlines()
    assert first.endswith("rods.BC.largest_moment.value,rods.BC.largest_moment.distance")
    moments = [float(row.split(",")[6]) for row in rows]
    assert moments[1] == pytest.approx(-54.32256, rel=1e-6)
    assert abs(moments[0]) < abs(moments[1])


def test_influence_lines_of_frames(portal: Path, answer: Any) -> None:
    """By the equilibrium of the whole: a force on B along x is borne by both supports."""
    lines = answer("verify", str(portal), "--influence", "A.x", "D.x", "A.y", "D.y", "AB")["influence"]
    for axis, place in (("x", 0), ("y", 1)):
        total = sum(lines[f"{support}.{axis}"]["of"]["B"][place] for support in "AD")
        assert total == pytest.approx(-1.0, abs=1e-12)
    assert lines["AB"]["of"]["B"] == pytest.approx([-v for v in lines["A.y"]["of"]["B"]], abs=1e-12)


def test_a_curve_ends_where_settling_does(portal: Path, answer: Any) -> None:
    curve = answer("curve", str(portal))
    (settled,) = answer("run", str(portal), "--static")["states"]
    assert curve["complete"]
    assert curve["displacement"]["B.x"][-1] == pytest.approx(
        settled["particles"]["B"]["displacement"][0], rel=1e-9
    )
    assert curve["rotation"]["B"][-1] == pytest.approx(settled["particles"]["B"]["rotation"], rel=1e-9)
    moments = [curve["bending_moment"][f"AB.{end}"][-1] for end in ("start", "end")]
    assert moments == pytest.approx(settled["rods"]["AB"]["bending_moment"], rel=1e-9)


def test_the_error_of_a_run_counts_rotations_and_moments(portal: Path, answer: Any) -> None:
    error = answer("run", str(portal), "--at", "0.02")["error_estimate"]
    assert 0.0 < error["relative_rotation"] < 1e-2
    assert 0.0 < error["relative_bending_moment"] < 1e-2


def test_a_person_settles_and_takes_back(portal: Path) -> None:
    session = Session.open(portal)
    assert session.settle() == "equilibrium"
    turned = session.particles["B"].rotation
    assert turned == pytest.approx(-0.009309906, rel=1e-6)
    assert session.rods["AB"].bending_moment[0] == pytest.approx(-54.32256, rel=1e-6)
    rows = {
        (row.name, row.quantity, row.component): row for row in session.document.assessment.comparison().rows
    }
    assert rows["B", "rotation", ""].simulation == turned
    assert rows["AB", "bending_moment", "start"].simulation_error < 1e-12
    session.undo()
    assert session.particles["B"].rotation == 0.0
