"""The report of the force method: what it says is what theory says, to the digits shown."""

import re
from collections.abc import Iterator, Sequence
from typing import Any

import pytest

from pinjoint.commands.command_line import main
from pinjoint.components.language import spoken
from pinjoint.components.view import TEXTBOOK, THESIS
from pinjoint.documents import models
from pinjoint.methods import words
from pinjoint.methods.report import contents, report
from pinjoint.methods.tables import ForceTables
from pinjoint.systems.render.backends.paper import LAYOUTS, WIDTH, Layout
from pinjoint.systems.statics.force_method import solve
from pinjoint.systems.statics.theory import linear
from pinjoint.systems.statics.unknowns import Unknown, redundants
from pinjoint.tables import Column
from tests.benchmarks.models import lattice
from tests.game.force_method_models import panels, propped, two_span
from tests.systems.render.frame_models import CLAMPED, frame

OWN = {"panels": panels, "propped": propped, "two_span": two_span}


def solved(name: str, *released: str) -> ForceTables:
    model = OWN[name]() if name in OWN else models.load(name)
    unknowns = [Unknown.named(model, one) for one in released] or redundants(model)
    return ForceTables(model, solve(model, unknowns))


def written_in(parts: Sequence[Any]) -> Iterator[Any]:
    """The paragraphs (texts) and tables (lists of rows) of a report, in order."""
    for part in parts:
        if hasattr(part, "_content"):
            yield from written_in(part._content)
        elif hasattr(part, "getPlainText"):
            yield part.getPlainText()
        elif hasattr(part, "_cellvalues"):
            rows = part._cellvalues
            if isinstance(rows[0][0], str):
                yield [list(row) for row in rows]
            else:
                yield from written_in([inner for row in rows for cell in row for inner in cell])


def number(text: str) -> tuple[float, float]:
    """A written number, and half of its last digit."""
    plain = text.replace("−", "-")
    decimals = len(plain.partition(".")[2])
    return float(plain), 0.5 * 10.0**-decimals if plain != "0" else 1e-9


def tables_of(found: ForceTables, head: str) -> list[list[str]]:
    """The rows below the head of all tables whose second column has this head."""
    rows = [part for part in written_in(contents(found, TEXTBOOK)) if isinstance(part, list)]
    return [row for table in rows if table[0][1].split("\n")[0] == head for row in table[1:]]


@pytest.mark.parametrize(
    ("name", "released"),
    [
        ("hyperstatic", ["BD"]),
        ("tower", ["R0-R1", "R1-L2"]),
        ("portal", []),
        ("two_storey_frame", ["AC.start", "B.x"]),
        ("panels", []),
        ("three_bar_plastic", []),
    ],
)
def test_its_forces_are_those_of_linear_theory_to_the_digits_shown(name: str, released: list[str]) -> None:
    found = solved(name, *released)
    theory = linear(found.model)
    rods = found.model.rods
    rows = tables_of(found, "N")
    assert [row[0] for row in rows] == rods.names
    for row, force in zip(rows, theory.axial_force.tolist(), strict=True):
        value, half = number(row[1])
        assert abs(value - force) <= half * 1.000001
    for row in tables_of(found, "M"):
        rod, _, end = row[0].rpartition(".")
        moment = theory.diagrams["bending_moment"][rods[rod].row, ("start", "end").index(end)]
        value, half = number(row[1])
        assert abs(value - moment) <= half * 1.000001
    for row in tables_of(found, "R"):
        particle, _, axis = row[0].rpartition(".")
        at = found.model.particles[particle].row
        reaction = theory.reaction_moment[at] if axis == "rotation" else theory.reaction[at, "xy".index(axis)]
        value, half = number(row[1])
        assert abs(value - reaction) <= max(half * 1.000001, 1e-9)


def test_its_table_of_virtual_work_adds_up_as_written() -> None:
    [rows] = [
        part
        for part in written_in(contents(solved("hyperstatic", "BD"), TEXTBOOK))
        if isinstance(part, list) and part[0][1].startswith("L\n")
    ]
    head, *body, total = rows
    assert head[-1] == "n₁²L/EA\n10⁻³ cm/kN"
    for column in (5, 6):
        parts = [number(row[column]) for row in body]
        assert sum(value for value, _ in parts) == pytest.approx(number(total[column])[0], abs=1e-12)


def test_the_equation_gives_the_unknown_as_written() -> None:
    said = [
        part for part in written_in(contents(solved("hyperstatic", "BD"), TEXTBOOK)) if isinstance(part, str)
    ]
    [equation] = [line for line in said if line.replace("\u00a0", " ").endswith("X₁ = 0") and "δ" not in line]
    gap, flexibility = (float(part) for part in re.findall(r"[0-9.]+", equation)[:2])
    assert "X₁ = −14.64 kN" in said
    assert f"{-gap / flexibility:.2f}" == "-14.64"
    assert "δ₁₀ + δ₁₁ X₁ = 0" in said


def test_the_report_in_the_convention_of_the_thesis() -> None:
    said = [part for part in written_in(contents(solved("hyperstatic", "BD"), THESIS)) if isinstance(part, str)]
    assert any(line.startswith("p = (Δ − Δ₀) / Δ₁ = ") and "= −14.64 kN" in line for line in said)


