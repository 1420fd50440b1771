"""Buckling modes in the window: order, titles, swinging, and how they go away."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.documents import models
from pinjoint.documents.shapes import DRAWN_SHARE, PERIOD, NoShape, buckling_shapes, mode_shapes
from pinjoint.systems.edit.arrows import extent
from pinjoint.systems.render.marks import Text
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.statics.buckling import Buckling
from tests.game.test_shapes import session_of, shown
from tests.verification.test_buckling import CLAMPED, HEADS, column


def opened(parts: int = 4) -> Session:
    return session_of(column(parts, CLAMPED, HEADS["free"]))


def test_buckling_modes_come_before_natural_modes() -> None:
    session, titles = opened(), []
    for _ in range(4):
        session.press("b")
        titles.append(shown(session))
    factor = session.buckling().factors[0]
    assert titles[0] == f"Buckling mode 1: load × {factor:.4g}; effective length 2000 cm (R3)"
    assert [title[:15] for title in titles[1:3]] == ["Buckling mode 2", "Buckling mode 3"]
    assert titles[3].startswith("Mode 1 of ")
    assert titles[0] in compose(session.model, _with_first(session), load_theme()).texts


def test_each_of_eulers_columns_has_its_effective_length() -> None:
    """2 L, L and 0.7 L of columns 2 m high, side by side; then the first buckles into its second mode."""
    session = Session.open("eulers_columns")
    found = session.buckling(4)
    names = [session.rods[int(row)].name[0] for row in found.leading]
    assert names == ["A", "B", "C", "A"]
    assert found.leading_length == pytest.approx(
        [4.0, 2.0, 2.0 * math.pi / 4.493409457909064, 4.0 / 3.0], rel=3e-4
    )


def _with_first(session: Session):
    session.document.shapes.show(buckling_shapes(session.model)[0])
    session.update_view()
    return session.view


def test_a_shape_swings_and_escape_hides_it() -> None:
    session = opened()
    session.press("b")
    session.update_view()
    assert session.view.swing == 1.0
    still = compose(session.model, session.view, load_theme())
    session.update_view(0.5 * PERIOD)
    assert session.view.swing == pytest.approx(-1.0)
    assert _drawn(compose(session.model, session.view, load_theme())) != _drawn(still)
    session.update_view(0.5 * PERIOD)
    assert session.view.swing == pytest.approx(1.0)
    session.press("escape")
    assert shown(session) == ""
    assert session.view.swing == 1.0


def _drawn(picture) -> bytes:
    return b"".join(mark.start.round(3).tobytes() for mark in picture.marks if hasattr(mark, "start"))


def test_an_edit_and_a_new_load_take_it_away() -> None:
    session = opened()
    session.press("b")
    assert shown(session)
    session.particles["P4"].force = (0.0, -2.0)
    assert shown(session) == ""
    session.press("b")
    assert f"load × {session.buckling().factors[0]:.4g}" in shown(session)


def test_what_is_no_danger_is_left_out() -> None:
    """A truss that would be shortened by half of its length first, and a column that is pulled."""
    session = Session.open("isostatic")
    session.press("b")
    assert shown(session) == "Mode 1 of 3: 347.6 Hz"
    assert buckling_shapes(session.model)
    session = Session.open(column(2, CLAMPED, {"force": [0.0, 1.0]}))
    session.press("b")
    assert shown(session).startswith("Mode 1 of ")
    with pytest.raises(NoShape, match="The forces and loads compress no rod"):
        buckling_shapes(session.model)


def test_a_picture_of_a_buckling_mode(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "column.json"
    path.write_text(json.dumps(column(2, CLAMPED, HEADS["free"])))
    words = [
        "render",
        str(path),
        "--size",
        "320x240",
        "--output",
        str(tmp_path / "mode.png"),
        "--buckling-mode",
    ]
    assert main([*words, "1"]) == 0
    assert main([*words, "90"]) == 2
    assert "There is no buckling mode 90; choose a number from 1 to" in capsys.readouterr().err
    assert main(["render", "collision_i", *words[2:], "1"]) == 2
    assert "No force or load acts on the rods" in capsys.readouterr().err
    assert math.isfinite(np.array(Session.open(str(path)).buckling().factors).sum())


def test_labels_stay_where_they_are_while_a_shape_swings() -> None:
    session = opened()
    session.press("b")
    placed: dict = {}
    pictures = []
    for elapsed in (0.0, 0.2 * PERIOD, 0.3 * PERIOD, 0.17 * PERIOD):
        session.update_view(elapsed)
        picture = compose(session.model, session.view, load_theme(), placed)
        pictures.append({mark.text: (mark.x, mark.y) for mark in picture.marks if isinstance(mark, Text)})
    assert all(picture == pictures[0] for picture in pictures)


def test_a_mode_within_a_member_is_drawn_no_larger_than_one_of_joints() -> None:
    """Its joints hardly move: drawn by their displacements it would reach far beyond the picture."""
    model = models.load("portal")
    for shape in (*buckling_shapes(model), *mode_shapes(model)):
        bulge = 0.0 if shape.rotation is None else _deflection(model, shape)
        assert max(np.abs(shape.displacement).max(), bulge) <= 1.01 * DRAWN_SHARE * extent(model), shape.title


def _deflection(model, shape) -> float:
    """The largest deflection of members from the lines between their ends, on their cubics."""
    largest, share = 0.0, np.linspace(0.0, 1.0, 101)
    for rod in model.rods:
        start, end = (shape.displacement[row] for row in rod.between)
        along = np.subtract(*(model.particles.position[row] for row in rod.between[::-1]))
        length = float(np.hypot(*along))
        chord = (along[0] * (end - start)[1] - along[1] * (end - start)[0]) / length**2
        first, last = (shape.rotation[row] - chord for row in rod.between)
        cubic = length * (first * share * (1 - share) ** 2 - last * share**2 * (1 - share))
        largest = max(largest, float(np.abs(cubic).max()))
    return largest


def test_statics_tells_buckling_about_the_exact_equilibrium() -> None:
    """In first order by linear buckling; in exact theory from the last load step on, as vibrations are."""
    session = session_of(column(8, CLAMPED, HEADS["free"], stiffness=1e5))
    session.settings.load_steps = (10.0,)
    session.press("q")
    session.press("b")
    assert shown(session).startswith(f"Buckling mode 1: load × {session.buckling().factors[0]:.4g};")
    session.press("z")
    session.press("b")
    told = session.buckling(1, theory="exact").factors[0]
    assert told > (1.0 + 2e-4) * session.buckling().factors[0]
    shape = session.document.shapes.shown
    assert shape is not None
    assert shape.title.startswith(f"Buckling mode 1: load × {told:.4g};")
    assert shape.about == pytest.approx(session.statics().final.displacement)
    assert "the load factor 10" in shape.note
    assert mode_shapes(session.model, 1)[0].title.startswith("Mode 1 of 24 under load: ")


def test_compression_near_the_critical_pulses_in_the_members_that_take_part() -> None:
    """Of Euler's columns, the cantilever buckles first, at π²EI/(2L)²; the others, at 4 times that and more, stand still."""
    session = Session.open("eulers_columns")
    session.press("q")
    critical = Buckling.of(session.model, 1).factors[0]

    def pulsing(share: float) -> set[str]:
        session.settings.load_steps = [share * critical]
        for _ in range(4):
            session.frame(0.1)
        return {session.model.rods.names[row] for row in session.view.near_buckling}

    assert pulsing(0.79) == set()
    assert pulsing(0.81) == {f"A{k}-A{k + 1}" for k in range(8)}
    before = session.view.swing
    session.frame(0.3)
    assert session.view.swing != before
    assert "near buckling" in compose(session.model, session.view, load_theme()).meanings
    assert pulsing(0.5) == set()


def test_what_pulses_is_known_before_a_run_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    """Finding it took 60 ms of the processor in the first frame of motion, when compression came up."""
    session = Session.open("eulers_columns")
    for _ in range(4):
        session.frame(0.1)
    monkeypatch.setattr(Buckling, "of", None)
    session.press("space")
    session.frame(0.1)
    assert (session.rods.axial_force < 0.0).any()
