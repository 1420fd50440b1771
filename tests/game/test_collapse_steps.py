"""Hinge by hinge: the table that one would write by hand, in Python, on the command line, in the window and the sheet."""

import json
from pathlib import Path

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.collapse_steps import collapse_steps
from pinjoint.commands.command_line import main
from pinjoint.components.language import spoken
from pinjoint.documents import models
from pinjoint.sheet import Solved
from tests.verification.test_limit_analysis import MP, portal


def test_a_portal_forms_four_hinges_by_which_it_collapses() -> None:
    table = collapse_steps(models.load(portal(10.0, 20.0)))
    assert table is not None
    assert [name.split(":")[0] for name in table.names] == ["1", "2", "3", "4"]
    assert table.names[0] == "1: hinge at D, DE"
    assert table.names[-1] == "4: hinge at A, AB, collapse"
    factors, *moments, _ = (column.values for column in table.columns)
    assert factors[-1] == pytest.approx(6.0 * MP / 70.0, rel=1e-9)
    assert (np.diff(factors) > 0.0).all()
    for number, values in enumerate(moments):  # a hinge keeps its moment once it has formed
        assert np.abs(values[number:]) == pytest.approx(MP, rel=1e-9)
        assert (np.abs(values[:number]) < MP).all()


def test_it_is_told_on_the_command_line_in_the_window_and_on_the_sheet(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    document = portal(10.0, 20.0)
    path = tmp_path / "portal.json"
    path.write_text(json.dumps(document), encoding="utf-8")
    main(["run", str(path), "--static", "--theory", "first-order", "--format", "json"])
    found = json.loads(capsys.readouterr().out)
    assert found["steps"] == 0  # of time
    steps = found["hinge_by_hinge"]
    assert [step["step"] for step in steps][2] == "3: hinge at E, DE"
    document["settings"] = {"theory": "first-order", "load_steps": [4.0]}
    session = Session.open(document)
    session.press("q")
    assert "limit analysis" in session.document.statics.collapse()[0].lower()
    session.press("n")
    session.lister.turn_to("steps")
    assert session.lister.table.names[0] == "1: hinge at D, DE"
    assert session.lister.listing.title == "Hinge by hinge"
    solved = Solved(models.load(document), "first-order")
    assert solved.steps is not None
    assert [shape.title for shape in solved.collapse] == ["Collapse by limit analysis: load × 4.286"]


def test_names_that_nobody_gave_are_told_in_the_present_language() -> None:
    text = json.dumps(portal(10.0, 20.0)).replace('"DE"', '"rod 4"').replace('"D"', '"particle 4"')
    with spoken("pt"):
        table = collapse_steps(models.load(json.loads(text)))
    assert table is not None
    assert table.names[0] == "1: rótula em partícula 4, barra 4"
    assert (table.columns[1].title, table.columns[1].key) == ("M barra 4.início", "M rod 4.start")


def test_nothing_is_told_where_nothing_limits_the_load() -> None:
    document = portal(10.0, 20.0)
    for rod in document["rods"]:
        del rod["plastic_moment"]
    assert collapse_steps(models.load(document)) is None
