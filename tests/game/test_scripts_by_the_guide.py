"""Eleven scripts as somebody writes them who has read only the README and the guide for scripts."""

import json
import math
from pathlib import Path

import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components import Load, Particle, Rod
from pinjoint.components.field import FieldError
from pinjoint.sweeps import sweep


def test_a_truss_by_hand_and_by_statics() -> None:
    """A joint load on two bars at 45°: N = −F/√2 in each."""
    s = Session.open({"format": "pinjoint model", "version": 1})
    places, held = [(0, 0), (2, 0), (1, 1)], [(True, True), (True, True), (False, False)]
    left, right, top = s.model.create(Particle, 3, name=["L", "R", "T"], position=places, fixed=held)
    s.model.create(Rod, 2, name=["LT", "RT"], between=[(left, top), (right, top)], stiffness=1e5)
    s.particles["T"].force = (0, -10)
    found = s.statics("first-order")
    assert found.final.axial_force.tolist() == pytest.approx([-10 / math.sqrt(2)] * 2)
    assert s.particles["T"].displacement == (0.0, 0.0)  # statics changes nothing
    assert s.settle() == "equilibrium"
    assert s.rods["LT"].axial_force == pytest.approx(-7.07, abs=0.02)


def test_ten_undos_lead_back() -> None:
    s = Session.open("isostatic")
    before = s.particles.position.copy(), s.rods.stiffness.copy()
    for n in range(5):
        s.rods[0].stiffness = 1e5 * (n + 1)
        s.particles["B"].position = (1, 1 + 0.1 * (n + 1))
    for _ in range(10):
        s.undo()
    assert (s.particles.position == before[0]).all()
    assert (s.rods.stiffness == before[1]).all()
    for _ in range(10):
        s.redo()
    assert s.particles["B"].position == (1.0, 1.5)


def test_a_run_and_settling_agree() -> None:
    run, settled = Session.open("isostatic"), Session.open("isostatic")
    assert run.run(until="rest") == "at rest"
    settled.settle()
    assert run.rods.axial_force == pytest.approx(settled.rods.axial_force, abs=1e-5)


def test_a_sweep_is_a_table(tmp_path: Path) -> None:
    found = sweep(
        "isostatic",
        {"rods.CA.stiffness": [1e5, 2e5, 3e5]},
        ["rods.AB.axial_force", "particles.B.displacement.y"],
    )
    assert len(found) == 3
    rows = list(found)
    assert [row["rods.CA.stiffness"] for row in rows] == [1e5, 2e5, 3e5]
    assert rows[0]["rods.AB.axial_force"] == found["rods.AB.axial_force"][0]
    found.write(tmp_path / "x.csv")
    assert len((tmp_path / "x.csv").read_text().splitlines()) == 4


def test_what_is_not_so_is_told() -> None:
    s = Session.open("isostatic")
    s.settle()
    s.expect("rods.AB.axial_force ≈ -28.34 ± 0.01")
    with pytest.raises(AssertionError, match="AB"):
        s.expect("rods.AB.axial_force ≈ -30 ± 0.01")


def test_cases_and_envelopes() -> None:
    s = Session.open("load_cases")
    chosen = s.settings.combination
    both = s.statics(combination="sun").final.axial_force
    assert len(both) == s.rods.count
    assert s.settings.combination == chosen  # looked at
    low, high = s.envelope().extremes("M", 0)
    assert low.value <= high.value
    assert low.combination
    assert high.combination


def test_pictures_of_what_is_shown(tmp_path: Path) -> None:
    s = Session.open("portal")
    s.press("i")
    for name in ("a.png", "a.svg", "a.pdf"):
        s.picture(tmp_path / name)
        assert (tmp_path / name).stat().st_size > 1000
    assert s._repr_png_()[:4] == b"\x89PNG"


def test_scenes_by_their_keys() -> None:
    s = Session.open("hyperstatic")
    s.press("k")
    s.frame(1 / 60)
    s.expect("scene = force method")
    s.press("escape")
    s.frame(1 / 60)
    s.expect("scene = pause")
    s.press("q")
    s.frame(1 / 60)
    s.expect("scene = statics")


def test_loads_that_vary_and_names_that_are_wrong() -> None:
    s = Session.open("isostatic")
    s.model.create(Load, on="B", force=(0, -50), history={"kind": "ramp", "duration": 0.2})
    s.run(time=0.1)
    assert s.particles["B"].applied_force[1] == pytest.approx(s.particles["B"].force[1] - 25)
    with pytest.raises(KeyError, match=r"did you mean|choose one of"):
        s.rods["AX"]
    with pytest.raises(AttributeError, match="axial_force"):
        getattr(s.rods["AB"], "axial_forec")  # noqa: B009
    assert "axial_force" in dir(s.rods)


def test_a_recorded_session_is_played(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines = [
        {"format": "pinjoint session", "version": 1, "title": "Settle", "model": "isostatic"},
        {"set": "particles.B.force=0,-50"},
        {"press": "e"},
        {"expect": "rods.BC.axial_force < -30"},
    ]
    script = tmp_path / "settle.jsonl"
    script.write_text("\n".join(map(json.dumps, lines)), encoding="utf-8")
    assert main(["play", str(script)]) == 0
    lines[-1]["expect"] = "rods.BC.axial_force > 0"
    script.write_text("\n".join(map(json.dumps, lines)), encoding="utf-8")
    assert main(["play", str(script)]) == 1
    assert "line 4" in capsys.readouterr().err


def test_a_model_is_kept_and_read_again(tmp_path: Path) -> None:
    s = Session.open("pendulum")
    s.run(time=0.5)
    s.save(tmp_path / "swung.json")
    again = Session.open(tmp_path / "swung.json")
    assert again.time == s.time
    assert (again.particles.velocity == s.particles.velocity).all()
    s.run(time=0.5)
    again.run(time=0.5)
    assert (again.particles.displacement == s.particles.displacement).all()  # the same bits


def test_results_are_looked_at_in_a_line() -> None:
    session = Session.open("load_cases")
    for result in (
        session.statics(),
        session.envelope(),
        session.buckling(),
        Session.open("hyperstatic").force_method(),
    ):
        assert "\n" not in repr(result)
        assert len(repr(result)) < 1500
    assert "diagrams={'end_axial_force': array (3, 2), 'shear'" in repr(session.statics())
    assert repr(session.envelope()).startswith(
        "Envelope(combinations=('spans 1 and 2', 'spans 1 and 3', …), without={}, "
    )


def test_what_is_no_element_or_diagram_is_named() -> None:
    session = Session.open("load_cases")
    for act in (session.select, lambda name: session.model.delete([name])):
        with pytest.raises(TypeError, match="'AB' is no element; give one, such as rods"):
            act("AB")  # type: ignore[operator]
    with pytest.raises(FieldError, match="There is no 'bending' among the diagrams; choose one of N, M, V"):
        session.envelope().extremes("bending", 0)
    session.model.delete(session.rods)
    with pytest.raises(FieldError, match="The model has no rods, along which an envelope would be"):
        session.envelope()
