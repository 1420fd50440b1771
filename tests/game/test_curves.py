"""Load–displacement curves as pictures and in the window: what they show, and where limit points are marked."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.mistake import NotFound, WrongValue
from pinjoint.components.view import Plot
from pinjoint.curves import plot
from tests.reference.models import model as frame
from tests.reference.models import particle, rod


def test_limit_points_are_marked_where_the_load_turns() -> None:
    """Two bars of a shallow truss: the load is greatest where the rise is 1/√3 of the original one, about."""
    session = Session.open("von_mises")
    curve = session.load_path(until="B.y=-2.5")
    drawn = plot(session.model, curve)
    assert (drawn.x_title, drawn.y_title) == ("B.y (m)", "load factor")
    assert drawn.dots is not None
    limits = [event.load_factor for event in curve.events]
    assert drawn.dots[:, 1] == pytest.approx(limits, rel=1e-3)
    rise = 1.0 + drawn.dots[:, 0]
    assert rise == pytest.approx([1.0 / np.sqrt(3.0), -1.0 / np.sqrt(3.0)], abs=0.03)
    with pytest.raises(NotFound, match=r"Q\.y"):
        plot(session.model, curve, ["Q.y"])
    with pytest.raises(WrongValue, match="different units"):
        plot(session.model, curve, ["B.y", "AB"])


@pytest.mark.parametrize(("suffix", "begins"), [(".png", b"\x89PNG"), (".svg", b"<"), (".pdf", b"%PDF")])
def test_the_command_draws_it(suffix: str, begins: bytes, tmp_path: Path) -> None:
    path = tmp_path / f"curve{suffix}"
    assert main(["curve", "von_mises", "--until", "B.y=-2.5", "--output", str(path)]) == 0
    assert path.read_bytes().startswith(begins)


def test_the_command_writes_only_what_is_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["curve", "portal", "--of", "B.x", "--of", "B.rotation"]) == 0
    assert capsys.readouterr().out.splitlines()[0] == "load factor,stable,B.x (m),B (rad)"
    assert main(["curve", "portal", "--of", "nothing"]) == 2
    assert "'nothing'" in capsys.readouterr().err


def plots(session: Session) -> list[Plot]:
    session.frame(0.1)
    return [one.plot for one in session.view.readouts if one.plot is not None]


def test_the_window_plots_it_until_the_next_edit() -> None:
    session = Session.open("von_mises")
    session.press("ctrl+u")
    [shown] = plots(session)
    assert shown.x_title == "B.y (m)"
    assert shown.dots is not None
    session.press("ctrl+u")
    assert plots(session) == []
    session.select(session.particles["B"])
    session.press("ctrl+u")
    [shown] = plots(session)
    assert [name for name, _, _ in shown.curves] == ["B.x", "B.y"]
    session.rods["AB"].stiffness *= 1.1
    assert plots(session) == []


def portal(tmp_path: Path) -> Path:
    """A clamped portal whose plastic hinges form at D, E, C and A; its collapse load factor is 2.5."""
    clamped = {"fixed": [True, True], "fixed_rotation": True}
    document = frame(
        [
            particle("A", 0, 0, **clamped),
            particle("B", 0, 3, force=[20.0, 0.0]),
            particle("C", 2, 3, force=[0.0, -30.0]),
            particle("D", 4, 3),
            particle("E", 4, 0, **clamped),
        ],
        [rod(a, b, bending_stiffness=1e3, plastic_moment=50.0) for a, b in ("AB", "BC", "CD", "DE")],
    )
    document["settings"] = {"load_steps": [2.34]}
    path = tmp_path / "portal.json"
    path.write_text(json.dumps(document), encoding="utf-8")
    return path


def test_plastic_hinges_and_collapse_are_told_and_marked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """By first-order theory as load steps have them; the last row of the table has the collapse."""
    path = portal(tmp_path)
    steps = [e for e in Session.open(path).statics("first-order", 3.0).events if e.kind == "hinge"]
    asked = ["curve", str(path), "--theory", "first-order", "--factor", "9"]
    assert main([*asked, "--format", "json"]) == 1
    events = json.loads(capsys.readouterr().out)["events"]
    assert [e["kind"] for e in events] == ["hinge"] * 4 + ["collapse"]
    assert [(e["particle"], e["rod"], e["end"]) for e in events[:4]] == [(*e.place.values(),) for e in steps]
    assert [e["load_factor"] for e in events[:4]] == pytest.approx([e.load_factor for e in steps], rel=1e-9)
    assert events[4]["load_factor"] == pytest.approx(2.5, rel=1e-12)
    main([*asked, "--of", "B.x"])
    table = list(csv.DictReader(capsys.readouterr().out.splitlines()))
    told = [row["event"] for row in table if row["event"]]
    assert told == ["hinge D", "hinge E", "hinge C", "hinge A, collapse"]
    assert table[-1]["event"] == told[-1]
    session = Session.open(path)
    session.press("ctrl+u")
    [shown] = plots(session)
    assert shown.dots is not None
    assert pytest.approx(shown.dots[:4, 1].tolist(), rel=1e-4) == [2.1007, 2.1023, 2.3223, 2.3609]


def test_a_limit_point_where_a_hinge_forms_is_one_from_which_the_load_falls(tmp_path: Path) -> None:
    """In exact geometry the portal gives way as its last hinge forms, a corner of the curve."""
    curve = Session.open(portal(tmp_path)).load_path(until="B.x=0.4")
    kinds = [event.kind for event in curve.events]
    last = kinds.index("limit point")
    assert kinds[:last] == ["hinge"] * 4
    assert curve.events[last].load_factor == curve.events[last - 1].load_factor < 2.5
    assert "from here on the load falls" in curve.events[last].message


def test_the_window_plots_it_beyond_the_load_steps() -> None:
    """von Mises's truss under less than it bears, and without any load at the end: the curve passes its limit points."""
    for steps in ([0.5], [0.5, 0.0]):
        session = Session.open("von_mises")
        session.settings.load_steps = steps
        session.press("ctrl+u")
        [shown] = plots(session)
        [(_, _, factor)] = shown.curves
        assert factor[-1] == pytest.approx(1.0)