def test_the_same_solution_gives_the_same_file() -> None:
    first, again = (report(solved("portal"), TEXTBOOK) for _ in range(2))
    assert first == again
    assert first.startswith(b"%PDF")


def test_large_structures_take_several_pages_and_say_what_is_left_out() -> None:
    model = lattice(300)
    found = ForceTables(model, solve(model, redundants(model)[:1]))
    said = [part for part in written_in(contents(found, TEXTBOOK)) if isinstance(part, str)]
    left_out = model.rods.count - 120
    assert f"{left_out} more rows are not printed; sums are of all." in said
    assert len(report(found, TEXTBOOK)) > 10_000


@pytest.mark.parametrize(
    ("name", "released", "pages"),
    [
        ("hyperstatic", ["BD"], 1),
        ("three_bar_plastic", [], 1),
        ("panels", [], 1),
        ("propped", [], 1),
        ("propped", ["B.y"], 1),
        ("two_span", [], 1),
        ("two_span", ["B.y"], 1),
        ("portal", ["AB.start"], 1),
        ("portal", [], 2),
    ],
)
@pytest.mark.parametrize("language", ["en", "pt"])
def test_usual_exercises_fit_on_one_page(name: str, released: list[str], pages: int, language: str) -> None:
    with spoken(language):
        made = report(solved(name, *released), TEXTBOOK)
    assert len(re.findall(rb"/Type /Page\b(?!s)", made)) == pages


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("name", ["panels", "portal", "two_span"])
def test_nothing_stands_beyond_the_margins_or_over_its_neighbour(name: str, layout: Layout) -> None:
    for row in rows_in(contents(solved(name), TEXTBOOK, layout)):
        width, _ = row.wrap(WIDTH, 1e6)
        assert width <= WIDTH + 0.5
        for cell, column in zip(row._cellvalues[0], row._colWidths, strict=True):
            assert all(part.wrap(column, 1e6)[0] <= column + 0.5 for part in cell)


def rows_in(parts: Sequence[Any]) -> Iterator[Any]:
    """The rows of blocks side by side of a report."""
    for part in parts:
        if hasattr(part, "_content"):
            yield from rows_in(part._content)
        elif hasattr(part, "_cellvalues") and not isinstance(part._cellvalues[0][0], str):
            yield part


def texts_of_figures(found: ForceTables) -> list[list[str]]:
    """The texts in each figure of a report, in order."""
    return [
        part.picture.texts
        for row in rows_in(contents(found, TEXTBOOK))
        for cell in row._cellvalues[0]
        for part in cell
        if hasattr(part, "picture")
    ]


def test_a_unit_force_is_shown_as_a_pair_at_the_cut_without_units() -> None:
    _, loaded, unit, _ = texts_of_figures(solved("hyperstatic", "BD"))
    assert "−100.0 kN" in loaded
    assert "X₁ = 1" in unit
    assert "−0.7071" in unit
    assert not any("kN" in text for text in unit)


@pytest.mark.parametrize(("name", "released"), [("two_span", "BD.start"), ("portal", "AB.start")])
def test_a_unit_moment_is_shown_at_the_hinge_without_units(name: str, released: str) -> None:
    found = texts_of_figures(solved(name, released))[2]
    assert "X₁ = 1" in found
    assert not any("kN" in text for text in found)


def test_the_command_line_writes_it(tmp_path: Any, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "solution.pdf"
    assert main(["force-method", "hyperstatic", "--release", "BD", "--report", str(path)]) == 0
    assert path.read_bytes().startswith(b"%PDF")
    assert main(["force-method", "hyperstatic", "--release", "BD", "--report", "solution.txt"]) == 2
    assert "write a file that ends with .pdf" in capsys.readouterr().err


def test_columns_have_decimals_with_which_they_add_up() -> None:
    import numpy as np

    column = Column("x", "cm", np.array([0.33333, 0.33333, 0.33334]), summed=True)
    parts = [float(column.text(row)) for row in range(3)]
    assert sum(parts) == pytest.approx(float(column.text(3)), abs=1e-12)
    assert Column("x", "cm", np.array([1.5e-7])).head == "x (10⁻⁹ cm)"


@pytest.mark.parametrize("released", [["BC.start", "D.x", "D.y"], ["D.x", "D.y", "D.rotation"]])
def test_what_is_rounding_is_told_as_nothing(released: list[str]) -> None:
    """Both columns of a portal are pushed alike, so that many of its terms are 0."""
    particles = {"A": (0.0, 0.0, CLAMPED), "B": (0.0, 4.0, {}), "C": (6.0, 4.0, {}), "D": (6.0, 0.0, CLAMPED)}
    loads = [{"name": f"at {one}", "on": one, "force": [10.0, 0.0]} for one in "BC"]
    model = models.load(frame(particles, {"A B": {}, "B C": {}, "C D": {}}, loads=loads))
    found = ForceTables(model, solve(model, [Unknown.named(model, name) for name in released]))
    said = [str(part) for part in written_in(contents(found, TEXTBOOK))]
    said += [*words.equations(found), *words.in_thesis(found.solution)]
    assert not [line for line in said if re.search("10⁻[¹²³][⁰-⁹]", line)]
