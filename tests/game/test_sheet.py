"""Sheets: their tables say what hand calculations do, and their figures have all values."""

from pathlib import Path

import pytest

from pinjoint.commands.command_line import main
from pinjoint.components.theory import EXACT, FIRST_ORDER, THEORIES
from pinjoint.documents import models
from pinjoint.session import Session
from pinjoint.sheet import NoSheet, Solved, contents, sheet
from pinjoint.systems.render.backends.paper import LAYOUTS, Figure
from pinjoint.systems.statics.theory import linear
from tests.game.test_force_method_report import written_in
from tests.game.test_results import column


def figures_of(parts: list[object]) -> list[list[str]]:
    """The texts in each figure."""
    found: list[list[str]] = []
    for part in parts:
        if isinstance(part, Figure):
            found.append(part._picture.texts)
        for row in getattr(part, "_cellvalues", ()):
            found += figures_of([inner for cell in row if isinstance(cell, list) for inner in cell])
    return found


def test_a_gerber_beam_has_the_numbers_of_statics() -> None:
    parts = contents(Solved(models.load("gerber_beam"), FIRST_ORDER), LAYOUTS[0])
    tables = {part[0][1]: part for part in written_in(parts) if isinstance(part, list)}
    forces = tables["N start\nkN"]
    assert forces[1][:9] == ["AB", "0", "0", "20.00", "−40.00", "0", "−60.00", "20.00", "200.0"]
    joints = tables["displacement x\ncm"]
    assert [row[5] for row in joints[1:]] == ["20.00", "80.00", "", "", "80.00", "20.00"]
    assert tables["force x\nkN"][-1] == ["Σ", "0", "0", "0"]
    drawing, moments, shears, _, deflected = figures_of(parts)
    assert [text for text in drawing if text.isdigit()] == ["6", "2", "4", "2", "6"]
    assert {"10 kN/m", "A", "GH"} <= {*drawing}
    assert {"60.00 kN·m", "20.00 kN·m"} <= {*moments}
    assert {"−40.00 kN", "80.00 kN"} <= {*shears}
    assert "80.00 kN" not in deflected


@pytest.mark.parametrize("name", ["portal", "two_storey_frame", "isostatic", "tower", "vierendeel"])
def test_by_default_it_is_first_order_theory(name: str) -> None:
    model = models.load(name)
    theory, found = linear(model), Solved(model, FIRST_ORDER).results
    for key, values in {
        "displacement_x": 100.0 * theory.displacement[:, 0],
        "displacement_y": 100.0 * theory.displacement[:, 1],
    }.items():
        assert column(found.particles, key) == pytest.approx(values.tolist(), rel=1e-9, abs=1e-9)
    if name in ("isostatic", "tower"):
        assert column(found.rods, "axial_force") == pytest.approx(
            theory.axial_force.tolist(), rel=1e-9, abs=1e-9
        )
        return
    for quantity in ("end_axial_force", "shear", "bending_moment"):
        for side, end in enumerate(("start", "end")):
            wanted = theory.diagrams[quantity][:, side].tolist()
            assert column(found.rods, f"{quantity}_{end}") == pytest.approx(wanted, rel=1e-9, abs=1e-7)


def test_in_exact_geometry_it_says_so() -> None:
    model = models.load("portal")
    said = [part for part in written_in(contents(Solved(model, EXACT), LAYOUTS[0])) if isinstance(part, str)]
    assert any(line.startswith("Statics in exact geometry") for line in said)
    found = Solved(model, EXACT).results
    assert column(found.rods, "bending_moment_start")[0] == pytest.approx(-20.5807, rel=1e-5)
    assert found.sums[-1] == ("Σ", "0", "0", "0")
    assert column(found.rods, "largest_moment_at")[1] == pytest.approx(250.0, rel=0.01)


def test_the_last_load_step_is_shown() -> None:
    model = models.load("portal")
    whole = column(Solved(model, FIRST_ORDER).results.rods, "bending_moment_end")
    model.settings.load_steps = [1.0, 0.5]
    half = column(Solved(model, FIRST_ORDER).results.rods, "bending_moment_end")
    assert half == pytest.approx([0.5 * moment for moment in whole], rel=1e-12)


def test_what_a_run_left_behind_is_not_in_it() -> None:
    model = models.load("isostatic")
    fresh = sheet(model)
    model.writable("particles.displacement")[1] = (0.1, 0.1)
    assert sheet(model) == fresh


@pytest.mark.parametrize("theory", THEORIES)
def test_there_is_none_of_what_cannot_be_solved(theory: str) -> None:
    with pytest.raises(NoSheet, match="no rods"):
        sheet(models.load("newtons_cradle"), theory)
    with pytest.raises(NoSheet, match="There is no sheet without an equilibrium"):
        sheet(models.load("isostatic_collapse"), theory)


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "sheet.pdf"
    assert main(["sheet", "portal", "--output", str(path)]) == 0
    assert path.read_bytes().startswith(b"%PDF")
    assert main(["sheet", "newtons_cradle", "--output", str(path)]) == 2
    assert "no structure to solve" in capsys.readouterr().err


def test_what_statics_shows_is_not_where_a_sheet_begins() -> None:
    session = Session.open("three_bar_plastic")
    session.model.settings.load_steps = [1.0, 0.0]
    before = sheet(session.model, EXACT)
    session.press("q")
    assert session.rods["AD"].plastic_strain or session.rods["BD"].plastic_strain
    assert sheet(session.model, EXACT) == before
