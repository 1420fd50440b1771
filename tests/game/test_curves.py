"""Load–displacement curves as pictures and in the window: what they show, and where limit points are marked."""

from pathlib import Path

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.mistake import NotFound, WrongValue
from pinjoint.components.view import Plot
from pinjoint.curves import plot


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


def test_the_window_plots_it_beyond_the_load_steps() -> None:
    """von Mises's truss under less than it bears, and without any load at the end: the curve passes its limit points."""
    for steps in ([0.5], [0.5, 0.0]):
        session = Session.open("von_mises")
        session.settings.load_steps = steps
        session.press("ctrl+u")
        [shown] = plots(session)
        [(_, _, factor)] = shown.curves
        assert factor[-1] == pytest.approx(1.0)
