"""Loads between the ends of rods, as people make, see, change, copy and lose them."""

import json
from pathlib import Path
from typing import Any

import pytest

from pinjoint import Session
from pinjoint.commands.command_line import main
from pinjoint.components.mistake import Mistake
from pinjoint.documents.document import document, parse
from pinjoint.results import Results
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.game.test_frames_by_mouse import choose, drag_by, opened, portal, titles
from tests.verification.test_span_loads import frame, simple

Document = dict[str, Any]


def texts(session: Session) -> list[str]:
    return compose(session.model, session.view, load_theme(session.view.theme)).texts


def test_a_force_is_drawn_at_a_place_of_a_rod() -> None:
    session = portal()
    session.press("ctrl+f", session.point(1.0, 3.0))
    x, y = session.point(1.0, 3.0)
    session.press("click", (x, y + 60.0))
    [load] = session.span_loads
    assert (load.rod, load.start, load.end) == (1, pytest.approx(1.0, abs=0.02), None)
    assert load.force[0] == 0.0
    assert load.force[1] < 0.0
    assert session.notice.startswith("BC: (0, −")
    session.undo()
    assert not session.span_loads.count


def test_a_second_click_on_the_rod_distributes_it_up_to_there() -> None:
    session = portal()
    session.press("ctrl+f", session.point(-1.0, 1.0))
    session.click(3.0, 3.0)
    session.click(1.0, 3.0)
    x, y = session.point(1.0, 3.0)
    session.press("click", (x, y + 60.0))
    [load] = session.span_loads
    assert (load.start, load.end) == pytest.approx((1.0, 3.0), abs=0.02)
    assert load.start_intensity == load.end_intensity
    assert load.start_intensity[1] < 0.0
    assert any("kN/m" in text for text in texts(session))


def test_typed_per_length_it_acts_all_along_the_rod() -> None:
    session = portal()
    session.press("ctrl+f", session.point(1.0, 3.0))
    session.type("-20 kN/m")
    session.press("return")
    [load] = session.span_loads
    assert (load.start, load.end) == (0.0, 4.0)
    assert load.start_intensity == load.end_intensity == (0.0, -20.0)
    assert "(0, −20) kN/m" in session.notice


def test_a_moment_is_drawn_at_a_place_of_a_rod_and_removed_in_its_menu() -> None:
    session = portal()
    choose(session, "moment")
    drag_by(session, (2.0, 3.0), (-60.0, 0.0))
    [load] = session.span_loads
    assert load.moment > 0.0
    assert load.start == pytest.approx(2.0, abs=0.02)
    session.press("escape")
    session.press("right click", session.point(1.0, 3.0))
    assert "remove the loads between its ends" in titles(session)
    choose(session, "clear span loads")
    assert not session.span_loads.count


def test_boxes_of_a_rod_show_its_loads() -> None:
    session = opened(simple({"start": 1.0, "force": [0.0, -10.0]}))
    session.select(session.rods["AB"])
    session.press("return")
    session.click_box("moment")
    session.type("5")
    session.press("return")
    assert session.span_loads[0].moment == 5.0


def test_files_hold_them_and_say_nothing_of_defaults() -> None:
    facts = {"rod": "AB", "start": 1.0, "end": 2.5, "end_intensity": [0.0, -3.0], "direction": "local"}
    made = document(parse(simple(facts)))
    assert made["span_loads"] == [{"name": "span load 1", **facts}]
    assert "span_loads" not in document(parse(simple()))


@pytest.mark.parametrize(
    ("load", "said"),
    [
        ({"start": 3.0, "end": 1.0}, "its end, 1 m along the rod, is before its start, 3 m"),
        ({"rod": "XY"}, "There is no 'XY' among the rods"),
        ({"direction": "up"}, "choose one of global, local"),
        ({"start": -1.0}, "at least 0 m"),
    ],
)
def test_wrong_ones_are_refused(load: Document, said: str) -> None:
    with pytest.raises(Mistake, match=said):
        parse(simple({"start": 1.0, "force": [0.0, -10.0]} | load))


def test_a_place_beyond_the_rod_is_named() -> None:
    session = Session.open(simple({"start": 5.0, "force": [0.0, -10.0]}))
    with pytest.raises(Mistake, match="reaches 5 m along rod AB, which is only 4 m long"):
        session.settle()


def test_commands_name_the_file_of_a_load_beyond_its_rod(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "beyond.json"
    path.write_text(json.dumps(simple({"start": 5.0, "force": [0.0, -10.0]})))
    for command in (["run", str(path), "--static"], ["verify", str(path)], ["buckling", str(path)]):
        assert main(command) == 2
        assert capsys.readouterr().err.startswith(f"pinjoint: {path}: Span load 1 reaches 5 m along rod AB")


def test_copies_have_the_loads_of_copied_rods() -> None:
    session = opened(frame())
    session.press("ctrl+a")
    session.press("ctrl+c")
    session.press("ctrl+v")
    assert session.span_loads.count == 10
    assert session.model.span_loads.rod.tolist() == [0, 1, 1, 2, 3, 4, 5, 5, 6, 7]
    session.model.delete([session.rods["BC"]])
    assert session.span_loads.count == 8


def test_sums_of_loads_and_reactions_are_opposite() -> None:
    session = Session.open(frame())
    for theory in ("first-order", "exact"):
        session.model.settings.theory = theory
        session.model.show(session.document.statics)
        sums = Results.of(session.model).sums
        for column in sums.columns:
            assert column.values[0] == pytest.approx(-column.values[1], abs=1e-6), (theory, column.key)


def test_values_are_typed_with_the_tool_in_hand_and_moved_by_a_slider() -> None:
    session = opened(simple({"start": 1.0, "force": [0.0, -10.0]}))
    session.select(session.rods["AB"])
    session.press("ctrl+l")
    [aim] = session.model.sliders[0].aims
    assert (aim.element, aim.field, aim.axis) == (session.span_loads[0], "force", "y")
    session.settings.displacement_scale = 1.0
    session.press("ctrl+f", session.point(3.0, 0.0))
    session.type("-1500 N")
    session.press("return")
    assert (session.span_loads[1].start, session.span_loads[1].force) == (3.0, (0.0, -1.5))
