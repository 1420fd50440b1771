"""What one force does that moves along a path of rods: its envelope, by influence lines, and in the window and commands."""

import json
from pathlib import Path

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.bent import Station
from pinjoint.components.language import spoken
from pinjoint.components.load import SpanLoad
from pinjoint.documents.influence import Influence
from pinjoint.sheet import Solved, contents
from pinjoint.systems.render.backends.paper import LAYOUTS
from tests.game.test_influence import three_spans
from tests.game.test_load_cases_in_window import in_statics, texts
from tests.game.test_sheet import figures_of


def test_it_is_what_influence_lines_say_at_every_section() -> None:
    """Least and most of each line, exact, beside the envelope at positions: less by at most 0.1 % of the largest."""
    session = Session.open(three_spans())
    found = session.envelope(path=["AB", "BC", "CD"])
    for letter in "VM":
        bounds, largest = found.forces[letter].values, np.abs(found.forces[letter].values).max()
        for at in range(0, 41, 5):
            x, station = at / 10.0, np.flatnonzero(np.abs(found.shares[letter][1] - at / 40.0) < 1e-12)
            [line] = Influence.of(session.model, f"BC.{letter}@{x}")
            extremes = [value for _, (value, _, _) in line.extremes(session.model)]
            sides = (bounds[0, 1, station].min(), bounds[1, 1, station].max())
            assert sides == pytest.approx(extremes, abs=1.2e-3 * largest)


def test_it_is_the_worst_of_single_solutions() -> None:
    session, other = Session.open(three_spans()), Session.open(three_spans())
    found = session.envelope(path=["AB", "BC"])
    other.press("q")
    [load] = other.model.create(SpanLoad, rod=[0], force=[[0.0, -1.0]])
    values = []
    for x in np.linspace(0.0, 4.0, 41):
        for row in (0, 1):
            load.rod, load.start = row, x
            values.append(Station.of(other.model, 2, 1.7).forces["M"])
    sides = [value for value, _ in found.at("M", 2, 1.7)]
    assert sides == pytest.approx([min(values), max(values)], abs=1e-9)


def test_several_rods_are_a_path_in_the_window_and_one_after_its_lines() -> None:
    session = in_statics(three_spans())
    session.select(session.rods["AB"], session.rods["BC"])
    session.press("ctrl+i")
    shown = texts(session)
    assert "envelope of 1 kN downwards that moves along AB and BC" in shown
    assert "0.8196 kN·m (AB, 170 cm)" in shown
    assert sum(one.startswith("y: ") and "…" in one for one in shown) == 4, "of every support"
    session.press("ctrl+i")
    assert not session.view.envelope
    session.select(session.rods["AB"])
    for _ in range(6):
        session.press("ctrl+i")
        session.frame(0.0)
        if session.view.envelope:
            break
    assert session.view.enveloped.path == ("AB",)
    assert session.view.shape is None
    session.model.delete([session.rods["AB"]])
    session.frame(0.0)
    assert not session.view.envelope


def test_in_portuguese_rods_are_barras() -> None:
    source = three_spans()
    for number, one in enumerate(source["rods"]):  # type: ignore[arg-type, var-annotated]
        one["name"] = f"rod {number + 1}"
    with spoken("pt"):
        session = in_statics(source)
        session.select(session.rods["rod 1"], session.rods["rod 2"])
        session.press("ctrl+i")
        assert "envolvente de 1 kN para baixo que se desloca ao longo de barra 1 e barra 2" in texts(session)
        assert "0,8196 kN·m (barra 1, 170 cm)" in texts(session)
        session.press("ctrl+i")
        session.select(session.rods["rod 2"])
        session.press("ctrl+i")
        assert session.view.shape is not None
        assert "rod" not in session.view.shape.title


def test_outside_statics_it_is_told_where_it_is_shown() -> None:
    session = Session.open(three_spans())
    session.select(session.rods["AB"], session.rods["BC"])
    session.press("ctrl+i")
    assert "is shown in statics" in session.notice


def test_commands(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model, made = tmp_path / "beam.json", tmp_path / "made.svg"
    model.write_text(json.dumps(three_spans()), encoding="utf-8")
    assert main(["run", str(model), "--static", "--path", "AB", "BC"]) == 0
    assert "AB, 170 cm" in capsys.readouterr().out
    assert main(["render", str(model), "--static", "--path", "AB", "--output", str(made)]) == 0
    assert "that moves along AB" in made.read_text(encoding="utf-8")
    assert main(["sheet", str(model), "--path", "AB", "--output", str(tmp_path / "sheet.pdf")]) == 0
    assert main(["run", str(model), "--path", "AB"]) == 2
    assert main(["run", str(model), "--static", "--path", "XY"]) == 2
    solved = Solved(Session.open(three_spans()).model, "first-order", ["AB"])
    captions = [figure.caption.text for figure in figures_of(contents(solved, LAYOUTS[0]))]
    assert any(one.startswith("Envelope of 1 kN downwards that moves along AB: Bending") for one in captions)


def test_its_size_is_a_setting() -> None:
    """All numbers are multiples of those of 1 kN, and what is shown names the force."""
    session = Session.open(three_spans())
    unit = session.envelope(path=["AB", "BC"])
    session.settings.moving_force = 20.0
    found = session.envelope(path=["AB", "BC"])
    assert found.forces["M"].values == pytest.approx(20.0 * unit.forces["M"].values, abs=1e-9)
    assert found.said.startswith("envelope of 20 kN downwards")
