"""Sheets: their tables say what hand calculations do, and their figures have all values."""

from collections.abc import Iterable, Iterator
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from pinjoint.commands.command_line import main
from pinjoint.components.bent import AXIAL
from pinjoint.components.rod import bends
from pinjoint.components.theory import EXACT, FIRST_ORDER, THEORIES
from pinjoint.documents import models
from pinjoint.figures import diagram_titles
from pinjoint.session import Session
from pinjoint.sheet import NoSheet, Solved, contents, sheet
from pinjoint.systems.render.backends.paper import LAYOUTS, Figure
from pinjoint.systems.render.marks import Picture, Text
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.render.typography import text_width
from pinjoint.systems.statics.theory import linear
from tests.game.test_force_method_report import written_in
from tests.game.test_results import column
from tests.golden.test_all_values import missing, told

LOAD = load_theme("light").load


def figures_of(parts: Iterable[object]) -> Iterator[Figure]:
    """The figures."""
    for part in parts:
        if isinstance(part, Figure):
            yield part
        for row in getattr(part, "_cellvalues", ()):
            yield from figures_of([inner for cell in row if isinstance(cell, list) for inner in cell])


def boxes_of(picture: Picture) -> list[tuple[str, float, float, float, float]]:
    """The texts of a picture, and what they cover: left, top, right, bottom."""
    found = []
    for mark in picture.marks:
        if isinstance(mark, Text):
            width = text_width(mark.text, mark.size, mark.weight)
            left = mark.x - {"left": 0.0, "centre": 0.5, "right": 1.0}[mark.anchor] * width
            found.append((mark.text, left, mark.y - 0.4 * mark.size, left + width, mark.y + 0.4 * mark.size))
    return found


@pytest.mark.parametrize("name", models.bundled())
def test_every_value_is_told_beside_no_other(name: str) -> None:
    try:
        solved = Solved(models.load(name), FIRST_ORDER)
    except NoSheet:
        return
    assert sheet(models.load(name)).startswith(b"%PDF")  # all have room on pages
    model, titles = solved.model, {title: quantity for quantity, title in diagram_titles().items()}
    for layout in LAYOUTS[:2]:
        told_of = set()
        for figure in figures_of(contents(solved, layout)):
            picture, title = figure.picture, figure.caption.text
            for (one, *a), (other, *b) in combinations(boxes_of(picture), 2):
                apart = a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]
                assert apart, (title, one, other)
            if title in titles:
                told_of.add(titles[title])
                assert missing(model, titles[title], told(picture, model)[0]) == []
            else:
                forces = int((np.abs(model.particles.force) > 1e-4).sum())
                values = [
                    m
                    for m in picture.marks
                    if isinstance(m, Text) and m.colour == LOAD and m.weight == "semibold"
                ]
                drawing = title.startswith("Dimensions")
                assert len(values) >= forces if drawing else not values, title
        assert told_of == ({*titles.values()} if bends(model) else {AXIAL})


def test_a_gerber_beam_has_the_numbers_of_statics() -> None:
    parts = contents(Solved(models.load("gerber_beam"), FIRST_ORDER), LAYOUTS[0])
    tables = {part[0][1]: part for part in written_in(parts) if isinstance(part, list)}
    forces = tables["N start\nkN"]
    assert forces[1][:9] == ["AB", "0", "0", "20.00", "−40.00", "0", "−60.00", "20.00", "200.0"]
    joints = tables["displacement x\ncm"]
    assert [row[5] for row in joints[1:]] == ["20.00", "80.00", "", "", "80.00", "20.00"]
    assert tables["force x\nkN"][-1] == ["Σ", "0", "0", "0"]
    drawing, moments, shears, _, deflected = (figure.picture.texts for figure in figures_of(parts))
    assert [text for text in drawing if text.isdigit()] == ["6", "2", "4", "2", "6"]
    assert {"10 kN/m", "A", "GH"} <= {*drawing}
    assert {"60.00 kN·m", "20.00 kN·m"} <= {*moments}
    assert {"20.00 kN", "80.00 kN"} <= {*drawing}
    assert "−40.00 kN" in shears
    assert all("80.00 kN" not in texts for texts in (moments, shears, deflected))


def test_reactions_stand_in_the_drawing_alone_clear_of_the_loads_above_them() -> None:
    drawing, *others = figures_of(contents(Solved(models.load("load_cases"), FIRST_ORDER), LAYOUTS[0]))
    told = {
        "47.46 kN",
        "143.6 kN",
        "76.14 kN",
        "9.960 kN",
    }  # also where a load is only a settlement of the support
    assert told <= {*drawing.picture.texts}
    assert not any(told & {*figure.picture.texts} for figure in others)


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
    model = models.load("isostatic")
    model.particles["C"].fixed = (False, True)
    with pytest.raises(NoSheet, match="There is no sheet without an equilibrium"):
        sheet(model, theory)


def test_the_mode_that_is_shown_is_in_it_and_a_collapse_once() -> None:
    buckled = Session.open("eulers_columns")
    buckled.press("b")
    assert buckled.view.shape is not None
    bare, more = (
        len(contents(Solved(buckled.model, FIRST_ORDER), LAYOUTS[0], s)) for s in ((), [buckled.view.shape])
    )
    assert more > bare
    solved = Solved(models.load("portal_collapse"), FIRST_ORDER)
    assert len(contents(solved, LAYOUTS[0])) == len(contents(solved, LAYOUTS[0], solved.collapse))


def test_what_collapses_is_shown_as_it_stands_just_before() -> None:
    model = models.load("portal_collapse")
    model.settings.load_steps = [0.5, 1.6]
    solved = Solved(model, FIRST_ORDER)
    assert "Plastic collapse at the load factor 1.500" in solved.said
    largest = max(map(abs, column(solved.results.rods, "bending_moment_end")))
    assert largest == pytest.approx(70.0, rel=1e-5)
    assert column(solved.results.rods, "bending_moment_start")[0] == pytest.approx(-70.0, rel=1e-4)
    assert len(solved.collapse) == 1


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
